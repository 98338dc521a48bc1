// SPDX-License-Identifier: GPL-3.0-or-later
// The viewport with what floats over it: view modes, light, side view, legend, notes.
import { effect, signal, untracked, useSignal } from '@preact/signals';
import type { ComponentChildren } from 'preact';
import { useEffect, useMemo, useRef } from 'preact/hooks';
import { Icon, Segmented } from '../../ui';
import type { Insets, LightDirection, Plate, ViewMode } from '../../view';
import { LightBall, SideInset, Viewport } from '../../view';
import { Legend } from '../../shared/panels/legend';
import { narrow } from '../../shared/panels/narrow';
import { figure } from '../../shared/session/report';
import { originalData, scaled } from '../../shared/panels/shaded_mesh';
import { ForestButton } from './forest/forest_button';
import { BaseMover } from './base/base_mover';
import { ShapeMover } from './base/shape_mover';
import { GroupMover } from './group/group_mover';
import type { GripElements } from './handles/grips';
import { Handles } from './handles/handles';
import { brushPointer, keepPainted } from './paint/paint_scene';
import { PaintTool } from './paint/paint_tool';
import { brightnessMapping } from './light/light_values';
import { errorMapping, errorOf, litData, plateOf, reliefData, viewpointOf } from './meshes';
import { placed } from './pieces/piece_meshes';
import { PiecesBar } from './pieces/pieces_bar';
import type { MadePieces } from './pieces/relief_pieces';
import type { ReliefSession } from './relief_session';
import type { LitRelief, Shown } from './shown';
import { BesideChoice } from './squashed/beside_choice';
import type { SquashedModel } from './squashed/squashed_relief';

type ReliefMode = ViewMode | 'light' | 'pieces';

/** The viewport's own state outlives a visit to another page. */
export const mode = signal<ReliefMode>('swipe');
const light = signal<LightDirection>({ azimuthDeg: 135, elevationDeg: 35, follows: 'object' });
export const atViewpoint = signal(true);
export const followCamera = signal(false);
let followed = '';

/** The camera is followed for one model of one project: opening another, it only comes to see it. */
function followOnly(session: ReliefSession): void {
  const { id } = session.services.projects.document.value;
  const which = `${id} ${session.document.value.model?.mesh.blob}`;
  if (which !== followed) followCamera.value = false;
  followed = which;
}

const modes: readonly { value: ReliefMode; label: string; short?: string }[] = [
  { value: 'swipe', label: 'Swipe' },
  { value: 'relief', label: 'Relief' },
  { value: 'original', label: 'Original' },
  { value: 'error', label: 'Shading difference' },
  { value: 'light', label: 'In real light', short: 'Light' },
  { value: 'pieces', label: 'In pieces', short: 'Pieces' },
];

export interface ViewportPanelProps {
  readonly session: ReliefSession;
  /** Given the viewport once it exists, null when it goes. */
  readonly onViewport: (viewport: Viewport | null) => void;
  /** At the foot, off the object. */
  readonly notes: ComponentChildren;
  readonly children?: ComponentChildren;
}

export function ViewportPanel({ session, onViewport, notes, children }: ViewportPanelProps) {
  const container = useRef<HTMLDivElement>(null);
  const ball = useRef<HTMLDivElement>(null);
  const side = useRef<HTMLDivElement>(null);
  const foot = useRef<HTMLDivElement>(null);
  const mover = useMemo(() => new GroupMover(session), [session]);
  const grips = useMemo((): GripElements => ({}), []);
  const baseMover = useMemo(() => new BaseMover(session), [session]);
  const baseGrips = useMemo((): GripElements => ({}), []);
  const shapeMover = useMemo(() => new ShapeMover(session), [session]);
  const shapeGrips = useMemo((): GripElements => ({}), []);
  /** The view says itself why it cannot draw; what belongs to a picture goes away. */
  const drawing = useSignal(true);
  const isNarrow = useSignal(narrow());
  const made = useSignal<Viewport | null>(null);

  useEffect(() => {
    if (container.current === null) return undefined;
    const brush = brushPointer(session, () => viewport);
    const viewport: Viewport = new Viewport(container.current, {
      mode: drawnMode(mode.value),
      light: light.value,
      freeRectangle: freeRectangle(null, false),
      label: 'Model and relief',
      onViewpointChange: (camera, at) => {
        atViewpoint.value = at;
        if (followCamera.value && !at) session.setViewpoint(camera, 'viewpoint');
      },
      onStatus: ({ state }) => (drawing.value = state === 'ready'),
      onPointer: (event) => {
        if (session.paint.open.value) brush(event);
        else if (event.kind === 'click' && event.hit?.part === 'original' && mode.value === 'original')
          mover.choose(event.hit.triangle);
      },
      onFrame: () => {
        mover.placeHandles(viewport, grips, areModelsShown(session));
        baseMover.placeHandles(viewport, baseGrips, isBaseShown(session));
        shapeMover.placeHandles(viewport, shapeGrips, isBaseShown(session));
      },
    });
    const lightBall = new LightBall(light.value, (chosen) => {
      light.value = chosen;
      viewport.setLight(chosen);
      inset.redraw();
    });
    ball.current?.append(lightBall.element);
    const inset = new SideInset(viewport);
    side.current?.append(inset.element);
    const stop = [
      effect(() => followOnly(session)),
      effect(() => {
        void [mover.model.value, session.drawnScale.value];
        const there = areModelsShown(session);
        requestAnimationFrame(() => mover.placeHandles(viewport, grips, there));
      }),
      effect(() => {
        void [baseMover.place.value, shapeMover.place.value, session.shown.value];
        const there = isBaseShown(session);
        requestAnimationFrame(() => {
          baseMover.placeHandles(viewport, baseGrips, there);
          shapeMover.placeHandles(viewport, shapeGrips, there);
        });
      }),
      effect(() => {
        const painting = session.paint.open.value;
        session.light.open.value = mode.value === 'light' && !painting;
        session.pieces.open.value = mode.value === 'pieces' && !painting;
        session.squashed.open.value =
          canStandBeside(session) && session.squashed.wanted.value && mode.value === 'swipe';
        if (mode.value === 'pieces' && !session.pieces.possible.value) mode.value = 'relief';
        viewport.setColourMapping(mode.value === 'light' ? brightnessMapping : errorMapping);
        viewport.setMode(painting ? 'original' : drawnMode(mode.value));
      }),
      keepDrawn(viewport, session, (thickness) => inset.update(thickness)),
      keepPainted(viewport, session),
      effect(() => {
        const painting = session.paint.open.value;
        untracked(() => viewport.setFreeRectangle(freeRectangle(foot.current, painting)));
      }),
      effect(() =>
        viewport.setResting(session.previews.running.value || session.activity.value.kind !== 'idle'),
      ),
    ];
    const resize = new ResizeObserver(() => {
      isNarrow.value = narrow();
      viewport.setFreeRectangle(freeRectangle(foot.current, session.paint.open.peek()));
    });
    resize.observe(container.current);
    if (foot.current) resize.observe(foot.current);
    onViewport(viewport);
    made.value = viewport;
    return () => {
      made.value = null;
      session.light.open.value = session.paint.open.value = session.pieces.open.value = false;
      session.squashed.open.value = false;
      onViewport(null);
      resize.disconnect();
      for (const end of stop) end();
      inset.dispose();
      lightBall.dispose();
      viewport.dispose();
    };
  }, []);

  const shown = session.shown.value;
  const offered = modes.filter(({ value }) => value !== 'pieces' || session.pieces.possible.value);
  // Six views fit beside each other on a phone with shorter names only.
  const crowded = offered.length === modes.length;
  const options = offered.map(({ value, label, short }) => ({
    value,
    label: isNarrow.value ? (short ?? (crowded ? label.replace(' difference', '') : label)) : label,
    disabledReason:
      shown === null && value !== 'original' ? 'Available when the first preview is ready' : undefined,
  }));
  return (
    <div class="viewport-panel">
      <div ref={container} class="viewport" />
      {session.paint.open.value && drawing.value ? (
        <PaintTool session={session} viewport={made.value} free={() => freeRectangle(foot.current, true)} />
      ) : session.model.original.value && drawing.value ? (
        <div class="float top-left relief-views">
          <Segmented
            floating
            label="View"
            options={options}
            value={mode.value}
            onChange={(value) => (mode.value = value)}
          />
          <ForestButton session={session} />
        </div>
      ) : null}
      {areModelsShown(session) && drawing.value ? (
        <Handles mover={mover} viewport={() => made.value} elements={grips} />
      ) : null}
      {isBaseShown(session) && drawing.value && baseMover.place.value ? (
        <Handles mover={baseMover} viewport={() => made.value} elements={baseGrips} />
      ) : null}
      {isBaseShown(session) && drawing.value && shapeMover.place.value ? (
        <Handles mover={shapeMover} viewport={() => made.value} elements={shapeGrips} />
      ) : null}
      <div ref={foot} class="float bottom-left foot">
        {mode.value === 'error' && shown && !session.paint.open.value ? (
          <Legend
            mapping={errorMapping}
            values={errorOf(shown.mesh)}
            mean={figure(shown.report, 'normal_error_mean_deg') ?? undefined}
          />
        ) : null}
        {mode.value === 'pieces' ? <PiecesBar pieces={session.pieces} /> : null}
        {mode.value === 'swipe' && canStandBeside(session) ? (
          <BesideChoice squashed={session.squashed} />
        ) : null}
        {session.previews.running.value && session.model.original.value && shown === null ? (
          <p class="label-chip">
            <Icon name="clock" small /> Making the first preview
          </p>
        ) : null}
        {notes}
      </div>
      <div
        ref={ball}
        class="float top-right panel light-panel"
        hidden={session.model.original.value === null || !drawing.value || mode.value === 'light'}
      />
      <div ref={side} class="float bottom-right panel side-inset" hidden={shown === null || !drawing.value} />
      {children}
    </div>
  );
}

/** A squashed model beside the relief: a relief in pieces has none. */
const canStandBeside = ({ shown, paint, pieces }: ReliefSession): boolean =>
  shown.value !== null && !paint.open.value && !pieces.possible.value;

/** Of the same model the last one stays until that of a new relief is made. */
const squashedBeside = ({ shown, squashed: { open, made } }: ReliefSession): SquashedModel | null =>
  open.value && made.value?.of.from === shown.value?.from ? made.value : null;

/** The models of a group, to be moved. */
const areModelsShown = ({ group, paint }: ReliefSession): boolean =>
  group.models.value !== null && mode.value === 'original' && !paint.open.value;

/** The relief on its base, which may be moved. */
const isBaseShown = ({ shown, paint }: ReliefSession): boolean =>
  shown.value !== null && mode.value === 'relief' && !paint.open.value;

/** Light is drawn as values on the relief, pieces in its place. */
const drawnMode = (chosen: ReliefMode): ViewMode =>
  chosen === 'light' ? 'error' : chosen === 'pieces' ? 'relief' : chosen;

/** What floats stays off the object: light and side view right, notes and legends below, paint left. */
function freeRectangle(foot: Element | null, painting: boolean): Insets {
  const height = foot?.getBoundingClientRect().height ?? 0;
  const bottom = height > 0 ? height + 24 : 0;
  return narrow()
    ? { left: 14, top: 70, right: 14, bottom: Math.max(24, bottom) }
    : { left: painting ? 292 : 28, top: 68, right: 180, bottom: Math.max(44, bottom) };
}

/** Draws what the session shows; as little as possible is sent again. */
function keepDrawn(
  viewport: Viewport,
  session: ReliefSession,
  onRelief: (thickness_mm: number) => void,
): () => void {
  let drawnOriginal: { from: string; scale: number } | null = null;
  let drawnSquashed: SquashedModel | null = null;
  let drawnRelief: Drawn = null;
  let drawnModel: string | null = null;
  const draw = () => {
    const original = session.model.original.value;
    const shown = session.shown.value;
    if (original === null) {
      viewport.setOriginal(null);
      viewport.setRelief(null, null);
      viewport.setPartNames(['Original', 'Relief']);
      drawnOriginal = drawnRelief = drawnModel = drawnSquashed = null;
      return;
    }
    const fits = session.showsModel.value;
    const scale = session.drawnScale.value;
    const squashed = fits ? squashedBeside(session) : null;
    if (squashed !== drawnSquashed) viewport.setPartNames([squashed ? 'Squashed' : 'Original', 'Relief']);
    if (squashed) {
      if (squashed !== drawnSquashed) viewport.setOriginal(squashed.mesh);
      drawnOriginal = null;
    } else {
      if (drawnOriginal?.from !== original.from) viewport.setOriginal(originalData(original.mesh, scale));
      else if (drawnOriginal.scale !== scale)
        viewport.rescaleOriginal(scaled(original.mesh.positions, scale));
      drawnOriginal = { from: original.from, scale };
    }
    drawnSquashed = squashed;
    if (shown === null || !fits) {
      if (drawnRelief) viewport.setRelief(null, null);
      drawnRelief = null;
      if (drawnModel !== original.from) viewport.fit(false);
      return;
    }
    const thickness = Number(inForceOf(session, shown, 'thickness_mm'));
    // The light on the relief before stays until the new one is cast.
    const found = mode.value === 'light' ? session.light.lit.value : null;
    const lit = found?.of.from === shown.from ? found : null;
    const made = mode.value === 'pieces' ? session.pieces.made.value : null;
    const pieces = made?.of.from === shown.from ? made : null;
    // Pieces move while they stay the same.
    if (pieces) drawPieces(viewport, pieces, drawnRelief, session.pieces.apart.value);
    else viewport.setMarkers([]);
    if (drawnRelief === (pieces ?? lit ?? shown)) return;
    if (lit) drawLit(viewport, lit, drawnRelief, Number(inForceOf(session, lit.of, 'thickness_mm')));
    else if (!pieces) drawShaded(viewport, shown, drawnRelief, thickness);
    const viewpoint = viewpointOf(shown.report, Number(inForceOf(session, shown, 'field_of_view_deg') ?? 20));
    if (viewpoint) {
      const first = drawnModel !== original.from;
      const stay = first || (viewport.atViewpoint && !followCamera.peek());
      viewport.setViewpoint(viewpoint);
      if (stay) viewport.lookFromViewpoint(false);
      drawnModel = original.from;
    }
    drawnRelief = pieces ?? lit ?? shown;
    onRelief(thickness);
  };
  return effect(draw);
}

type Drawn = Shown | LitRelief | MadePieces | null;

function drawShaded(viewport: Viewport, shown: Shown, before: Drawn, thickness_mm: number): void {
  const plate: Plate | null = plateOf(shown.report, thickness_mm, shown.base);
  const sameTriangles =
    before !== null &&
    'mesh' in before &&
    before.from === shown.from &&
    before.mesh.indices.length === shown.mesh.indices.length;
  if (sameTriangles) {
    viewport.updateRelief(shown.mesh.positions, plate);
    viewport.updateAttribute('relief', errorMapping.attribute, errorOf(shown.mesh));
  } else viewport.setRelief(reliefData(shown.mesh), plate);
}

/** The front of the solid has its plate in itself. */
function drawLit(viewport: Viewport, lit: LitRelief, before: Drawn, thickness_mm: number): void {
  const sameSolid =
    before !== null &&
    'brightness' in before &&
    before.of === lit.of &&
    before.indices.length === lit.indices.length;
  if (sameSolid) {
    viewport.updateAttribute('relief', brightnessMapping.attribute, lit.brightness);
    return;
  }
  const plate = plateOf(lit.of.report, thickness_mm);
  viewport.setRelief(litData(lit), plate && { ...plate, mesh: false });
}

/** They have their plates in themselves. */
function drawPieces(viewport: Viewport, made: MadePieces, before: Drawn, apart: number): void {
  const { mesh, markers } = placed(made.pieces, made.report, apart);
  const plate = plateOf(made.report, 0);
  if (before === made) viewport.updateRelief(mesh.positions);
  else viewport.setRelief(mesh, plate && { ...plate, mesh: false });
  viewport.setMarkers(markers);
}

function inForceOf(session: ReliefSession, shown: Shown, name: string) {
  const schema = session.operation.peek()?.parameters.properties[name];
  return shown.parameters[name] ?? schema?.default ?? null;
}
