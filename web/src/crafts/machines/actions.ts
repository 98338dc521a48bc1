// SPDX-License-Identifier: GPL-3.0-or-later
// What a person can have the machine do, each asked about before it moves or fires.
import type { MachineCommand } from '../../machines/links/machine_state';
import { workBoundsOfBed } from '../../machines/places';
import type { ToolPath } from '../../machines/toolpath';
import { workBounds } from '../../machines/toolpath';
import { formatDuration, formatNumber, withUnit } from '../../ui';
import { ask } from './panel/confirm';
import type { MachinesSession } from './machines_session';

const eyes =
  'Lid closed or eyes protected, extraction on, something to put out a fire at hand. Stay with the machine.';

const chips =
  'Stock clamped down, the right tool in the spindle, eyes and ears protected, extraction on. Stay with the machine.';

const isLaser = (session: MachinesSession): boolean =>
  (session.profiles.current.options['tool'] ?? 'laser') === 'laser';

/** A laser's program must not run on a mill, nor a mill's on a laser. */
function wrongMachine(session: MachinesSession): string | undefined {
  const kind = session.document.value.drawing?.kind;
  if (kind === 'model' && !session.isMill) return 'This job is for a mill: choose one as the machine';
  if (kind === 'test' && !isLaser(session)) return 'This test is for a laser: choose one as the machine';
  return undefined;
}

/** "finishing", of the job that Start starts; "" for the only one. */
const toolWords = (session: MachinesSession): string =>
  ({ rough: 'roughing', finish: 'finishing' })[session.job.value?.stage ?? ''] ?? '';

/** "Lion, finishing". */
const nameOf = (session: MachinesSession): string => {
  const words = toolWords(session);
  return words ? `${session.title}, ${words}` : session.title;
};

/** Of the job that Start starts. */
function secondsOf(session: MachinesSession, { seconds, stages }: ToolPath): number {
  const stage = session.stage.value;
  return (stages?.[stage + 1]?.start_s ?? seconds) - (stages?.[stage]?.start_s ?? 0);
}

const millimetres = (mm: number) => withUnit(formatNumber(mm, 4), 'mm');

/** Why the job cannot be started now; undefined where it can. */
export function startReason(session: MachinesSession): string | undefined {
  const { control } = session;
  const plan = session.plan.value;
  const state = control.state.value;
  if (state === null) return 'Connect a machine first';
  const wrong = wrongMachine(session);
  if (wrong) return wrong;
  if (plan === null) return session.subject.value ? 'Make the job first' : 'Open a drawing or a job first';
  if (session.planning.value) return 'Ready when the job is made';
  if (plan.misfits.length > 0 || session.job.value === null) return plan.misfits[0] ?? 'The job does not fit';
  if (!session.isCurrent.value)
    return session.subject.value
      ? 'What is shown is not what is set: make the job first'
      : 'What is shown is not what is set: mend what is marked first';
  if (control.isBusy) return 'A job is running';
  if (state.phase === 'alarm') return 'The machine is in alarm: home it first';
  if (!state.position_known)
    return state.can.includes('home')
      ? 'Where the head stands is unknown: home it first'
      : 'Where the head stands is unknown: jog to the corner and set the origin';
  if (session.needsZ)
    return `Mount the ${toolWords(session)} tool, lower its tip to the stock and set z here`;
  if (session.isMill && !state.axes_known.z)
    return 'Where the tool’s tip stands is unknown: lower it to the stock’s top and set z';
  return state.phase === 'idle' ? undefined : `The machine is ${state.phase}`;
}

/** What the driver warns of, and what happens when nobody talks to the machine any more. */
function whenLeftAlone(session: MachinesSession): string[] {
  const state = session.control.state.value;
  return state === null
    ? []
    : [...state.warnings, state.when_connection_ends].filter((sentence) => sentence !== '');
}

/** The machine has the job before the question: only then it can say what it does with it. */
export async function start(session: MachinesSession): Promise<void> {
  const plan = session.plan.value;
  const [job, key] = [session.job.value, session.jobKey.value];
  if (startReason(session) !== undefined || !plan || !job || key === null) return;
  const { toolPath } = plan;
  const seconds = secondsOf(session, toolPath);
  const power = Math.max(0, ...toolPath.paths.map(({ power_percent }) => power_percent));
  const name = nameOf(session);
  if (!(await session.control.load(name, key, job.bytes))) return;
  ask({
    title: `Start ${name} on ${session.control.machineName.value}?`,
    sentences: () => [
      isLaser(session)
        ? `The head moves and the laser turns on, at up to ${withUnit(formatNumber(power, 2), '%')}, for about ${formatDuration(seconds)}.`
        : `The machine moves and its spindle turns, for about ${formatDuration(seconds)}. Z is 0 on the stock's top, the tool at its corner.`,
      isLaser(session) ? eyes : chips,
      ...whenLeftAlone(session),
    ],
    action: isLaser(session) ? 'Start with the laser on' : 'Start with the spindle on',
    danger: true,
    run: () => {
      session.playhead.value = null;
      void session.control.start(name, key, job.bytes);
    },
  });
}

/** Goes on with a job that ended early, the careful way: from the beginning of a stroke before what may not have been done. */
export function goOn(session: MachinesSession): void {
  const [job, key] = [session.job.value, session.jobKey.value];
  const { state, cutOff } = session.control;
  const line = (state.value?.job ?? cutOff.value?.job)?.careful_line;
  if (!job || key === null || line === undefined) return;
  ask({
    title: 'Cut the rest?',
    sentences: [
      isLaser(session)
        ? `The machine was homed again; it goes to the stroke that begins at line ${line}, turns the laser on and cuts from there. What was cut last is cut once more.`
        : `The machine was homed again; it rises, goes to the line that begins at line ${line} of the job, starts its spindle and sinks at feed rate. What was cut last is cut once more.`,
      'This only fits where neither the material nor the origin has moved. ' +
        (isLaser(session) ? eyes : chips),
      ...whenLeftAlone(session),
    ],
    action: isLaser(session) ? 'Go on with the laser on' : 'Go on with the spindle on',
    danger: true,
    run: () => void session.control.start(nameOf(session), key, job.bytes, line),
  });
}

export function frame(session: MachinesSession): void {
  const plan = session.plan.value;
  const bounds = plan && workBounds(plan.toolPath);
  if (!bounds) return;
  ask({
    title: 'Frame the job?',
    sentences: [
      `The head moves once around ${millimetres(bounds[2] - bounds[0])} by ${millimetres(bounds[3] - bounds[1])}, ${isLaser(session) ? 'the laser stays off' : 'at the height where it stands now, the spindle off: raise it over stock and clamps first'}. Keep hands and clamps out of its way.`,
    ],
    action: 'Frame',
    run: () =>
      void session.control.command({
        do: 'frame',
        bounds_mm: workBoundsOfBed(bounds, session.origin.value, plan.toolPath.bed_mm),
        speed_mm_per_s: 50,
        confirmed: true,
      }),
  });
}

export function home(session: MachinesSession): void {
  ask({
    title: 'Home the machine?',
    sentences: ['The head moves to its switches. Keep hands and clamps out of its way.'],
    action: 'Home',
    run: () => void session.control.command({ do: 'home', confirmed: true }),
  });
}

export function focus(session: MachinesSession): void {
  const power_percent = 1;
  ask({
    title: 'Shine the laser to focus it?',
    sentences: [
      `The laser shines at ${withUnit(String(power_percent), '%')} without moving, and goes out by itself after a minute. Eyes protected.`,
    ],
    action: 'Shine the laser',
    danger: true,
    run: () => void session.control.command({ do: 'focus', power_percent, confirmed: true }),
  });
}

export function resume(session: MachinesSession): void {
  ask({
    title: 'Go on?',
    sentences: [
      isLaser(session)
        ? 'The machine goes on where it was held, with the laser on.'
        : 'The machine goes on where it was held, with the spindle on.',
      isLaser(session) ? eyes : chips,
    ],
    action: 'Go on',
    danger: true,
    run: () => void session.control.command({ do: 'resume', confirmed: true }),
  });
}

export const hold = (session: MachinesSession): void => void session.control.command({ do: 'pause' });
export const stop = (session: MachinesSession): void => void session.control.command({ do: 'stop' });

/** A line typed in the console; where it may move or fire, it is asked about. */
export function sendLine(session: MachinesSession, line: string): void {
  const send = (confirmed: boolean) =>
    session.control.command({ do: 'send', line, confirmed } satisfies MachineCommand);
  // Whether a line moves or fires the driver knows: it is asked first.
  void session.control.link.value
    ?.command({ do: 'send', line, confirmed: false })
    .catch((thrown: unknown) => {
      const where = thrown instanceof Error && 'where' in thrown ? thrown.where : '';
      const message = thrown instanceof Error ? thrown.message : String(thrown);
      if (where !== 'confirmed') session.control.problem.value = message;
      else
        ask({
          title: `Send ${line}?`,
          sentences: [message.replace(/: this must be confirmed.*/, '.')],
          action: 'Send',
          danger: true,
          run: () => void send(true),
        });
    });
}
