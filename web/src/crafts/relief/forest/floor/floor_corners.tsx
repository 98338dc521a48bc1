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
  const change = (edit: (one: Pillar) => Pillar, label: string, coalesce?: string) =>
    session.change((scene) => changePillar(scene, index, edit), label, coalesce);
  const what = { kind: 'pillar', index } as const;
  return (
    <>
      {corners.map((_, k) => (
        <AddCorner
          key={`side ${k}`}
          place={middleOfSide(corners, k)}
          mm={mm}
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
          <circle class="reach" r={11 * mm} />
          <circle class="dot" r={4.5 * mm} stroke-width={1.5 * mm} />
        </Handle>
      ))}
    </>
  );
}

interface AddCornerProps {
  readonly place: Place;
  readonly mm: number;
  readonly label: string;
  readonly onAdd: () => void;
}

function AddCorner({ place, mm, label, onAdd }: AddCornerProps) {
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
      <circle class="reach" r={7 * mm} />
      <circle class="dot" r={2.5 * mm} stroke-width={1 * mm} />
    </g>
  );
}
