// SPDX-License-Identifier: GPL-3.0-or-later
// The viewport with what floats over it: views, legend, timeline, notes, the handle that moves the model.
import { effect, useSignal } from '@preact/signals';
import type { ComponentChildren } from 'preact';
import { useEffect, useMemo, useRef } from 'preact/hooks';
import { Icon, IconButton, Segmented } from '../../ui';
import type { Insets, Viewpoint } from '../../view';
import { Viewport } from '../../view';
import { Legend } from '../../shared/panels/legend';
import { narrow } from '../../shared/panels/narrow';
import { figure } from '../../shared/session/report';
import { keepDrawn, thicknessOf } from './draw_scene';
import { watchExtras } from './extras';
import { MoveHandle } from './move_handle';
import { ModelMover } from './move_model';
import { besideModel } from './stand/clear_of_model';
import { FaceList } from './stand/face_list';
import { FaceOverlay } from './stand/face_overlay';
import type { FaceTool } from './stand/face_tool';
import type { TurnHandlesProps } from './stand/turn_handles';
import { keepRingDrawn, placeTurnHandles, TurnHandles } from './stand/turn_handles';
import { ModelTurner } from './stand/turn_model';
import type { ThermoformSession } from './thermoform_session';
import { Timeline } from './timeline';
import { dragging, mappingOf, offeredViews, swiping, view } from './views';

/** From the front, a little from the right, and from above, as one stands before the machine. */
const viewpoint: Viewpoint = {
  projection: 'perspective',
  direction: [0.14, 0.95, -0.98],
  up: [0, 0, 1],
  targetMm: [0, 0, 0],
  distanceMm: 900,
  fieldOfViewDeg: 20,
};

export interface ViewportPanelProps {
  readonly session: ThermoformSession;
  readonly tool: FaceTool;
  /** Given the viewport once it exists, null when it goes. */
  readonly onViewport: (viewport: Viewport | null) => void;
  /** At the foot, off the object. */
  readonly notes: ComponentChildren;
  readonly children?: ComponentChildren;
}

export function ViewportPanel({ session, tool, onViewport, notes, children }: ViewportPanelProps) {
  const container = useRef<HTMLDivElement>(null);
  const foot = useRef<HTMLDivElement>(null);
  const list = useRef<HTMLDivElement>(null);
  const handle = useRef<HTMLButtonElement>(null);
  const viewport = useRef<Viewport | null>(null);
  const mover = useMemo(() => new ModelMover(session), [session]);
  const turner = useMemo(() => new ModelTurner(session), [session]);
  const turnHandles = useMemo((): TurnHandlesProps['elements'] => ({}), []);
  const watched = useMemo(() => watchExtras(session), [session]);
  const drawing = useSignal(true);

  useEffect(() => {
    if (container.current === null) return undefined;
    const canvasPlace = (event: PointerEvent): [number, number] => {
      const box = made.canvas.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    const drag = (event: PointerEvent) => mover.drag(made, ...canvasPlace(event));
    const made = new Viewport(container.current, {
      mode: 'relief',
      freeRectangle: freeRectangle(null),
      label: 'Model, clamp and sheet',
      partNames: ['Model', 'Sheet'],
      uprightTurn: true,
      dimensions: false,
      onPointer: ({ kind, hit, button, shiftKey, capture }) => {
        if (tool.sides.peek() !== null) return; // a press turns the view or takes a face
        if (kind === 'move' && !mover.holding)
          made.canvas.style.cursor = hit && mover.holds(hit.positionMm[2]) ? 'move' : '';
        if (kind === 'down' && hit && button === 0 && !shiftKey && mover.holds(hit.positionMm[2])) {
          capture();
          mover.begin(made, hit.xPx, hit.yPx, hit.positionMm[2]);
          window.addEventListener('pointermove', drag);
        }
        if (kind === 'up') {
          window.removeEventListener('pointermove', drag);
          mover.end();
        }
      },
      onFrame: () => {
        const there = canBeMoved(session) && tool.sides.peek() === null;
        placeHandle(made, turner, handle.current, there);
        placeTurnHandles(made, turner, turnHandles, there);
        faces.place();
      },
      onStatus: ({ state }) => (drawing.value = state === 'ready'),
    });
    made.setViewpoint(viewpoint);
    made.lookFromViewpoint(false);
    viewport.current = made;
    const faces = new FaceOverlay(session, tool, made);
    // While the model is in hand the picture stays as it is, whatever notes come and go.
    const makeRoom = () => {
      const besides = tool.sides.value === null ? null : list.current;
      if (!dragging.peek()) made.setFreeRectangle(freeRectangle(foot.current, besides));
    };
    const stop = [
      keepDrawn(
        made,
        session,
        () => watched.extras.value,
        () => tool.sides.value !== null,
      ),
      keepRingDrawn(made, turner),
      effect(() => faces.mark()),
      () => faces.dispose(),
      effect(() => {
        if (!dragging.value) makeRoom();
      }),
      effect(() => made.setResting(session.previews.running.value || session.activity.value.kind !== 'idle')),
    ];
    const resize = new ResizeObserver(makeRoom);
    resize.observe(container.current);
    if (foot.current) resize.observe(foot.current);
    onViewport(made);
    return () => {
      onViewport(null);
      viewport.current = null;
      window.removeEventListener('pointermove', drag);
      resize.disconnect();
      for (const end of stop) end();
      made.dispose();
    };
  }, [session]);
  useEffect(() => () => watched.dispose(), [watched]);

  const shown = session.shown.value;
  const choosing = tool.sides.value !== null;
  const visible = drawing.value && session.model.original.value !== null;
  return (
    <div class="viewport-panel">
      <div ref={container} class="viewport" />
      {visible && shown && !choosing ? (
        <div class="float top-left row">
          <Segmented
            floating
            label="View"
            options={offeredViews(session)}
            value={view.value}
            onChange={(value) => (view.value = value)}
          />
          <span class="floating-button">
            <IconButton
              icon="swap"
              label={swiping.value ? 'Show the sheet alone' : 'Swipe between model and sheet'}
              keys="S"
              pressed={swiping.value}
              onClick={() => (swiping.value = !swiping.value)}
            />
          </span>
        </div>
      ) : null}
      <div ref={list}>
        <FaceList session={session} tool={tool} />
      </div>
      {visible && !choosing ? (
        <SidePanel session={session} url={watched.extras.value.printed?.url ?? null} />
      ) : null}
      <div ref={foot} class="float bottom-left foot wide">
        {session.previews.running.value && session.model.original.value && shown === null ? (
          <p class="label-chip">
            <Icon name="clock" small /> Making the first preview
          </p>
        ) : null}
        {choosing ? null : notes}
        {visible && !choosing && view.value !== 'undercut' ? <Timeline session={session} /> : null}
      </div>
      <MoveHandle session={session} mover={mover} viewport={() => viewport.current} element={handle} />
      <TurnHandles
        session={session}
        turner={turner}
        viewport={() => viewport.current}
        elements={turnHandles}
      />
      {children}
    </div>
  );
}

/** Top right: the scale of the colours, or the print. */
function SidePanel({ session, url }: { session: ThermoformSession; url: string | null }) {
  const shown = session.shown.value;
  const mapping = shown && mappingOf(view.value, shown, thicknessOf(session, shown));
  if (shown === null) return null;
  if (view.value === 'texture' && url)
    return (
      <figure class="float top-right panel print-panel">
        <img src={url} alt="The print, distorted so that it fits after forming" />
        <figcaption>Print, before forming</figcaption>
      </figure>
    );
  const values = mapping && shown.sheet.attributes[mapping.attribute];
  return mapping && (values || view.value === 'undercut') ? (
    <div class="float top-right">
      <Legend
        mapping={mapping}
        values={values ?? new Float32Array(0)}
        least={figure(shown.report, 'thickness_min_mm') ?? undefined}
      />
    </div>
  ) : null;
}

/** While the platform is up and the model on it. */
function canBeMoved(session: ThermoformSession): boolean {
  return session.moment.peek()?.platform_z_mm === 0;
}

/** In front of the model's foot, where there is one to move. */
function placeHandle(
  viewport: Viewport,
  turner: ModelTurner,
  element: HTMLElement | null,
  there: boolean,
): void {
  if (element === null) return;
  const box = there ? turner.box.peek() : null;
  const at = box && viewport.project([(box.low[0] + box.high[0]) / 2, box.low[1] - 14, 2]);
  element.hidden = !at || turner.holding;
  if (box && at) {
    const { xPx, yPx } = besideModel(viewport, box, at);
    element.style.translate = `${xPx.toFixed(1)}px ${yPx.toFixed(1)}px`;
  }
}

/** What floats stays off the object: at the foot, and the list of faces at the right or, on a phone, at the foot. */
function freeRectangle(foot: Element | null, list: Element | null = null): Insets {
  const floating = list?.firstElementChild?.getBoundingClientRect();
  const height = Math.max(foot?.getBoundingClientRect().height ?? 0, narrow() ? (floating?.height ?? 0) : 0);
  const bottom = height > 0 ? height + 20 : 24;
  if (narrow()) return { left: 10, top: floating ? 10 : 64, right: 10, bottom };
  return { left: 24, top: 88, right: floating ? floating.width + 36 : 24, bottom };
}
