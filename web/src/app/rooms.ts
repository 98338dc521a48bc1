// SPDX-License-Identifier: GPL-3.0-or-later
// The places in which something is made, each with its session.
import type { EvidenceSession } from '../crafts/evidence/evidence_session';
import type { MachinesSession } from '../crafts/machines/machines_session';
import type { ReliefSession } from '../crafts/relief/relief_session';
import type { ThermoformSession } from '../crafts/thermoform/thermoform_session';
import type { ZippableSession } from '../crafts/zippable/zippable_session';
import type { ProjectDocument } from '../project/document';
import { isObject } from '../project/document';
import type { Place } from './route';

export interface Sessions {
  readonly relief: ReliefSession;
  readonly thermoform: ThermoformSession;
  readonly zippable: ZippableSession;
  readonly evidence: EvidenceSession;
  readonly machines: MachinesSession;
}
export type Room = keyof Sessions;

const rooms: readonly Room[] = ['relief', 'thermoform', 'zippable', 'evidence', 'machines'];

export const isRoom = (place: Place): place is Room => (rooms as readonly Place[]).includes(place);

/** Where what is opened goes: to the room one is in. */
export const roomOf = (place: Place): Room => (isRoom(place) ? place : 'relief');

/** The first room that a project has something in. */
export function placeOfWork({ crafts }: ProjectDocument): Room | null {
  if (isObject(crafts['forest']) && !isObject(crafts['relief'])) return 'relief'; // a view of that room
  const hasWork = (room: Room) => {
    const craft = crafts[room];
    if (!isObject(craft)) return false;
    const { model, objects, drawing } = craft;
    return isObject(model) || isObject(drawing) || (Array.isArray(objects) && objects.length > 0);
  };
  return rooms.find(hasWork) ?? null;
}
