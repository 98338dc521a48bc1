// SPDX-License-Identifier: GPL-3.0-or-later
// The next print, before and after: a regular pattern as both simulations would have it printed, and how far features move.
import { useEffect, useMemo, useRef } from 'preact/hooks';
import { formatNumber, withUnit } from '../../../ui';
import type { ColourMapping } from '../../../view';
import type { EvidenceSession, Look } from '../evidence_session';
import type { Frame } from './frame';
import { frameOf } from './frame';
import { Pane, SheetMap } from './maps';
import type { Pattern } from './print_picture';
import { enlargementOf, patternOf, printOf } from './print_picture';
import type { Residuals } from './residuals';
import { extentOf, movedBy, movesOf, niceUp, percentile } from './residuals';
import { triangulate } from './sheet_surface';

/** Twice the pixels of a map: lines of the pattern are thin. */
const widthPx = 600;

export function PrintMaps({ session, look }: { session: EvidenceSession; look: Look }) {
  const { residuals } = look;
  const triangles = useMemo(() => triangulate(residuals), [residuals]);
  const fine = useMemo(() => frameOf(extentOf(residuals), widthPx), [residuals]);
  const frame = useMemo(() => frameOf(extentOf(residuals)), [residuals]);
  const pattern = useMemo(() => patternOf(residuals), [residuals]);
  const enlarged = useMemo(() => enlargementOf(residuals), [residuals]);
  const moves = useMemo(() => movesOf(residuals), [residuals]);
  const moved = useMemo(() => movedBy(residuals), [residuals]);
  const mapping: ColourMapping = {
    attribute: 'moved_mm',
    map: 'error',
    minimum: 0,
    maximum: niceUp(Math.max(percentile(moves, 0.98), 1e-3)),
    unit: 'mm',
    label: 'Shift of the print’s features',
  };
  const shared = { residuals, triangles, frame: fine, pattern };
  const length = (value: number) => withUnit(formatNumber(value, 2), 'mm');
  return (
    <>
      <div class="maps">
        <Pane title="Print as it is" detail="material calibrated">
          <Print {...shared} shift={0} spoken="as the calibrated simulation has it printed" />
        </Pane>
        <Pane title="Print for this machine" detail={enlarged > 1 ? `shift × ${enlarged}` : 'with the cause'}>
          <Print
            {...shared}
            shift={enlarged}
            spoken={`as the simulation with the cause has it printed${enlarged > 1 ? `, shift × ${enlarged}` : ''}`}
          />
        </Pane>
        <Pane title="Shift" detail={moved ? `${length(moved.mean_mm)} on average` : ''}>
          <SheetMap
            session={session}
            residuals={residuals}
            frame={frame}
            triangles={triangles}
            opening_mm={look.opening_mm}
            focusable
            values={moves}
            mapping={mapping}
            spoken={moved ? `${length(moved.mean_mm)} on average, up to ${length(moved.largest_mm)}.` : ''}
          />
        </Pane>
      </div>
      <p class="print-words">
        A test pattern on the flat sheet. On the formed object its bands are {length(pattern.band_mm)} high
        and its squares {length(pattern.square_mm)} wide, if the simulation is right. The print for this
        machine makes up for the cause.
        {enlarged > 1 ? ` What that changes is drawn ${enlarged} times as large as it is.` : ''}
      </p>
    </>
  );
}

interface PrintProps {
  readonly residuals: Residuals;
  readonly shift: number;
  readonly spoken: string;
  readonly triangles: Uint32Array;
  readonly frame: Frame;
  readonly pattern: Pattern;
}

function Print({ residuals, shift, spoken, triangles, frame, pattern }: PrintProps) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    const context = canvas.current?.getContext('2d');
    if (!context) return;
    const pixels = printOf(residuals, shift, triangles, frame, pattern);
    context.putImageData(new ImageData(pixels, frame.widthPx, frame.heightPx), 0, 0);
  }, [residuals, shift, triangles, frame, pattern]);
  return (
    <div class="sheet-map still" style={{ aspectRatio: `${frame.widthPx} / ${frame.heightPx}` }}>
      <canvas
        ref={canvas}
        width={frame.widthPx}
        height={frame.heightPx}
        role="img"
        aria-label={`Test pattern on the flat sheet, ${spoken}`}
      />
    </div>
  );
}
