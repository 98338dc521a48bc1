// SPDX-License-Identifier: GPL-3.0-or-later
// Printers and print servers that the worker reaches.
import { found } from './bridge_machines';
import type { MachinesSession } from './machines_session';

const kindWords = {
  printer: 'printer',
  octoprint: 'OctoPrint',
  moonraker: 'Moonraker',
  slicer: 'slicer',
  serial: 'cable',
  tcp: 'network',
  ruida: 'Ruida',
} as const;

export function OtherMachines({ session }: { readonly session: MachinesSession }) {
  const worker = session.services.connection.value?.state === 'ready';
  const others = found.value.filter(({ kind }) => kind !== 'serial' && kind !== 'tcp' && kind !== 'ruida');
  return (
    <section class="section" aria-label="Other machines">
      <h3>Other machines</h3>
      {others.length === 0 ? (
        <p class="hint">
          {worker
            ? 'None found. Printers of this computer appear by themselves; others are added with “formwright machine add”.'
            : 'Printers and network machines need the native worker: run “make run” and open the address it prints.'}
        </p>
      ) : (
        <ul class="other-machines">
          {others.map(({ id, name, kind, state }) => (
            <li key={id}>
              <i class={state === 'off' || state === 'stopped' ? 'dot off' : 'dot'} />
              <span class="clip">
                {name}, {kindWords[kind]}
              </span>
              <span>{state}</span>
            </li>
          ))}
        </ul>
      )}
    </section>
  );
}
