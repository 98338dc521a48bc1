// SPDX-License-Identifier: GPL-3.0-or-later
// The forest from above: what is dragged, and what each viewpoint sees in its own colour.
import { useEffect, useRef, useState } from 'preact/hooks';
import type { Frame } from './floor_frame';
import { frameOf, markOf } from './floor_frame';
import { PillarCorners } from './floor_corners';
import { EyeHandle, helpId, LookHandle, PillarHandle } from './floor_handles';
import type { ForestSession } from '../forest_session';
import type { Plan } from '../plan';
import type { Place, Scene, Viewpoint } from '../scene';
import { isShaped } from '../scene';
import { colourOf, isChosen, planReach } from '../views';

export interface FloorPlanProps {
  readonly session: ForestSession;
  readonly scene: Scene;
}

/** Millimetres a pixel of the screen. */
function useScale(frame: Frame) {
  const svg = useRef<SVGSVGElement>(null);
  const [size, setSize] = useState<readonly [number, number]>([600, 600]);
  useEffect(() => {
    if (svg.current === null) return undefined;
    const element = svg.current;
    const measure = () => setSize([element.clientWidth || 1, element.clientHeight || 1]);
    const resize = new ResizeObserver(measure);
    resize.observe(element);
    measure();
    return () => resize.disconnect();
  }, []);
  return { svg, mm: Math.max(frame.width / size[0], frame.height / size[1]) };
}

export function FloorPlan({ session, scene }: FloorPlanProps) {
  const [held, setHeld] = useState<Frame | null>(null);
  // What is dragged out of the frame does not move the floor under the pointer.
  const frame = held ?? frameOf(scene, planReach.value === 'eyes');
  const { svg, mm } = useScale(frame);
  const planned = session.plan.planned.value;
  const stale = !session.plan.fits.value && session.plan.problem.value !== null;
  const placeAt = (event: PointerEvent): Place => {
    const matrix = svg.current?.getScreenCTM()?.inverse();
    const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix);
    return [x, -y];
  };
  const handles = {
    session,
    scene,
    mm,
    placeAt,
    onHold: (hold: boolean) => setHeld(hold ? frame : null),
  };
  return (
    <div class={stale ? 'forest-plan stale' : 'forest-plan'}>
      <p id={helpId} class="hidden-text">
        Drag it, or move it with the arrow keys by 1 mm, with Shift by 10 mm. Delete removes it. Page up and
        page down go to another pillar.
      </p>
      <svg
        ref={svg}
        role="group"
        aria-label="Floor plan from above"
        viewBox={[frame.left, frame.top, frame.width, frame.height].join(' ')}
        onPointerDown={({ target, currentTarget }) => {
          if (target === currentTarget) session.chosen.value = null;
        }}
      >
        {planned ? <Sights plan={planned.plan} /> : null}
        {scene.viewpoints.map((viewpoint, v) => (
          <PictureLine
            key={v}
            viewpoint={viewpoint}
            index={v}
            from={markOf(viewpoint, frame, 18 * mm).place}
            mm={mm}
          />
        ))}
        {scene.pillars.map((pillar, p) => (
          <PillarHandle key={p} {...handles} pillar={pillar} index={p} />
        ))}
        {planned ? <Surfaces plan={planned.plan} mm={mm} /> : null}
        {scene.pillars.map((pillar, p) =>
          isChosen(session.chosen.value, 'pillar', p) && !isShaped(pillar) ? (
            <PillarCorners key={p} {...handles} pillar={pillar} index={p} />
          ) : null,
        )}
        {scene.viewpoints.map((viewpoint, v) => (
          <LookHandle key={v} {...handles} viewpoint={viewpoint} index={v} />
        ))}
        {scene.viewpoints.map((viewpoint, v) => (
          <EyeHandle
            key={v}
            {...handles}
            viewpoint={viewpoint}
            index={v}
            mark={markOf(viewpoint, frame, 18 * mm)}
          />
        ))}
      </svg>
    </div>
  );
}

const points = (places: readonly Place[]): string => places.map(([x, y]) => `${x},${-y}`).join(' ');

function Sights({ plan }: { plan: Plan }) {
  return (
    <g class="sights" aria-hidden="true">
      {plan.viewpoints.map(({ sight_mm }, v) => (
        <polygon key={v} points={points(sight_mm)} style={{ fill: colourOf(v) }} />
      ))}
    </g>
  );
}

/** Coloured what is a viewpoint's own, striped in both colours what two see. */
function Surfaces({ plan, mm }: { plan: Plan; mm: number }) {
  const width = 4.5 * mm;
  return (
    <g class="surfaces" aria-hidden="true" stroke-width={width}>
      {plan.viewpoints.map(({ surfaces }, v) =>
        surfaces.map(({ line_mm }, i) => (
          <polyline
            key={`${v} ${i}`}
            data-viewpoint={v + 1}
            points={points(line_mm)}
            style={{ stroke: colourOf(v) }}
          />
        )),
      )}
      {plan.shared.map(({ line_mm, viewpoints: [a = 1, b = 1] }, i) => (
        <g key={i} data-shared={`${a} ${b}`}>
          <polyline points={points(line_mm)} style={{ stroke: colourOf(a - 1) }} />
          <polyline
            points={points(line_mm)}
            style={{ stroke: colourOf(b - 1) }}
            stroke-dasharray={`${3 * mm} ${3 * mm}`}
          />
        </g>
      ))}
    </g>
  );
}

interface PictureLineProps {
  readonly viewpoint: Viewpoint;
  readonly index: number;
  readonly from: Place;
  readonly mm: number;
}

/** From the eye to the place looked at, and there the width of the picture. */
function PictureLine({ viewpoint, index, from, mm }: PictureLineProps) {
  const { eye_mm, look_at_mm, width_mm } = viewpoint;
  const [x, y] = look_at_mm;
  const distance = Math.hypot(x - eye_mm[0], y - eye_mm[1]) || 1;
  const [acrossX, acrossY] = [(-(y - eye_mm[1]) / distance) * 0.5 * width_mm, ((x - eye_mm[0]) / distance) * 0.5 * width_mm]; // prettier-ignore
  return (
    <g class="picture-line" style={{ stroke: colourOf(index) }} aria-hidden="true">
      <line
        x1={from[0]}
        y1={-from[1]}
        x2={x}
        y2={-y}
        stroke-width={1.2 * mm}
        stroke-dasharray={`${4 * mm} ${4 * mm}`}
      />
      <line
        x1={x - acrossX}
        y1={-(y - acrossY)}
        x2={x + acrossX}
        y2={-(y + acrossY)}
        stroke-width={2.5 * mm}
      />
    </g>
  );
}
