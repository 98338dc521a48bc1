// SPDX-License-Identifier: GPL-3.0-or-later
// Handles over what is moved in the picture, a model of a group or the base: dragged, or moved with the arrow keys.
import type { ReadonlySignal } from '@preact/signals';
import { hideTip, Icon, tipHandlers } from '../../../ui';
import '../../../shared/panels/move_handle.css';
import './handles.css';
import type { Viewport } from '../../../view';
import type { Grip, GripElements, Place } from './grips';

export interface Mover {
  readonly grips: readonly Grip[];
  /** The handle that is held. */
  readonly grip: ReadonlySignal<Grip | null>;
  /** What is moved. */
  readonly name: ReadonlySignal<string>;
  begin(viewport: Viewport, grip: Grip, px: Place): void;
  /** `free`: turns by any angle rather than in steps. */
  drag(viewport: Viewport, px: Place, free: boolean): void;
  /** False for a key that does nothing. */
  key(viewport: Viewport, grip: Grip, key: string, fine: boolean): boolean;
  end(): void;
}

interface GripWords {
  readonly action: string;
  readonly keys: string;
  readonly icon: 'move' | 'arrow' | 'turn' | 'frame';
}

const words: Readonly<Record<Grip, GripWords>> = {
  move: { action: 'Move', keys: 'Arrow keys: 5 mm, with Shift 1 mm', icon: 'move' },
  depth: {
    action: 'Move away from the viewer or nearer',
    keys: 'Up and down arrow keys: 5 mm, with Shift 1 mm',
    icon: 'arrow',
  },
  turn: { action: 'Turn', keys: 'Left and right arrow keys: 15°, with Shift 1°', icon: 'turn' },
  size: { action: 'Change the size of', keys: 'Up and down arrow keys: 5 %, with Shift 1 %', icon: 'frame' },
};

export interface HandlesProps {
  readonly mover: Mover;
  readonly viewport: () => Viewport | null;
  readonly elements: GripElements;
}

export function Handles({ mover, viewport, elements }: HandlesProps) {
  const at = (event: PointerEvent): Place => {
    const box = viewport()?.canvas.getBoundingClientRect();
    return [event.clientX - (box?.left ?? 0), event.clientY - (box?.top ?? 0)];
  };
  const name = mover.name.value;
  return (
    <>
      {mover.grips.map((grip) => {
        const { action, keys, icon } = words[grip];
        const label = grip === 'depth' ? `Move ${name} away from the viewer or nearer` : `${action} ${name}`;
        return (
          <button
            key={grip}
            ref={(element) => void (elements[grip] = element)}
            type="button"
            class={`move-handle view-handle ${grip} ${mover.grip.value === grip ? 'held' : ''}`}
            hidden
            aria-label={`${label}. ${keys}.`}
            {...tipHandlers(`${label}: drag, or ${keys.charAt(0).toLowerCase()}${keys.slice(1)}`)}
            onPointerDown={(event) => {
              const view = viewport();
              if (view === null || event.button !== 0) return;
              hideTip();
              event.currentTarget.setPointerCapture(event.pointerId);
              mover.begin(view, grip, at(event));
            }}
            onPointerMove={(event) => {
              const view = viewport();
              if (view) mover.drag(view, at(event), event.shiftKey);
            }}
            onPointerUp={() => mover.end()}
            onPointerCancel={() => mover.end()}
            onKeyDown={(event) => {
              const view = viewport();
              if (view === null || event.ctrlKey || event.altKey || event.metaKey) return;
              if (!mover.key(view, grip, event.key, event.shiftKey)) return;
              event.preventDefault();
              event.stopPropagation();
            }}
            onKeyUp={() => mover.end()}
          >
            <Icon name={icon} small />
          </button>
        );
      })}
    </>
  );
}
