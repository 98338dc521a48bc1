// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps the whole page for work without a network. A new build installs beside the old one and takes
// over at the next start. Answers carry the isolation headers, so that a plain file server will do.
/* global self, caches, fetch, Response, Headers, URL */
const cacheName = 'formwright-__VERSION__';
const files = ['__FILES__'];

self.addEventListener('install', (event) => {
  event.waitUntil(
    caches
      .open(cacheName)
      .then((cache) => cache.addAll(files.map((file) => new URL(file, self.registration.scope).href))),
  );
});

self.addEventListener('activate', (event) => {
  event.waitUntil(
    (async () => {
      for (const name of await caches.keys())
        if (name.startsWith('formwright-') && name !== cacheName) await caches.delete(name);
      await self.clients.claim();
    })(),
  );
});

self.addEventListener('message', (event) => {
  if (event.data === 'skip-waiting') self.skipWaiting();
});

function isolated(response) {
  if (response.status === 0 || response.type === 'opaque') return response;
  const headers = new Headers(response.headers);
  headers.set('Cross-Origin-Opener-Policy', 'same-origin');
  headers.set('Cross-Origin-Embedder-Policy', 'require-corp');
  return new Response(response.body, { status: response.status, statusText: response.statusText, headers });
}

async function answer(request) {
  const cache = await caches.open(cacheName);
  const kept = await cache.match(
    request.mode === 'navigate' ? new URL('index.html', self.registration.scope) : request,
    // A server's "Vary: Origin" would keep the page's own scripts from being found.
    { ignoreSearch: true, ignoreVary: true },
  );
  return isolated(kept ?? (await fetch(request)));
}

self.addEventListener('fetch', (event) => {
  const url = new URL(event.request.url);
  const inScope = url.href.startsWith(self.registration.scope);
  const api = url.href.slice(self.registration.scope.length).startsWith('api/');
  if (event.request.method === 'GET' && inScope && !api) event.respondWith(answer(event.request));
});
