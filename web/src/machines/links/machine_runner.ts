// SPDX-License-Identifier: GPL-3.0-or-later
// Holds one machine: its driver, its line, its clock. Runs in a Web Worker; apart from it so that it can be tested.
import type { EndListener, MachineEnd, SerialLike, UsbLike } from './machine_ends';
import { openSerialEnd, openUsbEnd, openVirtualEnd } from './machine_ends';
import type { FromMachineWorker, ToMachineWorker } from './machine_messages';
import type { MachineCall } from './machine_module';
import { MachineModule, MachineRefusal } from './machine_module';
import type { MachineEvent, MachineState } from './machine_state';

const tick_ms = 50;
/** The page hears of changes this often; a change of phase at once. */
const telling_ms = 100;

export interface Ports {
  readonly serial?: SerialLike;
  readonly usb?: UsbLike;
}

const bedOf = ({ bed_x_mm, bed_y_mm }: Readonly<Record<string, unknown>>): readonly [number, number] => [
  typeof bed_x_mm === 'number' ? bed_x_mm : 400,
  typeof bed_y_mm === 'number' ? bed_y_mm : 400,
];

export class MachineRunner {
  readonly #post: (message: FromMachineWorker) => void;
  readonly #ports: Ports;
  #module: MachineModule | null = null;
  #driver = 0;
  #end: (MachineEnd & { trip?(): void }) | null = null;
  /** A line that is gone, until it is closed: it may still hold the device, and a stop may still wait to leave by it. */
  #lost: MachineEnd | null = null;
  #timer: ReturnType<typeof setInterval> | null = null;
  #reported_ms = 0;
  #reportedPhase = '';
  #state: MachineState | null = null;
  #events: MachineEvent[] = [];
  #writing: Promise<void> = Promise.resolve();

  constructor(post: (message: FromMachineWorker) => void, ports: Ports) {
    this.#post = post;
    this.#ports = ports;
  }

  async handle(message: ToMachineWorker): Promise<void> {
    try {
      if (message.type === 'open') await this.#open(message);
      else if (message.type === 'command') this.#call({ call: 'command', command: message.command });
      else if (message.type === 'load') this.#call({ call: 'load', name: message.name }, message.job);
      else if (message.type === 'trip') this.#end?.trip?.();
      else await this.#close();
      this.#post({ type: 'done', id: message.id, error: null });
    } catch (thrown) {
      const refusal = thrown instanceof MachineRefusal ? thrown : null;
      const text = thrown instanceof Error ? thrown.message : String(thrown);
      this.#post({
        type: 'done',
        id: message.id,
        error: { code: refusal?.code ?? 'connection', where: refusal?.where ?? '', message: text },
      });
    }
    this.#tell();
  }

  #now_s = (): number => performance.now() / 1000;

  async #open({ module, options, end }: ToMachineWorker & { type: 'open' }): Promise<void> {
    this.#module ??= await MachineModule.load(module);
    this.#driver = this.#module.newDriver(options);
    const listener: EndListener = {
      received: (data) => this.#call({ call: 'received' }, data),
      gone: (why) => this.#gone(why),
    };
    const { serial, usb } = this.#ports;
    if (end.kind === 'virtual')
      this.#end = openVirtualEnd(
        this.#module,
        bedOf(options),
        options['tool'] === 'mill',
        this.#now_s,
        listener,
      );
    else if (end.kind === 'serial' && serial)
      this.#end = await openSerialEnd(serial, end.index, end.baud, listener);
    else if (end.kind === 'usb' && usb) this.#end = await openUsbEnd(usb, end.index, listener);
    else throw new Error('This browser cannot reach such a port: use Chrome or Edge, or the worker program.');
    this.#call({ call: 'opened' });
    this.#timer = setInterval(() => this.#call({ call: 'tick' }), tick_ms);
  }

  #call(call: MachineCall, data?: Uint8Array): void {
    if (this.#module === null || this.#driver === 0) throw new Error('The machine is not connected.');
    const { state, events, packets } = this.#module.call(this.#driver, call, this.#now_s(), data);
    const end = this.#end;
    // One after the other: what the driver put first must leave first.
    for (const packet of packets)
      this.#writing = this.#writing
        .then(() => end?.write(packet))
        .catch(() => this.#gone('The connection was lost while sending: check the cable and connect again.'));
    this.#state = state;
    this.#events.push(...events);
    if (state.phase !== this.#reportedPhase || performance.now() - this.#reported_ms >= telling_ms)
      this.#tell();
  }

  #tell(): void {
    if (this.#state === null) return;
    this.#post({ type: 'state', state: this.#state, events: this.#events });
    this.#events = [];
    this.#reportedPhase = this.#state.phase;
    this.#reported_ms = performance.now();
  }

  #gone(why: string | null): void {
    if (this.#end === null) return;
    if (why !== null) this.#lost = this.#end;
    this.#end = null;
    if (this.#timer !== null) clearInterval(this.#timer);
    try {
      this.#call({ call: 'closed' });
    } catch {
      // The driver itself broke: the page hears that the line is gone all the same.
    }
    this.#tell();
    this.#post({ type: 'gone', why });
  }

  /** What was written before leaves first, a stop above all. */
  async #close(): Promise<void> {
    const end = this.#end ?? this.#lost;
    this.#lost = null;
    await this.#writing.catch(() => undefined);
    await end?.close();
  }
}
