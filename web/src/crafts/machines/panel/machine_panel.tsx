// SPDX-License-Identifier: GPL-3.0-or-later
// The machine at the head of the inspector: what it is, where it stands, and the buttons that move it.
import { useEffect, useRef } from 'preact/hooks';
import type { MachineCommand, MachineState } from '../../../machines/links/machine_state';
import { Button, formatFixed, Icon } from '../../../ui';
import {
  focus,
  frame,
  hold,
  home,
  offersPractice,
  practiceReason,
  practiseTheJob,
  resume,
  start,
  startReason,
  stop,
} from '../actions';
import { ConnectMenu, ProfileMenu } from './machine_menus';
import { PracticeSpeed } from './practice_speed';
import type { MachinesSession } from '../machines_session';
import { stateWords } from './state_words';

const dotOf = (state: MachineState | null): string => {
  if (state === null) return 'off';
  if (state.connection === 'silent' || state.phase === 'alarm') return 'bad';
  return ['running', 'jogging', 'homing', 'pausing'].includes(state.phase) ? 'live' : '';
};

export function MachinePanel({ session }: { readonly session: MachinesSession }) {
  const { control } = session;
  const state = control.state.value;
  const cannot = (what: MachineCommand['do'], why: string) =>
    control.can(what) ? undefined : state === null ? 'Connect a machine first' : why;
  const held = state?.phase === 'paused' || state?.phase === 'door';
  const plan = session.plan.value;
  return (
    <>
      <div class="model-row machine-row">
        <span class="machine-icon" aria-hidden="true">
          <Icon name="machines" />
        </span>
        <div class="grow">
          <ProfileMenu session={session} />
          <span class="model-line">
            {state?.firmware ? `${state.controller.toUpperCase()} ${state.firmware}` : 'No machine connected'}
          </span>
        </div>
        <span class={`chip state-chip ${dotOf(state)}`} role="status">
          <i class={`dot ${dotOf(state)}`} />
          {stateWords(state)}
        </span>
      </div>
      <section class="section" aria-label="Machine">
        {state === null ? (
          <ConnectMenu session={session} />
        ) : (
          <>
            <Position state={state} withZ={session.isMill} />
            <Beam state={state} isMill={session.isMill} />
            <PracticeSpeed session={session} />
            <div class="machine-buttons">
              <Button
                icon="home"
                disabledReason={cannot('home', 'The machine is busy, or has no homing switches')}
                onClick={() => home(session)}
              >
                Home
              </Button>
              <Button
                icon="frame"
                disabledReason={
                  plan === null
                    ? 'Open a drawing first'
                    : cannot('frame', 'The position of the head is unknown, or the machine is busy')
                }
                onClick={() => frame(session)}
              >
                Frame
              </Button>
              {held ? (
                <Button icon="play" onClick={() => resume(session)}>
                  Resume
                </Button>
              ) : (
                <Button
                  icon="pause"
                  disabledReason={cannot('pause', 'No job is running')}
                  onClick={() => hold(session)}
                >
                  Pause
                </Button>
              )}
              {control.can('focus_off') ? (
                <Button icon="sun" onClick={() => void control.command({ do: 'focus_off' })}>
                  Laser off
                </Button>
              ) : session.isMill ? (
                <Button
                  disabledReason={cannot('set_origin', 'Only while the machine is idle')}
                  title="Sets z to 0 at the tool’s tip, which must touch the top of the stock"
                  onClick={() => void control.command({ do: 'set_origin', axes: 'z' })}
                >
                  Set z here
                </Button>
              ) : (
                <Button
                  disabledReason={cannot('focus', 'Only while the laser is idle')}
                  onClick={() => focus(session)}
                >
                  Focus
                </Button>
              )}
            </div>
            <div class="machine-small-buttons">
              {control.can('unlock') ? (
                <Button size="small" onClick={() => void control.command({ do: 'unlock' })}>
                  Unlock without homing
                </Button>
              ) : null}
              <Button
                size="small"
                disabledReason={cannot('set_origin', 'Only while the machine is idle')}
                onClick={() => void control.command({ do: 'set_origin', axes: 'xy' })}
              >
                Set origin here
              </Button>
              {control.can('set_origin') && state.position_known && state.controller === 'grbl' ? (
                <Button size="small" onClick={() => void control.command({ do: 'set_origin', at: 'corner' })}>
                  Set origin at the bed’s corner
                </Button>
              ) : null}
              <Button
                size="small"
                kind="quiet"
                disabledReason={control.isBusy ? 'Stop the job first' : undefined}
                onClick={() => void control.disconnect()}
              >
                Disconnect
              </Button>
            </div>
            <Jog session={session} />
          </>
        )}
      </section>
    </>
  );
}

function Position({ state, withZ }: { readonly state: MachineState; readonly withZ: boolean }) {
  const axis = (name: 'x' | 'y' | 'z', index: number) => (
    <div>
      <span>{name.toUpperCase()}</span>
      <b>{state.axes_known[name] && state.work_mm ? formatFixed(state.work_mm[index] ?? 0, 2) : 'unknown'}</b>
    </div>
  );
  return (
    <div
      class={withZ ? 'machine-position three' : 'machine-position'}
      role="group"
      aria-label="Position of the head, in millimetres"
    >
      {axis('x', 0)}
      {axis('y', 1)}
      {withZ ? axis('z', 2) : null}
    </div>
  );
}

/** Whether the machine says that its laser is on or its spindle turns, in whatever state it is; and what it warns of. */
function Beam({ state, isMill }: { readonly state: MachineState; readonly isMill: boolean }) {
  return (
    <>
      <p class={state.laser_on ? 'beam-state on' : 'beam-state'} role="status">
        {state.laser_on ? (isMill ? 'The spindle turns' : 'The laser is on') : ''}
      </p>
      {state.warnings.length > 0 ? (
        <ul class="machine-warnings" aria-label="Warnings about this machine">
          {state.warnings.map((sentence) => (
            <li key={sentence}>{sentence}</li>
          ))}
        </ul>
      ) : null}
    </>
  );
}

/** Along x, y or z, by so many millimetres. */
type Way = readonly [number, number, number];
const speedOf = (z: number): number => (z === 0 ? 60 : 10);
/** While a key is held the head is given this much of its way at a time: when the page hangs, it does not go far. Longer than
 *  the driver waits between two reports, which every jog begins anew. */
const portion_s = 0.3;
const ahead_s = 0.15;
const heldAfter_ms = 250;

/** Held down it moves, let go it stops; a short press moves one millimetre. */
function Jog({ session }: { readonly session: MachinesSession }) {
  const { control } = session;
  const timer = useRef<ReturnType<typeof setTimeout> | undefined>(undefined);
  const held = useRef<'no' | 'pressed' | 'moving'>('no');
  const jog = ([x, y, z]: Way, distance_mm: number) =>
    control.command({
      do: 'jog',
      ...(z === 0 ? { x_mm: x * distance_mm, y_mm: y * distance_mm } : { z_mm: z * distance_mm }),
      speed_mm_per_s: speedOf(z),
    });
  const goOn = async (way: Way) => {
    const first = held.current !== 'moving';
    held.current = 'moving';
    const taken = await jog(way, (portion_s + (first ? ahead_s : 0)) * speedOf(way[2]));
    if (held.current !== 'moving')
      void control.command({ do: 'jog_cancel' }); // let go meanwhile
    else if (taken) timer.current = setTimeout(() => void goOn(way), 1000 * portion_s);
  };
  const press = (way: Way) => {
    clearTimeout(timer.current);
    held.current = 'pressed';
    timer.current = setTimeout(() => void goOn(way), heldAfter_ms);
  };
  const leave = () => {
    clearTimeout(timer.current);
    if (held.current === 'moving') void control.command({ do: 'jog_cancel' });
    held.current = 'no';
  };
  const release = (way: Way) => {
    if (held.current === 'pressed') void jog(way, 1);
    leave();
  };
  useEffect(() => {
    // The window loses the focus, or the room is left, with a key held.
    addEventListener('blur', leave);
    return () => {
      removeEventListener('blur', leave);
      leave();
    };
  }, []);
  const reason = control.can('jog') ? undefined : 'Only while the machine is idle';
  const arrows: Record<string, Way> = {
    ArrowLeft: [-1, 0, 0],
    ArrowRight: [1, 0, 0],
    ArrowUp: [0, 1, 0],
    ArrowDown: [0, -1, 0],
    ...(session.isMill ? { PageUp: [0, 0, 1] as const, PageDown: [0, 0, -1] as const } : {}),
  };
  const key = (name: string, way: Way, area: string) => (
    <button
      type="button"
      class="jog-key"
      style={{ gridArea: area }}
      aria-label={`Move ${name}`}
      aria-disabled={reason ? true : undefined}
      onPointerDown={(event) => {
        if (reason || event.button !== 0) return;
        event.currentTarget.setPointerCapture(event.pointerId);
        press(way);
      }}
      onPointerUp={() => (reason ? undefined : release(way))}
      onPointerCancel={leave}
      onClick={(event) => {
        // From the keyboard a click has no pointer.
        if (!reason && event.detail === 0) void jog(way, event.shiftKey ? 10 : 1);
      }}
    >
      <Icon name="arrow" small />
    </button>
  );
  return (
    <div
      class={session.isMill ? 'jog with-z' : 'jog'}
      role="group"
      aria-label={`Move the head. Arrow keys${session.isMill ? ', Page Up and Page Down' : ''} move one millimetre, with Shift ten`}
      onKeyDown={(event) => {
        const by = arrows[event.key];
        if (by === undefined || reason) return;
        event.preventDefault();
        void jog(by, event.shiftKey ? 10 : 1);
      }}
    >
      {key('back', [0, 1, 0], 'up')}
      {key('left', [-1, 0, 0], 'left')}
      {key('right', [1, 0, 0], 'right')}
      {key('forward', [0, -1, 0], 'down')}
      {session.isMill ? key('the tool up', [0, 0, 1], 'raise') : null}
      {session.isMill ? key('the tool down', [0, 0, -1], 'lower') : null}
      <p class="jog-hint">Press: 1 mm. Hold: moves until you let go.</p>
    </div>
  );
}

/** Always in sight, wherever one has scrolled: Stop stands here as long as a machine is connected. */
export function StartAndStop({ session }: { readonly session: MachinesSession }) {
  const connected = session.control.link.value !== null;
  if (offersPractice(session))
    return (
      <Button
        kind="filled"
        size="big"
        icon="play"
        disabledReason={practiceReason(session)}
        onClick={() => void practiseTheJob(session)}
      >
        Practise the job
      </Button>
    );
  return (
    <div class={connected ? 'start-and-stop' : undefined}>
      <Button
        kind="filled"
        size="big"
        icon="play"
        disabledReason={startReason(session)}
        onClick={() => void start(session)}
      >
        {connected ? 'Start' : 'Start the job'}
      </Button>
      {connected ? (
        <Button
          kind="danger"
          size="big"
          icon="stop"
          title="Stop at once (Ctrl + .)"
          onClick={() => stop(session)}
        >
          Stop
        </Button>
      ) : null}
    </div>
  );
}
