// SPDX-License-Identifier: GPL-3.0-or-later
// What to know about the work, at the foot of the viewport: a line, and opened a list with a fix for each.
import { useSignal } from '@preact/signals';
import { useEffect, useId, useRef } from 'preact/hooks';
import { Button, Icon, IconButton } from '../../ui';
import type { ReportNote } from '../session/report_notes';
import { headed } from '../session/report_notes';
import { narrow } from './narrow';
import './note_list.css';

export interface NoteListProps {
  readonly notes: readonly ReportNote[];
  /** Over the list. */
  readonly title: string;
  /** The first note is shown before the list is opened. */
  readonly urgent: boolean;
  readonly onFix: (note: ReportNote) => void;
}

const count = (notes: readonly ReportNote[]) => (notes.length === 1 ? '1 note' : `${notes.length} notes`);

/** Lines that were read, in this tab. */
const read = new Set<string>();

export function NoteList({ notes, title, urgent, onFix }: NoteListProps) {
  const open = useSignal(false);
  const hidden = useSignal(0); // counts what was hidden, to draw anew
  const opener = useRef<HTMLButtonElement>(null);
  const closed = useRef(false);
  const id = useId();
  useEffect(() => {
    if (!open.value && closed.current) opener.current?.focus();
    closed.current = open.value;
  }, [open.value]);
  if (notes.length === 0) return null;
  void hidden.value;
  if (open.value)
    return (
      <section class="note-list panel" aria-labelledby={id}>
        <header>
          <h3 id={id}>{title}</h3>
          <IconButton icon="close" label="Close the notes" onClick={() => (open.value = false)} />
        </header>
        <ul>
          {notes.map((note) => (
            <NoteRow key={note.sentence} note={note} onFix={onFix} />
          ))}
        </ul>
      </section>
    );
  const [first] = notes;
  const show = () => (open.value = true);
  // On a phone the object needs the room until the notes are asked for.
  if (!urgent || first === undefined || read.has(first.sentence) || narrow())
    return (
      <button ref={opener} type="button" class="label-chip note-count" onClick={show}>
        <Icon name="warn" small /> {count(notes)}
      </button>
    );
  const others = notes.length - 1;
  return (
    <div class="label-chip advice" role="status">
      <Icon name="warn" small />
      <span class="clip">{headed(first.sentence)[0]}</span>
      <button ref={opener} type="button" class="text-button" onClick={show}>
        {others > 0
          ? `${others} more ${others === 1 ? 'note' : 'notes'}`
          : first.fix
            ? 'What to do'
            : 'Read on'}
      </button>
      <IconButton
        icon="close"
        label="Hide this note"
        onClick={() => {
          read.add(first.sentence);
          hidden.value += 1;
        }}
      />
    </div>
  );
}

function NoteRow({ note, onFix }: { note: ReportNote; onFix: (note: ReportNote) => void }) {
  const [head, rest] = headed(note.sentence);
  return (
    <li>
      <strong>{head}</strong>
      {rest ? <p>{rest}</p> : null}
      {note.fix ? (
        <Button size="small" onClick={() => onFix(note)}>
          {note.fix.label}
        </Button>
      ) : null}
    </li>
  );
}
