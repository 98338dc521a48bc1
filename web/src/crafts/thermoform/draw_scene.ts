// SPDX-License-Identifier: GPL-3.0-or-later
// Draws what the session shows: frame, model and sheet at the moment looked at; as little as possible is sent
// again.
import { effect } from '@preact/signals';
import type { MeshData, Viewport } from '../../view';
import { turnedShading } from '../../view';
import type { ShadedMesh } from '../../shared/panels/shaded_mesh';
import type { Clamp } from './clamp_frame';
import { clampFrame, frameShadow, platform } from './clamp_frame';
import { endOf, sheetAt, Stretching } from './film';
import type { Extras } from './extras';
import type { Placement } from './placement';
import { boxOf, placed, rotationOf } from './placement';
import type { Formed, ThermoformSession } from './thermoform_session';
import { chooseViewFor, dragging, mappingOf, swiping, view } from './views';

/** White plastic. */
const plastic = [0.9, 0.895, 0.88] as const;
/** While the model below matters more than the sheet. */
const translucent = 0.5;

function modelData(mesh: ShadedMesh, placement: Placement, texture: ImageBitmap | null): MeshData {
  const { shading, cornerUvs } = mesh;
  return {
    positions: placed(mesh.positions, placement),
    indices: mesh.indices,
    ...(shading ? { shading: turnedShading(shading, rotationOf(placement)) } : {}),
    ...(mesh.colours ? { colours: mesh.colours } : {}),
    ...(texture && cornerUvs ? { cornerUvs, texture } : {}),
  };
}

function clampOf(session: ThermoformSession, formed: Formed): Clamp {
  const all = session.filled(formed.parameters);
  const [sheetX, sheetY, openingX, openingY, height] = [
    'sheet_x_mm',
    'sheet_y_mm',
    'clamp_opening_x_mm',
    'clamp_opening_y_mm',
    'clamp_height_mm',
  ].map((name) => Number(all[name] ?? 0)) as [number, number, number, number, number];
  return { sheet_mm: [sheetX, sheetY], opening_mm: [openingX, openingY], height_mm: height };
}

/** Attributes and picture of the sheet as it is in the end. */
function sheetData({ sheet }: Formed, printed: Extras['printed']): MeshData {
  return {
    positions: sheet.positions,
    indices: sheet.indices,
    attributes: sheet.attributes,
    ...(printed
      ? { uvs: printed.uvs, texture: printed.texture }
      : { colours: Float32Array.from(sheet.positions, (_, i) => plastic[(i % 3) as 0 | 1 | 2]) }),
  };
}

/** May the picture of one sheet be shown on the next one until that has its own? Only on a preview of the same model, with as many vertices. */
export const servesMeanwhile = (printed: Extras['printed'], on: Formed): boolean =>
  printed !== null &&
  on.kind === 'preview' &&
  printed.of.from === on.from &&
  printed.of.sheet.positions.length === on.sheet.positions.length;

interface DrawnModel {
  readonly from: string;
  readonly placement: Placement;
  /** The turn that the model's shading was found for: it waits until the hand lets go. */
  readonly shadedFor: Placement;
  readonly up: string;
  readonly frame: string;
  readonly draft: unknown;
  readonly picture: unknown;
}

/** `alone`: the model is looked at by itself, without the sheet. */
export function keepDrawn(
  viewport: Viewport,
  session: ThermoformSession,
  extras: () => Extras,
  alone: () => boolean,
): () => void {
  let drawn: { formed: Formed; printed: unknown } | null = null;
  let lastPrinted: Extras['printed'] = null;
  let model: DrawnModel | null = null;
  let stretching: Stretching | null = null;
  let lift = 0;

  const drawModel = (): void => {
    const original = session.model.original.value;
    const shown = session.shown.value;
    const placement = session.placement.value;
    const draft = view.value === 'undercut' && !alone() ? (extras().draft?.mesh ?? null) : null;
    if (original === null || shown === null || placement === null) {
      viewport.setOriginal(null);
      viewport.setFixtures([]);
      model = null;
      return;
    }
    const clamp = clampOf(session, shown);
    const picture = session.picture.value;
    const data = modelData(original.mesh, placement, picture);
    const { high } = boxOf(data.positions);
    const up = dragging.value && model ? model.up : JSON.stringify(session.inForce.value['up']);
    const frame = JSON.stringify([clamp, original.from, up]);
    const repainted = model?.picture !== picture;
    if (model?.frame !== frame || repainted) {
      viewport.setFixtures([
        {
          id: 'frame',
          mesh: clampFrame(clamp, high[2]),
          parts: ['original', 'relief'],
          framed: true,
          shadow: frameShadow(clamp),
        },
        { id: 'platform', mesh: platform(clamp), parts: ['original'] },
        { id: 'model', mesh: data, parts: ['relief'], within: true },
      ]);
      lift = 0;
    }
    const same =
      !repainted && model?.from === original.from && model.draft === draft && model.frame === frame;
    const turned = !sameTurn(model?.shadedFor, placement);
    const anew = !same || (turned && !dragging.peek());
    if (draft) {
      if (!same) viewport.setOriginal(draft);
    } else if (anew) viewport.setOriginal(data);
    else if (turned) viewport.updateOriginal(data.positions);
    else if (model?.placement.join() !== placement.join()) viewport.rescaleOriginal(data.positions);
    const shadedFor = anew ? placement : (model?.shadedFor ?? placement);
    moveModel(data.positions, !sameTurn(model?.placement, placement));
    model = { from: original.from, placement, shadedFor, up, frame, draft, picture };
  };
  const moveModel = (positions: Float32Array | Float64Array, turned: boolean): void => {
    const down = session.moment.peek()?.platform_z_mm ?? 0;
    lift = down;
    viewport.moveFixture('model', down === 0 ? positions : raised(positions, down), turned);
  };

  const drawSheet = (): void => {
    const shown = session.shown.value;
    if (shown === null) {
      viewport.setRelief(null, null);
      drawn = null;
      return;
    }
    const own = extras().printed?.of === shown ? extras().printed : null;
    // Plain plastic between two pictures would flicker while a slider moves.
    lastPrinted =
      own ?? (session.hasColours.value && servesMeanwhile(lastPrinted, shown) ? lastPrinted : null);
    const printed = view.value === 'texture' ? lastPrinted : null;
    if (drawn?.formed === shown && drawn.printed === printed) return;
    viewport.setRelief(sheetData(shown, printed), null);
    stretching = new Stretching(shown.film);
    drawn = { formed: shown, printed };
    drawMoment();
  };

  const drawMoment = (): void => {
    const shown = session.shown.value;
    const moment = session.moment.value;
    if (shown === null || moment === null || drawn?.formed !== shown) return;
    const ended = session.time_s.value >= endOf(shown.film) - 1e-6;
    const positions = ended ? shown.sheet.positions : sheetAt(shown.film, moment);
    const mapping = mappingOf(view.value, shown, thicknessOf(session, shown));
    viewport.updateRelief(positions);
    if (mapping && view.value !== 'undercut')
      viewport.updateAttribute(
        'relief',
        mapping.attribute,
        valuesAt(mapping.attribute, shown, positions, ended),
      );
    const settled = ended && !dragging.value;
    const covered = moment.phase === 'vacuum' ? moment.touching_share : 0;
    viewport.setOpacity('relief', settled ? 1 : dragging.value ? translucent : translucent + 0.35 * covered);
    if (moment.platform_z_mm !== lift) {
      const placement = session.placement.value;
      const original = session.model.original.peek();
      if (placement && original) moveModel(placed(original.mesh.positions, placement), false);
    }
  };

  const valuesAt = (name: string, shown: Formed, positions: Float32Array, ended: boolean): Float32Array => {
    const known = shown.sheet.attributes[name];
    if (ended && known) return known;
    const stretch = stretching?.at(positions) ?? new Float32Array(positions.length / 3).fill(1);
    return name === 'stretch' ? stretch : stretch.map((s) => thicknessOf(session, shown) / Math.max(s, 1e-6));
  };

  const stops = [
    effect(() => {
      const original = session.model.original.value;
      if (original) chooseViewFor(original.from, session.hasColours.value);
    }),
    effect(drawModel),
    effect(drawSheet),
    effect(drawMoment),
    effect(() => {
      const shown = session.shown.value;
      const onlyModel = view.value === 'undercut' || alone();
      viewport.setMode(onlyModel ? 'original' : swiping.value ? 'swipe' : 'relief');
      const mapping = shown && !alone() ? mappingOf(view.value, shown, thicknessOf(session, shown)) : null;
      viewport.setColourMapping(mapping, true);
    }),
  ];
  return () => {
    for (const stop of stops) stop();
  };
}

export const thicknessOf = (session: ThermoformSession, { parameters }: Formed): number =>
  Number(session.filled(parameters)['sheet_thickness_mm'] ?? 1);

const sameTurn = (a: Placement | undefined, b: Placement): boolean =>
  a !== undefined && rotationOf(a).every((value, i) => Math.abs(value - (rotationOf(b)[i] ?? 0)) < 1e-9);

function raised(positions: Float32Array | Float64Array, by_mm: number): Float32Array {
  return Float32Array.from(positions, (value, i) => (i % 3 === 2 ? value + by_mm : value));
}
