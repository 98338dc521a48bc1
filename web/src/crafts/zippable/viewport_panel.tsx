// SPDX-License-Identifier: GPL-3.0-or-later
// The model with the zipper's course, or the ribbon in space; what floats over them.
import { effect, untracked, useSignal } from '@preact/signals';
import type { ComponentChildren } from 'preact';
import { useEffect, useMemo, useRef } from 'preact/hooks';
import { Icon, Segmented } from '../../ui';
import type { Insets, Viewpoint } from '../../view';
import { Viewport } from '../../view';
import { Legend } from '../../shared/panels/legend';
import { narrow } from '../../shared/panels/narrow';
import { figure } from '../../shared/session/report';
import { fromShown, place as drawAt, tool } from './drawing/draw_actions';
import { bentPositions, keepDrawn } from './drawing/draw_scene';
import { DrawTool } from './drawing/draw_tool';
import { ringPointer } from './drawing/ring';
import { Play } from './ribbon/play';
import { alongAt, placeInSpace } from './ribbon/ribbon_places';
import {
  bend,
  cameraMoves,
  distortionMapping,
  playing,
  pointed,
  themeChanges,
  view,
  viewNames,
} from './views';
import type { ZippableSession } from './zippable_session';

/** From the front, a little from the right and from above; the samples stand on y. */
export const viewpoint: Viewpoint = {
  projection: 'perspective',
  direction: [-0.35, -0.3, -1],
  up: [0, 1, 0],
  targetMm: [0, 0, 0],
  distanceMm: 900,
  fieldOfViewDeg: 20,
};

export interface ViewportPanelProps {
  readonly session: ZippableSession;
  /** Given the viewport once it exists, null when it goes. */
  readonly onViewport: (viewport: Viewport | null) => void;
  /** At the foot, off the object. */
  readonly notes: ComponentChildren;
  readonly children?: ComponentChildren;
}

export function ViewportPanel({ session, onViewport, notes, children }: ViewportPanelProps) {
  const container = useRef<HTMLDivElement>(null);
  const foot = useRef<HTMLDivElement>(null);
  const viewport = useRef<Viewport | null>(null);
  const drawing = useSignal(true);

  useEffect(() => {
    if (container.current === null) return undefined;
    const made = new Viewport(container.current, {
      mode: 'original',
      freeRectangle: freeRectangle(null),
      label: 'Model with the line of the zipper',
      partNames: ['Model', 'Ribbon'],
      uprightTurn: true,
      dimensions: false,
      ground: true,
      onViewpointChange: () => ++cameraMoves.value,
      onPointer: (event) => {
        const { kind, hit } = event;
        if (tool.peek() === 'ring') ringPointer(session, made, event);
        else if (kind === 'click' && hit && tool.peek())
          void drawAt(session, fromShown(session, hit.positionMm));
        if (kind !== 'move' && kind !== 'leave') return;
        const shown = session.shown.peek();
        if (shown === null || hit === null || kind === 'leave' || playing.peek()) {
          pointed.value = null;
          return;
        }
        const bent = view.peek() === 'ribbon' ? bentPositions(session, shown, bend.peek()) : undefined;
        const place = placeInSpace(shown.design.ribbon, hit.positionMm, bent);
        pointed.value = place && { places: [place], along_mm: alongAt(shown.design, place) };
      },
      onStatus: ({ state }) => (drawing.value = state === 'ready'),
    });
    made.setViewpoint(viewpoint);
    made.lookFromViewpoint(false);
    viewport.current = made;
    const makeRoom = () => {
      made.setFreeRectangle(freeRectangle(foot.current));
      ++cameraMoves.value;
    };
    const stop = [
      keepDrawn(made, session),
      effect(() => {
        void tool.value;
        untracked(makeRoom);
      }),
      effect(() => made.setResting(session.previews.running.value || session.activity.value.kind !== 'idle')),
    ];
    const resize = new ResizeObserver(makeRoom);
    resize.observe(container.current);
    if (foot.current) resize.observe(foot.current);
    const theme = new MutationObserver(() => ++themeChanges.value);
    theme.observe(document.documentElement, { attributes: true, attributeFilter: ['data-theme'] });
    onViewport(made);
    return () => {
      onViewport(null);
      viewport.current = null;
      pointed.value = null;
      resize.disconnect();
      theme.disconnect();
      for (const end of stop) end();
      made.dispose();
    };
  }, [session]);

  const shown = session.shown.value;
  const visible = drawing.value && session.model.original.value !== null;
  return (
    <div class="viewport-panel">
      <div ref={container} class="viewport" />
      {visible && tool.value ? <DrawTool session={session} viewport={viewport.current} /> : null}
      {visible && shown && tool.value === null ? (
        <div class="float top-left">
          <Segmented
            floating
            label="View"
            options={viewNames}
            value={view.value}
            onChange={(value) => (view.value = value)}
          />
        </div>
      ) : null}
      <div ref={foot} class="float bottom-left foot wide">
        {session.previews.running.value && session.model.original.value && shown === null ? (
          <p class="label-chip">
            <Icon name="clock" small /> Making the first ribbon
          </p>
        ) : null}
        {notes}
        {visible && shown && view.value === 'distortion' ? <DistortionLegend session={session} /> : null}
        {visible && shown && view.value === 'ribbon' ? (
          <Play session={session} onFit={() => viewport.current?.fit(false)} />
        ) : null}
      </div>
      {children}
    </div>
  );
}

function DistortionLegend({ session }: { session: ZippableSession }) {
  const shown = session.shown.value;
  const mapping = useMemo(() => shown && distortionMapping(shown), [shown]);
  const values = shown?.model.mesh.attributes['distortion'];
  if (shown === null || mapping === null || values === undefined) return null;
  const mean = figure(shown.report, 'distortion_mean') ?? undefined;
  return <Legend mapping={mapping} values={values} mean={mean} />;
}

/** What floats stays off the object. */
function freeRectangle(foot: Element | null): Insets {
  const height = foot?.getBoundingClientRect().height ?? 0;
  const bottom = height > 0 ? height + 20 : 24;
  const tools = tool.peek() ? 90 : 0;
  return narrow()
    ? { left: 10, top: 60 + tools, right: 10, bottom }
    : { left: 24, top: 64 + tools, right: 24, bottom };
}
