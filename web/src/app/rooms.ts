// SPDX-License-Identifier: GPL-3.0-or-later
// The places in which something is made, each with its session.
import type { ReliefSession } from '../crafts/relief/relief_session';
import type { ThermoformSession } from '../crafts/thermoform/thermoform_session';
import type { ProjectDocument } from '../project/document';
import { isObject } from '../project/document';
import type { Place } from './route';

export interface Sessions {
  readonly relief: ReliefSession;
  readonly thermoform: ThermoformSession;
}
export type Room = keyof Sessions;

const rooms: readonly Room[] = ['relief', 'thermoform'];

/** Where a model that is opened goes: to the room one is in. */
export const roomOf = (place: Place): Room => rooms.find((room) => room === place) ?? 'relief';

/** The first room that a project has a model in. */
export function placeOfWork({ crafts }: ProjectDocument): Room | null {
  const hasModel = (room: Room) => {
    const craft = crafts[room];
    return isObject(craft) && isObject(craft['model']);
  };
  return rooms.find(hasModel) ?? null;
}
