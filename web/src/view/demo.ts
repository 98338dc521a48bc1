// SPDX-License-Identifier: GPL-3.0-or-later
/* eslint-disable @typescript-eslint/no-non-null-assertion -- a page for trying, over its own elements */
// Drives the view with a mesh and a make-believe relief: depth squeezed along the rays of sight.
import { LightBall, SideInset, Viewport, legendFor, renderThumbnail } from './index';
import type { MeshData, Plate, Vec3, Viewpoint, ViewMode } from './api';
import { add, along, dot, scale, subtract, viewerAxes } from './vector';
import { smoothNormals } from './mesh/normals';

const query = new URLSearchParams(location.search);
if (query.get('theme')) document.documentElement.dataset['theme'] = query.get('theme')!;
const numbers = (name: string, fallback: number[]): number[] =>
  query.get(name)?.split(',').map(Number) ?? fallback;

function torus(): MeshData {
  const [n, m] = [160, 64];
  const positions: number[] = [];
  const indices: number[] = [];
  for (let i = 0; i < n; ++i) {
    for (let j = 0; j < m; ++j) {
      const [u, v] = [(2 * Math.PI * i) / n, (2 * Math.PI * j) / m];
      positions.push((2 + Math.cos(v)) * Math.cos(u), (2 + Math.cos(v)) * Math.sin(u), Math.sin(v));
      const [a, b, c, d] = [
        i * m + j,
        ((i + 1) % n) * m + j,
        ((i + 1) % n) * m + ((j + 1) % m),
        i * m + ((j + 1) % m),
      ];
      indices.push(a, b, c, a, c, d);
    }
  }
  return { positions: Float64Array.from(positions), indices: Uint32Array.from(indices) };
}

function parseObj(text: string): MeshData {
  const positions: number[] = [];
  const indices: number[] = [];
  for (const line of text.split('\n')) {
    const parts = line.trim().split(/\s+/);
    if (parts[0] === 'v') positions.push(+parts[1]!, +parts[2]!, +parts[3]!);
    if (parts[0] === 'f') {
      const corners = parts.slice(1).map((p) => parseInt(p, 10) - 1);
      for (let i = 1; i + 1 < corners.length; ++i) indices.push(corners[0]!, corners[i]!, corners[i + 1]!);
    }
  }
  return { positions: Float64Array.from(positions), indices: Uint32Array.from(indices) };
}

/** Splits every triangle into four: for measuring large meshes. */
function subdivided(mesh: MeshData): MeshData {
  const positions = [...mesh.positions];
  const middles = new Map<number, number>();
  const count = mesh.positions.length / 3;
  const middle = (a: number, b: number): number => {
    const key = Math.min(a, b) * count + Math.max(a, b);
    let v = middles.get(key);
    if (v === undefined) {
      v = positions.length / 3;
      for (let k = 0; k < 3; ++k)
        positions.push((mesh.positions[3 * a + k]! + mesh.positions[3 * b + k]!) / 2);
      middles.set(key, v);
    }
    return v;
  };
  const indices: number[] = [];
  for (let t = 0; t < mesh.indices.length; t += 3) {
    const [a, b, c] = [mesh.indices[t]!, mesh.indices[t + 1]!, mesh.indices[t + 2]!];
    const [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
    indices.push(a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca);
  }
  return { positions: Float64Array.from(positions), indices: Uint32Array.from(indices) };
}

const at = (p: ArrayLike<number>, i: number): Vec3 => [p[3 * i]!, p[3 * i + 1]!, p[3 * i + 2]!];

const url = query.get('mesh');
let source = url ? parseObj(await (await fetch(url)).text()) : torus();
for (let i = 0; i < Number(query.get('subdivide') ?? 0); ++i) source = subdivided(source);
const direction = numbers('direction', [0, 0, -1]) as unknown as Vec3;
const up = numbers('up', [0, 1, 0]) as unknown as Vec3;
const axes = viewerAxes(direction, up);
const projection = query.get('projection') === 'orthographic' ? 'orthographic' : 'perspective';
const count = source.positions.length / 3;

// Scaled so that the model is 104 mm wide as seen.
let [low, high] = [
  [1e9, 1e9, 1e9],
  [-1e9, -1e9, -1e9],
] as [number[], number[]];
for (let i = 0; i < count; ++i) {
  [axes.right, axes.up, axes.forward].forEach((a, k) => {
    const s = dot(a, at(source.positions, i));
    low[k] = Math.min(low[k]!, s);
    high[k] = Math.max(high[k]!, s);
  });
}
const size = Number(query.get('width') ?? 104) / (high[0]! - low[0]!);
const positions = Float64Array.from(source.positions, (x) => x * size);
low = low.map((x) => x * size);
high = high.map((x) => x * size);
const original: MeshData = { positions, indices: source.indices };
const targetMm = [axes.right, axes.up, axes.forward].reduce<Vec3>(
  (p, a, k) => along(p, a, (low[k]! + high[k]!) / 2),
  [0, 0, 0],
);
const distanceMm = Number(query.get('distance') ?? 300);
const viewpoint: Viewpoint = { projection, direction, up, targetMm, distanceMm, fieldOfViewDeg: 20 };

/** Depths squeezed into `thickness` before the plate z = 0, along the rays. */
function relief(thickness: number): Float64Array {
  const out = new Float64Array(positions.length);
  const kappa = projection === 'perspective' ? 1 / distanceMm : 0;
  const depth = high[2]! - low[2]!;
  for (let i = 0; i < count; ++i) {
    const d = subtract(at(positions, i), targetMm);
    const z = dot(d, axes.forward);
    const wanted = (z / depth - 0.5) * thickness;
    const s = (1 + kappa * wanted) / (1 + kappa * z);
    const moved =
      kappa > 0
        ? add(
            along(targetMm, axes.forward, -distanceMm),
            scale(subtract(at(positions, i), along(targetMm, axes.forward, -distanceMm)), s),
          )
        : along(at(positions, i), axes.forward, wanted - z);
    out.set(moved, 3 * i);
  }
  return out;
}

const thickness = Number(query.get('thickness') ?? 5);
const squeezed = relief(thickness);
let [halfWidth, halfHeight] = [0, 0];
for (let i = 0; i < count; ++i) {
  const d = subtract(at(squeezed, i), targetMm);
  halfWidth = Math.max(halfWidth, Math.abs(dot(d, axes.right)));
  halfHeight = Math.max(halfHeight, Math.abs(dot(d, axes.up)));
}
const plate: Plate = {
  widthMm: Math.round(20 * (halfWidth + 7)) / 10,
  heightMm: Math.round(20 * (halfHeight + 7)) / 10,
  thicknessMm: 3,
  centreMm: targetMm,
  reliefThicknessMm: thickness,
};
const n0 = smoothNormals(positions, source.indices, count);
const n1 = smoothNormals(squeezed, source.indices, count);
const error = Float32Array.from(
  { length: count },
  (_, i) => (Math.acos(Math.min(1, dot(at(n0, i), at(n1, i)))) * 180) / Math.PI,
);

const begun = performance.now();
const frames: { cpuMs: number; intervalMs: number | null }[] = [];
const insets =
  innerWidth < 720
    ? { left: 0, top: 58, right: 0, bottom: 6 }
    : { left: 12, top: 52, right: 12, bottom: 150 };
const hasRelief = query.get('relief') !== 'no';
const viewport = new Viewport(document.getElementById('view')!, {
  mode: (query.get('mode') ?? 'swipe') as ViewMode,
  freeRectangle: insets,
  ground: query.get('ground') === 'yes',
  refine: query.get('refine') !== 'no',
  onPointer: () => undefined,
  onFrame: (stats) => frames.push(stats),
});
viewport.setViewpoint(viewpoint);
viewport.setOriginal(original);
if (hasRelief)
  viewport.setRelief({ positions: squeezed, indices: source.indices, attributes: { error } }, plate);
const mapping = {
  attribute: 'error',
  map: 'error',
  minimum: 0,
  maximum: 75,
  unit: '°',
  label: 'Shading difference',
} as const;
viewport.setColourMapping(mapping);
viewport.lookFromViewpoint(false);
const [azimuth, elevation] = numbers('orbit', [0, 0]);
if (azimuth || elevation) viewport.orbit(azimuth!, elevation!);
if (query.get('section'))
  viewport.setSection({ axis: 'view', positionMm: dot(axes.right, targetMm) + Number(query.get('section')) });
if (query.get('swipe')) viewport.setSwipe(Number(query.get('swipe')));
const loadMs = performance.now() - begun;

const ball = new LightBall({ azimuthDeg: 135, elevationDeg: 36 }, (light) => viewport.setLight(light));
document.getElementById('light')!.append(ball.element);
const inset = new SideInset(viewport);
document.getElementById('inset')!.append(inset.element);
document.getElementById('inset')!.hidden = !hasRelief;
if (hasRelief) inset.update(thickness);
if (query.get('mode') === 'error') {
  const legend = legendFor(mapping, error);
  const box = document.getElementById('legend')!;
  box.hidden = false;
  box.innerHTML = `<b>${legend.label}</b> <span style="float:right">${legend.mark?.text ?? ''}</span><div class="bar" style="background:${legend.gradient}"><i style="left:${100 * (legend.mark?.fraction ?? 0)}%"></i></div><div class="ticks">${legend.ticks.map((t) => `<span style="left:${100 * t.fraction}%">${t.text}</span>`).join('')}</div>`;
}

/** Main-thread and whole-frame times, for the bench. */
async function measure(): Promise<Record<string, number>> {
  await viewport.settled();
  const result: Record<string, number> = { vertices: count, triangles: source.indices.length / 3, loadMs };
  frames.length = 0;
  for (let i = 0; i < 30; ++i) {
    viewport.orbit(3, 0);
    await new Promise(requestAnimationFrame);
  }
  const median = (a: number[]): number => a.sort((p, q) => p - q)[a.length >> 1] ?? NaN;
  result['orbitCpuMs'] = median(frames.map((f) => f.cpuMs));
  result['orbitIntervalMs'] = median(frames.flatMap((f) => (f.intervalMs === null ? [] : [f.intervalMs])));
  viewport.lookFromViewpoint(false);
  const updates: number[] = [];
  for (let i = 0; i < 10; ++i) {
    const next = relief(3 + 0.3 * i);
    const t = performance.now();
    viewport.updateRelief(next);
    updates.push(performance.now() - t);
    await new Promise(requestAnimationFrame);
  }
  result['updateMs'] = median(updates);
  const settling = performance.now();
  await viewport.settled();
  result['settleMs'] = performance.now() - settling;
  return result;
}
Object.assign(globalThis, {
  viewport,
  measure,
  renderThumbnail,
  original,
  plate,
  thickness,
  viewpoint,
  squeezed,
  source,
});
await viewport.settled();
document.body.dataset['ready'] = 'yes';
