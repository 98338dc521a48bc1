// SPDX-License-Identifier: GPL-3.0-or-later
// Over the model while parts are drawn: the tools, and a handle on every point.
import { useEffect } from 'preact/hooks';
import { Button, Icon, Segmented } from '../../../ui';
import type { Viewport } from '../../../view';
import type { Tool } from './draw_actions';
import {
  closeBorder,
  drawnNow,
  drop,
  endCut,
  fromShown,
  held,
  place,
  press,
  remove,
  startOver,
  takeFound,
  toShown,
  tool,
} from './draw_actions';
import type { Drawn, Handle } from './drawn_parts';
import { fewestToClose, fewestToCut, handleName, handlesOf, placeOf } from './drawn_parts';
import { noRing, ringInTheMiddle } from './ring';
import { RingLine } from './ring_line';
import { cameraMoves, themeChanges } from '../views';
import type { ZippableSession } from '../zippable_session';

interface ToolProps {
  readonly session: ZippableSession;
  readonly viewport: Viewport | null;
}

const tools: readonly { readonly value: Tool; readonly label: string }[] = [
  { value: 'border', label: 'Border' },
  { value: 'ring', label: 'Ring' },
  { value: 'opening', label: 'Opening' },
  { value: 'cut', label: 'Cut' },
];

export function DrawTool({ session, viewport }: ToolProps) {
  const on = tool.value !== null;
  useEffect(() => {
    // The first question about what lies under the pointer is answered once a search tree is there: it is asked now.
    if (on) viewport?.pick(0, 0);
  }, [on, viewport]);
  if (viewport === null || tool.value === null) return null;
  return (
    <>
      <Handles session={session} viewport={viewport} />
      {tool.value === 'ring' ? <RingLine /> : null}
      <Toolbar session={session} viewport={viewport} />
    </>
  );
}

function wordsFor(what: Tool, { begun, begunCut }: Drawn): string {
  if (what === 'ring')
    return (
      noRing.value ??
      'Drag a line straight across a limb: a border goes all around it. Arrow keys or another tool turn the model.'
    );
  if (what === 'opening')
    return 'Click where a part should have an opening. A part without one gets one automatically.';
  if (what === 'cut')
    return begunCut.length === 0
      ? 'Click the points of a cut that opens a part instead of a hole; two points make a straight cut.'
      : 'Continue along the cut. Click its last point again to end it.';
  return begun.length === 0
    ? 'Click points around a limb, on the model. Drag beside it to turn it.'
    : 'Continue all around. Click the first point again to close it.';
}

function Toolbar({ session, viewport }: { session: ZippableSession; viewport: Viewport }) {
  const drawn = drawnNow(session);
  const drawing = tool.value === 'border';
  const cutting = tool.value === 'cut';
  const ringing = tool.value === 'ring';
  const refused = ringing && noRing.value !== null;
  // A phone has no room for words; but that a drag draws here has to be said once.
  const onPhones = refused || (ringing && drawn.borders.length === 0);
  const left = fewestToClose - drawn.begun.length;
  const nothing =
    drawn.borders.length +
      drawn.openings.length +
      drawn.cuts.length +
      drawn.begun.length +
      drawn.begunCut.length ===
    0;
  const found = session.shown.value?.design.punctures.length ?? 0;
  /** For those who do not point: the middle of what is seen, from where arrow keys move it. */
  const addInTheMiddle = () => {
    const { clientWidth, clientHeight } = viewport.overlay;
    const hit = viewport.pick(clientWidth / 2, clientHeight / 2);
    if (hit) void place(session, fromShown(session, hit.positionMm));
  };
  return (
    <div class="float top-left draw-tools" role="toolbar" aria-label="Draw the parts">
      <div class="row">
        <Segmented
          floating
          label="What to draw"
          options={tools}
          value={tool.value ?? 'border'}
          onChange={(value) => (tool.value = value)}
        />
        <Button size="small" icon="check" onClick={() => (tool.value = null)}>
          Done
        </Button>
      </div>
      <div class="panel draw-words">
        <p class={`${onPhones ? 'on-phones' : ''} ${refused ? 'draw-refusal' : ''}`} role="status">
          {refused ? <Icon name="warn" small /> : null} {wordsFor(tool.value ?? 'border', drawn)}
        </p>
        <div class="row">
          {drawing && drawn.begun.length > 0 ? (
            <Button
              size="small"
              icon="loop"
              disabledReason={
                left > 0 ? `Add ${left} more ${left === 1 ? 'point' : 'points'} first` : undefined
              }
              onClick={() => void closeBorder(session)}
            >
              Close the border
            </Button>
          ) : null}
          {cutting && drawn.begunCut.length > 0 ? (
            <Button
              size="small"
              icon="check"
              disabledReason={drawn.begunCut.length < fewestToCut ? 'Add 1 more point first' : undefined}
              onClick={() => void endCut(session)}
            >
              End the cut here
            </Button>
          ) : null}
          {tool.value === 'opening' && drawn.openings.length === 0 && found > 0 ? (
            <Button size="small" icon="move" onClick={() => void takeFound(session)}>
              Move the openings found
            </Button>
          ) : null}
          {ringing ? (
            <div class="row" role="group" aria-labelledby="ring-in-the-middle">
              <span id="ring-in-the-middle">Ring in the middle:</span>
              <Button size="small" onClick={() => void ringInTheMiddle(session, viewport, 'level')}>
                Level
              </Button>
              <Button size="small" onClick={() => void ringInTheMiddle(session, viewport, 'upright')}>
                Upright
              </Button>
            </div>
          ) : (
            <Button size="small" icon="plus" onClick={addInTheMiddle}>
              Add a point in the middle
            </Button>
          )}
          {nothing ? null : (
            <Button size="small" kind="quiet" onClick={() => void startOver(session)}>
              Find the parts automatically
            </Button>
          )}
        </div>
      </div>
    </div>
  );
}

function Handles({ session, viewport }: { session: ZippableSession; viewport: Viewport }) {
  void cameraMoves.value;
  void themeChanges.value;
  const drawn = drawnNow(session);
  return (
    <div class="draw-handles">
      {handlesOf(drawn).map((handle) => (
        <PointHandle key={JSON.stringify(handle)} session={session} viewport={viewport} handle={handle} />
      ))}
    </div>
  );
}

/** Behind the model by more than this share of the distance to the eye, a point is out of sight. */
const sunken = 0.01;

function PointHandle({
  session,
  viewport,
  handle,
}: {
  session: ZippableSession;
  viewport: Viewport;
  handle: Handle;
}) {
  const at = placeOf(drawnNow(session), handle);
  if (at === undefined) return null;
  const shown = toShown(session, at);
  const seen = viewport.project(shown);
  if (seen === null) return null;
  const hit = viewport.pick(seen.xPx, seen.yPx);
  const { originMm } = viewport.rayThrough(seen.xPx, seen.yPx);
  const away = (p: readonly number[]) => Math.hypot(...p.map((x, k) => x - (originMm[k] ?? 0)));
  const hidden = hit !== null && away(hit.positionMm) < (1 - sunken) * away(shown);
  /** Onto the model under a point of the viewport; off the model it stays. */
  const carry = (xPx: number, yPx: number) => {
    const under = viewport.pick(xPx, yPx);
    if (under) held.value = { handle, at: fromShown(session, under.positionMm) };
  };
  const pull = (event: PointerEvent) => {
    const target = event.currentTarget as HTMLElement;
    if (!target.hasPointerCapture(event.pointerId)) return;
    const box = viewport.overlay.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    if (held.value !== null || Math.hypot(x - seen.xPx, y - seen.yPx) > 4) carry(x, y);
  };
  const letGo = () => {
    if (held.value) void drop(session);
    else press(session, handle);
  };
  const key = (event: KeyboardEvent) => {
    if (event.key === 'Delete' || event.key === 'Backspace') {
      event.preventDefault();
      void remove(session, handle);
      return;
    }
    if (event.key === 'Enter' || event.key === ' ') {
      event.preventDefault();
      press(session, handle);
      return;
    }
    const step = event.shiftKey ? 20 : 4;
    const by = (
      { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] } as const
    )[event.key as 'ArrowUp'] as readonly [number, number] | undefined;
    if (by === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    carry(seen.xPx + by[0], seen.yPx + by[1]);
  };
  return (
    <button
      type="button"
      class={`draw-handle ${handle.kind} ${hidden ? 'hidden-point' : ''}`}
      style={{ left: `${seen.xPx}px`, top: `${seen.yPx}px` }}
      aria-label={handleName(handle)}
      onPointerDown={(event) => event.currentTarget.setPointerCapture(event.pointerId)}
      onPointerMove={pull}
      onPointerUp={letGo}
      onPointerCancel={() => (held.value = null)}
      onKeyDown={key}
      onKeyUp={() => void drop(session)}
      onBlur={() => void drop(session)}
    />
  );
}
