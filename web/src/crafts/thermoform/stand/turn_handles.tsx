// SPDX-License-Identifier: GPL-3.0-or-later
// The handles on the rings: dragged, or turned with the arrow keys.
import { effect } from '@preact/signals';
import { formatOnStep, hideTip, Icon, tipHandlers, withUnit } from '../../../ui';
import '../../../shared/panels/move_handle.css';
import type { Curve, Viewport } from '../../../view';
import type { ThermoformSession } from '../thermoform_session';
import { besideModel } from './clear_of_model';
import type { Handle } from './ring';
import { circle, handles, pointOn, ticks } from './ring';
import type { ModelTurner } from './turn_model';
import { actions, snap_deg } from './turn_model';

const keys: Readonly<Record<Handle, string>> = {
  turn: 'Left and right arrow keys',
  sideways: 'Left and right arrow keys',
  forwards: 'Up and down arrow keys',
};
const icons = { turn: 'turn', sideways: 'tiltSideways', forwards: 'tiltForwards' } as const;

/** To the degree where it is whole. */
const degrees = (value: number): string => withUnit(formatOnStep(value, 1), '°');

export interface TurnHandlesProps {
  readonly session: ThermoformSession;
  readonly turner: ModelTurner;
  readonly viewport: () => Viewport | null;
  readonly elements: Partial<Record<Handle, HTMLElement | null>>;
}

export function TurnHandles({ session, turner, viewport, elements }: TurnHandlesProps) {
  const at = (event: PointerEvent): [number, number] => {
    const box = viewport()?.canvas.getBoundingClientRect();
    return [event.clientX - (box?.left ?? 0), event.clientY - (box?.top ?? 0)];
  };
  const held = turner.held.value;
  const turn = degrees(Number(session.value('turn_deg') ?? 0));
  return (
    <>
      {handles.map((handle) => (
        <button
          key={handle}
          ref={(element) => void (elements[handle] = element)}
          type="button"
          class={`move-handle turn-handle ${held?.handle === handle ? 'held' : ''}`}
          hidden
          aria-label={`${actions[handle]}${handle === 'turn' ? `. Now at ${turn}` : ''}. ${keys[handle]}: ${snap_deg}°, with Shift 1°.`}
          {...tipHandlers(
            `${actions[handle]}: drag, or ${keys[handle].toLowerCase()}. Steps of ${snap_deg}°, with Shift 1°.`,
          )}
          onPointerEnter={() => (turner.near.value = handle)}
          onPointerLeave={() => (turner.near.value = null)}
          onFocus={() => (turner.near.value = handle)}
          onBlur={() => (turner.near.value = null)}
          onPointerDown={(event) => {
            const view = viewport();
            if (view === null || event.button !== 0) return;
            hideTip();
            event.currentTarget.setPointerCapture(event.pointerId);
            turner.begin(view, handle, ...at(event));
          }}
          onPointerMove={(event) => {
            const view = viewport();
            if (view && turner.holding) turner.drag(view, ...at(event), event.shiftKey);
          }}
          onPointerUp={() => turner.end()}
          onPointerCancel={() => turner.end()}
          onKeyDown={(event) => {
            if (!turner.key(event, handle)) return;
            event.preventDefault();
            event.stopPropagation();
          }}
          onKeyUp={() => session.services.projects.commit()}
        >
          <Icon name={icons[handle]} small />
          {held?.handle === handle ? (
            <span class="turn-angle">{handle === 'turn' ? turn : degrees(held.by_deg)}</span>
          ) : null}
        </button>
      ))}
    </>
  );
}

/** Keeps the ring drawn whose handle is held, pointed at or in focus; returns what ends it. */
export function keepRingDrawn(viewport: Viewport, turner: ModelTurner): () => void {
  return effect(() => {
    const held = turner.held.value;
    const near = turner.near.value;
    const ring = held?.ring ?? (near && turner.ring(near));
    const colour = held ? '--live' : '--accent';
    const curves: Curve[] = ring
      ? [{ positions: circle(ring), closed: true, colour, widthPx: 2, ghost: true }]
      : [];
    if (held && ring)
      curves.push({ positions: ticks(ring, snap_deg), separate: true, colour, widthPx: 2, ghost: true });
    viewport.setCurves(curves);
  });
}

/** Puts the handles on their rings; `there`: whether the model stands where it can be turned. */
export function placeTurnHandles(
  viewport: Viewport,
  turner: ModelTurner,
  elements: TurnHandlesProps['elements'],
  there: boolean,
): void {
  const held = turner.held.peek();
  for (const handle of handles) {
    const element = elements[handle];
    if (!element) continue;
    const ring = there ? (held?.handle === handle ? held.ring : turner.ring(handle)) : null;
    const by_deg = held?.handle === handle ? held.by_deg : 0;
    const at = ring && viewport.project(pointOn(ring, ring.rest_deg + by_deg));
    element.hidden = !at || (held !== null && held.handle !== handle);
    const box = turner.box.peek();
    if (at && box) {
      const { xPx, yPx } = besideModel(viewport, box, at);
      element.style.translate = `${xPx.toFixed(1)}px ${yPx.toFixed(1)}px`;
    }
  }
}
