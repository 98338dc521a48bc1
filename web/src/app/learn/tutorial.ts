// SPDX-License-Identifier: GPL-3.0-or-later
// What a tutorial is made of. The page's overlay, the stories in e2e/ and the documents in docs/tutorials/ all follow the same steps.

type Role =
  | 'button'
  | 'link'
  | 'radio'
  | 'switch'
  | 'textbox'
  | 'slider'
  | 'combobox'
  | 'menuitem'
  | 'application'
  | 'img';

/** A control as a person finds it: by its kind and the beginning of its name. */
export interface Control {
  readonly role: Role;
  readonly name: string;
  /** The whole name, where another control's name begins with it. */
  readonly exact?: true;
}

/** What a person does at the step's control. */
type Act =
  | { readonly do: 'press' | 'wait' | 'look' }
  | { readonly do: 'enter' | 'choose'; readonly value: string }
  | { readonly do: 'keys'; readonly keys: readonly string[] };

/** What shows that a step was done. */
export type Sign =
  | { readonly pressed: true }
  /** The person says so: looking leaves no trace. */
  | { readonly said: true }
  /** The number or the choice of the step's control. */
  | { readonly value: string }
  | { readonly strip: string }
  | { readonly shown: Control }
  | { readonly gone: Control }
  | { readonly enabled: Control };

type Room = 'start' | 'relief' | 'thermoform' | 'zippable' | 'evidence' | 'machines';

export interface Step {
  /** Full sentences; labels of the page stand in **bold**. */
  readonly text: string;
  /** Where the control is; null: in every room. */
  readonly room: Room | null;
  readonly control: Control | null;
  readonly act: Act;
  /** All of them hold once the step is done. */
  readonly done: readonly Sign[];
  /** Taken when the step is done: file name without its ending, and what is to be seen. */
  readonly picture?: { readonly name: string; readonly alt: string };
}

export interface Tutorial {
  /** Also the name of its document. */
  readonly name: string;
  readonly title: string;
  /** One sentence for the list. */
  readonly makes: string;
  readonly steps: readonly Step[];
}

const controlOf =
  (role: Role) =>
  (name: string): Control => ({ role, name });
export const button = controlOf('button');
export const link = controlOf('link');
export const radio = controlOf('radio');
export const field = controlOf('textbox');
export const toggle = controlOf('switch');
export const picture = controlOf('img');
export const item = controlOf('menuitem');
export const list = controlOf('combobox');
export const view = controlOf('application');
export const exactly = (control: Control): Control => ({ ...control, exact: true });

type Rest = Pick<Step, 'picture'>;

/** Steps of one room, or of the bars that every room has. */
export const stepsIn = (room: Room | null) => ({
  press: (text: string, control: Control, signs: readonly Sign[] = [], rest: Rest = {}): Step => ({
    text,
    room,
    control,
    act: { do: 'press' },
    done: [{ pressed: true }, ...signs],
    ...rest,
  }),
  enter: (
    text: string,
    control: Control,
    value: string,
    signs: readonly Sign[] = [],
    rest: Rest = {},
  ): Step => ({
    text,
    room,
    control,
    act: { do: 'enter', value },
    done: [{ value }, ...signs],
    ...rest,
  }),
  choose: (
    text: string,
    control: Control,
    value: string,
    signs: readonly Sign[] = [],
    rest: Rest = {},
  ): Step => ({
    text,
    room,
    control,
    act: { do: 'choose', value },
    done: [{ value }, ...signs],
    ...rest,
  }),
  keys: (
    text: string,
    control: Control,
    keys: readonly string[],
    signs: readonly Sign[],
    rest: Rest = {},
  ): Step => ({
    text,
    room,
    control,
    act: { do: 'keys', keys },
    done: signs,
    ...rest,
  }),
  wait: (text: string, signs: readonly Sign[], rest: Rest = {}): Step => ({
    text,
    room,
    control: null,
    act: { do: 'wait' },
    done: signs,
    ...rest,
  }),
  look: (text: string, control: Control | null = null, rest: Rest = {}): Step => ({
    text,
    room,
    control,
    act: { do: 'look' },
    done: [{ said: true }],
    ...rest,
  }),
});

/** The words of a text that are bold: labels of the page. */
export const labelsIn = (text: string): string[] =>
  [...text.matchAll(/\*\*(.+?)\*\*/g)].map((match) => match[1] ?? '');
