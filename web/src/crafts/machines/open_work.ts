// SPDX-License-Identifier: GPL-3.0-or-later
// Takes up what was dropped, chosen or sent here: a drawing, a job, or what a mill carves.
import { effect } from '@preact/signals';
import type { Catalog, JsonObject } from '../../jobs/contract';
import { asJobError } from '../../jobs/contract';
import type { MachineControl } from '../../machines/machine_control';
import type { MachineProfile, ProfileStore } from '../../machines/profiles';
import { nameProject } from '../../shared/session/craft_document';
import type { Change, RoomSession } from '../../shared/session/room_session';
import type { Services } from '../../shared/session/services';
import type { FileWork, MachinesDocument } from './machines_document';
import { drawingEndings, heightMapEnding, jobEndings, machines, pictureSize } from './machines_document';

interface MachineInUse {
  readonly control: MachineControl;
  readonly profiles: ProfileStore;
  readonly isMill: boolean;
  /** New work is for the machine in use. */
  takeMachine(catalog: Catalog, change: Change): void;
  useProfile(profile: MachineProfile): void;
  practise(): Promise<void>;
}
type MachinesRoom = RoomSession<MachinesDocument> & MachineInUse;

interface OpenedFile {
  readonly file_name: string;
  readonly bytes: Uint8Array<ArrayBuffer>;
  readonly kind: FileWork['kind'];
  /** What is known of it beside its bytes, for the job. */
  readonly own?: JsonObject;
  /** The same, for this room. */
  readonly more?: Pick<FileWork, 'of_plan'>;
}

/** Takes up one drawing, job, or what a mill carves; false where the file is none of these. */
export async function openFiles(room: MachinesRoom, files: readonly File[]): Promise<boolean> {
  const [file] = files;
  if (file === undefined) return false;
  const name = file.name.toLowerCase();
  const isOne = (endings: readonly string[]) => endings.some((ending) => name.endsWith(ending));
  const formats = room.services.catalog.value?.mesh_formats ?? [];
  const model = isOne([heightMapEnding, ...formats.map(({ extension }) => `.${extension}`)]);
  const kind = isOne(jobEndings) ? 'job' : isOne(drawingEndings) ? 'drawing' : model ? 'model' : null;
  if (kind === null) {
    room.problem.value = {
      kind: 'file',
      title: `Could not open ${file.name}`,
      message: `Machines take drawings (${drawingEndings.join(', ')}), jobs (${jobEndings.join(', ')}) and, for mills, models and height maps (${heightMapEnding}).`,
    };
    return false;
  }
  return await takeWork(room, {
    file_name: file.name,
    bytes: new Uint8Array(await file.arrayBuffer()),
    kind,
  });
}

/** Drawings are work for lasers, models and height maps for mills: such a machine is chosen where the other kind was. A practice
 *  machine is exchanged; where a real one is connected the work is not taken, and a message says so. */
export async function takeWork(room: MachinesRoom, opened: OpenedFile): Promise<boolean> {
  const { file_name, bytes, kind, own = {}, more = {} } = opened;
  const change = room.changesHere();
  const suits = kind === 'job' || (kind === 'model') === room.isMill;
  const exchanged = !suits && room.control.practising.value && !room.control.isBusy;
  const connected = room.control.link.value !== null;
  if (!suits && connected && !exchanged) {
    room.problem.value = {
      kind: 'file',
      title: `Could not open ${file_name}`,
      message:
        kind === 'model'
          ? 'Models and height maps are for mills: disconnect the laser first, then open it again.'
          : 'Drawings are for lasers: disconnect the mill first, then open it again.',
    };
    return false;
  }
  const picture = kind === 'model' ? pictureSize(bytes) : null;
  const types = { job: 'text/x-gcode', drawing: 'image/svg+xml', model: 'application/octet-stream' };
  const file = await room.keep(bytes, picture ? 'image/png' : types[kind]);
  room.problem.value = null;
  const nodes = picture ? { nodes: picture[0] * picture[1] } : {};
  const catalog = await catalogWhenThere(room.services);
  if (catalog === null) {
    const message = room.services.catalogError.peek() ?? '';
    room.problem.value = { kind: 'file', title: `Could not open ${file_name}`, message };
    return false;
  }
  const blank = room.services.projects.isBlank.value;
  try {
    room.takeMachine(catalog, change);
    change(machines.setWork(catalog, { file_name, kind, file, ...nodes, ...more }, `Open ${file_name}`, own));
  } catch (thrown) {
    if (asJobError(thrown).code === 'cancelled') return false; // the person went on to another project
    throw thrown;
  }
  if (!suits && connected) await room.control.disconnect();
  if (!suits) room.useProfile(room.profiles.oneThat(kind === 'model'));
  if (!suits && connected) await room.practise();
  if (blank) change(nameProject(file_name.replace(/\.[^.]+$/, '')));
  return true;
}

/** What is opened before the catalog is there waits for it. Null: it could not be read. */
async function catalogWhenThere(services: Services): Promise<Catalog | null> {
  const { catalog, catalogError } = services;
  return await new Promise((resolve) => {
    const stop = effect(() => {
      if (catalog.value === null && catalogError.value === null) return;
      resolve(catalog.value);
      queueMicrotask(() => stop());
    });
  });
}
