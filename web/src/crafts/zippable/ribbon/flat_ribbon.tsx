// SPDX-License-Identifier: GPL-3.0-or-later
// The ribbon in the plane, in true proportions: parts in their colours, zipper sides, openings, the place pointed at.
import { useSignal } from '@preact/signals';
import { useEffect, useMemo, useRef } from 'preact/hooks';
import { formatMetres, Segmented } from '../../../ui';
import { figure } from '../../../shared/session/report';
import { boundaryEdges, partName } from '../design';
import { withCutPoints } from './cut_ribbon';
import type { FlatFit } from './flat_outline';
import { edgePath, fitFlat, partLabels, partPaths, scaleBar } from './flat_outline';
import { fabricName, fabricToken, paintedRibbon } from './paint';
import { alongAt, flatOf, placeInFlat, seamAt } from './ribbon_places';
import type { SendToMachine } from '../sheets/send_sheet';
import { Sheets } from '../sheets/sheets';
import { colourToken } from '../../../shared/panels/colour_token';
import { chosenPart, flatView, playing, pointed } from '../views';
import { planning } from '../zippable_document';
import type { Zippable, ZippableSession } from '../zippable_session';

const flatNames = [
  { value: 'ribbon', label: 'Ribbon' },
  { value: 'sheets', label: 'Sheets to cut' },
] as const;
const rigName = { value: 'rig', label: 'Fastening rig' } as const;

export interface FlatRibbonProps {
  readonly session: ZippableSession;
  readonly onSendToMachine: SendToMachine;
}

export function FlatRibbon({ session, onSendToMachine }: FlatRibbonProps) {
  const frame = useRef<HTMLDivElement>(null);
  const size = useSignal<readonly [number, number]>([0, 0]);
  useEffect(() => {
    const element = frame.current;
    if (element === null) return undefined;
    const resize = new ResizeObserver(() => (size.value = [element.clientWidth, element.clientHeight]));
    resize.observe(element);
    return () => resize.disconnect();
  }, []);
  const shown = session.shown.value;
  const [width, height] = size.value;
  const fit = useMemo(
    () => (shown && width > 0 ? fitFlat(shown.design.ribbon.flat, width, height) : null),
    [shown, width, height],
  );
  const plans = session.operationNamed(planning) !== undefined;
  const rig = session.value('rig') === true;
  const chosen = flatView.value === 'rig' && !rig ? 'sheets' : flatView.value;
  const sheets = plans && chosen !== 'ribbon';
  return (
    <div ref={frame} class="flat-ribbon">
      {shown && sheets ? (
        <Sheets
          session={session}
          drawing={chosen === 'rig' ? 'rig.svg' : 'plan.svg'}
          onSendToMachine={onSendToMachine}
        />
      ) : null}
      {shown && fit && !sheets ? <Drawing shown={shown} fit={fit} width={width} height={height} /> : null}
      {shown && plans ? (
        <div class="float top-left">
          <Segmented
            floating
            label="Flat"
            options={rig ? [...flatNames, rigName] : flatNames}
            value={chosen}
            onChange={(value) => (flatView.value = value)}
          />
        </div>
      ) : null}
    </div>
  );
}

interface DrawingProps {
  readonly shown: Zippable;
  readonly fit: FlatFit;
  readonly width: number;
  readonly height: number;
}

function Drawing({ shown, fit, width, height }: DrawingProps) {
  const { design } = shown;
  const at = pointed.value;
  const bar = scaleBar(fit.pxPerMm);
  const point = (event: PointerEvent & { readonly currentTarget: Element }) => {
    if (playing.value) return;
    const box = event.currentTarget.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left - fit.x, fit.y - (event.clientY - box.top)];
    const place = placeInFlat(design.ribbon, x / fit.pxPerMm, y / fit.pxPerMm);
    pointed.value = place && { places: [place], along_mm: alongAt(design, place) };
  };
  const along = at?.along_mm ?? null;
  const key = (event: KeyboardEvent) => {
    const from = along ?? 0;
    const step = design.zipper_mm / (event.shiftKey ? 20 : 200);
    const targets: Record<string, number> = {
      ArrowRight: from + step,
      ArrowUp: from + step,
      ArrowLeft: from - step,
      ArrowDown: from - step,
      Home: 0,
      End: design.zipper_mm,
    };
    const to = targets[event.key];
    if (to === undefined || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    event.stopPropagation();
    const along_mm = Math.min(design.zipper_mm, Math.max(0, to));
    pointed.value = { places: seamAt(design, along_mm), along_mm };
  };
  const said = along === null ? null : `${formatMetres(along)} from the start`;
  return (
    <>
      <div
        class="flat-slider"
        role="slider"
        tabIndex={0}
        aria-label="Place along the zipper"
        aria-valuemin={0}
        aria-valuemax={Math.round(design.zipper_mm)}
        aria-valuenow={Math.round(along ?? 0)}
        aria-valuetext={said ?? 'No place chosen'}
        onKeyDown={key}
        onBlur={() => (pointed.value = null)}
        onPointerMove={point}
        onPointerLeave={() => (pointed.value = null)}
      >
        <svg width={width} height={height} aria-hidden="true">
          <g transform={`translate(${fit.x} ${fit.y}) scale(${fit.pxPerMm} ${-fit.pxPerMm})`}>
            <Shapes shown={shown} chosen={chosenPart.value} line={lineWidth(shown, fit.pxPerMm)} />
          </g>
          <Labels shown={shown} fit={fit} />
          {at?.places.map((place, i) => {
            const [x, y] = flatOf(design.ribbon, place);
            return (
              <circle
                key={i}
                class="pointed"
                cx={fit.x + fit.pxPerMm * x}
                cy={fit.y - fit.pxPerMm * y}
                r={6}
              />
            );
          })}
        </svg>
      </div>
      <div class="flat-foot">
        <span class="scale-bar">
          <i style={{ width: `${bar.px}px` }} />
          {bar.text}
        </span>
        {design.fabric ? <FabricKey /> : null}
        <span>Seam: {formatMetres(design.zipper_mm)} on each side</span>
        <span>{said ?? ''}</span>
      </div>
    </>
  );
}

/** Which colour on the drawing is which fabric. */
function FabricKey() {
  return (
    <span class="fabric-key">
      {[0, 1].map((fabric) => (
        <span key={fabric}>
          <i style={{ '--part': `var(${fabricToken(fabric)})` }} aria-hidden="true" />
          {fabricName(fabric)}
        </span>
      ))}
    </span>
  );
}

interface ShapesProps {
  readonly shown: Zippable;
  readonly chosen: number | null;
  readonly line: number;
}

/** Thin enough to leave the ribbon's own colour to be seen, px. */
const lineWidth = ({ report }: Zippable, pxPerMm: number): number =>
  Math.min(1.5, Math.max(0.3, 0.12 * pxPerMm * (figure(report, 'ribbon_width_mean_mm') ?? 20)));

function Shapes({ shown, chosen, line }: ShapesProps) {
  const { design } = shown;
  const shapes = useMemo(() => {
    const { flat } = design.ribbon;
    const pieces = shown.pieces();
    const { ofPiece, paints } = paintedRibbon(design, pieces);
    const cut = { flat: withCutPoints(flat, 2, pieces), triangles: pieces.triangles };
    const paths = partPaths(cut, ofPiece, paints.length);
    return {
      painted: paints.map((paint, i) => ({ ...paint, path: paths[i] ?? '' })),
      zipper: edgePath(flat, boundaryEdges(design, 'zipper')),
      opening: edgePath(flat, boundaryEdges(design, 'opening')),
    };
  }, [shown]);
  return (
    <>
      {shapes.painted.map(({ part, token, path }, i) => (
        <path
          key={i}
          class={chosen === null || chosen === part ? 'flat-part' : 'flat-part faded'}
          style={{ '--part': `var(${token})` }}
          d={path}
        />
      ))}
      <path class="flat-zipper" style={{ strokeWidth: line }} d={shapes.zipper} />
      <path class="flat-opening" style={{ strokeWidth: line }} d={shapes.opening} />
    </>
  );
}

function Labels({ shown, fit }: { shown: Zippable; fit: FlatFit }) {
  const labels = useMemo(
    () => partLabels(shown.design.ribbon, shown.partOfTriangle, shown.design.parts.length),
    [shown],
  );
  return (
    <>
      {labels.map((at, part) =>
        at ? (
          <g
            key={part}
            class="flat-label"
            transform={`translate(${fit.x + fit.pxPerMm * at[0]} ${fit.y - fit.pxPerMm * at[1]})`}
            style={{ '--part': `var(${colourToken(part)})` }}
          >
            <title>{partName(part)}</title>
            <circle r={10} />
            <text dy="0.35em">{part + 1}</text>
          </g>
        ) : null,
      )}
    </>
  );
}
