// SPDX-License-Identifier: GPL-3.0-or-later
// Nothing moves and no laser fires before a person in front of the machine has said so.
import { signal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import { Button, Dialog } from '../../../ui';

export interface Question {
  readonly title: string;
  /** What will move, and whether the laser will be on. Asked anew whenever what they read changes. */
  readonly sentences: readonly string[] | (() => readonly string[]);
  readonly action: string;
  readonly danger?: boolean;
  readonly run: () => void;
}

const asked = signal<Question | null>(null);

export const ask = (question: Question): void => {
  asked.value = question;
};

/** Apart from the dialog, which takes the focus anew whenever it is drawn. */
function Sentences({ of }: { readonly of: Question['sentences'] }) {
  const sentences = typeof of === 'function' ? of() : of;
  return (
    <>
      {sentences.map((sentence) => (
        <p key={sentence}>{sentence}</p>
      ))}
    </>
  );
}

/** The focus stands on Cancel: Enter pressed by habit starts nothing. */
export function Confirmation() {
  const question = asked.value;
  const cancel = useRef<HTMLButtonElement>(null);
  useEffect(() => cancel.current?.focus(), [question]);
  if (question === null) return null;
  const close = () => (asked.value = null);
  return (
    <Dialog title={question.title} onClose={close}>
      <Sentences of={question.sentences} />
      <div class="dialog-actions">
        <Button buttonRef={cancel} onClick={close}>
          Cancel
        </Button>
        <Button
          kind={question.danger ? 'danger' : 'filled'}
          onClick={() => {
            close();
            question.run();
          }}
        >
          {question.action}
        </Button>
      </div>
    </Dialog>
  );
}
