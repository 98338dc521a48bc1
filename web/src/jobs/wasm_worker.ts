// SPDX-License-Identifier: GPL-3.0-or-later
// The Web Worker in which the core runs. The module is served from public/, not bundled.
import type { FromWorker, ModuleFactory, ToWorker } from './wasm_messages';
import { WasmRunner } from './wasm_runner';

const runner = new WasmRunner(
  (message: FromWorker, transfer) => self.postMessage(message, { transfer }),
  async (url) => ((await import(/* @vite-ignore */ url)) as { default: ModuleFactory }).default,
);

// Messages are handled strictly one after the other, as loading is asynchronous.
let last = Promise.resolve();
self.onmessage = (event: MessageEvent<ToWorker>) => {
  last = last.then(() => runner.handle(event.data));
};
