// SPDX-License-Identifier: GPL-3.0-or-later
// Which machine: profiles that are kept and shared, and the ways to connect.
import { useSignal } from '@preact/signals';
import { useRef } from 'preact/hooks';
import { hasSerial, hasUsb, openSerial, openUsb } from '../../../machines/links/open_machine';
import type { MachineLink } from '../../../machines/links/machine_link';
import type { MachineProfile } from '../../../machines/profiles';
import { asProfile, isPractice, profileExtension, profileFile } from '../../../machines/profiles';
import { Button, Dialog, Icon, Menu, toast } from '../../../ui';
import { download, safeFileName } from '../../../shared/session/download';
import { bridgeMachines } from '../bridge_machines';
import type { MachinesSession } from '../machines_session';

const controllers = [
  ['grbl', 'laser', 'GRBL laser'],
  ['grbl', 'mill', 'GRBL mill'],
  ['marlin', 'laser', 'Marlin laser'],
  ['marlin', 'printer', 'Marlin 3D printer'],
  ['k40', 'laser', 'K40 laser (M2Nano)'],
  ['ruida', 'laser', 'Ruida laser'],
] as const;

export function ProfileMenu({ session }: { readonly session: MachinesSession }) {
  const adding = useSignal(false);
  const file = useRef<HTMLInputElement>(null);
  const { profiles, control } = session;
  const current = profiles.current;
  const busy = control.link.value === null ? undefined : 'Disconnect the machine first';
  const read = async (chosen: File) => {
    try {
      session.useProfile(asProfile(JSON.parse(await chosen.text())));
    } catch (thrown) {
      const sentence =
        thrown instanceof SyntaxError
          ? 'The file is not JSON: choose a profile that was exported here.'
          : (thrown as Error).message;
      session.problem.value = { kind: 'file', title: `Could not read ${chosen.name}`, message: sentence };
    }
  };
  return (
    <>
      <Menu
        buttonClass="profile-button"
        title="Choose or set up a machine"
        items={[
          ...profiles.profiles.value.map((profile) => ({
            label: profile.name,
            checked: profile.id === current.id,
            disabledReason: profile.id === current.id ? undefined : busy,
            onSelect: () => session.useProfile(profile),
          })),
          null,
          {
            label: 'Add a machine',
            icon: 'plus' as const,
            disabledReason: busy,
            onSelect: () => (adding.value = true),
          },
          {
            label: 'Save these settings with the machine',
            icon: 'check' as const,
            disabledReason: session.profileChanged ? undefined : 'No setting of this machine has changed',
            onSelect: () => {
              profiles.put({ ...current, parameters: session.machineParameters() });
              toast(`Saved with ${current.name}.`);
            },
          },
          {
            label: 'Export its profile',
            icon: 'download' as const,
            onSelect: () =>
              download(
                new TextEncoder().encode(profileFile(current)),
                `${safeFileName(current.name)}.${profileExtension}`,
                'application/json',
              ),
          },
          {
            label: 'Import a profile',
            icon: 'upload' as const,
            disabledReason: busy,
            onSelect: () => file.current?.click(),
          },
          {
            label: 'Remove this machine',
            icon: 'trash' as const,
            danger: true,
            disabledReason: busy,
            onSelect: () => profiles.remove(current.id),
          },
        ]}
      >
        <strong class="clip">{current.name}</strong>
        <Icon name="chevronDown" small />
      </Menu>
      <input
        ref={file}
        type="file"
        hidden
        accept=".json"
        aria-label="Machine profile"
        onChange={(event) => {
          const chosen = event.currentTarget.files?.[0];
          event.currentTarget.value = '';
          if (chosen) void read(chosen);
        }}
      />
      {adding.value ? <AddMachine session={session} onClose={() => (adding.value = false)} /> : null}
    </>
  );
}

function AddMachine({
  session,
  onClose,
}: {
  readonly session: MachinesSession;
  readonly onClose: () => void;
}) {
  const name = useSignal('My laser');
  const kind = useSignal(0);
  const bed = useSignal<readonly [string, string]>(['400', '400']);
  const problem = useSignal('');
  const add = () => {
    const [x, y] = bed.value.map(Number);
    const [controller, tool] = controllers[kind.value] ?? controllers[0];
    if (name.value.trim() === '') problem.value = 'Give the machine a name.';
    else if (!(x !== undefined && y !== undefined && x >= 10 && y >= 10 && x <= 10000 && y <= 10000))
      problem.value = 'The bed must be 10 to 10000 mm wide and deep.';
    else {
      const profile: MachineProfile = {
        id: crypto.randomUUID(),
        name: name.value.trim(),
        options: { controller, tool },
        parameters: {
          bed_x_mm: x,
          bed_y_mm: y,
          controller: controller === 'grbl' && tool === 'mill' ? 'grbl_mill' : controller,
        },
        materials: [],
      };
      session.useProfile(profile);
      onClose();
    }
  };
  return (
    <Dialog title="Add a machine" onClose={onClose}>
      <form
        class="add-machine"
        onSubmit={(event) => {
          event.preventDefault();
          add();
        }}
      >
        <label>
          Name
          <input
            type="text"
            value={name.value}
            maxLength={80}
            onInput={(event) => (name.value = event.currentTarget.value)}
          />
        </label>
        <label>
          Kind
          <select
            class="select"
            value={String(kind.value)}
            onChange={(event) => (kind.value = Number(event.currentTarget.value))}
          >
            {controllers.map(([, , label], index) => (
              <option key={label} value={String(index)}>
                {label}
              </option>
            ))}
          </select>
        </label>
        <label>
          Bed width, mm
          <input
            type="text"
            inputMode="decimal"
            value={bed.value[0]}
            onInput={(event) => (bed.value = [event.currentTarget.value, bed.value[1]])}
          />
        </label>
        <label>
          Bed depth, mm
          <input
            type="text"
            inputMode="decimal"
            value={bed.value[1]}
            onInput={(event) => (bed.value = [bed.value[0], event.currentTarget.value])}
          />
        </label>
        {problem.value ? (
          <p class="problem" role="alert">
            {problem.value}
          </p>
        ) : null}
        <div class="dialog-actions">
          <Button onClick={onClose}>Cancel</Button>
          <Button kind="filled" type="submit">
            Add
          </Button>
        </div>
      </form>
    </Dialog>
  );
}

/** Shown while no machine is connected. */
export function ConnectMenu({ session }: { readonly session: MachinesSession }) {
  const { control, profiles } = session;
  const { controller } = profiles.current.options;
  const connect = (open: () => Promise<MachineLink | null>) => void control.connect(profiles.current, open);
  const options = () => session.driverOptions();
  const busy = control.connecting.value ? 'Connecting' : undefined;
  const serial = hasSerial()
    ? undefined
    : 'This browser cannot reach a serial port: use Chrome or Edge, or the worker program';
  const usb = hasUsb() ? undefined : 'This browser cannot reach USB devices: use Chrome or Edge';
  return (
    <div class="connect">
      {controller === 'k40' ? (
        <Button
          kind="filled"
          icon="machines"
          disabledReason={busy ?? usb}
          onClick={() => connect(() => openUsb(options()))}
        >
          Connect by USB
        </Button>
      ) : controller === 'ruida' ? null : (
        <Button
          kind={isPractice(profiles.current) ? 'outlined' : 'filled'}
          icon="machines"
          disabledReason={busy ?? serial}
          onClick={() => connect(() => openSerial(options()))}
        >
          Connect by cable
        </Button>
      )}
      {controller !== 'k40' && controller !== 'ruida' && serial === undefined ? (
        <Button
          size="small"
          kind="quiet"
          disabledReason={busy}
          onClick={() => connect(() => openSerial(options(), true))}
        >
          Choose another port
        </Button>
      ) : null}
      {bridgeMachines(session, controller).map(({ id, name, open }) => (
        <Button key={id} icon="machines" disabledReason={busy} onClick={() => connect(open)}>
          {name}
        </Button>
      ))}
      <Button icon="play" disabledReason={busy} onClick={() => void session.practise()}>
        Practise without a machine
      </Button>
      <p class="hint">
        {controller === 'ruida'
          ? 'Ruida lasers are reached over the network, through the worker program on your computer.'
          : 'The practice machine behaves like a real one and moves nothing.'}
      </p>
    </div>
  );
}
