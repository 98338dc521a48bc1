// SPDX-License-Identifier: GPL-3.0-or-later
// How the page gets at a machine by itself. The browser asks the person; what was allowed once is found again.
import type { MachineLink } from './machine_link';
import { WorkerLink } from './machine_link';

type Options = Readonly<Record<string, unknown>>;

interface Allowed {
  getInfo?(): { usbVendorId?: number; usbProductId?: number };
}
interface AllowedDevice {
  readonly vendorId: number;
  readonly productId: number;
}
interface PortChooser {
  getPorts(): Promise<Allowed[]>;
  requestPort(options?: object): Promise<Allowed>;
}
interface DeviceChooser {
  getDevices(): Promise<AllowedDevice[]>;
  requestDevice(options: object): Promise<AllowedDevice>;
}
const chooser = () => navigator as unknown as { serial?: PortChooser; usb?: DeviceChooser };

export const hasSerial = (): boolean => chooser().serial !== undefined;
export const hasUsb = (): boolean => chooser().usb !== undefined;

/** Null where the person chose none. */
const cancelled = (thrown: unknown): null => {
  if (thrown instanceof DOMException && (thrown.name === 'NotFoundError' || thrown.name === 'AbortError'))
    return null;
  throw thrown;
};

/** A serial machine: the one that was allowed before, or one that the person chooses now; null where none was chosen. */
export async function openSerial(options: Options, choose = false): Promise<MachineLink | null> {
  const { serial } = chooser();
  if (serial === undefined)
    throw new Error(
      'This browser cannot reach a serial port: use Chrome or Edge, or connect through the worker program.',
    );
  const before = await serial.getPorts();
  const port = !choose && before.length === 1 ? before[0] : await serial.requestPort().catch(cancelled);
  if (!port) return null;
  const index = (await serial.getPorts()).indexOf(port);
  const baud = typeof options['baud'] === 'number' ? options['baud'] : 115200;
  return WorkerLink.open({ kind: 'serial', index, baud }, options);
}

/** A K40 laser on its CH341 board: the one that was allowed before, or one that the person chooses now; null where none was chosen. */
export async function openUsb(options: Options): Promise<MachineLink | null> {
  const { usb } = chooser();
  if (usb === undefined) throw new Error('This browser has no WebUSB: use Chrome or Edge.');
  const board = { vendorId: 0x1a86, productId: 0x5512 };
  const before = (await usb.getDevices()).filter(
    ({ vendorId, productId }) => vendorId === board.vendorId && productId === board.productId,
  );
  const device =
    before.length === 1 ? before[0] : await usb.requestDevice({ filters: [board] }).catch(cancelled);
  if (!device) return null;
  const index = (await usb.getDevices()).indexOf(device);
  return WorkerLink.open({ kind: 'usb', index }, options);
}

/** A GRBL laser or mill that is not there, to practise on. */
export const openVirtual = (options: Options): Promise<WorkerLink> =>
  WorkerLink.open({ kind: 'virtual' }, { ...options, controller: 'grbl' });
