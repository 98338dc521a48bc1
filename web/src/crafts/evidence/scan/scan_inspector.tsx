// SPDX-License-Identifier: GPL-3.0-or-later
// A scan's files, how it is measured, and where its points go.
import type { Json } from '../../../jobs/contract';
import { Button, formatBytes } from '../../../ui';
import { withoutDefaults } from '../../../shared/session/craft_document';
import { ParameterPanel } from '../../../shared/panels/parameters/parameter_panel';
import type { Scan } from '../evidence_document';
import { evidence, registering } from '../evidence_document';
import type { EvidenceSession } from '../evidence_session';
import { lacking, measuredNow, measureScan, takePoints } from './measure_scan';

const openGroups = ['Points', 'Scan'];

export function ScanInspector({ session, scan }: { session: EvidenceSession; scan: Scan }) {
  const operation = session.operationNamed(registering);
  const { projects } = session.services;
  const measured = measuredNow(scan);
  const missing = lacking(session, scan);
  const busy = session.activity.value.kind !== 'idle';
  const reason = busy
    ? 'The scan is being measured; Esc cancels'
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
        <section class="section" aria-label="From a scan">
          <h3>From a scan</h3>
          <ul class="scan-files">
            {scan.files.map(({ input, file_name, file }) => (
              <li key={input}>
                <span class="clip grow">{file_name}</span>
                <small>{formatBytes(file.bytes)}</small>
              </li>
            ))}
          </ul>
          <Button size="small" onClick={() => projects.do(evidence.setScan(null, 'Remove the scan'))}>
            Remove the scan
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
              Measure the scan
            </Button>
            <p>
              {missing.length > 0
                ? 'Needs the scan and the pattern.json of its print'
                : 'Takes a few seconds'}
            </p>
          </>
        )}
      </div>
    </>
  );
}
