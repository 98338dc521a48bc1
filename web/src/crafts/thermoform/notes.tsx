// SPDX-License-Identifier: GPL-3.0-or-later
// Notes at the foot of the viewport: one at a time, the most urgent first.
import { signal, useSignal } from '@preact/signals';
import { formatNumber, Icon, IconButton, Note, useLasting, withUnit } from '../../ui';
import { narrow } from '../../shared/panels/narrow';
import { sentences } from '../../shared/session/report';
import { problemNote, repairsNote } from '../../shared/panels/room_notes';
import { clampOf, placementNow } from './draw_scene';
import { beyondOpening, boxOf, placed } from './placement';
import type { ThermoformSession } from './thermoform_session';
import { view } from './views';

/** Words that were read, until others come. */
const dismissed = signal('');

/** How far the model reaches beyond the clamp, mm; 0 inside. */
function overhang_mm(session: ThermoformSession): number {
  const original = session.model.original.value;
  const shown = session.shown.value;
  const placement = placementNow(session);
  if (original === null || shown === null || placement === null) return 0;
  return beyondOpening(boxOf(placed(original.mesh.positions, placement)), clampOf(session, shown).opening_mm);
}

/** What the reports say that a maker should know before heating a sheet. */
function advice(session: ThermoformSession): string[] {
  const shown = session.shown.value;
  const [print, mould] = [session.print.value?.report ?? {}, session.mould.value?.report ?? {}];
  const of = {
    texture: sentences(print, 'sentences'),
    undercut: sentences(mould, 'advice'),
    thickness: [],
    stretch: [],
  }[view.value];
  return [
    ...of,
    ...(shown ? [...sentences(shown.report, 'warnings'), ...sentences(shown.report, 'notes')] : []),
  ];
}

/** A sentence as what is the matter, and what follows from it: at its colon, or its first full stop. */
function headed(sentence: string): readonly [string, string] {
  const [, head = sentence, tail = ''] = /^(.*?[^\d])[:.]\s+(.+)$/.exec(sentence) ?? [];
  return [head.replace(/\.$/, ''), tail && tail.charAt(0).toUpperCase() + tail.slice(1)];
}

export interface NotesProps {
  readonly session: ThermoformSession;
  readonly onChooseFile: () => void;
}

export function Notes({ session, onChooseFile }: NotesProps) {
  const solving = useLasting(session.activity.value.kind === 'solving');
  const whole = useSignal(false);
  const { model } = session.document.value;
  const problem = problemNote(session, onChooseFile);
  if (problem) return problem;
  if (model === null) return null;
  const over = overhang_mm(session);
  if (over > 0.05)
    return (
      <div class="note-place">
        <Note
          kind="attention"
          icon="warn"
          title={`The model reaches ${withUnit(formatNumber(over, 2), 'mm')} beyond the clamp`}
        >
          Move the model inwards or make it smaller, so that the clamp frame can close.
        </Note>
      </div>
    );
  if (solving && session.shown.value)
    return (
      <p class="label-chip">
        <Icon name="clock" small /> This is the preview. The sheet formed at full detail replaces it.
      </p>
    );
  const repairs = narrow() ? null : repairsNote(session);
  if (repairs) return repairs;
  const said = advice(session);
  const words = said.join(' ');
  if (said.length === 0) return null;
  // On a phone the object needs the room until the notes are asked for; dismissed ones can be had again.
  if (words === dismissed.value || (narrow() && !whole.value))
    return (
      <button
        type="button"
        class="label-chip note-count"
        onClick={() => {
          dismissed.value = '';
          whole.value = true;
        }}
      >
        <Icon name="warn" small /> {said.length === 1 ? '1 note' : `${said.length} notes`}
      </button>
    );
  const [first = '', ...others] = said;
  const [title, rest] = headed(first);
  if (!whole.value)
    return (
      <div class="label-chip advice" role="status">
        <Icon name="warn" small />
        <span class="clip">{title}</span>
        <button type="button" class="text-button" onClick={() => (whole.value = true)}>
          {others.length > 0 ? `${others.length} more ${others.length === 1 ? 'note' : 'notes'}` : 'Read on'}
        </button>
        <IconButton icon="close" label="Hide this note" onClick={() => (dismissed.value = words)} />
      </div>
    );
  return (
    <div class="note-place">
      <Note
        kind="attention"
        icon="warn"
        title={title}
        onDismiss={() => {
          whole.value = false;
          dismissed.value = words;
        }}
      >
        {[rest, ...others].filter(Boolean).join(' ')}
      </Note>
    </div>
  );
}
