// SPDX-License-Identifier: GPL-3.0-or-later
/* eslint-disable @typescript-eslint/no-non-null-assertion -- indices stay within the arrays' own lengths */
// Lines some pixels wide: drawn loops, zipper curves, the outline of a cut.
import * as THREE from 'three';
import type { Curve, Vec3 } from '../api';
import { lineFragment, lineVertex } from '../render/line_shaders';
import { type Uniforms, still } from '../render/surface';

export interface LineStyle {
  /** sRGB 0..1 */
  colour: Vec3;
  widthPx: number;
  dashMm?: number;
  /** Seen faintly through the mesh. */
  ghost?: boolean;
  /** Cut away with the section. */
  sectioned?: boolean;
  /** A second colour where `axis` . (x, y, z, 1) reaches 1, from the scene's origin. */
  blend?: { colour: Vec3; axis: readonly [number, number, number, number] };
}

const QUAD = Float32Array.of(0, -1, 0, 1, -1, 0, 1, 1, 0, 0, -1, 0, 1, 1, 0, 0, 1, 0);

/** Pieces of lines as one instanced draw (two where ghosts are wanted). */
export class LineSet {
  readonly objects: THREE.Mesh[] = [];
  private readonly geometry = new THREE.InstancedBufferGeometry();
  private readonly materials: THREE.RawShaderMaterial[] = [];

  /** `pieces`: start x, y, z, end x, y, z, from the scene's origin. `values`: at the start and the end of each. */
  constructor(
    pieces: Float32Array,
    style: LineStyle,
    picture: Uniforms,
    pixelRatio: number,
    values?: Float32Array,
  ) {
    const count = pieces.length / 6;
    const run = new Float32Array(2 * count);
    let total = 0;
    for (let i = 0; i < count; ++i) {
      const p = 6 * i;
      const goesOn =
        i > 0 &&
        pieces[p] === pieces[p - 3] &&
        pieces[p + 1] === pieces[p - 2] &&
        pieces[p + 2] === pieces[p - 1];
      if (!goesOn) total = 0;
      run[2 * i] = total;
      total += Math.hypot(
        pieces[p + 3]! - pieces[p]!,
        pieces[p + 4]! - pieces[p + 1]!,
        pieces[p + 5]! - pieces[p + 2]!,
      );
      run[2 * i + 1] = total;
    }
    this.geometry.setAttribute('position', new THREE.BufferAttribute(QUAD, 3));
    const ends = new THREE.InstancedInterleavedBuffer(pieces, 6);
    this.geometry.setAttribute('start', new THREE.InterleavedBufferAttribute(ends, 3, 0));
    this.geometry.setAttribute('end', new THREE.InterleavedBufferAttribute(ends, 3, 3));
    this.geometry.setAttribute('run', new THREE.InstancedBufferAttribute(run, 2));
    if (values) this.geometry.setAttribute('value', new THREE.InstancedBufferAttribute(values, 2));
    this.geometry.instanceCount = count;
    const defines = {
      ...(style.sectioned ? { SECTIONED: 1 } : {}),
      ...(values ? { VALUES: 1 } : {}),
      ...(style.blend ? { BLEND: 1 } : {}),
    };
    this.layer(style, defines, picture, pixelRatio, false);
    if (style.ghost) this.layer(style, defines, picture, pixelRatio, true);
  }

  private layer(
    style: LineStyle,
    defines: Record<string, number>,
    picture: Uniforms,
    pixelRatio: number,
    ghost: boolean,
  ): void {
    const material = new THREE.RawShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: lineVertex,
      fragmentShader: lineFragment,
      defines,
      uniforms: {
        uSection: picture['uSection']!,
        uViewport: picture['uViewport']!,
        uWidth: { value: style.widthPx * pixelRatio },
        uNearer: { value: 2e-3 },
        uColour: { value: new THREE.Vector3(...style.colour) },
        uOpacity: { value: ghost ? 0.28 : 1 },
        uDash: { value: style.dashMm ?? 0 },
        uReach: picture['uReach']!,
        uBlendAxis: { value: new THREE.Vector4(...(style.blend?.axis ?? [0, 0, 0, 0])) },
        uBlendColour: { value: new THREE.Vector3(...(style.blend?.colour ?? [0, 0, 0])) },
      },
      side: THREE.DoubleSide,
      transparent: true,
      depthWrite: false,
      depthFunc: ghost ? THREE.GreaterDepth : THREE.LessEqualDepth,
      blending: THREE.CustomBlending,
      blendSrc: THREE.OneFactor,
      blendDst: THREE.OneMinusSrcAlphaFactor,
    });
    this.materials.push(material);
    this.objects.push(still(new THREE.Mesh(this.geometry, material)));
  }

  dispose(): void {
    this.geometry.dispose();
    for (const material of this.materials) material.dispose();
  }
}

/** Values per position as values at the two ends of each piece, in the order of `piecesOf`. */
export function pieceValues(
  values: ArrayLike<number>,
  { closed, separate }: Pick<Curve, 'closed' | 'separate'>,
): Float32Array {
  if (separate) return Float32Array.from(values);
  const count = values.length;
  const pieces = Math.max(0, closed && count > 2 ? count : count - 1);
  const out = new Float32Array(2 * pieces);
  for (let i = 0; i < pieces; ++i) {
    out[2 * i] = values[i]!;
    out[2 * i + 1] = values[(i + 1) % count]!;
  }
  return out;
}

/** A polyline, or lines apart, as pieces. */
export function piecesOf(
  positions: ArrayLike<number>,
  origin: Vec3,
  { closed, separate }: Pick<Curve, 'closed' | 'separate'>,
): Float32Array {
  const count = positions.length / 3;
  if (separate) return Float32Array.from(positions, (value, i) => value - origin[(i % 3) as 0 | 1 | 2]);
  const pieces = Math.max(0, closed && count > 2 ? count : count - 1);
  const out = new Float32Array(6 * pieces);
  for (let i = 0; i < pieces; ++i) {
    const j = (i + 1) % count;
    for (let k = 0; k < 3; ++k) {
      out[6 * i + k] = positions[3 * i + k]! - origin[k as 0 | 1 | 2];
      out[6 * i + 3 + k] = positions[3 * j + k]! - origin[k as 0 | 1 | 2];
    }
  }
  return out;
}
