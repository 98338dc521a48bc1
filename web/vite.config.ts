// SPDX-License-Identifier: GPL-3.0-or-later
import { defineConfig } from 'vitest/config';
import { FlakyReporter } from './scripts/flaky_reporter.ts';
import { licences } from './scripts/licences.ts';
import { serviceWorker } from './scripts/service_worker_plugin.ts';

// SharedArrayBuffer, by which a running job is cancelled, needs cross-origin isolation.
const isolation = {
  'Cross-Origin-Opener-Policy': 'same-origin',
  'Cross-Origin-Embedder-Policy': 'require-corp',
};

export default defineConfig({
  base: './',
  oxc: { jsx: { runtime: 'automatic', importSource: 'preact' } },
  plugins: [licences(), serviceWorker()],
  server: { headers: isolation },
  preview: { headers: isolation },
  worker: { format: 'es' },
  build: { target: 'es2022', assetsInlineLimit: 0, chunkSizeWarningLimit: 900 },
  test: {
    include: ['src/**/*.test.ts', 'src/**/*.test.tsx', 'scripts/**/*.test.ts'],
    environment: 'node',
    retry: process.env['CI'] ? 1 : 0, // what fails is asked once more (setup/test.sh)
    reporters: ['default', new FlakyReporter()],
  },
});
