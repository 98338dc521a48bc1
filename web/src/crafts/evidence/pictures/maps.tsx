// SPDX-License-Identifier: GPL-3.0-or-later
// Measured, simulated and their difference over the flat sheet, side by side; the same point is marked in all three.
import type { ComponentChildren } from 'preact';
import { useEffect, useMemo, useRef } from 'preact/hooks';
import { formatNumber, withUnit } from '../../../ui';
import type { ColourMapName, ColourMapping } from '../../../view';
import { legendFor, sampleStops, stopsOf } from '../../../view';
import type { EvidenceSession, Look } from '../evidence_session';
import type { Arrow, Residuals } from './residuals';
import {
  arrowsOf,
  cellSide,
  distancesOf,
  extentOf,
  heightDifferenceOf,
  heightsOf,
  meanOf,
  nearestTo,
  neighbourOf,
  niceUp,
  percentile,
  scaleFor,
  simulatedIn,
} from './residuals';
import type { Frame } from './frame';
import { frameOf, placeOn } from './frame';
import { rasterise, triangulate } from './sheet_surface';

const arrowCells = 9;

/** What stays the same while the model is switched, so that the two can be compared by eye. */
function scalesOf(residuals: Residuals, sigma_mm: number) {
  const heights = heightsOf(residuals.measured);
  // Outliers do not set the scale: most of a sheet lies low, few points high.
  const [low, high] = [percentile(heights, 0.02), percentile(heights, 0.995)];
  const differences = heightDifferenceOf(residuals, 'base').map(Math.abs);
  const most = niceUp(Math.max(3 * sigma_mm, percentile(differences, 0.95), 1e-3));
  const arrows = arrowsOf(residuals, 'base', arrowCells);
  const lengths = Float64Array.from(arrows, ({ dx, dy }) => Math.hypot(dx, dy));
  return {
    height: { low: Math.floor(low), high: Math.max(Math.ceil(high), Math.floor(low) + 1) },
    most,
    arrowScale: scaleFor(lengths, 0.9 * cellSide(residuals, arrowCells)),
  };
}

export function Maps({ session, look }: { session: EvidenceSession; look: Look }) {
  const { residuals, sigma_mm } = look;
  const model = session.model.value;
  const frame = useMemo(() => frameOf(extentOf(residuals)), [residuals]);
  const triangles = useMemo(() => triangulate(residuals), [residuals]);
  const scales = useMemo(() => scalesOf(residuals, sigma_mm), [residuals, sigma_mm]);
  const arrows = useMemo(() => arrowsOf(residuals, model, arrowCells), [residuals, model]);
  const values = useMemo(
    () => ({
      measured: heightsOf(residuals.measured),
      simulated: heightsOf(simulatedIn(residuals, model)),
      difference: heightDifferenceOf(residuals, model),
      mean: meanOf(distancesOf(residuals, model)),
    }),
    [residuals, model],
  );
  const height = (label: string): ColourMapping => ({
    attribute: 'height',
    map: 'thickness',
    minimum: scales.height.low,
    maximum: scales.height.high,
    unit: 'mm',
    label,
  });
  const difference: ColourMapping = {
    attribute: 'difference',
    map: 'signed',
    minimum: -scales.most,
    maximum: scales.most,
    unit: 'mm',
    label: 'Height, simulated minus measured',
  };
  const shared = { session, residuals, frame, triangles, opening_mm: look.opening_mm };
  const which = modelWords(look, model);
  return (
    <div class="maps">
      <Pane title="Measured" detail={session.chosen.value?.name ?? ''}>
        <SheetMap {...shared} values={values.measured} mapping={height('Measured height')} />
      </Pane>
      <Pane title="Simulated" detail={which}>
        <SheetMap {...shared} values={values.simulated} mapping={height('Simulated height')} />
      </Pane>
      <Pane title="Difference" detail={`sideways: arrows × ${scales.arrowScale}`}>
        <SheetMap
          {...shared}
          focusable
          values={values.difference}
          mapping={difference}
          arrows={arrows}
          arrowScale={scales.arrowScale}
          noise_mm={sigma_mm}
          onPainted={(canvas) => keepPicture(session, look, canvas)}
          spoken={`Mean distance ${withUnit(formatNumber(values.mean, 2), 'mm')}, ${which}.`}
        />
      </Pane>
    </div>
  );
}

/** The difference is the picture of its result in the strip. */
function keepPicture(session: EvidenceSession, look: Look, canvas: HTMLCanvasElement): void {
  const result = session.result.peek();
  if (result === null || result.id !== look.result || result.picture) return;
  canvas.toBlob((picture) => {
    if (picture) void session.keepPicture(result.id, picture);
  });
}

export const modelWords = (look: Look, model: 'base' | 'extended'): string =>
  look.kind === 'quick'
    ? 'current settings'
    : model === 'extended'
      ? 'with the cause'
      : 'material calibrated';

export function Pane(props: { title: string; detail: string; children: ComponentChildren }) {
  return (
    <section class="pane" aria-label={props.title}>
      <h2>
        {props.title}
        <span class="clip">{props.detail}</span>
      </h2>
      {props.children}
    </section>
  );
}

interface SheetMapProps {
  readonly session: EvidenceSession;
  readonly residuals: Residuals;
  readonly frame: Frame;
  readonly triangles: Uint32Array;
  readonly opening_mm: readonly [number, number] | null;
  readonly values: Float64Array;
  readonly mapping: ColourMapping;
  readonly arrows?: readonly Arrow[];
  readonly arrowScale?: number;
  readonly noise_mm?: number;
  /** The one of the three that the keyboard reaches. */
  readonly focusable?: boolean;
  readonly spoken?: string;
  readonly onPainted?: (canvas: HTMLCanvasElement) => void;
}

export function SheetMap(props: SheetMapProps) {
  const { session, residuals, frame, triangles, values, mapping } = props;
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    if (canvas.current === null) return;
    paint(canvas.current, rasterise(residuals.sheet, triangles, values, frame), mapping);
    props.onPainted?.(canvas.current);
  }, [residuals, triangles, values, frame, mapping.minimum, mapping.maximum]);
  const legend = useMemo(
    () => legendFor(mapping, Float32Array.from(values)),
    [values, mapping.minimum, mapping.maximum],
  );
  const hovered = session.hovered.value;
  const mark =
    hovered !== null && hovered < residuals.count
      ? placeOn(frame, residuals.sheet[2 * hovered] ?? 0, residuals.sheet[2 * hovered + 1] ?? 0)
      : null;
  const hover = (event: PointerEvent) => {
    const box = (event.currentTarget as Element).getBoundingClientRect();
    const scale = frame.widthPx / Math.max(box.width, 1) / frame.pixelsPerMm;
    const x = frame.left_mm + (event.clientX - box.left) * scale;
    const y = frame.top_mm - (event.clientY - box.top) * scale;
    session.hovered.value = nearestTo(residuals, x, y);
  };
  const move = (event: KeyboardEvent) => {
    const [dx, dy] = {
      ArrowLeft: [-1, 0],
      ArrowRight: [1, 0],
      ArrowUp: [0, 1],
      ArrowDown: [0, -1],
    }[event.key] ?? [0, 0];
    if (dx === 0 && dy === 0) return;
    event.preventDefault();
    session.hovered.value =
      hovered === null ? nearestTo(residuals, 0, 0) : neighbourOf(residuals, hovered, dx ?? 0, dy ?? 0);
  };
  return (
    <>
      <div
        class="sheet-map"
        style={{ aspectRatio: `${frame.widthPx} / ${frame.heightPx}` }}
        {...(props.focusable
          ? {
              role: 'application',
              tabIndex: 0,
              'aria-label': 'Points of the sheet: arrow keys go from one to the next',
              onKeyDown: move,
            }
          : {})}
        onPointerMove={hover}
        onPointerDown={hover}
        onPointerLeave={() => (session.hovered.value = null)}
      >
        <canvas
          ref={canvas}
          width={frame.widthPx}
          height={frame.heightPx}
          role="img"
          aria-label={[legend.summary, props.spoken].filter(Boolean).join(' ')}
        />
        <svg viewBox={`0 0 ${frame.widthPx} ${frame.heightPx}`} aria-hidden="true">
          {props.opening_mm ? <Opening frame={frame} size_mm={props.opening_mm} /> : null}
          {props.arrows ? (
            <path class="arrows" d={arrowPath(props.arrows, frame, props.arrowScale ?? 1)} />
          ) : null}
          {mark ? <circle class="live-mark" cx={mark[0]} cy={mark[1]} r="6" /> : null}
        </svg>
      </div>
      <ScaleBar mapping={mapping} noise_mm={props.noise_mm ?? 0} />
    </>
  );
}

function Opening({ frame, size_mm: [x, y] }: { frame: Frame; size_mm: readonly [number, number] }) {
  const [left, top] = placeOn(frame, -x / 2, y / 2);
  const { pixelsPerMm } = frame;
  return <rect class="opening" x={left} y={top} width={x * pixelsPerMm} height={y * pixelsPerMm} />;
}

/** Shafts with heads; what is too short for a head is a dot. */
function arrowPath(arrows: readonly Arrow[], frame: Frame, scale: number): string {
  return arrows
    .map(({ x, y, dx, dy }) => {
      const [px, py] = placeOn(frame, x, y);
      const [u, v] = [dx * scale * frame.pixelsPerMm, -dy * scale * frame.pixelsPerMm];
      const length = Math.hypot(u, v);
      const at = (a: number, b: number) => `${(px + a).toFixed(1)} ${(py + b).toFixed(1)}`;
      if (length < 2) return `M${at(-0.5, 0)}L${at(0.5, 0)}`;
      const head = Math.min(5, 0.5 * length) / length;
      const [bx, by] = [u * (1 - head), v * (1 - head)];
      const [sx, sy] = [0.6 * head * v, -0.6 * head * u];
      return `M${at(0, 0)}L${at(u, v)}M${at(bx + sx, by + sy)}L${at(u, v)}L${at(bx - sx, by - sy)}`;
    })
    .join('');
}

/** Heights: the flat sheet is pale, what rises is dark. */
const turned = (map: ColourMapName): boolean => map === 'thickness';

function paint(
  canvas: HTMLCanvasElement,
  raster: Float32Array,
  { map, minimum, maximum }: ColourMapping,
): void {
  const context = canvas.getContext('2d');
  if (context === null) return;
  const stops = stopsOf(map);
  const image = context.createImageData(canvas.width, canvas.height);
  for (let i = 0; i < raster.length; ++i) {
    const value = raster[i] ?? NaN;
    if (Number.isNaN(value)) continue;
    const fraction = (value - minimum) / (maximum - minimum);
    const [r, g, b] = sampleStops(stops, turned(map) ? 1 - fraction : fraction);
    image.data.set([r, g, b, 255], 4 * i);
  }
  context.putImageData(image, 0, 0);
}

/** The colours with their ends; what lies between the marks may be noise. */
function ScaleBar({ mapping, noise_mm }: { mapping: ColourMapping; noise_mm: number }) {
  const { minimum, maximum, map, unit } = mapping;
  const shown = noise_mm > 0 && noise_mm < maximum;
  const fraction = (value: number) => `${(100 * (value - minimum)) / (maximum - minimum)}%`;
  const signed = minimum < 0 && map === 'signed';
  const end = formatNumber(maximum, 2);
  return (
    <div class="scale-bar" aria-hidden="true">
      <div>
        <b class={turned(map) ? 'turned' : ''} style={{ background: `var(--map-${map})` }} />
        {shown
          ? [-noise_mm, noise_mm].map((value) => <i key={value} style={{ left: fraction(value) }} />)
          : null}
      </div>
      <span>{signed ? `too low ${formatNumber(minimum, 2)}` : formatNumber(minimum, 2)}</span>
      {shown ? <span>noise ±{formatNumber(noise_mm, 1)}</span> : null}
      <span>{signed ? `${withUnit(`+${end}`, unit)} too high` : withUnit(end, unit)}</span>
    </div>
  );
}
