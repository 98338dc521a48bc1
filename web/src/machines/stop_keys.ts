// SPDX-License-Identifier: GPL-3.0-or-later
// Esc holds the machine, Esc twice or Ctrl and a full stop stops it: in every room, in fields and dialogs too.
import type { MachineLink } from './links/machine_link';

export interface Stoppable {
  readonly link: { readonly value: MachineLink | null };
  can(what: 'pause'): boolean;
  readonly isBusy: boolean;
  command(command: { readonly do: 'pause' | 'stop' }): Promise<boolean>;
}

const twice_ms = 800;

export function listenForStop(control: Stoppable, target: EventTarget = window): () => void {
  let escaped_ms = -Infinity;
  const onKey = (event: Event) => {
    if (!(event instanceof KeyboardEvent) || control.link.value === null) return;
    if ((event.ctrlKey || event.metaKey) && event.key === '.') {
      event.preventDefault();
      event.stopPropagation();
      void control.command({ do: 'stop' });
      return;
    }
    if (event.key !== 'Escape' || event.repeat) return;
    const again = event.timeStamp - escaped_ms < twice_ms;
    escaped_ms = event.timeStamp;
    // A dialog or a field may have Esc as well: the machine has it first, and nothing is taken from them.
    if (again && control.isBusy) void control.command({ do: 'stop' });
    else if (control.can('pause')) void control.command({ do: 'pause' });
  };
  target.addEventListener('keydown', onKey, true);
  return () => target.removeEventListener('keydown', onKey, true);
}
