// SPDX-License-Identifier: GPL-3.0-or-later
// What a maker's hand does while parts are drawn. Every point is a step to undo.
import { signal } from '@preact/signals';
import type { ShadedMesh } from '../../../shared/panels/shaded_mesh';
import type { Drawn, Handle, Place3 } from './drawn_parts';
import {
  closedNow,
  cutDone,
  moved,
  nothingDrawn,
  placeOf,
  segmentsJson,
  withCutPoint,
  without,
  withBorder,
  withOpening,
  withPoint,
} from './drawn_parts';
import { SurfaceGraph } from './surface_path';
import { drawnOn, setDrawn } from '../zippable_document';
import type { ZippableSession } from '../zippable_session';

export type Tool = 'border' | 'ring' | 'opening' | 'cut';

/** Null: nothing is being drawn. Outlives a visit to another page. */
export const tool = signal<Tool | null>(null);
/** A handle on its way. */
export const held = signal<{ readonly handle: Handle; readonly at: Place3 } | null>(null);

/** Millimetres as shown, a unit of the model's file. */
const shownScale = (session: ZippableSession): number => session.shown.value?.design.scale ?? 1;

export const fromShown = (session: ZippableSession, [x, y, z]: Place3): Place3 => {
  const scale = shownScale(session);
  return [x / scale, y / scale, z / scale];
};

export const toShown = (session: ZippableSession, [x, y, z]: Place3): [number, number, number] => {
  const scale = shownScale(session);
  return [x * scale, y * scale, z * scale];
};

/** With the handle where the hand has it. */
export function drawnNow(session: ZippableSession): Drawn {
  const drawn = drawnOn(session.document.value);
  return held.value ? moved(drawn, held.value.handle, held.value.at) : drawn;
}

/** The operation's input is kept before the document speaks of it. */
async function change(session: ZippableSession, to: Drawn, label: string): Promise<void> {
  const before = drawnOn(session.document.peek());
  const text = segmentsJson(to);
  const unchanged = text !== null && text === segmentsJson(before);
  const segments = unchanged
    ? before.segments
    : text && (await session.keep(new TextEncoder().encode(text), 'application/json'));
  const { projects } = session.services;
  projects.do(setDrawn({ ...to, on: before.on, segments: segments || null }, label));
  projects.commit();
}

const now = (session: ZippableSession): Drawn => drawnOn(session.document.peek());

export function place(session: ZippableSession, at: Place3): Promise<void> {
  const drawn = now(session);
  if (tool.peek() === 'cut') return change(session, withCutPoint(drawn, at), 'Draw a cut');
  return tool.peek() === 'opening'
    ? change(session, withOpening(drawn, at), 'Set an opening')
    : change(session, withPoint(drawn, at), 'Draw a border');
}

export function press(session: ZippableSession, handle: Handle): void {
  const at = placeOf(now(session), handle);
  const ofCut = handle.kind === 'cut' || handle.kind === 'begun-cut';
  const continues = tool.peek() === 'cut' ? handle.kind === 'begun-cut' : tool.peek() === 'border' && !ofCut;
  if (at && continues && handle.kind !== 'opening') void place(session, at);
}

export const closeBorder = (session: ZippableSession) =>
  change(session, closedNow(now(session)), 'Close a border');
export const addRing = (session: ZippableSession, points: readonly Place3[]) =>
  change(session, withBorder(now(session), points), 'Draw a ring');
export const endCut = (session: ZippableSession) => change(session, cutDone(now(session)), 'End a cut');
export const startOver = (session: ZippableSession) =>
  change(session, nothingDrawn, 'Find the parts automatically');
export const remove = (session: ZippableSession, handle: Handle) =>
  change(
    session,
    without(now(session), handle),
    handle.kind === 'opening' ? 'Remove an opening' : 'Remove a point',
  );

/** Key and focus may both let go of what is let go once. */
const dropped = new WeakSet<object>();

export async function drop(session: ZippableSession): Promise<void> {
  const hand = held.peek();
  if (hand === null || dropped.has(hand)) return;
  dropped.add(hand);
  await change(
    session,
    moved(now(session), hand.handle, hand.at),
    hand.handle.kind === 'opening' ? 'Move an opening' : 'Move a point',
  );
  if (held.peek() === hand) held.value = null;
}

/** Openings that were found, to be moved by hand. */
export function takeFound(session: ZippableSession): Promise<void> {
  const found = session.shown.peek()?.design.punctures ?? [];
  const openings = found.map((at) => fromShown(session, at));
  return change(session, { ...now(session), openings }, 'Move the openings by hand');
}

let graph: { readonly of: ShadedMesh; readonly graph: SurfaceGraph } | null = null;

/** The ways over a mesh, kept until another one is asked for. */
export function waysOn(mesh: ShadedMesh): SurfaceGraph {
  if (graph?.of !== mesh) graph = { of: mesh, graph: new SurfaceGraph(mesh.positions, mesh.indices) };
  return graph.graph;
}

/** Borders and cuts as they will run, mm as shown; the last is the one that is not whole. */
export function drawnLines(session: ZippableSession): Float32Array[] {
  const original = session.model.original.value;
  if (original === null) return [];
  const { borders, cuts, begun, begunCut } = drawnNow(session);
  if (borders.length + cuts.length + begun.length + begunCut.length === 0) return [];
  const on = waysOn(original.mesh);
  const scale = shownScale(session);
  const open = (points: readonly Place3[]) => ({ points, closed: false });
  const unfinished = begun.length > 0 && begunCut.length > 0 ? [begun, begunCut] : [[...begun, ...begunCut]];
  return [...borders, ...cuts.map(open), ...unfinished.map(open)].map(({ points, closed }) =>
    on.through(points, closed).map((x) => x * scale),
  );
}
