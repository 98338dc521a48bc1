// SPDX-License-Identifier: GPL-3.0-or-later
// Nothing moves and no laser fires before a person in front of the machine has said so.
import { signal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import { Button, Dialog } from '../../../ui';

export interface Option<Value extends string> {
  readonly value: Value;
  readonly label: string;
}

/** What must be chosen before the action, none of it being chosen in advance. */
export interface Choice<Value extends string> {
  readonly legend: string;
  /** Asked anew whenever what they read changes; null where there is nothing to choose. */
  readonly options: () => readonly Option<Value>[] | null;
}

interface Question<Value extends string> {
  readonly title: string;
  /** What will move, and whether the laser will be on. Asked anew whenever what they read changes. */
  readonly sentences: readonly string[] | (() => readonly string[]);
  readonly choice?: Choice<Value>;
  readonly action: string | (() => string);
  readonly danger?: boolean;
  /** Null where nothing was to be chosen. */
  readonly run: (chosen: Value | null) => void;
}

const asked = signal<Question<string> | null>(null);
const chosen = signal<string | null>(null);

export const ask = <Value extends string = string>(question: Question<Value>): void => {
  chosen.value = null;
  asked.value = question as unknown as Question<string>;
};

/** Is a question open? */
export const isAsking = (): boolean => asked.value !== null;

/** Apart from the dialog, which takes the focus anew whenever it is drawn. */
function Sentences({ of }: { readonly of: Question<string>['sentences'] }) {
  const sentences = typeof of === 'function' ? of() : of;
  return (
    <>
      {sentences.map((sentence) => (
        <p key={sentence}>{sentence}</p>
      ))}
    </>
  );
}

function Choices({ of }: { readonly of: Choice<string> }) {
  const options = of.options();
  if (options === null) return null;
  return (
    <fieldset class="dialog-choice">
      <legend>{of.legend}</legend>
      {options.map(({ value, label }) => (
        <label key={value}>
          <input
            type="radio"
            name="dialog-choice"
            checked={chosen.value === value}
            onChange={() => (chosen.value = value)}
          />
          {label}
        </label>
      ))}
    </fieldset>
  );
}

function Act({ question, close }: { readonly question: Question<string>; readonly close: () => void }) {
  const options = question.choice?.options() ?? null;
  const choice = options?.find(({ value }) => value === chosen.value)?.value ?? null;
  return (
    <Button
      kind={question.danger ? 'danger' : 'filled'}
      disabledReason={
        options !== null && choice === null ? `Choose first: ${question.choice?.legend}` : undefined
      }
      onClick={() => {
        close();
        question.run(choice);
      }}
    >
      {typeof question.action === 'function' ? question.action() : question.action}
    </Button>
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
      {question.choice ? <Choices of={question.choice} /> : null}
      <div class="dialog-actions">
        <Button buttonRef={cancel} onClick={close}>
          Cancel
        </Button>
        <Act question={question} close={close} />
      </div>
    </Dialog>
  );
}
