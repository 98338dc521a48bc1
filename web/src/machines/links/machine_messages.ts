// SPDX-License-Identifier: GPL-3.0-or-later
// Between the page and the Web Worker that holds the machine.
import type { MachineCommand, MachineEvent, MachineState } from './machine_state';

export type EndChoice =
  | { readonly kind: 'virtual' }
  | { readonly kind: 'serial'; readonly index: number; readonly baud: number }
  | { readonly kind: 'usb'; readonly index: number };

export type ToMachineWorker =
  | {
      readonly type: 'open';
      readonly id: number;
      readonly module: string;
      readonly options: Readonly<Record<string, unknown>>;
      readonly end: EndChoice;
    }
  | { readonly type: 'command'; readonly id: number; readonly command: MachineCommand }
  | { readonly type: 'load'; readonly id: number; readonly name: string; readonly job: Uint8Array }
  | { readonly type: 'trip'; readonly id: number }
  /** Of a practice machine: seconds of its time a second, while a job runs. */
  | { readonly type: 'speed'; readonly id: number; readonly speed: number }
  | { readonly type: 'close'; readonly id: number };

export type FromMachineWorker =
  | {
      readonly type: 'done';
      readonly id: number;
      readonly error: { readonly code: string; readonly where: string; readonly message: string } | null;
    }
  | {
      readonly type: 'state';
      readonly state: MachineState;
      readonly events: readonly MachineEvent[];
      /** Of a practice machine: seconds of its time a second of the wall, as measured. */
      readonly pace?: number;
    }
  | { readonly type: 'gone'; readonly why: string | null };
