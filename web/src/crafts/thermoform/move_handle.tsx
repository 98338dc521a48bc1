// SPDX-License-Identifier: GPL-3.0-or-later
import type { RefObject } from 'preact';
import { hideTip, Icon, tipHandlers } from '../../ui';
import '../../shared/panels/move_handle.css';
import type { Viewport } from '../../view';
import type { ModelMover } from './move_model';
import type { ThermoformSession } from './thermoform_session';

export interface MoveHandleProps {
  readonly session: ThermoformSession;
  readonly mover: ModelMover;
  readonly viewport: () => Viewport | null;
  readonly element: RefObject<HTMLButtonElement | null>;
}

/** A handle in front of the model: dragged, or moved with the arrow keys. */
export function MoveHandle({ session, mover, viewport, element }: MoveHandleProps) {
  const at = (event: PointerEvent): [number, number] => {
    const box = viewport()?.canvas.getBoundingClientRect();
    return [event.clientX - (box?.left ?? 0), event.clientY - (box?.top ?? 0)];
  };
  const [x, y] = [session.value('x_mm'), session.value('y_mm')];
  return (
    <button
      ref={element}
      type="button"
      class="move-handle"
      hidden
      aria-label={`Move the model. Now at ${String(x)}, ${String(y)} mm. Arrow keys move it.`}
      {...tipHandlers('Drag, or move with the arrow keys')}
      onPointerDown={(event) => {
        const view = viewport();
        if (view === null || event.button !== 0) return;
        hideTip();
        event.currentTarget.setPointerCapture(event.pointerId);
        mover.begin(view, ...at(event), 0);
      }}
      onPointerMove={(event) => {
        const view = viewport();
        if (view && mover.holding) mover.drag(view, ...at(event));
      }}
      onPointerUp={() => mover.end()}
      onPointerCancel={() => mover.end()}
      onKeyDown={(event) => {
        if (!mover.key(event)) return;
        event.preventDefault();
        event.stopPropagation();
      }}
      onKeyUp={() => session.services.projects.commit()}
    >
      <Icon name="move" small />
    </button>
  );
}
