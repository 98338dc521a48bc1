// SPDX-License-Identifier: GPL-3.0-or-later
// A border all around a limb by one straight drag across it.
import { signal } from '@preact/signals';
import type { Viewport, ViewPointerEvent } from '../../../view';
import { addRing, fromShown, waysOn } from './draw_actions';
import type { Sight } from './line_across';
import { ringAcross } from './ring_across';
import type { ZippableSession } from '../zippable_session';

/** x and y from the viewport's upper left corner, px. */
type OnScreen_px = readonly [x: number, y: number];

/** While it is being dragged. */
export const ringLine = signal<{ readonly from: OnScreen_px; readonly to: OnScreen_px } | null>(null);
/** Why the last line has made no border; null where it has, or a new one has begun. */
export const noRing = signal<string | null>(null);

type Eye = Pick<Viewport, 'rayThrough'>;

const tooShort = 'That was no line: press beside a limb, drag across it and let go on its other side.';

/** Shorter than this a press is no line. */
const shortest_px = 8;
/** How far apart lines of sight are that look for the model along the line. */
const look_px = 2;

/** Through places along a line on the screen, in the model file's coordinates. */
function sightsAlong(session: ZippableSession, eye: Eye, from: OnScreen_px, to: OnScreen_px): Sight[] {
  const steps = Math.ceil(Math.hypot(to[0] - from[0], to[1] - from[1]) / look_px);
  return Array.from({ length: steps + 1 }, (_, i) => {
    const share = i / steps;
    const { originMm, direction } = eye.rayThrough(
      from[0] + share * (to[0] - from[0]),
      from[1] + share * (to[1] - from[1]),
    );
    return { origin: fromShown(session, originMm), direction };
  });
}

async function draw(session: ZippableSession, eye: Eye, from: OnScreen_px, to: OnScreen_px): Promise<void> {
  const mesh = session.model.original.peek()?.mesh;
  if (mesh === undefined) return;
  const isLine = Math.hypot(to[0] - from[0], to[1] - from[1]) >= shortest_px;
  const ring = isLine ? ringAcross(mesh, sightsAlong(session, eye, from, to), () => waysOn(mesh)) : tooShort;
  noRing.value = typeof ring === 'string' ? ring : null;
  if (typeof ring !== 'string') await addRing(session, ring);
}

/** For those who do not point: a short line in the middle of what is seen; the limb that is nearest there is meant. */
export function ringInTheMiddle(
  session: ZippableSession,
  viewport: Viewport,
  way: 'level' | 'upright',
): Promise<void> {
  const { clientWidth, clientHeight } = viewport.overlay;
  const [x, y] = [clientWidth / 2, clientHeight / 2];
  return way === 'level'
    ? draw(session, viewport, [x - shortest_px, y], [x + shortest_px, y])
    : draw(session, viewport, [x, y - shortest_px], [x, y + shortest_px]);
}

/** What the pointer does with the tool, on the model and beside it. */
export function ringPointer(
  session: ZippableSession,
  eye: Eye,
  { kind, xPx, yPx, button, shiftKey, capture }: ViewPointerEvent,
): void {
  const line = ringLine.peek();
  if (kind === 'down' && button === 0 && !shiftKey) {
    capture(() => (ringLine.value = null));
    noRing.value = null;
    ringLine.value = { from: [xPx, yPx], to: [xPx, yPx] };
  } else if (kind === 'move' && line) ringLine.value = { ...line, to: [xPx, yPx] };
  else if (kind === 'up' && line) {
    ringLine.value = null;
    void draw(session, eye, line.from, [xPx, yPx]);
  }
}
