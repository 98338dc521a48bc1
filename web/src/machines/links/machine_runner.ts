// SPDX-License-Identifier: GPL-3.0-or-later
// Holds one machine: its driver, its line, its clock. Runs in a Web Worker; apart from it so that it can be tested.
import type { EndListener, MachineEnd, SerialLike, UsbLike, VirtualEnd } from './machine_ends';
import { openSerialEnd, openUsbEnd, openVirtualEnd } from './machine_ends';
import type { FromMachineWorker, ToMachineWorker } from './machine_messages';
import type { MachineCall } from './machine_module';
import { MachineModule, MachineRefusal } from './machine_module';
import type { MachineCommand, MachineEvent, MachineState } from './machine_state';
import { Practice } from './practice';

const tick_ms = 50;
/** A practice machine's time passes in such portions. */
const practice_ms = 20;
/** The page hears of changes this often; a change of phase at once. */
const telling_ms = 100;

export interface Ports {
  readonly serial?: SerialLike;
  readonly usb?: UsbLike;
}

const wall_s = (): number => performance.now() / 1000;
const bedOf = ({ bed_x_mm, bed_y_mm }: Readonly<Record<string, unknown>>): readonly [number, number] => [
  typeof bed_x_mm === 'number' ? bed_x_mm : 400,
  typeof bed_y_mm === 'number' ? bed_y_mm : 400,
];

export class MachineRunner {
  readonly #post: (message: FromMachineWorker) => void;
  readonly #ports: Ports;
  #module: MachineModule | null = null;
  #driver = 0;
  #end: MachineEnd | null = null;
  /** Of a machine that is not there; a real one has the wall's time, and no other. */
  #virtual: { readonly end: VirtualEnd; readonly practice: Practice } | null = null;
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
      else if (message.type === 'command') this.#command(message.command);
      else if (message.type === 'load') this.#call({ call: 'load', name: message.name }, message.job);
      else if (message.type === 'trip') this.#virtual?.end.trip();
      else if (message.type === 'speed') this.#setSpeed(message.speed);
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

  #now_s = (): number => this.#virtual?.practice.now_s ?? wall_s();

  #command(command: MachineCommand): void {
    this.#pass(); // it is given now, not at the machine's last portion of time
    this.#call({ call: 'command', command });
  }

  #setSpeed(speed: number): void {
    if (this.#virtual === null) throw new Error('Only a practice machine can run faster than real.');
    this.#pass(); // at the speed before, up to now
    this.#virtual.practice.speed = speed;
  }

  /** Lets the time of a practice machine pass. */
  #pass(): void {
    if (this.#virtual === null || this.#end === null) return;
    const { end, practice } = this.#virtual;
    practice.pass(
      end,
      () => this.#call({ call: 'tick' }),
      () => this.#state,
    );
  }

  async #open({ module, options, end }: ToMachineWorker & { type: 'open' }): Promise<void> {
    this.#module ??= await MachineModule.load(module);
    this.#driver = this.#module.newDriver(options);
    const listener: EndListener = {
      received: (data) => this.#call({ call: 'received' }, data),
      gone: (why) => this.#gone(why),
    };
    const { serial, usb } = this.#ports;
    if (end.kind === 'virtual') this.#end = this.#openPractice(this.#module, options, listener);
    else if (end.kind === 'serial' && serial)
      this.#end = await openSerialEnd(serial, end.index, end.baud, listener);
    else if (end.kind === 'usb' && usb) this.#end = await openUsbEnd(usb, end.index, listener);
    else throw new Error('This browser cannot reach such a port: use Chrome or Edge, or the worker program.');
    this.#call({ call: 'opened' });
    this.#timer =
      this.#virtual === null
        ? setInterval(() => this.#call({ call: 'tick' }), tick_ms)
        : setInterval(() => this.#pass(), practice_ms);
  }

  #openPractice(
    module: MachineModule,
    options: Readonly<Record<string, unknown>>,
    listener: EndListener,
  ): VirtualEnd {
    const practice = new Practice(wall_s);
    const end = openVirtualEnd(
      module,
      bedOf(options),
      options['tool'] === 'mill',
      () => practice.now_s,
      listener,
    );
    this.#virtual = { end, practice };
    return end;
  }

  #call(call: MachineCall, data?: Uint8Array): void {
    if (this.#module === null || this.#driver === 0) throw new Error('The machine is not connected.');
    const { state, events, packets } = this.#module.call(this.#driver, call, this.#now_s(), data);
    const end = this.#end;
    const virtual = end !== null && end === this.#virtual?.end ? end : null;
    // One after the other: what the driver put first must leave first.
    // A practice machine hears at once: its time may go on within this very call.
    if (virtual) for (const packet of packets) void virtual.write(packet);
    else
      for (const packet of packets)
        this.#writing = this.#writing
          .then(() => end?.write(packet))
          .catch(() =>
            this.#gone('The connection was lost while sending: check the cable and connect again.'),
          );
    this.#state = state;
    this.#events.push(...events);
    if (state.phase !== this.#reportedPhase || performance.now() - this.#reported_ms >= telling_ms)
      this.#tell();
  }

  #tell(): void {
    if (this.#state === null) return;
    const practice = this.#virtual?.practice;
    this.#post({
      type: 'state',
      state: practice ? practice.onWall(this.#state) : this.#state,
      events: this.#events,
      ...(practice ? { pace: practice.pace } : {}),
    });
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
