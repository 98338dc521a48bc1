// SPDX-License-Identifier: GPL-3.0-or-later
/* eslint-disable @typescript-eslint/no-non-null-assertion -- indices stay within the arrays' own lengths */
// One mesh on the graphics card: buffers, live updates, and the materials that draw, shadow and bake it.
import * as THREE from 'three';
import type { MeshData, Vec3 } from '../api';
import { type PicturedShading, apartByUv, copyNormals } from '../mesh/corner_uvs';
import { type Shading, updateNormals } from '../mesh/normals';
import { findShading } from '../mesh/shading';
import { bakeFragment, bakeQuadFragment, bakeQuadVertex, bakeVertex } from './bake_shaders';
import { depthFragment, depthVertex, surfaceFragment, surfaceVertex } from './surface_shaders';
import { type Support, supportOf } from '../mesh/support';

export type Uniforms = Record<string, THREE.IUniform>;

/** Texels per row of a baked light map: one texel per drawn vertex. */
const OCCLUSION_WIDTH = 1024;

/** Of the depth buffer; a millimetre or two of a scene of half a metre. */
const WITHIN_UNITS = 60_000;

export interface SurfaceUniforms {
  /** Section, eye, light frame: the whole picture's. */
  picture: Uniforms;
  /** Shadow map: the subject's. */
  subject: Uniforms;
  /** Direction and shadow map of the sky sample being baked. */
  bake: Uniforms;
}

export interface SurfaceOptions {
  albedo: Vec3;
  /** Flat quads are baked as pictures of this many texels instead of per vertex; needs uvs. */
  picture?: { width: number; height: number };
  /** Look-ups into the key light's depth map per pixel. */
  shadowTaps?: number;
}

export function still<T extends THREE.Object3D>(object: T): T {
  object.frustumCulled = false;
  object.matrixAutoUpdate = false;
  object.matrixWorldAutoUpdate = false;
  return object;
}

function occlusionTarget(width: number, height: number): THREE.WebGLRenderTarget {
  return new THREE.WebGLRenderTarget(width, height, {
    format: THREE.RGFormat,
    type: THREE.HalfFloatType,
    minFilter: THREE.LinearFilter,
    magFilter: THREE.LinearFilter,
    depthBuffer: false,
    generateMipmaps: false,
  });
}

export class Surface {
  readonly geometry = new THREE.BufferGeometry();
  readonly main: THREE.Mesh<THREE.BufferGeometry, THREE.RawShaderMaterial>;
  readonly depth: THREE.Mesh<THREE.BufferGeometry, THREE.RawShaderMaterial>;
  readonly bake: THREE.Object3D;
  /** Triangles of the mesh as given; picking and values speak of these. */
  readonly indices: Uint32Array;
  readonly vertexCount: number;
  /** Has an inside that a cut shows. */
  readonly closed: boolean;
  /** Closed, and its triangles look outwards: nobody sees their backs until it is cut. */
  private readonly solid: boolean;
  private readonly shading: Shading;
  /** What is drawn of it: more vertices where a picture has seams. */
  private readonly pictured: PicturedShading | null;
  /** Of the mesh as it was given, until its shape changes: its vertices come first among those drawn. */
  private knownOutline: Uint32Array | undefined;
  private readonly given: MeshData;
  private readonly drawn: Float32Array;
  private readonly bakeGeometry: THREE.BufferGeometry | null;
  private readonly disposables: { dispose(): void }[] = [];
  private outline: { version: number; support: Support } | null = null;
  private faces: Float32Array;
  private sums: THREE.WebGLRenderTarget | null = null;
  private nextSums: THREE.WebGLRenderTarget | null = null;
  private readonly uniforms: Uniforms;
  private readonly sizeOfSums: { width: number; height: number };
  private scalar: THREE.BufferAttribute | null = null;
  private scalarMap: THREE.Texture | null = null;
  scalarValues: Float32Array | null = null;
  opacity = 1;

  #within = false;
  /** Of a fixture: drawn only while its part's mesh is translucent, and then always behind it. */
  get within(): boolean {
    return this.#within;
  }
  set within(within: boolean) {
    this.#within = within;
    const { material } = this.main;
    material.polygonOffset = within;
    material.polygonOffsetFactor = within ? 2 : 0;
    material.polygonOffsetUnits = within ? WITHIN_UNITS : 0;
  }
  /** Counts when a picture is framed. */
  framed = true;
  /** Counts changes of shape, so that pickers know when they are stale. */
  version = 0;

  constructor(
    mesh: MeshData,
    private origin: Vec3,
    shared: SurfaceUniforms,
    options: SurfaceOptions,
  ) {
    this.given = mesh;
    this.indices = mesh.indices;
    this.vertexCount = mesh.positions.length / 3;
    this.faces = new Float32Array(mesh.indices.length);
    const found = mesh.shading ?? findShading(mesh.positions, mesh.indices);
    this.solid = found.outward;
    this.closed = found.closed;
    this.knownOutline = found.outline;
    this.shading = mesh.normals
      ? { indices: mesh.indices, source: identity(this.vertexCount), normals: mesh.normals }
      : {
          indices: found.indices ?? mesh.indices,
          source: found.source ?? identity(this.vertexCount),
          normals: found.normals.slice(), // moving the mesh writes into them
        };
    this.pictured = mesh.texture && mesh.cornerUvs ? apartByUv(this.shading, mesh.cornerUvs) : null;
    const { source, normals, indices } = this.drawnShading;
    const count = source.length;
    this.drawn = new Float32Array(3 * count);
    this.writePositions(mesh.positions);
    const attribute = (array: Float32Array, size: number, live = false): THREE.BufferAttribute => {
      const buffer = new THREE.BufferAttribute(array, size);
      if (live) buffer.setUsage(THREE.DynamicDrawUsage);
      return buffer;
    };
    this.geometry.setAttribute('position', attribute(this.drawn, 3, true));
    this.geometry.setAttribute('normal', attribute(normals, 3, true));
    this.geometry.setIndex(new THREE.BufferAttribute(indices, 1));
    const defines: Record<string, string | number> = { SHADOW_TAPS: options.shadowTaps ?? 16 };
    if (mesh.colours) {
      this.geometry.setAttribute('colour', attribute(this.spread(mesh.colours, 3), 3, true));
      defines['COLOURS'] = 1;
    }
    const uvs = this.pictured?.uvs ?? (mesh.uvs ? this.spread(mesh.uvs, 2) : null);
    if (uvs) this.geometry.setAttribute('uv', attribute(uvs, 2));
    const texture = mesh.texture && uvs ? new THREE.Texture(mesh.texture as HTMLImageElement) : null;
    if (texture) {
      defines['TEXTURED'] = 1;
      texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
      texture.anisotropy = 8;
      texture.needsUpdate = true;
      this.disposables.push(texture);
    }
    if (options.picture) defines['OCCLUSION_MAP'] = 1;
    this.sizeOfSums = options.picture ?? {
      width: OCCLUSION_WIDTH,
      height: Math.max(1, Math.ceil(count / OCCLUSION_WIDTH)),
    };
    this.uniforms = {
      uAlbedo: { value: new THREE.Vector3(...options.albedo) },
      uOcclusion: { value: null },
      uOcclusionWidth: { value: this.sizeOfSums.width },
      uOcclusionHeight: { value: this.sizeOfSums.height },
      uOcclusionStrength: { value: 0 },
      uHighlight: { value: 0 },
      uOpacity: { value: 1 },
      uMap: { value: null },
      uMapRange: { value: new THREE.Vector2(0, 1) },
      uUnlit: { value: 0 },
      uTexture: { value: texture },
    };
    const material = new THREE.RawShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: surfaceVertex,
      fragmentShader: surfaceFragment,
      defines,
      uniforms: { ...shared.picture, ...shared.subject, ...this.uniforms },
      // The far side of a closed mesh only shows as specks along outlines.
      side: this.solid ? THREE.FrontSide : THREE.DoubleSide,
      blending: THREE.NoBlending,
      blendSrc: THREE.OneFactor,
      blendDst: THREE.OneMinusSrcAlphaFactor,
    });
    this.main = still(new THREE.Mesh(this.geometry, material));
    const depthMaterial = new THREE.RawShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: depthVertex,
      fragmentShader: depthFragment,
      uniforms: { uSection: shared.picture['uSection']!, uClip: shared.bake['uClip']! },
      side: THREE.DoubleSide,
      polygonOffset: true,
      polygonOffsetFactor: 1.5,
      polygonOffsetUnits: 2,
    });
    depthMaterial.colorWrite = false;
    this.depth = still(new THREE.Mesh(this.geometry, depthMaterial));

    const bakeMaterial = new THREE.RawShaderMaterial({
      glslVersion: THREE.GLSL3,
      defines: { BAKE_TAPS: 4 },
      vertexShader: options.picture ? bakeQuadVertex : bakeVertex,
      fragmentShader: options.picture ? bakeQuadFragment : bakeFragment,
      uniforms: {
        ...shared.bake,
        uBlur: { value: 0.0012 },
        uOcclusionWidth: this.uniforms['uOcclusionWidth']!,
        uOcclusionHeight: this.uniforms['uOcclusionHeight']!,
      },
      side: THREE.DoubleSide,
      depthTest: false,
      depthWrite: false,
      blending: THREE.CustomBlending,
      blendSrc: THREE.OneFactor,
      blendDst: THREE.OneFactor,
    });
    if (options.picture) {
      this.bakeGeometry = null;
      this.bake = still(new THREE.Mesh(this.geometry, bakeMaterial));
    } else {
      // Without an index every vertex is one point, and gl_VertexID its number.
      this.bakeGeometry = new THREE.BufferGeometry();
      this.bakeGeometry.setAttribute('position', this.geometry.getAttribute('position'));
      this.bakeGeometry.setAttribute('normal', this.geometry.getAttribute('normal'));
      this.bake = still(new THREE.Points(this.bakeGeometry, bakeMaterial));
    }
    this.disposables.push(this.geometry, material, depthMaterial, bakeMaterial);
    if (this.bakeGeometry) this.disposables.push(this.bakeGeometry);
  }

  private get drawnShading(): Shading {
    return this.pictured ?? this.shading;
  }

  /** x, y, z of the drawn vertices, from the scene's origin. */
  get positions(): Float32Array {
    return this.drawn;
  }

  /** Outline by few points; found anew only after the shape changed. */
  get support(): Support {
    if (!this.outline || this.outline.version !== this.version) {
      this.outline = {
        version: this.version,
        support: supportOf(this.drawn, this.knownOutline),
      };
    }
    return this.outline.support;
  }

  get triangleCount(): number {
    return this.indices.length / 3;
  }

  get drawnIndices(): Uint32Array {
    return this.drawnShading.indices;
  }

  updatePositions(positions: Float32Array | Float64Array, similar: boolean): void {
    this.writePositions(positions);
    this.geometry.getAttribute('position').needsUpdate = true;
    if (!similar) {
      updateNormals(this.shading, this.drawn, this.indices, this.faces);
      if (this.pictured) copyNormals(this.shading.normals, this.pictured);
      this.geometry.getAttribute('normal').needsUpdate = true;
      this.knownOutline = undefined;
    }
    ++this.version;
  }

  /** Of a mesh that came with colours. */
  updateColours(colours: Float32Array): void {
    const attribute = this.geometry.getAttribute('colour') as THREE.BufferAttribute;
    attribute.array.set(this.spread(colours, 3));
    attribute.needsUpdate = true;
  }

  /** Colours by values per mesh vertex; null goes back to plaster. Only values: keep `map` and set the range. `unlit`: as they are,
   *  without light and shadow of the view. */
  setScalar(
    values: Float32Array | null,
    map: THREE.Texture | null,
    minimum: number,
    maximum: number,
    unlit = false,
  ): void {
    const material = this.main.material;
    this.scalarValues = values;
    const wasMapped = this.scalar !== null;
    if (values && map) {
      const spread = this.spread(values, 1);
      if (this.scalar && this.scalar.array.length === spread.length) {
        this.scalar.array.set(spread);
        this.scalar.needsUpdate = true;
      } else {
        this.scalar = new THREE.BufferAttribute(spread, 1).setUsage(THREE.DynamicDrawUsage);
        this.geometry.setAttribute('scalar', this.scalar);
      }
      this.scalarMap = map;
    } else if (wasMapped) {
      this.geometry.deleteAttribute('scalar');
      this.scalar = null;
      this.scalarMap = null;
    }
    if (wasMapped !== (this.scalar !== null)) {
      if (this.scalar) material.defines['SCALAR'] = 1;
      else delete material.defines['SCALAR'];
      material.needsUpdate = true;
    }
    this.uniforms['uMap']!.value = this.scalarMap;
    (this.uniforms['uMapRange']!.value as THREE.Vector2).set(minimum, maximum);
    this.uniforms['uUnlit']!.value = unlit ? 1 : 0;
  }

  /** A cut shows the inside. */
  setCut(cut: boolean): void {
    this.main.material.side = this.solid && !cut ? THREE.FrontSide : THREE.DoubleSide;
  }

  setOpacity(opacity: number): void {
    this.opacity = opacity;
    this.uniforms['uOpacity']!.value = opacity;
    this.main.material.blending = opacity < 1 ? THREE.CustomBlending : THREE.NoBlending;
  }

  setOcclusionStrength(strength: number): void {
    this.uniforms['uOcclusionStrength']!.value = this.sums ? strength : 0;
  }

  /** The light map being baked; take it over with `finishBake`. */
  beginBake(): THREE.WebGLRenderTarget {
    this.nextSums ??= occlusionTarget(this.sizeOfSums.width, this.sizeOfSums.height);
    return this.nextSums;
  }

  get baking(): THREE.WebGLRenderTarget | null {
    return this.nextSums;
  }

  finishBake(): void {
    if (!this.nextSums) return;
    this.sums?.dispose();
    this.sums = this.nextSums;
    this.nextSums = null;
    this.uniforms['uOcclusion']!.value = this.sums.texture;
  }

  get baked(): boolean {
    return this.sums !== null;
  }

  /** After the graphics context came back, light maps are empty. */
  forgetBake(): void {
    this.sums?.dispose();
    this.nextSums?.dispose();
    this.sums = this.nextSums = null;
    this.uniforms['uOcclusion']!.value = null;
    this.uniforms['uOcclusionStrength']!.value = 0;
  }

  dispose(): void {
    this.forgetBake();
    for (const item of this.disposables) item.dispose();
  }

  private writePositions(positions: Float32Array | Float64Array): void {
    const { drawn } = this;
    const { source } = this.drawnShading;
    const [ox, oy, oz] = this.origin;
    for (let i = 0, j = 0; i < source.length; ++i, j += 3) {
      const s = 3 * source[i]!;
      drawn[j] = positions[s]! - ox;
      drawn[j + 1] = positions[s + 1]! - oy;
      drawn[j + 2] = positions[s + 2]! - oz;
    }
  }

  /** Values per mesh vertex to values per drawn vertex. */
  private spread(values: Float32Array, size: number): Float32Array {
    const { source } = this.drawnShading;
    const out = new Float32Array(size * source.length);
    out.set(values.subarray(0, size * this.vertexCount));
    for (let i = this.vertexCount; i < source.length; ++i) {
      for (let k = 0; k < size; ++k) out[size * i + k] = values[size * source[i]! + k]!;
    }
    return out;
  }

  get mesh(): MeshData {
    return this.given;
  }
}

function identity(count: number): Uint32Array {
  const out = new Uint32Array(count);
  for (let i = 0; i < count; ++i) out[i] = i;
  return out;
}
