// SPDX-License-Identifier: GPL-3.0-or-later
import { useEffect } from 'preact/hooks';
import type { RoomDocument } from './craft_document';
import type { RoomSession } from './room_session';

export interface RoomKeys {
  /** Ctrl+Enter. */
  readonly solve: () => void;
  /** Ctrl+E. */
  readonly save: () => void;
  /** Space, where nothing that can be pressed has the focus. */
  readonly space?: (() => void) | undefined;
  /** Single keys, by their lower-case names. */
  readonly plain?: Readonly<Record<string, () => void>>;
}

/** The keys of a room while it is open; Esc cancels what runs. `keys` is asked at each key, so that it sees the present state. */
export function useRoomKeys<D extends RoomDocument>(session: RoomSession<D>, keys: () => RoomKeys): void {
  useEffect(() => {
    const actionOf = (event: KeyboardEvent): (() => void) | undefined => {
      const { solve, save, space, plain = {} } = keys();
      const target = event.target as Element;
      const name = event.key.toLowerCase();
      if (name === 'escape')
        return session.activity.value.kind === 'idle' ? undefined : () => session.cancel();
      if (event.ctrlKey || event.metaKey) return { enter: solve, e: save }[name];
      if (event.altKey || target.matches('input[type=text], select, textarea')) return undefined;
      if (name === ' ') return target.matches('button, a, input, [role=menuitem]') ? undefined : space;
      return plain[name];
    };
    const onKey = (event: KeyboardEvent) => {
      if (event.defaultPrevented || document.querySelector('dialog[open]')) return;
      const action = actionOf(event);
      if (action === undefined) return;
      event.preventDefault();
      if (!event.repeat) action(); // all of these are meant once, however long the key is held
    };
    document.addEventListener('keydown', onKey);
    return () => document.removeEventListener('keydown', onKey);
  }, [session]);
}
