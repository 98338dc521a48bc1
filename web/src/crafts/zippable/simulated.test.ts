// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import type { Film } from '../../jobs/glb';
import { frameAt } from './simulated';

it('is a frame at its share, and between two frames their blend', () => {
  const frames = [
    [0, 0, 0],
    [1, 2, 3],
    [3, 2, 1],
  ].map((frame) => Float32Array.from(frame));
  const film = { frames } as unknown as Film;
  expect([...frameAt(film, 0)]).toEqual([0, 0, 0]);
  expect([...frameAt(film, 0.5)]).toEqual([1, 2, 3]);
  expect([...frameAt(film, 0.75)]).toEqual([2, 2, 2]);
  expect(frameAt(film, 2)).toBe(frames[2]);
  expect(frameAt({ ...film, frames: [] }, 1)).toHaveLength(0);
});
