// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import { servesMeanwhile } from './draw_scene';
import type { Formed } from './thermoform_session';

const formed = (kind: 'preview' | 'full', from: string, vertices: number): Formed =>
  ({ kind, from, sheet: { positions: new Float32Array(3 * vertices) } }) as unknown as Formed;
const printedOn = (of: Formed) => ({ of }) as unknown as Parameters<typeof servesMeanwhile>[0];

it('a picture stays on the sheet while a slider moves, not on another model, other triangles or a full result', () => {
  const printed = printedOn(formed('preview', 'cat', 8));
  expect(servesMeanwhile(printed, formed('preview', 'cat', 8))).toBe(true);
  expect(servesMeanwhile(printedOn(formed('full', 'cat', 8)), formed('preview', 'cat', 8))).toBe(true);
  expect(servesMeanwhile(printed, formed('preview', 'fish', 8))).toBe(false);
  expect(servesMeanwhile(printed, formed('preview', 'cat', 9))).toBe(false);
  expect(servesMeanwhile(printed, formed('full', 'cat', 8))).toBe(false);
  expect(servesMeanwhile(null, formed('preview', 'cat', 8))).toBe(false);
});
