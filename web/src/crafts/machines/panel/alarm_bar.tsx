// SPDX-License-Identifier: GPL-3.0-or-later
// What happened, what is safe, what to do.
import { Button, formatNumber, Icon, Note } from '../../../ui';
import { home } from '../actions';
import type { MachinesSession } from '../machines_session';

export function AlarmBar({ session }: { readonly session: MachinesSession }) {
  const { control } = session;
  const state = control.state.value;
  if (!state?.alarm) return null;
  const locked = state.alarm.code === 0;
  return (
    <section class={locked ? 'alarm-bar locked' : 'alarm-bar'} role="alert">
      <Icon name={locked ? 'lock' : 'warn'} />
      <div class="grow">
        <strong>{state.alarm.text}</strong>
        <p>
          {locked ? '' : 'The laser is off. '}
          {state.alarm.fix}
        </p>
      </div>
      {control.can('home') ? <Button onClick={() => home(session)}>Home</Button> : null}
    </section>
  );
}

/** Problems that are no alarm: of the connection, of a file, of a refused command or line. */
export function MachineNotes({
  session,
  onChooseFile,
  onLayOutAgain,
}: {
  readonly session: MachinesSession;
  readonly onChooseFile: () => void;
  readonly onLayOutAgain: (bed_mm: readonly [number, number]) => void;
}) {
  const { control } = session;
  const plan = session.plan.value;
  const error = control.state.value?.error;
  const problem = session.problem.value;
  if (problem)
    return (
      <Note
        kind="bad"
        icon="file"
        title={problem.title}
        onDismiss={() => (session.problem.value = null)}
        actions={
          <Button size="small" onClick={onChooseFile}>
            Choose another file
          </Button>
        }
      >
        {problem.message}
      </Note>
    );
  if (control.problem.value)
    return (
      <Note
        kind="bad"
        icon="warn"
        title="The machine did not do this"
        onDismiss={() => (control.problem.value = null)}
      >
        {control.problem.value}
      </Note>
    );
  if (error)
    return (
      <Note
        kind="bad"
        icon="warn"
        title={
          error.line_number > 0
            ? `The machine refused line ${error.line_number}`
            : 'The machine refused a line'
        }
      >
        {error.text} The line was “{error.line}”.
      </Note>
    );
  if (plan && plan.misfits.length > 0) {
    const { drawing } = session.document.value;
    const bed = session.bed_mm;
    if (drawing?.kind === 'drawing' && drawing.of_plan && bed)
      return (
        <Note
          kind="attention"
          icon="warn"
          title="The sheet does not fit on the bed"
          actions={
            <Button size="small" onClick={() => onLayOutAgain(bed)}>
              Lay out again for {bed.map((mm) => formatNumber(mm, 3)).join(' × ')}
            </Button>
          }
        >
          The pieces were laid out for a larger sheet. Laid out again they keep their size, and may take more
          sheets.
        </Note>
      );
    return (
      <Note kind="attention" icon="warn" title="The job does not fit">
        {plan.misfits.join(' ')}
      </Note>
    );
  }
  return null;
}
