// SPDX-License-Identifier: GPL-3.0-or-later
// The corners of the chosen pillar's own outline, to be dragged, added and taken away.
import type { Pillar, Place } from '../scene';
import { addedCorner, changePillar, cornersOf, middleOfSide, movedCorner, removedCorner } from '../scene';
import { placeWords } from '../views';
import type { Shared } from './floor_handles';
import { Handle } from './floor_handles';

interface CornersProps extends Shared {
  readonly pillar: Pillar;
  readonly index: number;
}

export function PillarCorners({ pillar, index, ...shared }: CornersProps) {
  const { session, mm } = shared;
  const corners = cornersOf(pillar);
  // Small pillars have small handles, so that none covers the next.
  const shortest = Math.min(
    ...corners.map(([x, y], k) => {
      const [a, b] = corners[(k + 1) % corners.length] ?? [x, y];
      return Math.hypot(a - x, b - y);
    }),
  );
  const size = (most: number, share: number) => Math.min(most * mm, share * shortest);
  const change = (edit: (one: Pillar) => Pillar, label: string, coalesce?: string) =>
    session.change((scene) => changePillar(scene, index, edit), label, coalesce);
  const what = { kind: 'pillar', index } as const;
  return (
    <>
      {corners.map((_, k) => (
        <AddCorner
          key={`side ${k}`}
          place={middleOfSide(corners, k)}
          size={size}
          label={`Pillar ${index + 1}, add a corner between ${k + 1} and ${((k + 1) % corners.length) + 1}`}
          onAdd={() => change((one) => addedCorner(one, k), `Add a corner to pillar ${index + 1}`)}
        />
      ))}
      {corners.map((place, k) => (
        <Handle
          key={`corner ${k}`}
          {...shared}
          what={what}
          name={`Pillar ${index + 1}`}
          label={`corner ${k + 1}, at ${placeWords(place)}`}
          class="corner"
          place={place}
          inTabOrder
          onMove={(to) =>
            change(
              (one) => movedCorner(one, k, to),
              `Move a corner of pillar ${index + 1}`,
              `corner ${index} ${k}`,
            )
          }
          onRemove={() => change((one) => removedCorner(one, k), `Take a corner from pillar ${index + 1}`)}
        >
          <circle class="reach" r={size(11, 0.35)} />
          <circle class="dot" r={size(4.5, 0.2)} stroke-width={size(1.5, 0.1)} />
        </Handle>
      ))}
    </>
  );
}

interface AddCornerProps {
  readonly place: Place;
  /** At most so many pixels, and this share of the shortest side. */
  readonly size: (most: number, share: number) => number;
  readonly label: string;
  readonly onAdd: () => void;
}

function AddCorner({ place, size, label, onAdd }: AddCornerProps) {
  return (
    <g
      class="handle add-corner"
      role="button"
      tabindex={0}
      aria-label={label}
      transform={`translate(${place[0]} ${-place[1]})`}
      onClick={onAdd}
      onKeyDown={(event) => {
        if (event.key !== 'Enter' && event.key !== ' ') return;
        event.preventDefault();
        onAdd();
      }}
    >
      <circle class="reach" r={size(7, 0.15)} />
      <circle class="dot" r={size(2.5, 0.08)} stroke-width={size(1, 0.05)} />
    </g>
  );
}
