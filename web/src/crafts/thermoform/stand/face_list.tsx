// SPDX-License-Identifier: GPL-3.0-or-later
// The faces that the model can be placed on, as a list: the same by keys as by pointing at the model.
import { useEffect, useId, useRef } from 'preact/hooks';
import { formatNumber, IconButton, withUnit } from '../../../ui';
import type { ThermoformSession } from '../thermoform_session';
import type { FaceTool } from './face_tool';

const square_mm_in_square_cm = 100;

export function FaceList({ session, tool }: { session: ThermoformSession; tool: FaceTool }) {
  const sides = tool.sides.value;
  const id = useId();
  const list = useRef<HTMLUListElement>(null);
  const there = sides !== null;
  useEffect(() => {
    if (there) list.current?.focus();
  }, [there]);
  useEffect(() => {
    if (!there) return undefined;
    const escape = (event: KeyboardEvent) => {
      if (event.key !== 'Escape' || event.defaultPrevented) return;
      event.preventDefault();
      tool.leave();
    };
    document.addEventListener('keydown', escape, true);
    return () => document.removeEventListener('keydown', escape, true);
  }, [there, tool]);
  const pointed = tool.pointed.value;
  useEffect(() => {
    if (pointed !== null)
      list.current?.children[pointed]?.scrollIntoView({ block: 'nearest', inline: 'nearest' });
  }, [pointed]);
  if (sides === null) return null;
  const [a = 0, b = 0, c = 0] = session.placement.value ?? [];
  const scale = Math.hypot(a, b, c);
  const area = (of: number) => withUnit(formatNumber((of * scale ** 2) / square_mm_in_square_cm, 2), 'cm²');
  const key = (event: KeyboardEvent) => {
    const last = sides.length - 1;
    const at = pointed ?? -1;
    const targets: Record<string, number> = {
      ArrowDown: Math.min(last, at + 1),
      ArrowRight: Math.min(last, at + 1),
      ArrowUp: Math.max(0, at - 1),
      ArrowLeft: Math.max(0, at - 1),
      Home: 0,
      End: last,
    };
    const to = targets[event.key];
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (to !== undefined) tool.pointed.value = to;
    else if (event.key === 'Enter' || event.key === ' ') tool.take(pointed);
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  return (
    <section class="float panel face-list" aria-label="Place on face">
      <header>
        <h3>Place on face</h3>
        <IconButton icon="close" label="Leave “Place on face”" keys="Escape" onClick={() => tool.leave()} />
      </header>
      <p>
        {sides.length > 0
          ? 'Press a face on the model, or one of these.'
          : 'This model has no face that is large enough to stand on. Lay it on one of its sides, or tilt it by its handles.'}
      </p>
      <ul
        ref={list}
        role="listbox"
        tabIndex={0}
        aria-label="Faces, the largest first"
        aria-activedescendant={pointed === null ? undefined : `${id}-${String(pointed)}`}
        hidden={sides.length === 0}
        onKeyDown={key}
        onPointerLeave={() => (tool.pointed.value = null)}
      >
        {sides.map((side, index) => (
          <li
            key={index}
            id={`${id}-${String(index)}`}
            role="option"
            aria-selected={pointed === index}
            onPointerEnter={() => (tool.pointed.value = index)}
            onClick={() => tool.take(index)}
          >
            Face {index + 1}, {area(side.area)}
            {tool.underside.value === index ? <small> on the plate</small> : null}
          </li>
        ))}
      </ul>
    </section>
  );
}
