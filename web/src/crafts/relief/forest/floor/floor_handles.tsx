// SPDX-License-Identifier: GPL-3.0-or-later
// What can be taken hold of in the floor plan: pillars, eyes and the places looked at.
import type { ComponentChildren } from 'preact';
import { useRef } from 'preact/hooks';
import type { EyeMark } from './floor_frame';
import type { ForestSession } from '../forest_session';
import type { Chosen, End, Pillar, Place, Scene, Viewpoint } from '../scene';
import {
  changePillar,
  changeViewpoint,
  isShaped,
  movedEnd,
  movedPillar,
  placeOf,
  removePillar,
  removeViewpoint,
  turnedTo,
  widthOf,
} from '../scene';
import { colourOf, isChosen, modelName, placeWords, shapeName } from '../views';

/** What is said of how they are moved. */
export const helpId = 'forest-plan-help';

export interface Shared {
  readonly session: ForestSession;
  readonly scene: Scene;
  /** Millimetres a pixel. */
  readonly mm: number;
  readonly placeAt: (event: PointerEvent) => Place;
  readonly onHold: (hold: boolean) => void;
}

export interface HandleProps extends Shared {
  readonly what: Chosen;
  readonly name: string;
  readonly label: string;
  readonly class: string;
  readonly place: Place;
  /** Reached with Tab; the others with page up and page down. */
  readonly inTabOrder: boolean;
  readonly onGrip?: () => void;
  readonly onMove: (to: Place, dragged: boolean) => void;
  readonly onRemove: () => void;
  readonly children: ComponentChildren;
}

const steps: Readonly<Record<string, Place>> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};

/** Dragging, or holding a key, is one step to undo. */
export function Handle(props: HandleProps) {
  const { session, what, place, onMove } = props;
  const grip = useRef<Place | null>(null);
  const choose = () => (session.chosen.value = what);
  const key = (event: KeyboardEvent) => {
    const step = steps[event.key];
    if (step) {
      const by = event.shiftKey ? 10 : 1;
      onMove([place[0] + by * step[0], place[1] + by * step[1]], false);
    } else if (event.key === 'Delete' || event.key === 'Backspace') props.onRemove();
    else if (event.key === 'Enter' || event.key === ' ') choose();
    else if (event.key === 'PageDown' || event.key === 'PageUp')
      goTo(event, event.key === 'PageDown' ? 1 : -1);
    else return;
    event.preventDefault();
  };
  return (
    <g
      class={`handle ${props.class}`}
      role="button"
      tabindex={props.inTabOrder ? 0 : -1}
      aria-label={`${props.name}, ${props.label}`}
      aria-describedby={helpId}
      aria-pressed={isChosen(session.chosen.value, what.kind, what.index)}
      transform={`translate(${place[0]} ${-place[1]})`}
      onFocus={choose}
      onPointerDown={(event) => {
        if (event.button !== 0) return;
        event.currentTarget.setPointerCapture(event.pointerId);
        const [x, y] = props.placeAt(event);
        grip.current = [place[0] - x, place[1] - y];
        choose();
        props.onGrip?.();
        props.onHold(true);
      }}
      onPointerMove={(event) => {
        if (grip.current === null || !event.currentTarget.hasPointerCapture(event.pointerId)) return;
        const [x, y] = props.placeAt(event);
        onMove([x + grip.current[0], y + grip.current[1]], true);
      }}
      onLostPointerCapture={() => {
        grip.current = null;
        props.onHold(false);
        session.commit();
      }}
      onKeyDown={key}
      onKeyUp={({ key: name }) => {
        if (name in steps) session.commit();
      }}
    >
      {props.children}
    </g>
  );
}

/** Another handle of the same kind gets the focus. */
function goTo(event: KeyboardEvent, by: number): void {
  const own = event.currentTarget as SVGElement;
  const kind = own.classList.contains('pillar') ? '.handle.pillar' : '.handle:not(.pillar)';
  const all = [...(own.ownerSVGElement?.querySelectorAll<SVGElement>(kind) ?? [])];
  all[(all.indexOf(own) + by + all.length) % all.length]?.focus();
}

interface PillarProps extends Shared {
  readonly pillar: Pillar;
  readonly index: number;
}

export function PillarHandle({ pillar, index, ...shared }: PillarProps) {
  const { session, mm } = shared;
  const place = placeOf(pillar);
  const name = `Pillar ${index + 1}`;
  const width = widthOf(pillar);
  const chosen = session.chosen.value;
  const roving = chosen?.kind === 'pillar' ? chosen.index === index : index === 0;
  return (
    <Handle
      {...shared}
      what={{ kind: 'pillar', index }}
      name={name}
      label={`${shapeName(pillar).toLowerCase()}, at ${placeWords(place)}`}
      class={isChosen(chosen, 'pillar', index) ? 'pillar chosen' : 'pillar'}
      place={place}
      inTabOrder={roving}
      onMove={(to) =>
        session.change(
          (scene) => changePillar(scene, index, (one) => movedPillar(one, to)),
          `Move pillar ${index + 1}`,
          `pillar ${index}`,
        )
      }
      onRemove={() => {
        session.change((scene) => removePillar(scene, index), `Delete pillar ${index + 1}`);
        session.chosen.value = null;
      }}
    >
      <circle class="reach" r={Math.max(0.5 * width, 11 * mm)} />
      <Outline pillar={pillar} place={place} mm={mm} />
      {width > 15 * mm ? (
        <text font-size={Math.min(11 * mm, 0.6 * width)} dy="0.36em">
          {index + 1}
        </text>
      ) : null}
    </Handle>
  );
}

function Outline({ pillar, place, mm }: { pillar: Pillar; place: Place; mm: number }) {
  const line = { class: 'outline', 'stroke-width': 1.5 * mm };
  if (!isShaped(pillar)) {
    const corners = pillar.outline_mm.map(([x, y]) => `${x - place[0]},${place[1] - y}`);
    return <polygon {...line} points={corners.join(' ')} />;
  }
  const { shape, width_mm: width, turn_deg = 0 } = pillar;
  if (shape === 'round') return <circle {...line} r={width / 2} />;
  const turn = `rotate(${-turn_deg})`;
  if (shape === 'square')
    return <rect {...line} x={-width / 2} y={-width / 2} width={width} height={width} transform={turn} />;
  const corners = [0, 1, 2, 3, 4, 5].map((k) => {
    const angle = (Math.PI * k) / 3;
    return `${(width / 2) * Math.cos(angle)},${-(width / 2) * Math.sin(angle)}`;
  });
  return <polygon {...line} points={corners.join(' ')} transform={turn} />;
}

interface ViewpointProps extends Shared {
  readonly viewpoint: Viewpoint;
  readonly index: number;
}

function removing({ session }: Shared, index: number) {
  return () => {
    if ((session.scene.value?.viewpoints.length ?? 0) < 2) return; // the core asks for one
    session.change((scene) => removeViewpoint(scene, index), `Delete viewpoint ${index + 1}`);
    session.chosen.value = null;
  };
}

function moveEnd({ session }: Shared, index: number, end: End, to: Place): void {
  const what = end === 'eye_mm' ? 'Move the eye of' : 'Move what is looked at from';
  session.change(
    (scene) => changeViewpoint(scene, index, (one) => movedEnd(one, end, to)),
    `${what} viewpoint ${index + 1}`,
    `${end} ${index}`,
  );
}

export function EyeHandle({
  viewpoint,
  index,
  mark,
  ...shared
}: ViewpointProps & { readonly mark: EyeMark }) {
  const { session, mm } = shared;
  const { eye_mm: eye } = viewpoint;
  /** Taken beyond the frame, it goes round what it looks at. */
  const turns = useRef(false);
  const label = `${modelName(session, viewpoint)}, eye at ${placeWords(eye)}${mark.beyond ? ', beyond the plan' : ''}`;
  return (
    <Handle
      {...shared}
      what={{ kind: 'viewpoint', index }}
      name={`Viewpoint ${index + 1}`}
      label={label}
      class={isChosen(session.chosen.value, 'viewpoint', index) ? 'eye chosen' : 'eye'}
      place={mark.place}
      inTabOrder
      onGrip={() => (turns.current = mark.beyond)}
      onMove={(to, dragged) => {
        if (dragged && turns.current)
          session.change(
            (scene) => changeViewpoint(scene, index, (one) => turnedTo(one, to)),
            `Move the eye of viewpoint ${index + 1}`,
            `eye_mm ${index}`,
          );
        else if (dragged) moveEnd(shared, index, 'eye_mm', to);
        else
          moveEnd(shared, index, 'eye_mm', [eye[0] + to[0] - mark.place[0], eye[1] + to[1] - mark.place[1]]);
      }}
      onRemove={removing(shared, index)}
    >
      <circle class="reach" r={20 * mm} />
      <circle class="disc" r={11 * mm} style={{ fill: colourOf(index) }} stroke-width={1.5 * mm} />
      <text font-size={12 * mm} dy="0.36em">
        {index + 1}
      </text>
    </Handle>
  );
}

/** Several often look at one place: of the chosen viewpoint it is dragged. */
export function LookHandle({ viewpoint, index, ...shared }: ViewpointProps) {
  const { session, mm } = shared;
  const [x, y] = viewpoint.look_at_mm;
  const chosen = isChosen(session.chosen.value, 'viewpoint', index);
  return (
    <Handle
      {...shared}
      what={{ kind: 'viewpoint', index }}
      name={`Viewpoint ${index + 1}`}
      label={`${modelName(session, viewpoint)}, looks at ${placeWords([x, y])}`}
      class={chosen ? 'look chosen' : 'look'}
      place={[x, y]}
      inTabOrder
      onMove={(to) => moveEnd(shared, index, 'look_at_mm', to)}
      onRemove={removing(shared, index)}
    >
      <circle class="reach" r={16 * mm} />
      <circle
        class="target"
        r={(chosen ? 7 : 4) * mm}
        style={{ stroke: colourOf(index) }}
        stroke-width={3 * mm}
      />
    </Handle>
  );
}
