// SPDX-License-Identifier: GPL-3.0-or-later
// What a person can have the machine do, each asked about before it moves or fires.
import { effect } from '@preact/signals';
import type { MachineCommand, MachineState, ZChoice } from '../../machines/links/machine_state';
import { workBoundsOfBed } from '../../machines/places';
import { isPractice } from '../../machines/profiles';
import type { ToolPath } from '../../machines/toolpath';
import { workBounds } from '../../machines/toolpath';
import { formatDuration, formatFixed, formatNumber, withUnit } from '../../ui';
import type { Choice, Option } from './panel/confirm';
import { ask, isAsking } from './panel/confirm';
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

/** Why the job is none that a machine could start, whichever is connected; undefined where it is one. */
function jobReason(session: MachinesSession): string | undefined {
  const plan = session.plan.value;
  const wrong = wrongMachine(session);
  if (wrong) return wrong;
  if (plan === null) return session.subject.value ? 'Make the job first' : 'Open a drawing or a job first';
  if (session.planning.value) return 'Available when the job has been made';
  if (plan.misfits.length > 0 || session.job.value === null) {
    // A pattern is laid out again, never made smaller (alarm_bar.tsx).
    const { drawing } = session.document.value;
    const ofPlan = drawing?.kind === 'drawing' && drawing.of_plan === true;
    return ofPlan ? 'The sheet does not fit on the bed' : (plan.misfits[0] ?? 'The job does not fit');
  }
  if (session.isCurrent.value) return undefined;
  return session.subject.value
    ? 'The job shown is out of date because settings changed: make the job again'
    : 'The preview is out of date because some values are invalid. Correct the highlighted fields.';
}

/** Why the job cannot be started now; undefined where it can. */
export function startReason(session: MachinesSession): string | undefined {
  const { control } = session;
  const state = control.state.value;
  if (state === null) return 'Connect a machine first';
  const reason = jobReason(session);
  if (reason) return reason;
  if (control.isBusy) return 'A job is running';
  if (state.phase === 'alarm') return 'The machine is in alarm: home it first';
  if (!state.position_known)
    return state.can.includes('home')
      ? 'The position of the head is unknown: home the machine first'
      : 'The position of the head is unknown: jog to the corner and set the origin';
  // What a driver asks at the start it knows once it has the job.
  if (session.needsZ && control.loaded.value !== null && !state.z_choice)
    return `Mount the ${toolWords(session)} tool, lower its tip to the stock and set z here`;
  if (session.isMill && !state.axes_known.z)
    return 'The height of the tool’s tip is unknown: lower it to the top of the stock and set z';
  return state.phase === 'idle' ? undefined : 'The machine is busy: wait until it is ready';
}

/** What the driver warns of, and what happens when nobody talks to the machine any more. */
function whenLeftAlone(session: MachinesSession): string[] {
  const state = session.control.state.value;
  return state === null
    ? []
    : [...state.warnings, state.when_connection_ends].filter((sentence) => sentence !== '');
}

/** What a mill's start asks; null where nothing is to be chosen. */
export function zOptions(state: MachineState | null, now: Date): readonly Option<ZChoice>[] | null {
  if (!state?.z_choice) return null;
  const { origin_machine_mm: origin, set_seconds_ago: ago } = state.z_choice;
  const place =
    origin === null
      ? 'where it was set'
      : `at ${withUnit(formatFixed(origin, 2), 'mm')} in machine coordinates`;
  const set =
    ago === null
      ? 'set before the machine was connected'
      : `set at ${new Date(now.getTime() - 1000 * ago).toLocaleTimeString([], { hour: '2-digit', minute: '2-digit' })}`;
  return [
    { value: 'here', label: 'Set z to the stock’s top here: the tip of the tool touches it now' },
    { value: 'kept', label: `Keep z 0 ${place} (${set})` },
  ];
}

/** Is the tip's place now the only one that z 0 can have? After a change of tools, and on a practice machine that knows no other. */
export function isZHere(session: MachinesSession): boolean {
  const { control } = session;
  const untouched = control.practising.value && control.zSets.value === 0;
  return (control.state.value?.z_choice ?? null) !== null && (session.needsZ || untouched);
}

/** `hasOne`: that there is only one answer, which the action's own name says. */
const zQuestion = (session: MachinesSession, hasOne: () => boolean): Choice<ZChoice> => ({
  legend: 'Where is z 0?',
  options: () => (hasOne() ? null : zOptions(session.control.state.value, new Date())),
});

/** "The finishing tool is mounted, and its tip touches the top of the stock: z becomes 0 there." */
function zIsHere(session: MachinesSession): string {
  const words = toolWords(session);
  return `The ${words ? `${words} tool is mounted, and its tip` : 'tip of the tool'} touches the top of the stock: z becomes 0 there.`;
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
        : `The machine moves and its spindle turns, for about ${formatDuration(seconds)}. X and y are 0 at the stock's corner, z on its top.`,
      isLaser(session) ? eyes : chips,
      ...(isZHere(session) ? [zIsHere(session)] : []),
      ...whenLeftAlone(session),
    ],
    choice: zQuestion(session, () => isZHere(session)),
    action: () =>
      isLaser(session)
        ? 'Start with the laser on'
        : isZHere(session)
          ? 'Set z here and start the spindle'
          : 'Start with the spindle on',
    danger: true,
    run: (chosen) => {
      const z = isZHere(session) ? 'here' : chosen;
      session.playhead.value = null;
      void session.control.start(name, key, job.bytes, z === null ? {} : { z });
    },
  });
}

/** Goes on with a job that ended early, the careful way: from the beginning of a stroke before what may not have been done. */
export async function goOn(session: MachinesSession): Promise<void> {
  const [job, key] = [session.job.value, session.jobKey.value];
  const { state, cutOff } = session.control;
  const line = (state.value?.job ?? cutOff.value?.job)?.careful_line;
  if (!job || key === null || line === undefined) return;
  // The driver asks about z of the job that it has; after a lost connection it has none. Loading ends what it knew of the last one.
  if (!(await session.control.load(nameOf(session), key, job.bytes))) return;
  ask({
    title: isLaser(session) ? 'Cut the rest?' : 'Carve on from here?',
    sentences: [
      isLaser(session)
        ? `The machine was homed again; it moves to the path that begins at line ${line}, turns the laser on and continues cutting there. The last cut is repeated.`
        : `The machine was homed again; it rises, moves to the path that begins at line ${line} of the job, starts its spindle and lowers the tool at feed rate. The last cut is repeated.`,
      'This works only if neither the material nor the origin has moved. ' +
        (isLaser(session) ? eyes : chips),
      ...whenLeftAlone(session),
    ],
    choice: zQuestion(session, () => false),
    action: isLaser(session) ? 'Continue with the laser on' : 'Continue with the spindle on',
    danger: true,
    run: (z) =>
      void session.control.start(nameOf(session), key, job.bytes, {
        from_line: line,
        ...(z === null ? {} : { z }),
      }),
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

/** `then`: what comes once the machine knows where it stands. */
export function home(session: MachinesSession, then?: () => void): void {
  const { control } = session;
  ask({
    title: 'Home the machine?',
    sentences: ['The head moves to its homing switches. Keep hands and clamps out of its way.'],
    action: 'Home',
    run: () => {
      const run = async () => {
        if (!(await control.command({ do: 'home', confirmed: true })) || then === undefined) return;
        if (await whenSo(session, ({ phase, position_known }) => phase === 'idle' && position_known)) then();
      };
      void run();
    },
  });
}

/** Resolves to true once the connected machine is so, to false where it is gone or in alarm before, or another job is shown. */
function whenSo(session: MachinesSession, isSo: (state: MachineState) => boolean): Promise<boolean> {
  const { control } = session;
  const job = session.jobKey.peek();
  return new Promise((resolve) => {
    const end = effect(() => {
      const state = control.state.value;
      const lost = control.link.value === null || session.jobKey.value !== job;
      const so = !lost && state !== null && isSo(state);
      const alarmed = (state?.alarm?.code ?? 0) > 0; // 0: locked, as before homing
      if (!so && !lost && !alarmed) return;
      resolve(so);
      queueMicrotask(() => end());
    });
  });
}

/** May the job that is shown be practised? Where no machine is connected to a profile that has none. */
export const offersPractice = ({ control, profiles }: MachinesSession): boolean =>
  control.link.value === null && isPractice(profiles.current);

/** Why not; undefined where it can. */
export function practiceReason(session: MachinesSession): string | undefined {
  if (session.control.connecting.value) return 'Connecting';
  return jobReason(session);
}

/** Connects the practice machine and asks whether to home it; a laser's start is asked about after that, a mill's once z is set. */
export async function practiseTheJob(session: MachinesSession): Promise<void> {
  if (practiceReason(session) !== undefined) return;
  await session.practise();
  if (!(await whenSo(session, ({ can }) => can.includes('home')))) return;
  home(session, () => {
    // A mill's z is still to be set. Whoever went on to something else meanwhile is not asked.
    if (isLaser(session) && session.active.value && !isAsking()) void start(session);
  });
}

export function focus(session: MachinesSession): void {
  const power_percent = 1;
  ask({
    title: 'Turn on the laser at low power to focus it?',
    sentences: [
      `The laser is on at ${withUnit(String(power_percent), '%')} without moving, and turns off by itself after a minute. Protect your eyes.`,
    ],
    action: 'Turn on the focus beam',
    danger: true,
    run: () => void session.control.command({ do: 'focus', power_percent, confirmed: true }),
  });
}

export function resume(session: MachinesSession): void {
  ask({
    title: 'Resume the job?',
    sentences: [
      isLaser(session)
        ? 'The machine continues where it was paused, with the laser on.'
        : 'The machine continues where it was paused, with the spindle on.',
      isLaser(session) ? eyes : chips,
    ],
    action: 'Resume',
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
          sentences: [message.replace(/: the person in front of the machine must confirm.*/, '.')],
          action: 'Send',
          danger: true,
          run: () => void send(true),
        });
    });
}
