// SPDX-License-Identifier: GPL-3.0-or-later
// From a solid to a 3D printer: slice, look at time and filament, send, start.
import { useSignal } from '@preact/signals';
import { useEffect, useMemo } from 'preact/hooks';
import { Button, Dialog, formatBytes, formatDuration, formatNumber, Icon, withUnit } from '../../ui';
import { download } from '../session/download';
import './print_dialog.css';
import type { Solid } from './print_request';
import type { Services } from '../session/services';
import { SliceSession } from './slice_session';

export interface SliceDialogProps {
  readonly services: Services;
  readonly solid: Solid;
  readonly onClose: () => void;
}

export function SliceDialog({ services, solid, onClose }: SliceDialogProps) {
  const session = useMemo(() => SliceSession.of(services, solid), [solid]);
  useEffect(() => () => session.close(), [session]);
  return (
    <Dialog title={`Print ${session.solid.title} in plastic`} onClose={onClose}>
      {session.slicer.value ? <Slicing session={session} /> : <NoSlicer session={session} />}
      {session.current.value ? <Sending session={session} /> : null}
      <div class="print-foot">
        {session.task.value ? (
          <div class="print-state" role="status">
            <Icon name="clock" small /> {session.task.value.sentence}
            <Button size="small" onClick={() => session.cancel()}>
              Cancel
            </Button>
          </div>
        ) : session.done.value ? (
          <div class="print-state" role="status">
            <Icon name="check" small /> {session.done.value}
          </div>
        ) : null}
        {session.problem.value ? (
          <p class="problem" role="alert">
            {session.problem.value}
          </p>
        ) : null}
      </div>
    </Dialog>
  );
}

function NoSlicer({ session }: { readonly session: SliceSession }) {
  const { solid, services } = session;
  const worker = services.connection.value?.state === 'ready';
  if (session.looking.value) return <p class="hint">Looking for a slicer</p>;
  return (
    <>
      <p>
        {worker
          ? 'No slicer was found on this computer. Install PrusaSlicer, or slice the file yourself.'
          : 'Slicing and sending need the worker program: run “make run” in Formwright’s source and open the address it prints. Or slice the file yourself.'}
      </p>
      <div class="dialog-actions">
        <Button
          icon="download"
          kind="filled"
          onClick={() => download(solid.bytes, solid.fileName, 'model/stl')}
        >
          Save the file
        </Button>
      </div>
    </>
  );
}

function Slicing({ session }: { readonly session: SliceSession }) {
  const sliced = session.current.value;
  const profiles = session.profiles.value;
  return (
    <section class="section" aria-label="Slicing">
      {profiles.length > 0 ? (
        <div class="field-line">
          <label for="slice-profile">Profile</label>
          <select
            id="slice-profile"
            class="select"
            value={session.profile.value}
            onChange={(event) => (session.profile.value = event.currentTarget.value)}
          >
            {profiles.map((name) => (
              <option key={name}>{name}</option>
            ))}
            <option value="">{session.slicer.value?.name}’s own settings</option>
          </select>
        </div>
      ) : (
        <p class="hint">
          Sliced with {session.slicer.value?.name}’s own settings. Profiles that you export from it to the
          worker’s folder slicer_profiles are offered here.
        </p>
      )}
      <div class="slice-line">
        <span>{sliced ? factsLine(sliced.facts, sliced.gcode.byteLength) : 'Not sliced yet'}</span>
        {sliced ? (
          <Button
            icon="download"
            size="small"
            onClick={() => download(sliced.gcode, session.fileName, 'text/x-gcode')}
          >
            Save the G-code
          </Button>
        ) : (
          <Button
            kind="filled"
            disabledReason={session.task.value ? 'A print is being prepared' : undefined}
            onClick={() => void session.slice()}
          >
            Slice
          </Button>
        )}
      </div>
    </section>
  );
}

function factsLine(
  {
    seconds,
    filament_g,
    filament_mm,
  }: { seconds: number | null; filament_g: number | null; filament_mm: number | null },
  bytes: number,
): string {
  return [
    seconds === null ? null : `About ${formatDuration(seconds)}`,
    filament_g
      ? `${withUnit(formatNumber(filament_g, 3), 'g')} of filament`
      : filament_mm
        ? `${withUnit(formatNumber(filament_mm / 1000, 3), 'm')} of filament`
        : null,
    formatBytes(bytes),
  ]
    .filter(Boolean)
    .join(', ');
}

function Sending({ session }: { readonly session: SliceSession }) {
  const confirming = useSignal(false);
  const servers = session.servers.value;
  const now = session.serverNow.value;
  if (servers.length === 0)
    return (
      <p class="hint">
        Printers behind OctoPrint or Moonraker are added with “formwright machine add --kind octoprint”; see
        the docs on machines.
      </p>
    );
  const name = servers.find(({ id }) => id === session.server.value)?.name ?? '';
  const busy = session.task.value
    ? 'A print is being prepared'
    : now === null
      ? 'The printer has not answered yet'
      : undefined;
  const notReady =
    now?.state === 'ready' ? undefined : now ? `The printer is ${now.state}` : 'The printer does not answer';
  return (
    <section class="section" aria-label="Printer">
      <div class="field-line">
        <label for="slice-server">Printer</label>
        <select
          id="slice-server"
          class="select"
          value={session.server.value}
          onChange={(event) => void session.chooseServer(event.currentTarget.value)}
        >
          {servers.map((server) => (
            <option key={server.id} value={server.id}>
              {server.name}
            </option>
          ))}
        </select>
      </div>
      {now ? <p class="hint">{[now.software, now.state].filter(Boolean).join(', ')}</p> : null}
      {confirming.value ? (
        <>
          <p>
            {name} heats up and moves as soon as it has the file. Is its bed clear, and is somebody beside it?
          </p>
          <div class="dialog-actions">
            <Button onClick={() => (confirming.value = false)}>Do not start yet</Button>
            <Button
              kind="danger"
              onClick={() => {
                confirming.value = false;
                void session.upload(true);
              }}
            >
              Send and start
            </Button>
          </div>
        </>
      ) : (
        <div class="dialog-actions">
          <Button disabledReason={busy} onClick={() => void session.upload(false)}>
            Send
          </Button>
          <Button kind="filled" disabledReason={busy ?? notReady} onClick={() => (confirming.value = true)}>
            Send and start
          </Button>
        </div>
      )}
    </section>
  );
}
