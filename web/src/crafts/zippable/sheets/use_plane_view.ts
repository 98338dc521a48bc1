// SPDX-License-Identifier: GPL-3.0-or-later
// Hand and keyboard on a plane: wheel, drag, pinch, double click and keys change what a pane shows of it.
import { useEffect, useRef, useState } from 'preact/hooks';
import type { PlaneView, Size } from './plane_view';
import { dragged, fitted, resized, usable, wheelFactor, zoomed } from './plane_view';

const keyZoom = 1.25;
const keyPan_px = 60;

export interface PlaneControls {
  readonly view: PlaneView;
  /** All is shown as large as it fits. */
  readonly isFitted: boolean;
  readonly fit: () => void;
  /** About the pane's middle. */
  readonly zoom: (factor: number) => void;
  readonly handlers: {
    readonly onWheel: (event: WheelEvent) => void;
    readonly onDblClick: () => void;
    readonly onPointerDown: (event: PointerEvent) => void;
    readonly onPointerMove: (event: PointerEvent) => void;
    readonly onPointerUp: (event: PointerEvent) => void;
    readonly onPointerCancel: (event: PointerEvent) => void;
    /** True where the key was meant for the plane. */
    readonly onKey: (event: KeyboardEvent) => boolean;
  };
}

type Place = readonly [x: number, y: number];

/** `of`: what is looked at; another one is shown whole at first. */
export function usePlaneView(of: unknown, content: Size, pane: Size): PlaneControls {
  const [chosen, setChosen] = useState<{ view: PlaneView; of: unknown; pane: Size } | null>(null);
  const pointers = useRef(new Map<number, Place>());
  const whole = usable(pane) && usable(content) ? fitted(content, pane) : { x: 0, y: 0, scale: 1 };
  const kept = chosen?.of === of ? chosen : null;
  const view = kept ? resized(kept.view, kept.pane, content, pane) : whole;
  // Several events may come before the next drawing: each goes on from the one before.
  const now = useRef(view);
  now.current = view;
  useEffect(() => pointers.current.clear(), [of]);

  const show = (next: PlaneView) => {
    now.current = next;
    setChosen(next.scale <= whole.scale * 1.0001 ? null : { view: next, of, pane });
  };
  const zoomAt = (factor: number, at: Place) => show(zoomed(now.current, factor, at, content, pane));
  const zoom = (factor: number) => zoomAt(factor, [pane.width / 2, pane.height / 2]);
  const pan = (dx: number, dy: number) => show(dragged(now.current, dx, dy, content, pane));
  const fit = () => setChosen(null);

  const placeOf = (event: MouseEvent): Place => {
    const box = (event.currentTarget as Element).getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const move = (event: PointerEvent) => {
    const before = pointers.current.get(event.pointerId);
    if (before === undefined) return;
    const after = placeOf(event);
    const other = [...pointers.current].find(([id]) => id !== event.pointerId)?.[1];
    pointers.current.set(event.pointerId, after);
    if (other === undefined) pan(after[0] - before[0], after[1] - before[1]);
    else {
      // The middle between two fingers follows them, and what is between grows with their distance.
      const distance = (place: Place) => Math.max(1, Math.hypot(place[0] - other[0], place[1] - other[1]));
      pan((after[0] - before[0]) / 2, (after[1] - before[1]) / 2);
      zoomAt(distance(after) / distance(before), [(after[0] + other[0]) / 2, (after[1] + other[1]) / 2]);
    }
  };
  const end = (event: PointerEvent) => void pointers.current.delete(event.pointerId);
  return {
    view,
    isFitted: kept === null,
    fit,
    zoom,
    handlers: {
      onWheel: (event) => {
        event.preventDefault();
        zoomAt(wheelFactor(event), placeOf(event));
      },
      onDblClick: fit,
      onPointerDown: (event) => {
        if (event.button !== 0 || pointers.current.size > 1) return;
        (event.currentTarget as Element).setPointerCapture(event.pointerId);
        pointers.current.set(event.pointerId, placeOf(event));
      },
      onPointerMove: move,
      onPointerUp: end,
      onPointerCancel: end,
      onKey: (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey) return false;
        const actions: Record<string, () => void> = {
          '+': () => zoom(keyZoom),
          '=': () => zoom(keyZoom),
          '-': () => zoom(1 / keyZoom),
          0: fit,
          ArrowLeft: () => pan(keyPan_px, 0),
          ArrowRight: () => pan(-keyPan_px, 0),
          ArrowUp: () => pan(0, keyPan_px),
          ArrowDown: () => pan(0, -keyPan_px),
        };
        const action = actions[event.key];
        action?.();
        return action !== undefined;
      },
    },
  };
}
