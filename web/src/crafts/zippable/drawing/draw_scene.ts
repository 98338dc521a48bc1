// SPDX-License-Identifier: GPL-3.0-or-later
// Draws what the session shows: the divided model or the ribbon in space, the zipper's course, the place pointed at.
import { effect } from '@preact/signals';
import type { Film } from '../../../jobs/glb';
import type { Curve, MeshData, Vec3, Viewport } from '../../../view';
import { originalData, shadingOf } from '../../../shared/panels/shaded_mesh';
import { figure, vectorOf } from '../../../shared/session/report';
import { boundaryEdges } from '../design';
import { withCutPoints } from '../ribbon/cut_ribbon';
import { drawnLines, tool } from './draw_actions';
import { positionOf } from '../ribbon/ribbon_places';
import { frameAt } from '../simulated';
import type { Paint } from '../ribbon/paint';
import { paintedRibbon, paintsOfParts } from '../ribbon/paint';
import { bend, chosenPart, course, distortionMapping, pointed, themeChanges, view } from '../views';
import type { Zippable, ZippableSession } from '../zippable_session';

type Colour = readonly [number, number, number];
const paper: Colour = [0.86, 0.845, 0.815];
/** How much of a part's colour is left while another part is chosen. */
const faded = 0.25;

/** A colour as the style sheet has it, 0..1. */
function colourOf({ part, token }: Paint): Colour {
  const text = getComputedStyle(document.documentElement).getPropertyValue(token).trim();
  const six = /^#([0-9a-f]{6})$/i.exec(text)?.[1];
  const number = parseInt(six ?? '808080', 16);
  const full: Colour = [(number >> 16) / 255, ((number >> 8) & 255) / 255, (number & 255) / 255];
  const chosen = chosenPart.value;
  if (chosen === null || chosen === part) return full;
  return full.map((c, k) => faded * c + (1 - faded) * (paper[k] ?? 0)) as unknown as Colour;
}

/** Of what is painted in these, one after the other. */
function coloursOf(painted: ArrayLike<number>, paints: readonly Paint[]): Float32Array {
  const colours = paints.map(colourOf);
  return Float32Array.from({ length: 3 * painted.length }, (_, i) => {
    const colour = colours[painted[Math.floor(i / 3)] ?? 0] ?? paper;
    return colour[(i % 3) as 0 | 1 | 2];
  });
}

/** The ribbon cut along the parts' borders, with vertices apart where its colours change; which vertex of the ribbon, or
 *  further point of the cut, each of them is. */
interface ColouredRibbon {
  readonly indices: Uint32Array;
  readonly source: Uint32Array;
  /** Per vertex. */
  readonly paint: Uint32Array;
  readonly paints: readonly Paint[];
}

function apartByPaint(shown: Zippable): ColouredRibbon {
  const pieces = shown.pieces();
  const { triangles } = pieces;
  const vertices = shown.design.ribbon.sample.length + pieces.corners.length / 3;
  const { ofPiece, paints } = paintedRibbon(shown.design, pieces);
  const numbers = new Map<number, number>();
  const [source, paint]: [number[], number[]] = [[], []];
  const indices = triangles.map((vertex, at) => {
    const mine = ofPiece[Math.floor(at / 3)] ?? 0;
    const key = mine * vertices + vertex;
    const known = numbers.get(key);
    if (known !== undefined) return known;
    numbers.set(key, source.length);
    source.push(vertex);
    paint.push(mine);
    return source.length - 1;
  });
  return { indices, source: Uint32Array.from(source), paint: Uint32Array.from(paint), paints };
}

const gathered = (positions: Float32Array, source: Uint32Array) =>
  Float32Array.from({ length: 3 * source.length }, (_, i) => {
    return positions[3 * (source[Math.floor(i / 3)] ?? 0) + (i % 3)] ?? 0;
  });

/** Tape and teeth, thinner where the windings are close together. */
function zipper({ report }: Zippable, positions: Float32Array, separate: boolean): Curve[] {
  const size = Math.max(...(vectorOf(report, 'size_mm') ?? [1]));
  const widthPx = Math.min(4, Math.max(1.5, (30 * (figure(report, 'ribbon_width_mean_mm') ?? size)) / size));
  return [
    { positions, separate, colour: '#26221d', widthPx },
    { positions, separate, colour: '#d8cfbf', widthPx: 0.375 * widthPx },
  ];
}

/** What is drawn by hand, in the colour of what can be taken hold of. */
function sketched(session: ZippableSession): Curve[] {
  const lines = drawnLines(session);
  return lines.map((positions, i) => ({
    positions,
    colour: '--accent',
    widthPx: 2.5,
    dashed: i + 1 === lines.length,
    ghost: true,
  }));
}

/** The ribbon's vertices as they are in space now. */
export function bentPositions(session: ZippableSession, shown: Zippable, share: number): Float32Array {
  const { bending, design } = shown;
  const film = course.value === 'simulated' ? session.film.value : null;
  if (film && film.frames[0]?.length === design.ribbon.positions.length) return frameAt(film, share);
  return share >= 1 ? design.ribbon.positions : bending().at(share);
}

export function keepDrawn(viewport: Viewport, session: ZippableSession): () => void {
  let fitted: string | null = null;
  let coloured: { of: Zippable; ribbon: ColouredRibbon; style: string } | null = null;
  let bent: { of: Zippable; share: number; film: Film | null; positions: Float32Array } | null = null;

  const styleNow = () => `${chosenPart.value} ${themeChanges.value}`;
  const positionsNow = (shown: Zippable): Float32Array => {
    const share = view.value === 'ribbon' ? bend.value : 1;
    const film = course.value === 'simulated' ? session.film.value : null;
    if (bent?.of !== shown || bent.share !== share || bent.film !== film)
      bent = { of: shown, share, film, positions: bentPositions(session, shown, share) };
    return bent.positions;
  };
  let drawnModel: { of: unknown; style: string } | null = null;

  const drawModel = (): void => {
    const original = session.model.original.value;
    const shown = session.shown.value;
    const style = styleNow();
    const of = shown?.model ?? original;
    if (of === null) {
      viewport.setOriginal(null);
      viewport.setRelief(null, null);
      drawnModel = coloured = fitted = null;
      return;
    }
    if (drawnModel?.of !== of || drawnModel.style !== style) {
      viewport.setOriginal(shown ? modelData(shown) : original && originalData(original.mesh, 1));
      drawnModel = { of, style };
    }
    const key = `${session.document.peek().model?.mesh.blob} ${String(shown?.report['size_mm'] !== undefined)} ${String(
      session.value('size_mm'),
    )}`;
    if (fitted !== key) viewport.fit(false);
    fitted = key;
  };

  const drawRibbon = (): void => {
    const shown = session.shown.value;
    if (shown === null) {
      viewport.setRelief(null, null);
      coloured = null;
      return;
    }
    // Of a preview the ribbon in space is drawn when it is looked at: not at every step of a slider.
    if (view.value !== 'ribbon' && shown.kind === 'preview') return;
    const style = styleNow();
    const positions = positionsNow(shown);
    const cut = (values: Float32Array) => withCutPoints(values, 3, shown.pieces());
    if (coloured?.of !== shown || coloured.style !== style) {
      const ribbon = apartByPaint(shown);
      const { indices, source, paint, paints } = ribbon;
      const colours = coloursOf(paint, paints);
      viewport.setRelief({ positions: gathered(cut(positions), source), indices, colours }, null);
      coloured = { of: shown, ribbon, style };
    } else viewport.updateRelief(gathered(cut(positions), coloured.ribbon.source));
  };

  const drawCurves = (): void => {
    const shown = session.shown.value;
    if (tool.value) viewport.setCurves(sketched(session));
    else if (shown === null) viewport.setCurves([]);
    else if (view.value === 'ribbon') {
      const edges = boundaryEdges(shown.design, 'zipper');
      viewport.setCurves(zipper(shown, gathered(positionsNow(shown), edges), true));
    } else viewport.setCurves(shown.course.flatMap((piece) => zipper(shown, piece, false)));
  };

  const drawPointed = (): void => {
    const shown = session.shown.value;
    const at = pointed.value;
    if (shown === null || at === null) {
      viewport.setMarkers([]);
      return;
    }
    const positions = positionsNow(shown);
    // Zipped up, the two sides of the seam are one place.
    const places = view.value === 'ribbon' && bend.value < 1 ? at.places : at.places.slice(0, 1);
    viewport.setMarkers(
      places.map((place, i) => ({
        id: `pointed ${i}`,
        kind: 'live',
        positionMm: positionOf(shown.design.ribbon, place, positions) as Vec3,
      })),
    );
  };

  const stops = [
    effect(drawModel),
    effect(drawRibbon),
    effect(drawCurves),
    effect(drawPointed),
    effect(() => {
      const shown = session.shown.value;
      if (shown && (chosenPart.value ?? 0) >= shown.design.parts.length) chosenPart.value = null;
      viewport.setMode(shown && view.value === 'ribbon' ? 'relief' : 'original');
      viewport.setColourMapping(shown && view.value === 'distortion' ? distortionMapping(shown) : null, true);
    }),
  ];
  return () => {
    for (const stop of stops) stop();
  };
}

function modelData({ model, design }: Zippable): MeshData {
  const { positions, indices, attributes } = model.mesh;
  const segment = attributes['segment'] ?? new Float32Array(positions.length / 3);
  const colours = coloursOf(segment, paintsOfParts(design.parts.length));
  return { positions, indices, attributes, colours, ...shadingOf(model.mesh) };
}
