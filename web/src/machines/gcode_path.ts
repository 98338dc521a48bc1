// SPDX-License-Identifier: GPL-3.0-or-later
// The way that a file of G-code leads, to be looked at before it is sent. Whether it may be sent the machine's driver judges.
import type { ToolPath, ToolPathPart } from './toolpath';

const rapid_mm_per_s = 100; // what G0 is shown with; machines tell their own speed in no file
const chord_mm = 0.5;
/** Chords of a whole turn: at a radius of 1 m they are within 0.01 mm of the circle. */
const max_chords_of_turn = 720;
/** Points of all arcs of a file together; behind them arcs are drawn with the fewest chords. */
const max_arc_points = 4_000_000;
const min_chords = 2;

interface Open {
  kind: 'travel' | 'work';
  layer: string;
  part: string;
  pass: number;
  power_percent: number;
  speed_mm_per_s: number;
  points_mm: number[];
  times_s: number[];
  lines: number[];
}

/** Times are lengths over feeds: machines that have to brake take longer. Throws Error for a file without a move. */
export function readGcodePath(
  text: string,
  bed_mm: readonly [number, number],
  power_max_s: number,
): ToolPath {
  const paths: Open[] = [];
  let [x, y, z, time] = [0, 0, 0, 0];
  let [motion, spindle, power, feed] = [0, 5, 0, 1000];
  let [unit, relative, plane] = [1, false, 17];
  let number = 0;
  let arcPointsLeft = max_arc_points;
  const moveTo = (to: readonly [number, number, number], line: number) => {
    const works = motion !== 0 && spindle !== 5 && power > 0;
    const kind = works ? 'work' : 'travel';
    const power_percent = works ? (100 * power) / power_max_s : 0;
    const speed_mm_per_s = motion === 0 ? rapid_mm_per_s : feed / 60;
    let open = paths.at(-1);
    if (
      open?.kind !== kind ||
      open.power_percent !== power_percent ||
      open.speed_mm_per_s !== speed_mm_per_s
    ) {
      open = {
        kind,
        layer: works ? 'cut' : '',
        part: '',
        pass: 1,
        power_percent,
        speed_mm_per_s,
        points_mm: [x, y, z],
        times_s: [time],
        lines: [line - 1],
      };
      paths.push(open);
    }
    const length = Math.hypot(to[0] - x, to[1] - y, to[2] - z);
    time += speed_mm_per_s > 0 ? length / speed_mm_per_s : 0;
    [x, y, z] = to;
    open.points_mm.push(x, y, z);
    open.times_s.push(time);
    open.lines.push(line);
  };
  for (const raw of text.split(/\r\n|\r|\n/)) {
    ++number;
    const words = raw
      .replace(/\([^)]*\)|;.*/g, '')
      .toUpperCase()
      .matchAll(/([A-Z])\s*([+-]?[\d.]+)/g);
    const target: (number | null)[] = [null, null, null];
    const centre: (number | null)[] = [null, null, null];
    let radius: number | null = null;
    for (const [, letter = '', digits = ''] of words) {
      const value = Number(digits);
      if (!Number.isFinite(value)) continue;
      if (letter === 'G') {
        if (value >= 0 && value <= 3) motion = value;
        else if (value === 20 || value === 21) unit = value === 20 ? 25.4 : 1;
        else if (value === 90 || value === 91) relative = value === 91;
        else if (value >= 17 && value <= 19) plane = value;
      } else if (letter === 'M' && value >= 3 && value <= 5) spindle = value;
      else if (letter === 'S') power = value;
      else if (letter === 'F') feed = value * unit;
      else if ('XYZ'.includes(letter)) target['XYZ'.indexOf(letter)] = value * unit;
      else if ('IJK'.includes(letter)) centre['IJK'.indexOf(letter)] = value * unit;
      else if (letter === 'R') radius = value * unit;
    }
    const axes = axesOfPlane(plane);
    const [i, j] = [centre[axes[0]] ?? null, centre[axes[1]] ?? null];
    const arc = motion > 1 && (i !== null || j !== null || radius !== null);
    if (target.every((value) => value === null) && !arc) continue;
    const along = (value: number | null | undefined, from: number) =>
      value === null || value === undefined ? from : relative ? from + value : value;
    const to = [along(target[0], x), along(target[1], y), along(target[2], z)] as const;
    if (arc) {
      const from = [x, y, z] as const;
      const middle =
        radius === null ? ([i ?? 0, j ?? 0] as const) : middleOf(from, to, axes, radius, motion === 2);
      const points = arcPoints(from, to, axes, middle, motion === 2, arcPointsLeft);
      for (const point of points) {
        moveTo(point, number);
        --arcPointsLeft;
      }
    } else moveTo(to, number);
  }
  if (paths.length === 0) throw new Error('The file has no moves in it: choose a G-code file.');
  return { bed_mm, no_go_mm: [], seconds: time, paths: paths as readonly ToolPathPart[] };
}

type Point = readonly [number, number, number];
type Axes = readonly [0 | 1 | 2, 0 | 1 | 2, 0 | 1 | 2];

/** Arcs turn from the first axis towards the second; the third is the helix's (core/machines/gcode/gcode_motion.h). */
const axesOfPlane = (plane: number): Axes =>
  plane === 18 ? [2, 0, 1] : plane === 19 ? [1, 2, 0] : [0, 1, 2];

/** From where the arc begins, of the radius form: the shorter arc for a radius over 0. */
function middleOf(from: Point, to: Point, [a, b]: Axes, radius: number, clockwise: boolean) {
  const [dx, dy] = [to[a] - from[a], to[b] - from[b]];
  const chord = Math.hypot(dx, dy);
  const reach = Math.sqrt(Math.max(0, 4 * radius * radius - chord * chord)) / (chord || 1);
  const h = clockwise === radius > 0 ? -reach : reach;
  return [(dx - dy * h) / 2, (dy + dx * h) / 2] as const;
}

function* arcPoints(
  from: Point,
  to: Point,
  [a, b, c]: Axes,
  [i, j]: readonly [number, number],
  clockwise: boolean,
  max_chords: number,
): Generator<Point> {
  const [ca, cb, radius] = [from[a] + i, from[b] + j, Math.hypot(i, j)];
  const start = Math.atan2(-j, -i);
  let sweep = Math.atan2(to[b] - cb, to[a] - ca) - start;
  while (clockwise && sweep >= -1e-6) sweep -= 2 * Math.PI;
  while (!clockwise && sweep <= 1e-6) sweep += 2 * Math.PI;
  while (Math.abs(sweep) > 2 * Math.PI + 1e-6) sweep -= Math.sign(sweep) * 2 * Math.PI;
  const turns = Math.abs(sweep) / (2 * Math.PI);
  const chords = Math.min((turns * 2 * Math.PI * radius) / chord_mm, turns * max_chords_of_turn, max_chords);
  const count = Math.max(min_chords, Math.ceil(chords));
  for (let k = 1; k < count; ++k) {
    const angle = start + (sweep * k) / count;
    const point: [number, number, number] = [0, 0, 0];
    point[a] = ca + radius * Math.cos(angle);
    point[b] = cb + radius * Math.sin(angle);
    point[c] = from[c] + ((to[c] - from[c]) * k) / count;
    yield point;
  }
  yield to;
}
