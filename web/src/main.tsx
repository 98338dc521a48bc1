// SPDX-License-Identifier: GPL-3.0-or-later
import { effect } from '@preact/signals';
import { render } from 'preact';
import './ui/tokens.css';
import './ui/ui.css';
import './app/app.css';
import { App } from './app/app';
import { createServices } from './app/create_services';
import { placeOfWork } from './app/rooms';
import { go, place, startRouting } from './app/route';
import { openSampleLink } from './app/share/open_link';
import { isSampleLink } from './app/share/sample_link';
import { followSystemTheme } from './app/theme';
import { resumePending } from './shared/session/full_solve';
import type { Services } from './shared/session/services';
import { EvidenceSession } from './crafts/evidence/evidence_session';
import { MachinesSession } from './crafts/machines/machines_session';
import { ReliefSession } from './crafts/relief/relief_session';
import { ThermoformSession } from './crafts/thermoform/thermoform_session';
import { ZippableSession } from './crafts/zippable/zippable_session';
import { toast } from './ui';

async function start(root: HTMLElement): Promise<void> {
  followSystemTheme();
  const services = await createServices();
  const machines = new MachinesSession(services);
  const sessions = {
    relief: new ReliefSession(services),
    thermoform: new ThermoformSession(services),
    zippable: new ZippableSession(services, machines.laserSheet),
    evidence: new EvidenceSession(services),
    machines,
  };
  effect(() => resumePending(sessions.relief));
  effect(() => resumePending(sessions.relief.forest));
  effect(() => resumePending(sessions.thermoform));
  effect(() => resumePending(sessions.zippable));
  effect(() => resumePending(sessions.machines));
  effect(() => resumePending(sessions.evidence));
  const named = startRouting({
    mayReload: () => everythingSaved(services),
    isLink: isSampleLink,
    openLink: (hash) => void openSampleLink(hash, services, sessions),
  });
  if (!named && !services.projects.isBlank.value)
    go(placeOfWork(services.projects.document.value) ?? 'relief');
  effect(() => {
    for (const [room, { active }] of Object.entries(sessions)) active.value = place.value === room;
  });
  render(<App services={services} sessions={sessions} />, root);
  addEventListener('pagehide', () => void services.projects.flush());
  document.addEventListener('visibilitychange', () => {
    if (document.visibilityState === 'hidden') void services.projects.flush();
  });
  // The worker serves the page itself, always the one that fits it; elsewhere the page keeps itself.
  if (import.meta.env.PROD && services.native === null && 'serviceWorker' in navigator)
    void navigator.serviceWorker.register('./sw.js').catch(() => undefined);
  if (services.native !== null) void forgetKeptPage().catch(() => undefined);
}

/** Opened at the worker's address without its token, the page was kept there: an older one would be shown after an update. */
async function forgetKeptPage(): Promise<void> {
  if (!('serviceWorker' in navigator)) return;
  const registrations = await navigator.serviceWorker.getRegistrations();
  if (registrations.length === 0) return;
  await Promise.all(registrations.map((registration) => registration.unregister()));
  for (const name of await caches.keys()) if (name.startsWith('formwright-')) await caches.delete(name);
}

async function everythingSaved({ projects }: Services): Promise<boolean> {
  await projects.flush();
  const saved = projects.saveState.value;
  if (saved.state === 'failed') toast(saved.message, true);
  return saved.state !== 'failed';
}

const root = document.getElementById('root');
if (root) void start(root);
