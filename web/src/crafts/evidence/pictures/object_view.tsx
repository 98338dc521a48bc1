// SPDX-License-Identifier: GPL-3.0-or-later
// The measured surface in space, coloured by its distance from the simulation, with arrows to where that has each point.
import { effect } from '@preact/signals';
import { useEffect, useMemo, useRef } from 'preact/hooks';
import type { ColourMapping, Curve, Viewpoint } from '../../../view';
import { Viewport } from '../../../view';
import { Legend } from '../../../shared/panels/legend';
import type { EvidenceSession, Look } from '../evidence_session';
import type { Model, Residuals } from './residuals';
import { distancesOf, niceUp, percentile, scaleFor, simulatedIn } from './residuals';
import { triangulate } from './sheet_surface';

const viewpoint: Viewpoint = {
  projection: 'perspective',
  direction: [0.14, 0.95, -0.98],
  up: [0, 0, 1],
  targetMm: [0, 0, 0],
  distanceMm: 900,
  fieldOfViewDeg: 20,
};
const maxArrows = 240;

/** Of every so many points; `scale` makes the longest usual ones a tenth of the sheet. */
function spaceArrows(residuals: Residuals, model: Model, scale: number): Float32Array {
  const stride = Math.max(1, Math.ceil(residuals.count / maxArrows));
  const simulated = simulatedIn(residuals, model);
  const ends: number[] = [];
  for (let i = 0; i < residuals.count; i += stride) {
    const from = [0, 1, 2].map((k) => residuals.measured[3 * i + k] ?? 0);
    const along = from.map((at, k) => scale * ((simulated[3 * i + k] ?? 0) - at));
    ends.push(...arrowEnds(from, along));
  }
  return Float32Array.from(ends);
}

/** A shaft and the two halves of its head. */
function arrowEnds(from: readonly number[], along: readonly number[]): number[] {
  const [u = 0, v = 0] = along;
  const tip = from.map((at, k) => at + (along[k] ?? 0));
  const flat = Math.hypot(u, v);
  const aside = flat > 1e-9 ? [-v / flat, u / flat, 0] : [1, 0, 0];
  const head = 0.22 * Math.hypot(...along);
  const barb = (side: number) =>
    tip.map((at, k) => at - 0.25 * (along[k] ?? 0) + 0.5 * side * head * (aside[k] ?? 0));
  return [...from, ...tip, ...barb(1), ...tip, ...barb(-1), ...tip];
}

export function ObjectView({ session, look }: { session: EvidenceSession; look: Look }) {
  const container = useRef<HTMLDivElement>(null);
  const viewport = useRef<Viewport | null>(null);
  const { residuals } = look;
  const model = session.model.value;
  const indices = useMemo(() => triangulate(residuals), [residuals]);
  const { maximum, scale } = useMemo(() => {
    const base = distancesOf(residuals, 'base');
    const side = Math.abs(percentile(residuals.sheet, 0.99)) + Math.abs(percentile(residuals.sheet, 0.01));
    return { maximum: niceUp(Math.max(percentile(base, 0.98), 1e-3)), scale: scaleFor(base, 0.1 * side) };
  }, [residuals]);
  const distances = useMemo(() => Float32Array.from(distancesOf(residuals, model)), [residuals, model]);
  const mapping: ColourMapping = {
    attribute: 'distance_mm',
    map: 'error',
    minimum: 0,
    maximum,
    unit: 'mm',
    label: 'Distance',
  };

  useEffect(() => {
    if (container.current === null) return undefined;
    const made = new Viewport(container.current, {
      mode: 'relief',
      freeRectangle: { left: 20, top: 20, right: 20, bottom: 20 },
      label: 'Measured object',
      uprightTurn: true,
      dimensions: false,
      ground: true,
      onPointer: ({ kind, hit }) => {
        if (kind === 'leave' || hit === null) session.hovered.value = null;
        else if (kind === 'move' || kind === 'click')
          session.hovered.value = cornerOf(made, hit.triangle, hit.barycentric);
      },
    });
    const cornerOf = (_: Viewport, triangle: number, weights: readonly number[]): number | null => {
      const largest = weights.indexOf(Math.max(...weights));
      return indices[3 * triangle + largest] ?? null;
    };
    made.setViewpoint(viewpoint);
    viewport.current = made;
    const stop = effect(() => {
      const point = session.hovered.value;
      const places = residuals.measured;
      made.setMarkers(
        point === null || point >= residuals.count
          ? []
          : [
              {
                id: 'point',
                kind: 'live',
                positionMm: [places[3 * point] ?? 0, places[3 * point + 1] ?? 0, places[3 * point + 2] ?? 0],
              },
            ],
      );
    });
    return () => {
      stop();
      viewport.current = null;
      made.dispose();
    };
  }, [session, residuals]);

  useEffect(() => {
    const made = viewport.current;
    if (made === null) return;
    const attributes = { distance_mm: distances };
    made.setRelief({ positions: residuals.measured, indices, attributes }, null);
    made.setColourMapping(mapping, true);
    const arrows: Curve = {
      positions: spaceArrows(residuals, model, scale),
      separate: true,
      // On pale maps and on the bench of either theme.
      colour: '#6c665c',
      widthPx: 1.5,
    };
    made.setCurves([arrows]);
  }, [residuals, distances]);
  useEffect(() => viewport.current?.lookFromViewpoint(false), [residuals]);

  return (
    <section class="object-view" aria-label="On the object">
      <div ref={container} class="viewport" />
      <div class="float top-right">
        <Legend mapping={mapping} values={distances} />
      </div>
      <p class="float bottom-left label-chip">Arrows from measured to simulated × {scale}</p>
    </section>
  );
}
