// SPDX-License-Identifier: GPL-3.0-or-later
// The way that a file of G-code leads, to be looked at before it is sent. Whether it may be sent the machine's driver judges.
import type { ToolPath, ToolPathPart } from './toolpath';

const rapid_mm_per_s = 100; // what G0 is shown with; machines tell their own speed in no file
const chord_mm = 0.5;

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
  let [unit, relative] = [1, false];
  let number = 0;
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
  for (const raw of text.split('\n')) {
    ++number;
    const words = raw
      .replace(/\([^)]*\)|;.*/g, '')
      .toUpperCase()
      .matchAll(/([A-Z])\s*([+-]?[\d.]+)/g);
    const target: (number | null)[] = [null, null, null];
    const centre: (number | null)[] = [null, null];
    for (const [, letter = '', digits = ''] of words) {
      const value = Number(digits);
      if (!Number.isFinite(value)) continue;
      if (letter === 'G') {
        if (value >= 0 && value <= 3) motion = value;
        else if (value === 20 || value === 21) unit = value === 20 ? 25.4 : 1;
        else if (value === 90 || value === 91) relative = value === 91;
      } else if (letter === 'M' && value >= 3 && value <= 5) spindle = value;
      else if (letter === 'S') power = value;
      else if (letter === 'F') feed = value * unit;
      else if ('XYZ'.includes(letter)) target['XYZ'.indexOf(letter)] = value * unit;
      else if ('IJ'.includes(letter)) centre['IJ'.indexOf(letter)] = value * unit;
    }
    const arc = motion > 1 && (centre[0] !== null || centre[1] !== null);
    if (target.every((value) => value === null) && !arc) continue;
    const along = (value: number | null | undefined, from: number) =>
      value === null || value === undefined ? from : relative ? from + value : value;
    const to = [along(target[0], x), along(target[1], y), along(target[2], z)] as const;
    if (arc)
      for (const point of arcPoints([x, y, z], to, centre[0] ?? 0, centre[1] ?? 0, motion === 2))
        moveTo(point, number);
    else moveTo(to, number);
  }
  if (paths.length === 0) throw new Error('The file has no moves in it: choose a G-code file.');
  return { bed_mm, no_go_mm: [], seconds: time, paths: paths as readonly ToolPathPart[] };
}

function* arcPoints(
  from: readonly [number, number, number],
  to: readonly [number, number, number],
  i: number,
  j: number,
  clockwise: boolean,
): Generator<readonly [number, number, number]> {
  const [cx, cy, radius] = [from[0] + i, from[1] + j, Math.hypot(i, j)];
  const start = Math.atan2(-j, -i);
  let sweep = Math.atan2(to[1] - cy, to[0] - cx) - start;
  if (clockwise && sweep >= -1e-9) sweep -= 2 * Math.PI;
  if (!clockwise && sweep <= 1e-9) sweep += 2 * Math.PI;
  const count = Math.max(2, Math.ceil((Math.abs(sweep) * radius) / chord_mm));
  for (let k = 1; k < count; ++k) {
    const angle = start + (sweep * k) / count;
    yield [
      cx + radius * Math.cos(angle),
      cy + radius * Math.sin(angle),
      from[2] + ((to[2] - from[2]) * k) / count,
    ];
  }
  yield to;
}
