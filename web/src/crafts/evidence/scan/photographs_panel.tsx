// SPDX-License-Identifier: GPL-3.0-or-later
// Photographs of a printed sheet, and which of its marks they show.
import { Button, formatCount, formatNumber, withUnit } from '../../../ui';
import { figure, sentences } from '../../../shared/session/report';
import type { MeasuredScan, Scan } from '../evidence_document';
import type { EvidenceSession } from '../evidence_session';
import { Pane } from '../pictures/maps';
import { lacking, measuredNow } from './measure_scan';
import { usePicture } from './use_picture';

export interface PhotographsPanelProps {
  readonly session: EvidenceSession;
  readonly scan: Scan;
  readonly onChooseFile: () => void;
}

export function PhotographsPanel({ session, scan, onChooseFile }: PhotographsPanelProps) {
  const missing = lacking(session, scan);
  const measured = measuredNow(scan);
  const photographs = scan.files.filter(({ input }) => input !== 'pattern');
  return (
    <div class="bench">
      <div class="scan-panes">
        <Pane title="Photographs" detail={formatCount(photographs.length)}>
          {missing.length > 0 ? <p>Still missing: {missing.join(' and ')}.</p> : null}
          <div class="photographs">
            {photographs.map((photograph) => (
              <Photograph key={photograph.input} session={session} photograph={photograph} />
            ))}
          </div>
          <Button icon="upload" onClick={onChooseFile}>
            Add files
          </Button>
        </Pane>
        <Pane title="What was seen" detail={measured ? seenOf(measured) : ''}>
          {measured ? (
            <Seen session={session} measured={measured} />
          ) : (
            <p class="later">
              The flat sheet with every mark that could be measured, and those that could not.
            </p>
          )}
        </Pane>
      </div>
    </div>
  );
}

interface PhotographProps {
  readonly session: EvidenceSession;
  readonly photograph: Scan['files'][number];
}

function Photograph({ session, photograph: { file_name, file } }: PhotographProps) {
  const url = usePicture(async () => {
    const bytes = await session.services.projects.blobs.read(file.blob);
    return new Blob([bytes], { type: file.media_type });
  }, file.blob);
  return url ? <img src={url} alt={file_name} title={file_name} /> : null;
}

const seenOf = ({ report }: MeasuredScan): string =>
  `${formatCount(figure(report, 'marks_measured') ?? 0)} of ${formatCount(figure(report, 'marks') ?? 0)} marks`;

function Seen({ session, measured }: { session: EvidenceSession; measured: MeasuredScan }) {
  const { report, aligned } = measured;
  const url = usePicture(async () => {
    const bytes = await session.services.projects.blobs.read(aligned.blob);
    return new Blob([bytes], { type: aligned.media_type });
  }, aligned.blob);
  const sigma = figure(report, 'sigma_median_mm');
  const notes = sentences(report, 'notes');
  return (
    <>
      <div class="scan-picture">
        {url ? (
          <img
            src={url}
            alt="The flat sheet. Full squares: marks that were measured. Frames: marks that were not"
          />
        ) : null}
      </div>
      <p class="scan-figures">
        {formatCount(figure(report, 'points') ?? 0)} points
        {sigma === null ? '' : `, each to about ${withUnit(formatNumber(sigma, 2), 'mm')}`}. Full squares were
        measured, frames were not.
      </p>
      {notes.length > 0 ? (
        <ul class="plain-list">
          {notes.map((note) => (
            <li key={note}>{note}</li>
          ))}
        </ul>
      ) : null}
    </>
  );
}
