// SPDX-License-Identifier: GPL-3.0-or-later
// What the machines' room keeps in a project: the drawing, model, test or job that is to be made, and how.
import type { Catalog, JsonObject, Operation } from '../../jobs/contract';
import { findOperation } from '../../jobs/contract';
import type { MachineProfile } from '../../machines/profiles';
import type { BlobReference } from '../../project/document';
import { jsonEqual } from '../../project/document';
import type { RoomDocument } from '../../shared/session/craft_document';
import { emptyRoom, RoomCommands, withoutDefaults } from '../../shared/session/craft_document';

export const laserJob = 'laser-job';
const testGrid = 'test-grid';
export const millJob = 'mill-job';

/** A job is sent as it is; of a drawing, or of a model or height map, a job is made. */
export interface FileWork {
  readonly file_name: string;
  readonly kind: 'drawing' | 'job' | 'model';
  readonly file: BlobReference;
  /** Of a height map: its pixels. */
  readonly nodes?: number;
  /** A sheet of this project's cutting plan, which can be laid out for another bed. */
  readonly of_plan?: true;
}
/** A test of the material, made of parameters alone. */
interface TestWork {
  readonly file_name: string;
  readonly kind: 'test';
  /** What was there before, to go back to. */
  readonly instead_of: FileWork | null;
}
export type Work = FileWork | TestWork;

export interface MachinesDocument extends RoomDocument {
  readonly drawing: Work | null;
  /** Parameters of the other operations, by name. */
  readonly set_aside: Readonly<Record<string, JsonObject>>;
  /** The id of the machine that these parameters were set for; null where nobody has noted it. */
  readonly machine: string | null;
}

export const drawingEndings = ['.svg'];
export const jobEndings = ['.gcode', '.nc', '.ngc', '.gc', '.tap', '.cnc'];
export const heightMapEnding = '.png';

/** What makes the job of it; what makes nothing is set by the laser's words. */
export function operationFor(work: Work | null): string {
  return work?.kind === 'test' ? testGrid : work?.kind === 'model' ? millJob : laserJob;
}

const isOfMachine = (operation: Operation | undefined, name: string) =>
  operation?.parameters.properties[name]?.['x-group'] === 'Machine';

/**
 * The parameters that `to` begins with: its own from last time, on the same machine as `from`. A machine's value that was
 * never set stays the default of `to` where the two differ, as a mill's speed and dialect do from a laser's.
 */
export function carriedOver(from: Operation, before: JsonObject, to: Operation, own: JsonObject): JsonObject {
  const carried = new Map(Object.entries(own));
  for (const [name, schema] of Object.entries(to.parameters.properties)) {
    const other = from.parameters.properties[name];
    if (!isOfMachine(to, name) || !isOfMachine(from, name)) continue;
    const value = before[name];
    if (value !== undefined) carried.set(name, value);
    else if (jsonEqual(schema.default ?? null, other?.default ?? null)) carried.delete(name);
  }
  return withoutDefaults(to, Object.fromEntries(carried));
}

const sizeOfWork: readonly string[] = ['width_mm', 'thickness_mm'];

class MachinesCommands extends RoomCommands<MachinesDocument> {
  /** Parameters follow the operation: those of the one before are kept aside. `own`: what the new work says of itself. */
  setWork(catalog: Catalog, work: Work, label: string, own: JsonObject = {}) {
    return this.command({ label }, ({ drawing, parameters, set_aside }) => {
      const [from, to] = [operationFor(drawing), operationFor(work)];
      const [before, after] = [findOperation(catalog, from), findOperation(catalog, to)];
      if (before === undefined || after === undefined) return { drawing: work };
      const kept = from === to ? parameters : carriedOver(before, parameters, after, set_aside[to] ?? {});
      // Its size is the work's own: what another one was sent with would scale this one.
      const begun =
        work.kind === 'model'
          ? Object.fromEntries(Object.entries(kept).filter(([name]) => !sizeOfWork.includes(name)))
          : kept;
      const changed: Partial<MachinesDocument> = {
        drawing: work,
        parameters: withoutDefaults(after, { ...begun, ...own }),
        set_aside: from === to ? set_aside : { ...set_aside, [from]: parameters },
      };
      return changed;
    });
  }

  /** The machine's values in the parameters in force, and in those that are kept aside. */
  setMachine(
    catalog: Catalog,
    { id, parameters: values }: Pick<MachineProfile, 'id' | 'parameters'>,
    label: string,
  ) {
    return this.command({ label }, ({ drawing, parameters, set_aside }) => {
      const with_ = (name: string, old: JsonObject) => {
        const operation = findOperation(catalog, name);
        if (operation === undefined) return old;
        const others = Object.entries(old).filter(([key]) => !isOfMachine(operation, key));
        const own = Object.entries(values).filter(([key]) => isOfMachine(operation, key));
        return withoutDefaults(operation, Object.fromEntries([...others, ...own]));
      };
      const changed: Partial<MachinesDocument> = {
        parameters: with_(operationFor(drawing), parameters),
        set_aside: Object.fromEntries(
          Object.entries(set_aside).map(([name, old]) => [name, with_(name, old)] as const),
        ),
        machine: id,
      };
      return changed;
    });
  }

  /** What a test has told, for the jobs of the laser; goes back to what was there before. */
  takeFromTest(catalog: Catalog, values: JsonObject, label: string) {
    return this.command({ label }, (before) => {
      const { drawing, parameters, set_aside } = before;
      const [test, laser] = [findOperation(catalog, testGrid), findOperation(catalog, laserJob)];
      if (drawing?.kind !== 'test' || test === undefined || laser === undefined) return {};
      const back = drawing.instead_of;
      const own = { ...(set_aside[laserJob] ?? {}), ...values };
      const carried = carriedOver(test, parameters, laser, own);
      const kept = { ...set_aside, [testGrid]: parameters, [laserJob]: carried };
      const mill = findOperation(catalog, millJob);
      const changed: Partial<MachinesDocument> =
        back?.kind === 'model' && mill
          ? {
              drawing: back,
              parameters: carriedOver(test, parameters, mill, set_aside[millJob] ?? {}),
              set_aside: kept,
            }
          : { drawing: back, parameters: carried, set_aside: kept };
      return changed;
    });
  }
}
export const machines = new MachinesCommands('machines', {
  ...emptyRoom,
  drawing: null,
  set_aside: {},
  machine: null,
});

/** Width and height of a PNG from its header; null for what is none. */
export function pictureSize(bytes: Uint8Array): readonly [number, number] | null {
  if (bytes.length < 24 || String.fromCharCode(...bytes.subarray(1, 4)) !== 'PNG') return null;
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  return [view.getUint32(16), view.getUint32(20)];
}
