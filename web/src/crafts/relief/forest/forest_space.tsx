// SPDX-License-Identifier: GPL-3.0-or-later
// The finished pillars in space, from each eye and from elsewhere.
import { effect, signal, useSignal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import { Button } from '../../../ui';
import { narrow } from '../../../shared/panels/narrow';
import type { Viewpoint as Camera, Vec3 } from '../../../view';
import { Viewport } from '../../../view';
import type { ForestSession } from './forest_session';
import type { Scene, Viewpoint } from './scene';
import { useNarrow } from './use_narrow';
import { colourOf } from './views';

/** The eye looked from; null: somewhere else. */
const eye = signal<number | null>(0);
const up: Vec3 = [0, 0, 1];
/** Of the model's width, that the picture shows. */
const pictureWidth = 1.3;

function cameraOf({ eye_mm, look_at_mm, width_mm }: Viewpoint): Camera {
  const direction = [0, 1, 2].map((k) => (look_at_mm[k] ?? 0) - (eye_mm[k] ?? 0)) as [number, number, number];
  const distanceMm = Math.hypot(...direction);
  const fieldOfViewDeg = (360 / Math.PI) * Math.atan((0.5 * pictureWidth * width_mm) / distanceMm);
  return { projection: 'perspective', direction, up, targetMm: look_at_mm, distanceMm, fieldOfViewDeg };
}

/** Between the first two eyes and from above. */
function elsewhere(scene: Scene): Camera | null {
  const [first, second = first] = scene.viewpoints;
  if (first === undefined || second === undefined) return null;
  const { look_at_mm: at } = first;
  const middle = [0, 1].map((k) => 0.5 * ((first.eye_mm[k] ?? 0) + (second.eye_mm[k] ?? 0)));
  const direction: Vec3 = [at[0] - (middle[0] ?? 0), at[1] - (middle[1] ?? 0), -0.9 * at[2] - 180];
  const distanceMm = Math.hypot(...direction);
  return { projection: 'perspective', direction, up, targetMm: at, distanceMm, fieldOfViewDeg: 40 };
}

export function ForestSpace({ session }: { session: ForestSession }) {
  const container = useRef<HTMLDivElement>(null);
  const viewport = useSignal<Viewport | null>(null);
  const drawing = useSignal(true);
  const isNarrow = useNarrow();
  useEffect(() => {
    if (container.current === null) return undefined;
    const made = new Viewport(container.current, {
      mode: 'original',
      freeRectangle: narrow()
        ? { left: 10, top: 124, right: 10, bottom: 20 }
        : { left: 24, top: 108, right: 24, bottom: 40 },
      label: 'The pillars in space',
      partNames: ['Forest', ''],
      uprightTurn: true,
      dimensions: false,
      ground: true,
      // From near the viewer: shadows of pillars before it would lie on what is looked at.
      light: { azimuthDeg: 135, elevationDeg: 72, follows: 'camera' },
      onViewpointChange: (_, at) => {
        if (!at) eye.value = null;
      },
      onStatus: ({ state }) => (drawing.value = state === 'ready'),
    });
    viewport.value = made;
    const stop = effect(() => {
      const solid = session.solid.value;
      made.setOriginal(solid?.mesh ?? null);
      const scene = session.shownScene.value;
      if (solid && scene) look(made, scene, eye.peek(), false);
    });
    return () => {
      stop();
      viewport.value = null;
      made.dispose();
    };
  }, [session]);
  const scene = session.shownScene.value;
  return (
    <div class="viewport-panel">
      <div ref={container} class="viewport" />
      {scene && drawing.value ? (
        <div class="float forest-eyes" role="group" aria-label="Where to look from">
          {scene.viewpoints.map((_, v) => (
            <button
              key={v}
              type="button"
              aria-pressed={eye.value === v}
              onClick={() => viewport.value && look(viewport.value, scene, v, true)}
            >
              <i class="number-disc" style={{ background: colourOf(v) }} aria-hidden="true">
                {v + 1}
              </i>
              {isNarrow ? <span class="hidden-text">From viewpoint {v + 1}</span> : `From viewpoint ${v + 1}`}
            </button>
          ))}
          <Button size="small" onClick={() => viewport.value && look(viewport.value, scene, null, true)}>
            From elsewhere
          </Button>
        </div>
      ) : null}
    </div>
  );
}

function look(viewport: Viewport, scene: Scene, from: number | null, animated: boolean): void {
  const viewpoint = from === null ? undefined : scene.viewpoints[from];
  const camera = viewpoint ? cameraOf(viewpoint) : elsewhere(scene);
  if (camera === null) return;
  viewport.setViewpoint(camera);
  viewport.lookFromViewpoint(animated);
  eye.value = viewpoint ? from : null;
}
