// SPDX-License-Identifier: GPL-3.0-or-later
// Draws a row of docs/zippable_gallery.md, in a browser, for scripts/draw_zippables.js: model, course, ribbon, plan, zipped cloth.
// Not part of the page.
import { colourToken } from '../../src/shared/panels/colour_token';
import '../../src/crafts/zippable/zippable.css';
import { originalData } from '../../src/shared/panels/shaded_mesh';
import { readPly } from '../../src/jobs/mesh_reader';
import type { MeshData, ThumbnailOptions, Vec3 } from '../../src/view';
import { renderThumbnail } from '../../src/view';
import { cross, normalise, perpendicular, subtract } from '../../src/view/vector';

/** Files of zippable-design, zippable-plan and zippable-simulate; what is bytes comes as base64. */
export interface RowFiles {
  /** The sample's picture, a data URL. */
  readonly model: string;
  readonly parameterised_ply: string;
  readonly curve_obj: string;
  readonly ribbon_svg: string;
  readonly plan_svg: string;
  readonly zipped_ply: string;
}

const panel = { widthPx: 256, heightPx: 224 };
const viewpoint = { direction: [-0.35, -0.3, -1], up: [0, 1, 0] } as const;
const options: ThumbnailOptions = { transparent: true, ground: true, patient: true, viewpoint };
const teeth = [0.13, 0.11, 0.09] as const;
const sidesOfTube = 6;

/** A WebP picture as a data URL. */
export async function drawRow(files: RowFiles): Promise<string> {
  const canvas = document.createElement('canvas');
  canvas.width = 5 * panel.widthPx;
  canvas.height = panel.heightPx;
  const paper = canvas.getContext('2d');
  if (paper === null) throw new Error('No canvas.');
  paper.fillStyle = '#faf8f4';
  paper.fillRect(0, 0, canvas.width, canvas.height);
  const pictures = [
    await loaded(files.model),
    await createImageBitmap(await renderThumbnail(await course(files), panel, options)),
    await loaded(svgAddress(files.ribbon_svg)),
    await loaded(svgAddress(files.plan_svg)),
    await createImageBitmap(await renderThumbnail(await zipped(files.zipped_ply), panel, options)),
  ];
  pictures.forEach((picture, i) => {
    const room = 0.94 * Math.min(panel.widthPx / picture.width, panel.heightPx / picture.height);
    const [width, height] = [room * picture.width, room * picture.height];
    const [x, y] = [(i + 0.5) * panel.widthPx - width / 2, (panel.heightPx - height) / 2];
    paper.drawImage(picture, x, y, width, height);
  });
  return canvas.toDataURL('image/webp', 0.86);
}

const bytesOf = (base64: string) => Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
/** Lines of a fraction of a millimetre would vanish in a picture this small. */
const svgAddress = (text: string) =>
  `data:image/svg+xml;charset=utf-8,${encodeURIComponent(
    text.replace(/stroke-width="[\d.]+"/g, 'stroke-width="1.2" vector-effect="non-scaling-stroke"'),
  )}`;

async function loaded(address: string): Promise<HTMLImageElement> {
  const image = new Image();
  image.src = address;
  await image.decode();
  return image;
}

function colourOf(token: string): readonly [number, number, number] {
  const text = getComputedStyle(document.documentElement).getPropertyValue(token).trim();
  const number = parseInt(/^#([0-9a-f]{6})$/i.exec(text)?.[1] ?? '808080', 16);
  return [(number >> 16) / 255, ((number >> 8) & 255) / 255, (number & 255) / 255];
}

/** The parts in their colours, the zipper's course as a tube on them. */
async function course({ parameterised_ply, curve_obj }: RowFiles): Promise<MeshData> {
  const mesh = await readPly(bytesOf(parameterised_ply));
  const segment = mesh.attributes['segment'] ?? new Float32Array(mesh.positions.length / 3);
  const positions: number[] = [...mesh.positions];
  const colours: number[] = [...segment].flatMap((part) => colourOf(colourToken(part)));
  const indices: number[] = [...mesh.indices];
  const size = extent(mesh.positions);
  for (const line of linesOf(curve_obj)) addTube(positions, colours, indices, line, 0.006 * size);
  return {
    positions: Float32Array.from(positions),
    colours: Float32Array.from(colours),
    indices: Uint32Array.from(indices),
  };
}

function linesOf(obj: string): Vec3[][] {
  const vertices: Vec3[] = [];
  const lines: Vec3[][] = [];
  for (const row of obj.split('\n')) {
    const [kind, ...words] = row.trim().split(/\s+/);
    const numbers = words.map(Number);
    if (kind === 'v') vertices.push(numbers as unknown as Vec3);
    if (kind === 'l') lines.push(numbers.map((number) => vertices[number - 1] ?? [0, 0, 0]));
  }
  return lines;
}

function addTube(
  positions: number[],
  colours: number[],
  indices: number[],
  line: Vec3[],
  radius: number,
): void {
  const first = positions.length / 3;
  line.forEach((at, i) => {
    const [before, after] = [line[Math.max(0, i - 1)] ?? at, line[Math.min(line.length - 1, i + 1)] ?? at];
    const along = normalise(subtract(after, before));
    const across = perpendicular(along);
    const third = cross(along, across);
    for (let k = 0; k < sidesOfTube; ++k) {
      const [c, s] = [Math.cos((2 * Math.PI * k) / sidesOfTube), Math.sin((2 * Math.PI * k) / sidesOfTube)];
      for (const axis of [0, 1, 2] as const)
        positions.push(at[axis] + radius * (c * across[axis] + s * third[axis]));
      colours.push(...teeth);
    }
    if (i === 0) return;
    for (let k = 0; k < sidesOfTube; ++k) {
      const next = (k + 1) % sidesOfTube;
      const [low, high] = [first + (i - 1) * sidesOfTube, first + i * sidesOfTube];
      indices.push(low + k, low + next, high + next, low + k, high + next, high + k);
    }
  });
}

/** The cloth, each triangle flat, coloured by how far it is from where the design has it: up to a twentieth of its size. */
async function zipped(ply: string): Promise<MeshData> {
  const mesh = await readPly(bytesOf(ply));
  const distance_mm = mesh.attributes['distance_mm'] ?? new Float32Array(mesh.positions.length / 3);
  const most = 0.05 * extent(mesh.positions);
  const [near, far] = [
    [0.86, 0.85, 0.8],
    [0.72, 0.25, 0.1],
  ] as const;
  const positions = Float32Array.from({ length: 3 * mesh.indices.length }, (_, i) => {
    return mesh.positions[3 * (mesh.indices[Math.floor(i / 3)] ?? 0) + (i % 3)] ?? 0;
  });
  const colours = Float32Array.from(positions, (_, i) => {
    const share = Math.min(1, (distance_mm[mesh.indices[Math.floor(i / 3)] ?? 0] ?? 0) / most);
    return (1 - share) * (near[i % 3] ?? 0) + share * (far[i % 3] ?? 0);
  });
  return originalData(
    { ...mesh, positions, colours, indices: mesh.indices.map((_, i) => i), attributes: {} },
    1,
  );
}

function extent(positions: Float32Array): number {
  const side = (axis: number) => {
    const along = positions.filter((_, i) => i % 3 === axis);
    return (
      along.reduce((a, b) => Math.max(a, b), -Infinity) - along.reduce((a, b) => Math.min(a, b), Infinity)
    );
  };
  return Math.max(side(0), side(1), side(2));
}
