// SPDX-License-Identifier: GPL-3.0-or-later
// The other end of the line: a serial port, a USB device, or the virtual machine. All live in the machine's Web Worker.
import type { MachineModule } from './machine_module';

export interface MachineEnd {
  /** Resolves when the packet is on its way. */
  write(packet: Uint8Array<ArrayBuffer>): Promise<void>;
  close(): Promise<void>;
}
export interface EndListener {
  received(data: Uint8Array): void;
  /** The other end is gone; null where it was closed from here. */
  gone(why: string | null): void;
}

// The parts of Web Serial and WebUSB in use; the library's types do not have them.
interface SerialPortLike {
  readonly readable: ReadableStream<Uint8Array> | null;
  readonly writable: WritableStream<Uint8Array> | null;
  open(options: { baudRate: number; bufferSize?: number }): Promise<void>;
  close(): Promise<void>;
  getInfo(): { usbVendorId?: number; usbProductId?: number };
}
export interface SerialLike {
  getPorts(): Promise<SerialPortLike[]>;
}
interface UsbTransfer {
  readonly data?: DataView;
  readonly status?: string;
}
interface UsbDeviceLike {
  readonly vendorId: number;
  readonly productId: number;
  open(): Promise<void>;
  close(): Promise<void>;
  selectConfiguration(value: number): Promise<void>;
  claimInterface(number: number): Promise<void>;
  releaseInterface(number: number): Promise<void>;
  controlTransferOut(setup: object, data?: BufferSource): Promise<UsbTransfer>;
  transferIn(endpoint: number, bytes: number): Promise<UsbTransfer>;
  transferOut(endpoint: number, data: BufferSource): Promise<UsbTransfer>;
}
export interface UsbLike {
  getDevices(): Promise<UsbDeviceLike[]>;
}

const within = async <T>(ms: number, work: Promise<T>, late: string): Promise<T> => {
  let timer = 0;
  const timeout = new Promise<never>((_, reject) => {
    timer = setTimeout(() => reject(new Error(late)), ms) as unknown as number;
  });
  try {
    return await Promise.race([work, timeout]);
  } finally {
    clearTimeout(timer);
  }
};

/** The `index`-th of the ports that the person has allowed. */
export async function openSerialEnd(
  serial: SerialLike,
  index: number,
  baud: number,
  listener: EndListener,
): Promise<MachineEnd> {
  const port = (await serial.getPorts())[index];
  if (port === undefined)
    throw new Error('The serial port is no longer connected: plug the machine in and choose it again.');
  try {
    await port.open({ baudRate: baud, bufferSize: 4096 });
  } catch (thrown) {
    throw new Error(
      `The serial port could not be opened (${thrown instanceof Error ? thrown.message : String(thrown)}): close other programs that use it.`,
      { cause: thrown },
    );
  }
  const { readable, writable } = port;
  if (readable === null || writable === null)
    throw new Error('The serial port has no streams: unplug the machine and plug it in again.');
  const writer = writable.getWriter();
  let reader = readable.getReader();
  let closing = false;
  const read = async () => {
    try {
      for (;;) {
        const { value, done } = await reader.read();
        if (done) break;
        listener.received(value);
      }
    } catch (thrown) {
      // Framing errors and overruns end the reader, not the port: the next one goes on.
      const name = thrown instanceof DOMException ? thrown.name : '';
      if (
        !closing &&
        port.readable &&
        ['BreakError', 'BufferOverrunError', 'FramingError', 'ParityError'].includes(name)
      ) {
        reader = port.readable.getReader();
        return void read();
      }
    }
    if (!closing) {
      closing = true;
      listener.gone('The cable was unplugged, or the machine switched off.');
    }
  };
  void read();
  return {
    write: async (packet) => writer.write(packet),
    close: async () => {
      closing = true;
      await reader.cancel().catch(() => undefined);
      reader.releaseLock();
      await writer.close().catch(() => undefined);
      await port.close().catch(() => undefined);
      listener.gone(null);
    },
  };
}

/** CH341 in its parallel (EPP) mode, as on K40 boards: everything is a bulk transfer. */
const ch341 = {
  write: 2,
  read: 2,
  initialise: { requestType: 'vendor', recipient: 'device', request: 177, value: 0x0102, index: 0 },
};

export async function openUsbEnd(usb: UsbLike, index: number, listener: EndListener): Promise<MachineEnd> {
  const device = (await usb.getDevices())[index];
  if (device === undefined)
    throw new Error('The laser is no longer connected: plug it in and choose it again.');
  try {
    await device.open();
    await device.selectConfiguration(1);
    // Where the system's own driver holds the interface this may never answer.
    await within(
      3000,
      device.claimInterface(0),
      'The laser is used by another program or driver: close that program, or install the WinUSB driver with Zadig on Windows.',
    );
    await device.controlTransferOut(ch341.initialise);
  } catch (thrown) {
    await device.close().catch(() => undefined);
    throw thrown;
  }
  let open = true;
  const gone = (why: string | null) => {
    if (!open) return;
    open = false;
    listener.gone(why);
  };
  const askStatus = 0xa0;
  return {
    write: async (packet) => {
      // Once it is gone nothing is asked any more; a stop that waited behind a question still leaves.
      if (!open && packet[0] === askStatus) return;
      try {
        await within(
          5000,
          device.transferOut(ch341.write, packet),
          'The laser does not accept data any more: switch it off and on.',
        );
        if (packet[0] !== askStatus) return;
        const answer = await within(
          5000,
          device.transferIn(ch341.read, 32),
          'The laser does not answer: check that it is on and its cable plugged in.',
        );
        if (answer.data)
          listener.received(
            new Uint8Array(answer.data.buffer, answer.data.byteOffset, answer.data.byteLength),
          );
      } catch (thrown) {
        // The browser's own words for it are about transfers.
        const unplugged = thrown instanceof DOMException;
        gone(unplugged ? 'The cable was unplugged, or the laser switched off.' : (thrown as Error).message);
      }
    },
    close: async () => {
      await device.releaseInterface(0).catch(() => undefined);
      await device.close().catch(() => undefined);
      gone(null);
    },
  };
}

export interface VirtualEnd extends MachineEnd {
  /** Lets time pass for the machine, which may say something. */
  advance(now_s: number): void;
  /** Into a limit switch. */
  trip(): void;
}

/** A machine to practise on. Its time is the driver's, which says when it passes. */
export function openVirtualEnd(
  module: MachineModule,
  bed_mm: readonly [number, number],
  mill: boolean,
  now_s: () => number,
  listener: EndListener,
): VirtualEnd {
  const handle = module.newVirtual(bed_mm, mill, now_s());
  let open = true;
  return {
    advance: (now) => {
      const said = module.advanceVirtual(handle, now);
      if (said.length > 0) listener.received(said);
    },
    write: (packet) => {
      if (open) module.tellVirtual(handle, packet, now_s());
      return Promise.resolve();
    },
    trip: () => module.tripVirtualLimit(handle),
    close: () => {
      open = false;
      module.dropVirtual(handle);
      listener.gone(null);
      return Promise.resolve();
    },
  };
}
