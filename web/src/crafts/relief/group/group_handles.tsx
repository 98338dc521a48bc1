// SPDX-License-Identifier: GPL-3.0-or-later
// Handles over the model of a group that is changed: dragged, or moved with the arrow keys.
import { hideTip, Icon, tipHandlers } from '../../../ui';
import '../../../shared/panels/move_handle.css';
import './group_handles.css';
import type { Viewport } from '../../../view';
import type { Grip, GripElements } from './hold';
import { grips } from './hold';
import type { GroupMover } from './group_mover';

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

export interface GroupHandlesProps {
  readonly mover: GroupMover;
  readonly viewport: () => Viewport | null;
  readonly elements: GripElements;
}

export function GroupHandles({ mover, viewport, elements }: GroupHandlesProps) {
  const at = (event: PointerEvent): [number, number] => {
    const box = viewport()?.canvas.getBoundingClientRect();
    return [event.clientX - (box?.left ?? 0), event.clientY - (box?.top ?? 0)];
  };
  const name = mover.model.value?.name ?? '';
  return (
    <>
      {grips.map((grip) => {
        const { action, keys, icon } = words[grip];
        const label = grip === 'depth' ? `Move ${name} away from the viewer or nearer` : `${action} ${name}`;
        return (
          <button
            key={grip}
            ref={(element) => void (elements[grip] = element)}
            type="button"
            class={`move-handle group-handle ${grip} ${mover.grip.value === grip ? 'held' : ''}`}
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
