// SPDX-License-Identifier: GPL-3.0-or-later
// A machine has a Web Worker of its own: it is served whatever the page is busy with.
import type { ToMachineWorker } from './machine_messages';
import type { Ports } from './machine_runner';
import { MachineRunner } from './machine_runner';

const runner = new MachineRunner((message) => postMessage(message), navigator as unknown as Ports);
let last: Promise<void> = Promise.resolve();
addEventListener('message', ({ data }: MessageEvent<ToMachineWorker>) => {
  // Opening and closing take time; a stop must not wait behind anything but these.
  if (data.type === 'command') void runner.handle(data);
  else last = last.then(() => runner.handle(data));
});
