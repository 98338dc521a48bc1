// SPDX-License-Identifier: GPL-3.0-or-later
// Standing the model of the room otherwise: each a step to undo.
import type { JsonObject } from '../../../jobs/contract';
import type { ThermoformSession } from '../thermoform_session';
import { rotationIn, stoodOtherwise } from './place_model';
import type { Rotation, Vector } from '../../../shared/geometry/rotation';
import type { Side } from './stance';
import { laidOn, placedOn } from './stance';

/** From `values` on, which hold the stance before; `coalesce` names what is being dragged. */
export function standBy(
  session: ThermoformSession,
  values: JsonObject,
  rotation: Rotation,
  label: string,
  coalesce?: string,
): void {
  const original = session.model.original.peek();
  const changes = original && stoodOtherwise(values, original.mesh.positions, rotation);
  // A drag that comes back to where it began brings back its automatic size, too.
  if (changes) session.setParameters({ size_mm: values['size_mm'] ?? null, ...changes }, label, coalesce);
}

const names: Readonly<Record<Side, string>> = {
  left: 'left side',
  right: 'right side',
  front: 'front',
  back: 'back',
  top: 'top',
};

export function layOn(session: ThermoformSession, side: Side): void {
  const values = session.inForce.peek();
  const now = rotationIn(values);
  if (now) standBy(session, values, laidOn(now, side), `Lay the model on its ${names[side]}`);
}

/** `outward`: the normal of the side, in the model's axes. */
export function placeOnSide(session: ThermoformSession, outward: Vector): void {
  const values = session.inForce.peek();
  const now = rotationIn(values);
  if (now) standBy(session, values, placedOn(now, outward), 'Place the model on a face');
}

/** The parameters `up` and `turn_deg` by default. */
function inFile(session: ThermoformSession): JsonObject {
  const all = session.operation.value?.parameters.properties ?? {};
  return { up: all['up']?.default ?? null, turn_deg: all['turn_deg']?.default ?? null };
}

export function standsAsInFile(session: ThermoformSession): boolean {
  const values = session.inForce.value;
  return Object.entries(inFile(session)).every(
    ([name, value]) => JSON.stringify(values[name]) === JSON.stringify(value),
  );
}

export function standAsInFile(session: ThermoformSession): void {
  const values = session.inForce.peek();
  const rotation = rotationIn({ ...values, ...inFile(session) });
  if (rotation) standBy(session, values, rotation, 'Stand the model as in its file');
}
