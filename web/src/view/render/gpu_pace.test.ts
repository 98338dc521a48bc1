// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import { GpuPace } from './gpu_pace';

it('what was marked on a context that was lost does not hold up the next', () => {
  let answer: number | null = 0; // not done
  const gl = {
    SIGNALED: 1,
    fenceSync: () => ({}),
    flush: () => undefined,
    deleteSync: () => undefined,
    isContextLost: () => false,
    getSyncParameter: () => answer,
  };
  const pace = new GpuPace(gl as unknown as WebGL2RenderingContext);
  pace.mark();
  expect(pace.busy).toBe(true);
  answer = null; // restored: the fence belongs to nothing any more
  expect(pace.busy).toBe(true);
  pace.forget();
  expect(pace.busy).toBe(false);
  pace.mark();
  answer = 1;
  expect(pace.busy).toBe(false);
});
