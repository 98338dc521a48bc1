// SPDX-License-Identifier: GPL-3.0-or-later
// The one filled button: runs what is chosen, then hands its profile to the next print.
import { Button, formatBytes, formatDuration, Icon, Menu } from '../../ui';
import { download, safeFileName } from '../../shared/session/download';
import { outputOf } from '../../shared/session/full_solve';
import { machineProfile } from '../../shared/session/machine_profile';
import { readyWorker } from '../../shared/session/services';
import type { EvidenceSession } from './evidence_session';

const verbs = { diagnose: 'Diagnose', calibrate: 'Calibrate' } as const;
/** In a browser, this coarse is still telling and several times quicker. */
const coarseTriangles = 1000;

async function save(session: EvidenceSession, name: string, label: string, mediaType: string): Promise<void> {
  const bytes = await outputOf(session, name, label);
  if (bytes) download(bytes, `${safeFileName(session.title)}-${name}`, mediaType);
}

export function MainButton({ session }: { session: EvidenceSession }) {
  const mode = session.mode.value;
  const activity = session.activity.value;
  const result = session.result.value;
  if (activity.kind === 'solving')
    return (
      <>
        <Button kind="filled" size="big" disabledReason="This takes a while; Esc cancels">
          {mode === 'diagnose' ? 'Diagnosing' : 'Calibrating'}
        </Button>
        <p>
          {activity.name === 'native'
            ? 'Finished simulations are kept: if you stop, the next run continues from there'
            : 'Earlier results are kept. Esc cancels.'}
        </p>
      </>
    );
  const busy = activity.kind === 'idle' ? undefined : 'A file is being made or opened';
  if (result === null) {
    const none = session.subject.value === null ? 'Add a measured object first' : busy;
    return (
      <>
        <Button kind="filled" size="big" disabledReason={none} onClick={() => void session.solve()}>
          {verbs[mode]}
        </Button>
        <TimeLine session={session} />
      </>
    );
  }
  const { projects } = session.services;
  const used = session.profileUsed.value;
  const named = (session.diagnosis.value?.named.length ?? 0) > 0;
  const outputs = session.operation.value?.outputs ?? [];
  return (
    <>
      <div class="split">
        <Button
          kind="filled"
          size="big"
          icon={used ? 'check' : 'print'}
          disabledReason={used ? 'Thermoform in this project uses this machine profile already' : busy}
          onClick={() => void session.useProfile()}
        >
          {used ? 'Used in the next print' : 'Use in the next print'}
        </Button>
        <Menu
          label="Download the results, or stop using them"
          buttonClass="button filled big"
          align="right"
          items={[
            ...[...outputs]
              .sort((a, b) => Number(b.media_type === 'text/html') - Number(a.media_type === 'text/html'))
              .map(({ name, label, media_type }) => ({
                label: `Download ${label.toLowerCase()}`,
                hint: hintOf(name, result.outputs[name]?.bytes),
                disabledReason: busy,
                onSelect: () => void save(session, name, label, media_type),
              })),
            null,
            {
              label: 'Form without the machine profile',
              disabledReason: used ? undefined : 'No machine profile is in use',
              onSelect: () => projects.do(machineProfile.remove()),
            },
          ]}
        >
          <Icon name="chevronDown" small />
        </Menu>
      </div>
      <p>
        {used
          ? 'Thermoform now makes sheets, prints and moulds for this machine'
          : named
            ? 'Thermoform will allow for the material and the cause found'
            : 'Thermoform will use the calibrated material'}
      </p>
    </>
  );
}

const hintOf = (name: string, bytes: number | undefined): string =>
  [name.slice(name.lastIndexOf('.') + 1).toUpperCase(), bytes === undefined ? null : formatBytes(bytes)]
    .filter(Boolean)
    .join(', ');

function TimeLine({ session }: { session: EvidenceSession }) {
  const { browser_s, worker_s } = session.estimate.value;
  if (readyWorker(session.services) !== null)
    return (
      <p>
        {worker_s ? `About ${formatDuration(worker_s)} in the worker program` : 'Runs in the worker program'}
      </p>
    );
  const triangles = Number(session.value('triangles') ?? 0);
  return (
    <>
      <p>
        {browser_s
          ? `About ${formatDuration(browser_s)} in the browser; the worker program is quicker`
          : 'Runs in the browser'}
      </p>
      {triangles > coarseTriangles ? (
        <p>
          <button
            type="button"
            class="text-button"
            onClick={() => session.setParameters({ triangles: coarseTriangles }, 'Use fewer triangles')}
          >
            Use {coarseTriangles.toLocaleString('en')} triangles instead of {triangles.toLocaleString('en')}
          </button>
        </p>
      ) : null}
    </>
  );
}
