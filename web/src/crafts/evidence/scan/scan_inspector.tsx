// SPDX-License-Identifier: GPL-3.0-or-later
// A scan's files, how it is measured, and where its points go.
import type { Json } from '../../../jobs/contract';
import { Button, formatBytes } from '../../../ui';
import { withoutDefaults } from '../../../shared/session/craft_document';
import { ParameterPanel } from '../../../shared/panels/parameters/parameter_panel';
import type { Scan } from '../evidence_document';
import { evidence } from '../evidence_document';
import type { EvidenceSession } from '../evidence_session';
import {
  isOfPhotographs,
  lacking,
  measuredNow,
  measureScan,
  measuringOf,
  takePoints,
  wordOf,
} from './measure_scan';

const openGroups = ['Points', 'Scan', 'Board'];

export function ScanInspector({ session, scan }: { session: EvidenceSession; scan: Scan }) {
  const operation = session.operationNamed(measuringOf(scan));
  const { projects } = session.services;
  const measured = measuredNow(scan);
  const word = wordOf(scan);
  const missing = lacking(session, scan);
  const busy = session.activity.value.kind !== 'idle';
  const reason = busy
    ? `The ${word} ${isOfPhotographs(scan) ? 'are' : 'is'} being measured; Esc cancels`
    : missing.length > 0
      ? `Still missing: ${missing.join(' and ')}`
      : undefined;
  const set = (name: string, value: Json) => {
    if (operation === undefined) return;
    const title = operation.parameters.properties[name]?.title ?? name;
    const parameters = withoutDefaults(operation, { ...scan.parameters, [name]: value });
    projects.do(evidence.changeScan({ parameters }, `Change ${title.toLowerCase()}`, name));
  };
  return (
    <>
      <div class="inspector-scroll" tabIndex={-1}>
        <section class="section" aria-label={isOfPhotographs(scan) ? 'From photographs' : 'From a scan'}>
          <h3>{isOfPhotographs(scan) ? 'From photographs' : 'From a scan'}</h3>
          <ul class="scan-files">
            {scan.files.map(({ input, file_name, file }) => (
              <li key={input}>
                <span class="clip grow">{file_name}</span>
                <small>{formatBytes(file.bytes)}</small>
              </li>
            ))}
          </ul>
          <Button size="small" onClick={() => projects.do(evidence.setScan(null, `Remove the ${word}`))}>
            Remove the {word}
          </Button>
        </section>
        {operation ? (
          <ParameterPanel
            operation={operation}
            parameters={scan.parameters}
            errors={session.fieldErrors.value}
            onPreview={set}
            onCommit={() => projects.commit()}
            openGroups={openGroups}
          />
        ) : null}
      </div>
      <div class="inspector-foot">
        {measured ? (
          <>
            <Button
              kind="filled"
              size="big"
              disabledReason={reason}
              onClick={() => void takePoints(session, scan, measured)}
            >
              Use these points
            </Button>
            <p>After this, add the object’s mould.obj and setup.json</p>
          </>
        ) : (
          <>
            <Button
              kind="filled"
              size="big"
              disabledReason={reason}
              onClick={() => void measureScan(session, scan)}
            >
              Measure the {word}
            </Button>
            <p>
              {missing.length > 0
                ? `Needs the ${word} and the pattern.json of the print`
                : isOfPhotographs(scan)
                  ? 'Takes a few seconds for each photograph'
                  : 'Takes a few seconds'}
            </p>
          </>
        )}
      </div>
    </>
  );
}
