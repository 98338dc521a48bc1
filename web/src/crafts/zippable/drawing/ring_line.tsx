// SPDX-License-Identifier: GPL-3.0-or-later
// The line that is being dragged across a limb. While it is there the pointer is a cross.
import { useEffect } from 'preact/hooks';
import { noRing, ringLine } from './ring';

export function RingLine() {
  // Another tool begins without what was left of this one.
  useEffect(
    () => () => {
      ringLine.value = noRing.value = null;
    },
    [],
  );
  const line = ringLine.value;
  const ends = line && { x1: line.from[0], y1: line.from[1], x2: line.to[0], y2: line.to[1] };
  return (
    <svg class="ring-line" aria-hidden="true">
      {ends ? (
        <>
          <line {...ends} />
          <line {...ends} />
        </>
      ) : null}
    </svg>
  );
}
