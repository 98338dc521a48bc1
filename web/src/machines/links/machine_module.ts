// SPDX-License-Identifier: GPL-3.0-or-later
// The WASM module that talks to machines, with JavaScript's own types. One a Web Worker.
import type { MachineCommand, MachineEvent, MachineState } from './machine_state';

interface Emscripten {
  readonly HEAPU8: Uint8Array;
  UTF8ToString(pointer: number): string;
  stringToUTF8(text: string, pointer: number, bytes: number): void;
  lengthBytesUTF8(text: string): number;
  _malloc(bytes: number): number;
  _free(pointer: number): void;
  _fw_machine_options(): number;
  _fw_machine_new(options: number): number;
  _fw_machine_call(handle: number, call: number, data: number, size: number, now_s: number): number;
  _fw_machine_next_packet(handle: number): number;
  _fw_machine_packet(): number;
  _fw_virtual_new(bed_x_mm: number, bed_y_mm: number, mill: number, now_s: number): number;
  _fw_virtual_drop(handle: number): void;
  _fw_virtual_receive(handle: number, data: number, size: number, now_s: number): void;
  _fw_virtual_advance(handle: number, now_s: number): number;
  _fw_virtual_trip_limit(handle: number): void;
}
type MachineModuleFactory = (options?: object) => Promise<Emscripten>;

/** What the driver would not do, with the sentence for a person. */
export class MachineRefusal extends Error {
  readonly code: string;
  readonly where: string;
  constructor(code: string, where: string, message: string) {
    super(message);
    this.name = 'MachineRefusal';
    this.code = code;
    this.where = where;
  }
}

export interface MachineAnswer {
  readonly state: MachineState;
  readonly events: readonly MachineEvent[];
  /** To be written to the machine, in this order. */
  readonly packets: readonly Uint8Array<ArrayBuffer>[];
}

export type MachineCall =
  | { readonly call: 'opened' | 'closed' | 'tick' | 'received' }
  | { readonly call: 'load'; readonly name: string }
  | { readonly call: 'command'; readonly command: MachineCommand };

const nothing = new Uint8Array();

export class MachineModule {
  readonly #module: Emscripten;
  constructor(module: Emscripten) {
    this.#module = module;
  }

  static async load(url: string): Promise<MachineModule> {
    const { default: factory } = (await import(/* @vite-ignore */ url)) as { default: MachineModuleFactory };
    return new MachineModule(await factory());
  }

  /** The options of a machine as JSON schemas, each with its name. */
  options(): readonly Record<string, unknown>[] {
    return this.#json(this.#module._fw_machine_options()) as Record<string, unknown>[];
  }

  newDriver(options: Readonly<Record<string, unknown>>): number {
    const text = JSON.stringify(options);
    const { handle } = this.#withText(text, (at) => this.#checked(this.#module._fw_machine_new(at))) as {
      handle: number;
    };
    return handle;
  }

  call(handle: number, call: MachineCall, now_s: number, data: Uint8Array = nothing): MachineAnswer {
    const { state, events } = this.#withText(JSON.stringify(call), (at) =>
      this.#withBytes(data, (pointer) =>
        this.#checked(this.#module._fw_machine_call(handle, at, pointer, data.length, now_s)),
      ),
    ) as { state: MachineState; events: MachineEvent[] };
    const packets: Uint8Array<ArrayBuffer>[] = [];
    for (let size = this.#nextSize(handle); size > 0; size = this.#nextSize(handle))
      packets.push(this.#packet(size));
    return { state, events, packets };
  }

  newVirtual(bed_mm: readonly [number, number], mill: boolean, now_s: number): number {
    return this.#module._fw_virtual_new(bed_mm[0], bed_mm[1], mill ? 1 : 0, now_s);
  }
  dropVirtual(handle: number): void {
    this.#module._fw_virtual_drop(handle);
  }
  tripVirtualLimit(handle: number): void {
    this.#module._fw_virtual_trip_limit(handle);
  }
  tellVirtual(handle: number, data: Uint8Array, now_s: number): void {
    this.#withBytes(data, (pointer) => this.#module._fw_virtual_receive(handle, pointer, data.length, now_s));
  }
  /** Lets time pass for the virtual machine; what it says. */
  advanceVirtual(handle: number, now_s: number): Uint8Array<ArrayBuffer> {
    return this.#packet(this.#module._fw_virtual_advance(handle, now_s) >>> 0);
  }

  #nextSize(handle: number): number {
    return this.#module._fw_machine_next_packet(handle) >>> 0;
  }
  #packet(size: number): Uint8Array<ArrayBuffer> {
    const start = this.#module._fw_machine_packet() >>> 0;
    return new Uint8Array(this.#module.HEAPU8.subarray(start, start + size));
  }
  #json(pointer: number): unknown {
    return JSON.parse(this.#module.UTF8ToString(pointer));
  }
  #checked(pointer: number): unknown {
    const answer = this.#json(pointer) as { error?: { code: string; where: string; message: string } };
    if (answer.error) throw new MachineRefusal(answer.error.code, answer.error.where, answer.error.message);
    return answer;
  }
  #withText<T>(text: string, use: (pointer: number) => T): T {
    const bytes = this.#module.lengthBytesUTF8(text) + 1;
    const pointer = this.#module._malloc(bytes);
    try {
      this.#module.stringToUTF8(text, pointer, bytes);
      return use(pointer);
    } finally {
      this.#module._free(pointer);
    }
  }
  #withBytes<T>(data: Uint8Array, use: (pointer: number) => T): T {
    const pointer = this.#module._malloc(Math.max(data.length, 1));
    try {
      this.#module.HEAPU8.set(data, pointer >>> 0);
      return use(pointer);
    } finally {
      this.#module._free(pointer);
    }
  }
}
