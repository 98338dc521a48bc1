// SPDX-License-Identifier: GPL-3.0-or-later
// A scan or photographs on the way to measured points: its picture with the four corner marks, and how it looks on the flat sheet.
import { useState } from 'preact/hooks';
import { Button, formatCount, formatNumber, withUnit } from '../../../ui';
import { figure, sentences } from '../../../shared/session/report';
import type { MeasuredScan, Place, Scan } from '../evidence_document';
import { evidence } from '../evidence_document';
import type { EvidenceSession } from '../evidence_session';
import { Pane } from '../pictures/maps';
import { PhotographsPanel } from './photographs_panel';
import { usePicture } from './use_picture';
import {
  cornerNames,
  cornersToMove,
  isOfPhotographs,
  lacking,
  measuredNow,
  moved,
  pictureOf,
  seenCorners,
} from './measure_scan';

export interface ScanPanelProps {
  readonly session: EvidenceSession;
  readonly scan: Scan;
  readonly onChooseFile: () => void;
}

export function ScanPanel({ session, scan, onChooseFile }: ScanPanelProps) {
  const missing = lacking(session, scan);
  const measured = measuredNow(scan);
  if (isOfPhotographs(scan))
    return <PhotographsPanel session={session} scan={scan} onChooseFile={onChooseFile} />;
  return (
    <div class="bench">
      <div class="scan-panes">
        <Pane title="Scan" detail={scan.files.find(({ input }) => input === 'scan')?.file_name ?? ''}>
          {missing.length > 0 ? (
            <div class="scan-missing">
              <p>Still missing: {missing.join(' and ')}.</p>
              <Button icon="upload" onClick={onChooseFile}>
                Choose files
              </Button>
            </div>
          ) : (
            <Corners session={session} scan={scan} />
          )}
        </Pane>
        <Pane title="On the flat sheet" detail={measured ? likenessOf(measured) : ''}>
          {measured ? (
            <Aligned session={session} measured={measured} />
          ) : (
            <p class="later">
              The scan mapped back to the flat sheet: it should look like the printed pattern.
            </p>
          )}
        </Pane>
      </div>
    </div>
  );
}

function Corners({ session, scan }: { session: EvidenceSession; scan: Scan }) {
  const [size, setSize] = useState<Place | null>(null);
  const url = usePicture(() => pictureOf(session, scan), scan.files.map(({ file }) => file.blob).join());
  const { projects } = session.services;
  const measured = measuredNow(scan);
  const found = measured && scan.corners === null ? seenCorners(measured) : [];
  const found_count = found.filter((place) => place !== null).length;
  const set = (corners: readonly Place[] | null, label: string) => {
    projects.do(evidence.changeScan({ corners }, label));
    projects.commit();
  };
  if (url === null)
    return (
      <p class="later">
        The scan has no picture that can be shown here. The corner marks are searched for when the scan is
        measured.
      </p>
    );
  return (
    <>
      <div class="scan-picture">
        <img
          src={url}
          alt="The scan’s picture"
          onLoad={({ currentTarget: { naturalWidth, naturalHeight } }) =>
            setSize([naturalWidth, naturalHeight])
          }
        />
        {scan.corners && size
          ? scan.corners.map((place, i) => (
              <Handle
                key={cornerNames[i]}
                session={session}
                corners={scan.corners ?? []}
                which={i}
                place={place}
                size={size}
              />
            ))
          : null}
        {size
          ? found.map((place, i) =>
              place ? (
                <span
                  key={cornerNames[i]}
                  class="corner found"
                  role="img"
                  aria-label={`Corner ${cornerNames[i] ?? ''}, found at ${Math.round(place[0])}, ${Math.round(place[1])} px`}
                  style={shownAt(place, size)}
                >
                  <span aria-hidden="true">{cornerNames[i]}</span>
                </span>
              ) : null,
            )
          : null}
      </div>
      <div class="row scan-tools">
        {scan.corners ? (
          <>
            <p class="grow">Move each corner onto its ring mark: drag it, or use the arrow keys.</p>
            <Button size="small" onClick={() => set(null, 'Find the corners')}>
              Search for the corners instead
            </Button>
          </>
        ) : (
          <>
            <p class="grow">
              {measured
                ? `${found_count} of 4 corner marks found. If one is not on its ring mark, move it.`
                : 'The four corner marks are searched for when the scan is measured.'}
            </p>
            <Button
              size="small"
              disabledReason={size ? undefined : 'The picture is being read'}
              onClick={() => size && set(cornersToMove(found, size), 'Set the corners by hand')}
            >
              Set the corners by hand
            </Button>
          </>
        )}
      </div>
    </>
  );
}

const shownAt = ([x, y]: Place, [width, height]: Place) => ({
  left: `${(100 * x) / width}%`,
  top: `${(100 * y) / height}%`,
});

interface HandleProps {
  readonly session: EvidenceSession;
  readonly corners: readonly Place[];
  readonly which: number;
  readonly place: Place;
  readonly size: Place;
}

/** Dragging is one step to undo; arrow keys go by a pixel of the picture, with Shift by ten. */
function Handle({ session, corners, which, place: [x, y], size }: HandleProps) {
  const { projects } = session.services;
  const name = cornerNames[which] ?? '';
  const move = (by: Place) =>
    projects.do(
      evidence.changeScan(
        { corners: moved(corners, which, by, size) },
        `Move the ${name} corner`,
        `corner ${which}`,
      ),
    );
  const drag = (event: PointerEvent) => {
    const handle = event.currentTarget as HTMLElement;
    if (!handle.hasPointerCapture(event.pointerId)) return;
    const box = handle.parentElement?.getBoundingClientRect();
    if (!box) return;
    const [to_x, to_y] = [
      ((event.clientX - box.left) / box.width) * size[0],
      ((event.clientY - box.top) / box.height) * size[1],
    ];
    move([to_x - x, to_y - y]);
  };
  const key = (event: KeyboardEvent) => {
    const step = event.shiftKey ? 10 : 1;
    const by: Place | undefined = (
      { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] } as const
    )[event.key as 'ArrowLeft'];
    if (by === undefined) return;
    event.preventDefault();
    move(by);
  };
  return (
    <button
      type="button"
      class="corner"
      style={shownAt([x, y], size)}
      aria-label={`Corner ${name}, at ${Math.round(x)}, ${Math.round(y)} px`}
      onPointerDown={(event) => event.currentTarget.setPointerCapture(event.pointerId)}
      onPointerMove={drag}
      onPointerUp={() => projects.commit()}
      onKeyDown={key}
      onKeyUp={() => projects.commit()}
    >
      <span aria-hidden="true">{name}</span>
    </button>
  );
}

const likenessOf = ({ report }: MeasuredScan): string => {
  const likeness = figure(report, 'likeness');
  return likeness === null ? '' : `similarity ${formatNumber(likeness, 3)} (1 is perfect)`;
};

function Aligned({ session, measured }: { session: EvidenceSession; measured: MeasuredScan }) {
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
        {url ? <img src={url} alt="The scan mapped back to the flat sheet" /> : null}
      </div>
      <p class="scan-figures">
        {formatCount(figure(report, 'points') ?? 0)} points
        {sigma === null ? '' : `, each to about ${withUnit(formatNumber(sigma, 2), 'mm')}`}
        {report['coordinates'] === 'scan'
          ? ', in the scanner’s coordinates, because the sheet’s rim was not scanned'
          : ''}
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
