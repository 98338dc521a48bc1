// SPDX-License-Identifier: GPL-3.0-or-later
import { EmptyRoom } from '../../shared/panels/empty_room';
import { Button, formatCount, formatNumber, Segmented, Sheet, useLasting, withUnit } from '../../ui';
import { outputOf } from '../../shared/session/full_solve';
import { useRoomKeys } from '../../shared/session/room_keys';
import { download, safeFileName } from '../../shared/session/download';
import '../../shared/panels/room.css';
import { CalibrationPanel } from './calibration_panel';
import { Distances, Gains } from './pictures/charts';
import './evidence.css';
import { inventing } from './evidence_document';
import type { EvidenceSession, Look } from './evidence_session';
import { Inspector } from './inspector';
import { Maps, modelWords, Pane } from './pictures/maps';
import { Notes } from './notes';
import { ObjectView } from './pictures/object_view';
import { PrintMaps } from './pictures/print_maps';
import { minPrintPoints } from './pictures/print_picture';
import { simulatedIn } from './pictures/residuals';
import { ResultsStrip } from './results_strip';
import { ScanInspector } from './scan/scan_inspector';
import { ScanPanel } from './scan/scan_panel';
import { begin } from './by_hand/plan_marks';
import { HandInspector } from './by_hand/hand_inspector';
import { HandPanel } from './by_hand/hand_panel';
import { PatternButton } from './pattern_dialog';
import type { Diagnosis } from '../../shared/diagnosis/diagnosis';
import { view } from './view_choice';
import { VirtualObject } from './objects/virtual_object';

export interface EvidencePageProps {
  readonly session: EvidenceSession;
  readonly onChooseFile: () => void;
}

/** Why there is no picture of the next print; undefined where there is one. */
function noPrint({ residuals }: Look, diagnosis: Diagnosis | null): string | undefined {
  if (diagnosis === null || diagnosis.named.length === 0 || residuals.extended === null)
    return 'A diagnosis that names a cause shows how the next print changes';
  return residuals.count < minPrintPoints
    ? `Fewer than ${minPrintPoints} points make no picture of a print`
    : undefined;
}

export function EvidencePage({ session, onChooseFile }: EvidencePageProps) {
  useRoomKeys(session, () => ({
    solve: () => {
      if (session.activity.value.kind === 'idle') void session.solve();
    },
    save: () => {
      if (session.diagnosis.value) void saveReport(session);
    },
  }));
  const { objects, scan, byHand } = session.document.value;
  const opening = session.activity.value.kind === 'opening';
  const notes = <Notes session={session} onChooseFile={onChooseFile} />;
  return (
    <>
      <main class="view evidence" aria-label="Evidence">
        <h1 class="hidden-text">Evidence</h1>
        {scan ? (
          <ScanPanel session={session} scan={scan} onChooseFile={onChooseFile} />
        ) : byHand ? (
          <HandPanel session={session} byHand={byHand} />
        ) : objects.length === 0 ? (
          opening ? null : (
            <Empty session={session} onChooseFile={onChooseFile} />
          )
        ) : (
          <Bench session={session} />
        )}
        {notes}
      </main>
      {session.hasWork.value ? (
        <Sheet label="Objects and causes">
          {scan ? (
            <ScanInspector session={session} scan={scan} />
          ) : byHand ? (
            <HandInspector session={session} byHand={byHand} />
          ) : (
            <Inspector session={session} onChooseFile={onChooseFile} />
          )}
        </Sheet>
      ) : null}
      {session.hasWork.value || opening ? (
        <footer class="strip">
          <ResultsStrip session={session} />
        </footer>
      ) : null}
    </>
  );
}

function Empty({ session, onChooseFile }: EvidencePageProps) {
  const invention = session.operationNamed(inventing);
  return (
    <EmptyRoom
      what="Find out why a formed part came out wrong, and what to change in the next print."
      below={
        <>
          <h2>What you need</h2>
          <ul class="needs">
            <li>
              <strong>The model you formed over.</strong> A file named mould.obj.
            </li>
            <li>
              <strong>The machine’s settings.</strong> A file named setup.json: sheet, clamp opening and
              vacuum.
            </li>
            <li>
              <strong>Measured points of the formed sheet.</strong> A table named measured.csv. A photographed
              scan of a printed sheet with its pattern.json does as well: its points are measured first. So do
              several photographs of a sheet printed with coded marks. Ten marks measured with calipers will
              do, too.
            </li>
          </ul>
          <p class="aside">Drop the three files together, their folder, or a zip of it.</p>
        </>
      }
    >
      <Button kind="filled" icon="upload" onClick={onChooseFile}>
        Open a measured object
      </Button>
      <Button onClick={() => begin(session)}>Measure with calipers</Button>
      {invention ? <VirtualObject session={session} operation={invention} /> : null}
      <PatternButton session={session} />
    </EmptyRoom>
  );
}

/** Measured beside simulated, and what is known of the difference. */
function Bench({ session }: { session: EvidenceSession }) {
  const look = session.look.value;
  const waiting = useLasting(look === null && session.looking.value);
  const diagnosis = session.diagnosis.value;
  const calibrated = session.mode.value === 'calibrate' ? session.result.value : null;
  const without = look ? noPrint(look, diagnosis) : 'Nothing is compared yet';
  const shown = view.value === 'print' && without ? 'plane' : view.value;
  return (
    <div class="bench">
      <div class="bench-head">
        <Segmented
          label="View"
          options={[
            { value: 'plane', label: 'Flat maps' },
            { value: 'object', label: 'On the object' },
            { value: 'print', label: 'Next print', disabledReason: without },
          ]}
          value={shown}
          onChange={(value) => (view.value = value)}
        />
        {look ? <ReadOut session={session} look={look} /> : null}
      </div>
      {look === null ? (
        <p class="waiting" role="status">
          {waiting ? 'Simulating with the machine settings as they are…' : ''}
        </p>
      ) : shown === 'plane' ? (
        <Maps session={session} look={look} />
      ) : shown === 'print' ? (
        <PrintMaps session={session} look={look} />
      ) : (
        <ObjectView session={session} look={look} />
      )}
      {calibrated ? (
        <CalibrationPanel session={session} result={calibrated} />
      ) : look ? (
        <div class="charts">
          <Distances session={session} look={look} />
          {diagnosis ? (
            <Gains diagnosis={diagnosis} />
          ) : (
            <Pane title="Error on points left out of the fit" detail="">
              <p class="later">
                {session.mode.value === 'diagnose'
                  ? 'A diagnosis leaves parts of the sheet out of the fit and then predicts them. How well it does is shown here afterwards.'
                  : 'Only a diagnosis fills this chart. A calibration fits the sheet’s material and reports how certain each parameter is.'}
              </p>
            </Pane>
          )}
        </div>
      ) : null}
    </div>
  );
}

/** The marked point in figures. */
function ReadOut({ session, look }: { session: EvidenceSession; look: Look }) {
  const point = session.hovered.value;
  const { residuals } = look;
  if (point === null || point >= residuals.count)
    return (
      <p class="read-out" aria-live="polite">
        {formatCount(residuals.count)} points
      </p>
    );
  const simulated = simulatedIn(residuals, session.model.value);
  const at = (values: Float64Array, k: number) => values[3 * point + k] ?? 0;
  const distance = Math.hypot(...[0, 1, 2].map((k) => at(simulated, k) - at(residuals.measured, k)));
  const length = (value: number, digits = 3) => withUnit(formatNumber(value, digits), 'mm');
  const [x, y] = [residuals.sheet[2 * point] ?? 0, residuals.sheet[2 * point + 1] ?? 0];
  return (
    <p class="read-out" aria-live="polite">
      At {formatNumber(x)}, {length(y)}: measured {length(at(residuals.measured, 2))} high,{' '}
      {modelWords(look, session.model.value)} {length(at(simulated, 2))};{' '}
      <strong>{length(distance, 2)} apart</strong>
    </p>
  );
}

async function saveReport(session: EvidenceSession): Promise<void> {
  const bytes = await outputOf(session, 'diagnosis.html', 'report');
  if (bytes) download(bytes, `${safeFileName(session.title)}-diagnosis.html`, 'text/html');
}
