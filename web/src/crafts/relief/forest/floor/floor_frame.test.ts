// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import { frameOf, markOf } from './floor_frame';
import type { Viewpoint } from '../scene';

const viewpoint: Viewpoint = { eye_mm: [0, -600, 60], look_at_mm: [0, 0, 60], width_mm: 70 };
const pillars = [
  { shape: 'round', x_mm: 100, y_mm: 30, width_mm: 12, height_mm: 100 },
  { shape: 'round', x_mm: -100, y_mm: -50, width_mm: 12, height_mm: 100 },
] as const;
const scene = { viewpoints: [viewpoint], pillars };

it('the frame holds pillars and what is looked at, and the eyes where they are asked for', () => {
  expect(frameOf(scene, false)).toEqual({ left: -160, top: -80, width: 320, height: 160 });
  const whole = frameOf(scene, true);
  expect(whole.top + whole.height).toBeGreaterThan(600);
  expect(frameOf({ viewpoints: [], pillars: [] }, true)).toMatchObject({ width: 160, height: 160 });
});

it('an eye beyond the frame is marked where its line of sight enters', () => {
  const frame = frameOf(scene, false);
  expect(markOf(viewpoint, frame, 10)).toEqual({ place: [0, -70], beyond: true });
  expect(markOf(viewpoint, frameOf(scene, true), 10)).toEqual({ place: [0, -600], beyond: false });
});
