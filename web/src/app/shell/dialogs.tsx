// SPDX-License-Identifier: GPL-3.0-or-later
import type { Services } from '../../shared/session/services';
import { Dialog, formatBytes, formatCount } from '../../ui';

const keys: readonly (readonly [keys: readonly string[], meaning: string])[] = [
  [['1', '–', '5'], 'Go to a room'],
  [['0'], 'Look from the relief’s viewpoint'],
  [['F'], 'Fit the model into the picture'],
  [['S'], 'Swipe between model and result'],
  [['Space'], 'Play the animation of forming'],
  [['P'], 'Find a setting'],
  [['Ctrl', 'Enter'], 'Solve at full detail'],
  [['Ctrl', 'E'], 'Export'],
  [['Ctrl', 'O'], 'Open a file'],
  [['Ctrl', 'Z'], 'Undo'],
  [['Ctrl', 'Shift', 'Z'], 'Redo'],
  [['Esc'], 'Cancel, or pause the machine'],
  [['Ctrl', '.'], 'Stop the machine'],
  [['Esc', 'Esc'], 'Stop the machine (second key)'],
  [['?'], 'All keys'],
];
const viewKeys: typeof keys = [
  [['←', '→', '↑', '↓'], 'Turn the model'],
  [['+', '−'], 'Zoom'],
];
const sheetKeys: typeof keys = [
  [['+', '−'], 'Zoom'],
  [['0'], 'Fit'],
  [['←', '→', '↑', '↓'], 'Move'],
  [['Page Up', 'Page Down'], 'Previous or next sheet'],
  [['Home'], 'All sheets'],
];
const fieldKeys: typeof keys = [
  [['↑', '↓'], 'Change the value by 1 % of its range'],
  [['Shift', '↑'], 'Change the value by 10 % of its range'],
  [['Enter'], 'Accept the number'],
];

function KeyList({ list }: { list: typeof keys }) {
  return (
    <dl class="key-list">
      {list.map(([combination, meaning]) => (
        <div key={meaning}>
          <dt>{combination.map((key) => (key === '–' ? ' – ' : <kbd key={key}>{key}</kbd>))}</dt>
          <dd>{meaning}</dd>
        </div>
      ))}
    </dl>
  );
}

export function KeysDialog({ onClose }: { onClose: () => void }) {
  return (
    <Dialog title="All keys" onClose={onClose} wide>
      <div class="key-columns">
        <div>
          <KeyList list={keys} />
        </div>
        <div>
          <h3>In the 3D view</h3>
          <KeyList list={viewKeys} />
          <h3>In the sheets to cut</h3>
          <KeyList list={sheetKeys} />
          <h3>In a parameter</h3>
          <KeyList list={fieldKeys} />
        </div>
      </div>
    </Dialog>
  );
}

export function WorkerDialog({ services, onClose }: { services: Services; onClose: () => void }) {
  const connection = services.connection.value;
  return (
    <Dialog title="Where models are solved" onClose={onClose}>
      {connection?.state === 'ready' ? (
        <>
          <p>Previews run in this page, work at full detail in the worker program on this machine.</p>
          <dl class="figures">
            <dt>Version</dt>
            <dd>{connection.status.version}</dd>
            <dt>Cores</dt>
            <dd>{connection.status.cores}</dd>
            <dt>Memory</dt>
            <dd>{formatBytes(connection.status.memory_mb * 1e6)}</dd>
            <dt>Largest model</dt>
            <dd>{formatCount(connection.status.triangle_limit)} triangles</dd>
          </dl>
        </>
      ) : connection?.state === 'refused' ? (
        <p>{connection.message}</p>
      ) : connection ? (
        <p>
          The connection to the worker program was lost; this page keeps trying to connect. A job sent to the
          worker continues there, and its result is fetched once it is connected again. Until then everything
          runs in this page.
        </p>
      ) : (
        <>
          <p>
            Everything runs in this page. The worker program on your own computer does the same several times
            faster, and reaches printers and network machines.
          </p>
          <p>To start it, run this in a copy of Formwright’s source:</p>
          <pre class="command">make run</pre>
          <p>and open the address it prints. The worker listens to this machine only.</p>
        </>
      )}
    </Dialog>
  );
}
