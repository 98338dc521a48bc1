// SPDX-License-Identifier: GPL-3.0-or-later
// The bed from above: the job to be placed by dragging or by keys, and the head.
import { useEffect, useRef } from 'preact/hooks';
import { useSignal } from '@preact/signals';
import { bedOfWork } from '../../../machines/places';
import { workBounds } from '../../../machines/toolpath';
import { formatNumber, withUnit } from '../../../ui';
import { drawBed, frameOf } from './bed_canvas';
import { timeShown } from '../panel/job_bar';
import type { MachinesSession } from '../machines_session';
import { cellAt, cellsOf } from '../sections/test_results';

const numberOf = (session: MachinesSession, name: string): number => {
  const value = session.value(name);
  return typeof value === 'number' ? value : 0;
};

export function BedView({
  session,
  showTravel,
}: {
  readonly session: MachinesSession;
  readonly showTravel: boolean;
}) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const size = useSignal(0);
  const theme = useSignal(0);
  const plan = session.plan.value;
  const bed =
    plan?.toolPath.bed_mm ??
    ([numberOf(session, 'bed_x_mm') || 400, numberOf(session, 'bed_y_mm') || 400] as const);
  const { control } = session;
  const state = control.state.value;
  const head =
    state?.position_known && state.work_mm
      ? bedOfWork([state.work_mm[0] ?? 0, state.work_mm[1] ?? 0], session.origin.value, bed)
      : null;
  const time_s = timeShown(session);
  useEffect(() => {
    const observer = new ResizeObserver(() => ++size.value);
    if (canvas.current) observer.observe(canvas.current);
    const changes = new MutationObserver(() => ++theme.value);
    changes.observe(document.documentElement, { attributes: true, attributeFilter: ['data-theme'] });
    return () => {
      observer.disconnect();
      changes.disconnect();
    };
  }, []);
  const test = session.document.value.drawing?.kind === 'test';
  const side_mm = numberOf(session, 'cell_mm');
  const cells = test && session.value('kind') === 'power_speed' ? cellsOf(plan?.report ?? {}) : [];
  const chosen = cells.find(({ name }) => name === session.chosenCell.value);
  useEffect(() => {
    if (canvas.current)
      drawBed(canvas.current, {
        bed_mm: bed,
        toolPath: plan?.toolPath ?? null,
        time_s,
        head_mm: head,
        showTravel,
        misfits: (plan?.misfits.length ?? 0) > 0,
        chosen_mm: chosen ? [chosen.x_mm, chosen.y_mm, chosen.x_mm + side_mm, chosen.y_mm + side_mm] : null,
      });
  }, [plan, bed[0], bed[1], time_s, head?.[0], head?.[1], showTravel, size.value, theme.value, chosen]);

  const movable = (test || session.document.value.drawing?.kind === 'drawing') && !control.isBusy;
  const place = (x_mm: number, y_mm: number, done: boolean) => {
    const properties = session.operation.value?.parameters.properties;
    const rounded = (name: 'x_mm' | 'y_mm', mm: number) =>
      Math.max(properties?.[name]?.minimum ?? -Infinity, Math.round(10 * mm) / 10);
    const placed = { x_mm: rounded('x_mm', x_mm), y_mm: rounded('y_mm', y_mm) };
    session.setParameters(placed, 'Place the job', 'place');
    if (done) session.services.projects.commit();
  };
  const drag = (event: PointerEvent) => {
    if (!movable || canvas.current === null || event.button !== 0) return;
    const { scale } = frameOf(canvas.current.clientWidth, canvas.current.clientHeight, bed);
    const from = [
      event.clientX,
      event.clientY,
      numberOf(session, 'x_mm'),
      numberOf(session, 'y_mm'),
    ] as const;
    canvas.current.setPointerCapture(event.pointerId);
    let dragged = false;
    const move = (now: PointerEvent) => {
      dragged ||= Math.hypot(now.clientX - from[0], now.clientY - from[1]) > 3;
      if (dragged)
        place(from[2] + (now.clientX - from[0]) / scale, from[3] - (now.clientY - from[1]) / scale, false);
    };
    const end = (now: PointerEvent) => {
      session.services.projects.commit();
      canvas.current?.removeEventListener('pointermove', move);
      if (!dragged && now.type === 'pointerup') pick(now);
    };
    canvas.current.addEventListener('pointermove', move);
    canvas.current.addEventListener('pointerup', end, { once: true });
    canvas.current.addEventListener('pointercancel', end, { once: true });
  };
  /** The square of a test that was clicked. */
  const pick = (event: PointerEvent) => {
    if (cells.length === 0 || canvas.current === null) return;
    const { left, low, scale } = frameOf(canvas.current.clientWidth, canvas.current.clientHeight, bed);
    const box = canvas.current.getBoundingClientRect();
    const [x, y] = [(event.clientX - box.left - left) / scale, (low - event.clientY + box.top) / scale];
    const found = cellAt(cells, side_mm, x, y);
    if (found) session.chosenCell.value = found.name;
  };
  const keys = (event: KeyboardEvent) => {
    const step = event.shiftKey ? 10 : 1;
    const by = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] }[
      event.key
    ];
    if (!movable || by === undefined) return;
    event.preventDefault();
    place(numberOf(session, 'x_mm') + (by[0] ?? 0), numberOf(session, 'y_mm') + (by[1] ?? 0), true);
  };
  return (
    <canvas
      ref={canvas}
      class={movable ? 'bed movable' : 'bed'}
      tabIndex={0}
      role="img"
      aria-label={words(session)}
      onPointerDown={drag}
      onKeyDown={keys}
    />
  );
}

/** The bed for those who do not see it. */
function words(session: MachinesSession): string {
  const plan = session.plan.value;
  if (plan === null) return 'The bed, empty';
  const mm = (value: number) => formatNumber(value, 3);
  const bounds = workBounds(plan.toolPath);
  const bed = withUnit(plan.toolPath.bed_mm.map(mm).join(' × '), 'mm');
  const job = bounds
    ? `the job from ${mm(bounds[0])}, ${mm(bounds[1])} to ${mm(bounds[2])}, ${withUnit(mm(bounds[3]), 'mm')}`
    : 'nothing to cut';
  const head = session.control.state.value?.position_known ? session.control.state.value.work_mm : null;
  const where = head ? `; the head at ${head.slice(0, 2).map(mm).join(', ')}` : '';
  const movable = session.document.value.drawing?.kind !== 'model';
  return `Bed of ${bed}: ${job}${where}.${movable ? ' Arrow keys move the job.' : ''}`;
}
