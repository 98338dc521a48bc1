// SPDX-License-Identifier: GPL-3.0-or-later
// What a viewpoint sees of the forest as it is planned: the pillars in the colours of the plan, and over them its model.
import { signal } from '@preact/signals';
import { useEffect, useMemo } from 'preact/hooks';
import { formatFixed, withUnit } from '../../../../ui';
import type { ForestSession } from '../forest_session';
import type { Planned } from '../live_plan';
import type { Plan } from '../plan';
import { figuresOf } from '../plan';
import { colourOf, modelName } from '../views';
import { EyeCamera } from './eye_camera';
import type { Seen } from './eye_camera';
import type { SeenPillar, Strip } from './seen_walls';
import { seenPillars } from './seen_walls';

/** The last viewpoint that was chosen, from 0. */
const looking = signal(0);
/** Of what the model needs. */
const margin = 1.2;
/** Of the shade on a wall that is seen from its edge. */
const darkest = 0.45;

const points = (corners: readonly Seen[]) => corners.map(({ x_mm, y_mm }) => `${x_mm.toFixed(2)},${(-y_mm).toFixed(2)}`).join(' '); // prettier-ignore

export function EyePicture({ session, planned }: { session: ForestSession; planned: Planned }) {
  const chosen = session.chosen.value;
  const chosenViewpoint = chosen?.kind === 'viewpoint' ? chosen.index : null;
  useEffect(() => {
    if (chosenViewpoint !== null) looking.value = chosenViewpoint;
  }, [chosenViewpoint]);
  const { viewpoints } = planned.made;
  const v = Math.min(chosenViewpoint ?? looking.value, viewpoints.length - 1);
  const viewpoint = viewpoints[v];
  if (viewpoint === undefined) return null;
  const own = figuresOf(planned.report, 'in_plan')[v]?.shares['own_percent'];
  const name = modelName(session, viewpoint);
  return (
    <figure class="forest-eye">
      <div role="group" aria-label="Viewpoint">
        {viewpoints.map((_, i) => (
          <button
            key={i}
            type="button"
            aria-pressed={i === v}
            aria-label={`Seen from viewpoint ${i + 1}`}
            onClick={() => {
              looking.value = i;
              if (chosenViewpoint !== null) session.chosen.value = { kind: 'viewpoint', index: i };
            }}
          >
            <i class="number-disc" style={{ background: colourOf(i) }} aria-hidden="true">
              {i + 1}
            </i>
          </button>
        ))}
      </div>
      <Drawing planned={planned} v={v} label={`${name} and the pillars, seen from viewpoint ${v + 1}`} />
      <figcaption>
        {name}
        {own === undefined
          ? null
          : `: ${withUnit(formatFixed(own, own > 99.95 ? 0 : 1), '%')} on its pillars, seen from above`}
      </figcaption>
    </figure>
  );
}

/** Viewpoints of which two see one surface, from 1. */
function sharedPairs({ shared }: Plan): (readonly [number, number])[] {
  const pairs = shared.map(({ viewpoints: [a = 1, b = 1] }) => [a, b] as const);
  return [...new Map(pairs.map((pair) => [pair.join(), pair])).values()];
}

function Drawing({ planned, v, label }: { planned: Planned; v: number; label: string }) {
  const { plan, made, models } = planned;
  const viewpoint = made.viewpoints[v];
  const pillars = useMemo(() => {
    if (viewpoint === undefined) return null;
    const camera = new EyeCamera(viewpoint);
    return { camera, seen: seenPillars(camera, plan, made) };
  }, [planned, v]);
  const model = models[v];
  if (viewpoint === undefined || pillars === null) return null;
  const width = viewpoint.width_mm;
  const height = width * (model?.height_share ?? 1);
  const shown = [margin * width, margin * Math.max(height, 0.9 * width)] as const;
  return (
    <svg
      role="img"
      aria-label={label}
      viewBox={[-0.5 * shown[0], -0.5 * shown[1], ...shown].join(' ')}
      style={{ aspectRatio: `${shown[0]} / ${shown[1]}` }}
    >
      <defs>
        {sharedPairs(plan).map(([a, b]) => (
          <pattern
            key={`${a} ${b}`}
            id={`eye-${a}-${b}`}
            width={0.04 * width}
            height={0.04 * width}
            patternUnits="userSpaceOnUse"
            patternTransform="rotate(45)"
          >
            <rect width={0.04 * width} height={0.04 * width} style={{ fill: colourOf(a - 1) }} />
            <rect width={0.02 * width} height={0.04 * width} style={{ fill: colourOf(b - 1) }} />
          </pattern>
        ))}
      </defs>
      {pillars.seen.map((pillar) => (
        <PillarPicture key={pillar.pillar} camera={pillars.camera} pillar={pillar} />
      ))}
      {model ? (
        <image href={model.url} x={-0.5 * width} y={-0.5 * height} width={width} height={height} />
      ) : null}
    </svg>
  );
}

function PillarPicture({ camera, pillar }: { camera: EyeCamera; pillar: SeenPillar }) {
  const { height_mm, outline_mm, walls } = pillar;
  const side = ([a, b]: Strip['foot_mm']) =>
    points([camera.seen(a, 0), camera.seen(b, 0), camera.seen(b, height_mm), camera.seen(a, height_mm)]);
  // Neighbours of one colour overlap by a line, or what lies behind would shine through between them.
  const paint = ([a = 0, b]: Strip['owners']) => {
    const colour = b === undefined ? colourOf(a) : `url(#eye-${a + 1}-${b + 1})`;
    return { fill: colour, stroke: colour };
  };
  return (
    <g data-pillar={pillar.pillar + 1}>
      {camera.eye_mm[2] > height_mm ? (
        <polygon class="top" points={points(outline_mm.map((place) => camera.seen(place, height_mm)))} />
      ) : null}
      {walls.map(({ foot_mm, facing, strips }, i) => (
        <g key={i}>
          <polygon class="wall" points={side(foot_mm)} />
          {strips.map((strip, k) => (
            <polygon
              key={k}
              data-owners={strip.owners.map((owner) => owner + 1).join(' ')}
              points={side(strip.foot_mm)}
              style={paint(strip.owners)}
            />
          ))}
          <polygon class="shade" points={side(foot_mm)} style={{ opacity: darkest * (1 - facing) }} />
        </g>
      ))}
    </g>
  );
}
