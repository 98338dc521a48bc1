// SPDX-License-Identifier: GPL-3.0-or-later
// What the machines' room keeps in a project: the drawing or job that is to be made, and how.
import type { BlobReference } from '../../project/document';
import type { RoomDocument } from '../common/craft_document';
import { emptyRoom, RoomCommands } from '../common/craft_document';

export const laserJob = 'laser-job';

export interface Drawing {
  readonly file_name: string;
  /** A job is sent as it is; of a drawing a job is made. */
  readonly kind: 'drawing' | 'job';
  readonly file: BlobReference;
}

export interface MachinesDocument extends RoomDocument {
  readonly drawing: Drawing | null;
}

export const drawingEndings = ['.svg'];
export const jobEndings = ['.gcode', '.nc', '.ngc', '.gc', '.tap', '.cnc'];

class MachinesCommands extends RoomCommands<MachinesDocument> {
  setDrawing(drawing: Drawing) {
    return this.command({ label: `Open ${drawing.file_name}` }, () => ({ drawing }));
  }
}
export const machines = new MachinesCommands('machines', { ...emptyRoom, drawing: null });
