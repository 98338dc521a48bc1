// SPDX-License-Identifier: GPL-3.0-or-later
// What a machine's driver says of itself and may be told: docs/machines.md.

type Phase =
  | 'unknown'
  | 'idle'
  | 'homing'
  | 'jogging'
  | 'running'
  | 'pausing'
  | 'paused'
  | 'stopping'
  | 'alarm'
  | 'door'
  | 'check'
  | 'sleep';

export interface MachineJob {
  readonly name: string;
  readonly line_count: number;
  readonly sent: number;
  readonly acknowledged: number;
  readonly line_now: number;
  readonly started_s: number;
  readonly seconds: number;
  /** From here a job that did not end well may go on, once the machine is homed. */
  readonly careful_line?: number;
  readonly ended: null | 'done' | 'stopped' | 'failed' | 'cut_off';
}

export interface MachineState {
  readonly controller: 'grbl' | 'marlin' | 'k40' | 'ruida';
  readonly connection: 'closed' | 'greeting' | 'ready' | 'silent';
  readonly firmware: string;
  readonly phase: Phase;
  /** Of x and y; each axis of its own is in `axes_known`. */
  readonly position_known: boolean;
  readonly axes_known: { readonly x: boolean; readonly y: boolean; readonly z: boolean };
  readonly machine_mm: readonly number[] | null;
  readonly work_mm: readonly number[] | null;
  readonly speed_mm_per_s: number;
  readonly power_percent: number;
  readonly job: MachineJob | null;
  readonly alarm: { readonly code: number; readonly text: string; readonly fix: string } | null;
  readonly error: {
    readonly code: number;
    readonly text: string;
    readonly line: string;
    readonly line_number: number;
  } | null;
  /** As the machine reports it; null where it does not tell. */
  readonly laser_on: boolean | null;
  /** What a person should read before a start. */
  readonly warnings: readonly string[];
  /** What the machine does with the loaded job when this page, the cable or the computer dies; '' where there is nothing to say. */
  readonly when_connection_ends: string;
  /** Of a mill whose loaded job moves z: where z is 0 in machine coordinates, and how long ago it was set in this connection. */
  readonly z_choice: {
    readonly origin_machine_mm: number | null;
    readonly set_seconds_ago: number | null;
  } | null;
  readonly can: readonly MachineCommand['do'][];
}

/** Z is 0 at the tip of the tool now, or where it was set before. */
export type ZChoice = 'here' | 'kept';

export type MachineCommand =
  | { readonly do: 'unlock' | 'jog_cancel' | 'focus_off' | 'pause' | 'stop' }
  | { readonly do: 'home'; readonly confirmed: boolean }
  | {
      readonly do: 'jog';
      readonly x_mm?: number;
      readonly y_mm?: number;
      readonly z_mm?: number;
      readonly speed_mm_per_s: number;
    }
  | { readonly do: 'set_origin'; readonly axes?: string; readonly at?: 'head' | 'corner' }
  | { readonly do: 'go_to'; readonly x_mm: number; readonly y_mm: number; readonly speed_mm_per_s: number }
  | {
      readonly do: 'frame';
      readonly bounds_mm: readonly [number, number, number, number];
      readonly speed_mm_per_s: number;
      readonly confirmed: boolean;
    }
  | { readonly do: 'focus'; readonly power_percent: number; readonly confirmed: boolean }
  | {
      readonly do: 'start';
      readonly confirmed: boolean;
      readonly from_line?: number;
      readonly z?: ZChoice;
    }
  | { readonly do: 'resume'; readonly confirmed: boolean }
  | { readonly do: 'send'; readonly line: string; readonly confirmed?: boolean }
  | { readonly do: 'override'; readonly feed_percent?: number; readonly power_percent?: number };

export interface MachineEvent {
  readonly event: 'sent' | 'received' | 'note' | 'ended';
  readonly text?: string;
  readonly how?: string;
  readonly now_s: number;
}
