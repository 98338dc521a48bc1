// SPDX-License-Identifier: GPL-3.0-or-later
// The model in the colours of what is painted on it, and the pointer as a brush, while the tool is open.
import { effect, signal, untracked } from '@preact/signals';
import { originalData } from '../../../shared/panels/shaded_mesh';
import type { ViewPointerEvent, Viewport } from '../../../view';
import type { ReliefSession } from '../relief_session';
import type { PaintKind } from './painted_values';
import { kindAt } from './painted_values';

/** Tokens of the style sheet; each stands beside its name wherever it is seen. */
export const kindColours: Readonly<Record<PaintKind, string>> = {
  more: '--seg-b',
  less: '--seg-h',
  free: '--seg-e',
  on_base: '--seg-c',
  own_thickness: '--seg-d',
};
const plaster = [0.83, 0.81, 0.78] as const;
const strength = 0.85;

type Colour = readonly [number, number, number];
const black: Colour = [0, 0, 0];

function colourOf(token: string): Colour {
  const text = getComputedStyle(document.documentElement).getPropertyValue(token).trim();
  const number = parseInt(/^#([0-9a-f]{6})$/i.exec(text)?.[1] ?? '808080', 16);
  return [(number >> 16) / 255, ((number >> 8) & 255) / 255, (number & 255) / 255];
}

const themeChanges = signal(0);

/** sRGB per vertex, 0..1. */
function coloursNow(session: ReliefSession): Float32Array | null {
  void themeChanges.value;
  const painted = session.paint.painted.value?.values;
  const original = session.model.original.value;
  if (!painted || !original || painted.region.length * 3 !== original.mesh.positions.length) return null;
  const own = original.mesh.colours;
  const colours = new Map<PaintKind, Colour>(
    Object.entries(kindColours).map(([kind, token]) => [kind as PaintKind, colourOf(token)]),
  );
  const result = new Float32Array(3 * painted.region.length);
  for (let v = 0; v < painted.region.length; ++v) {
    const kind = kindAt(painted, v);
    const paint = kind === null ? black : (colours.get(kind) ?? black);
    const share = kind === null ? 0 : strength;
    for (let k = 0; k < 3; ++k) {
      const below = own?.[3 * v + k] ?? plaster[k as 0] ?? 0;
      result[3 * v + k] = share * (paint[k as 0] ?? 0) + (1 - share) * below;
    }
  }
  return result;
}

/** To be begun after what draws the model without paint. */
export function keepPainted(viewport: Viewport, session: ReliefSession): () => void {
  let drawn: string | null = null;
  const stop = effect(() => {
    const original = session.model.original.value;
    const colours = session.paint.open.value ? coloursNow(session) : null;
    untracked(() => {
      if (original === null) {
        drawn = null;
        return;
      }
      const bare = () => originalData(original.mesh, session.drawnScale.peek());
      if (colours === null) {
        if (drawn === original.from) viewport.setOriginal(bare());
        drawn = null;
      } else if (drawn === original.from) viewport.updateColours('original', colours);
      else {
        viewport.setOriginal({ ...bare(), colours });
        drawn = original.from;
      }
    });
  });
  const theme = new MutationObserver(() => ++themeChanges.value);
  theme.observe(document.documentElement, { attributes: true, attributeFilter: ['data-theme'] });
  return () => {
    theme.disconnect();
    stop();
  };
}

/** Dabs along the way of a fast hand lie so far apart, px. */
const dabs_px = 6;
const max_dabs = 40;

/** What the pointer does with the brush. The camera keeps still while it is on the model, and while nobody knows yet
 *  whether it is: then the stroke begins where the model is first found under it. */
export function brushPointer(
  session: ReliefSession,
  view: () => Pick<Viewport, 'pick' | 'preparingPick'>,
): (event: ViewPointerEvent) => void {
  let last: { readonly xPx: number; readonly yPx: number } | null = null;
  let down = false;
  return ({ kind, hit, button, shiftKey, capture }) => {
    const { paint } = session;
    const here = hit?.part === 'original' || (hit === null && view().preparingPick);
    if (kind === 'down' && paint.open.peek() && here && button === 0 && !shiftKey) {
      capture();
      down = true;
      last = hit;
      if (hit) paint.dab(hit);
    } else if (kind === 'move' && down) {
      if (hit && last) {
        const way = Math.hypot(hit.xPx - last.xPx, hit.yPx - last.yPx);
        const steps = Math.min(max_dabs, Math.max(1, Math.ceil(way / dabs_px)));
        for (let i = 1; i < steps; ++i) {
          const share = i / steps;
          const between = view().pick(
            last.xPx + share * (hit.xPx - last.xPx),
            last.yPx + share * (hit.yPx - last.yPx),
          );
          if (between) paint.dab(between);
        }
        paint.dab(hit);
      }
      last = hit;
    } else if (kind === 'up' && down) {
      down = false;
      last = null;
      void paint.endStroke();
    }
  };
}
