// SPDX-License-Identifier: GPL-3.0-or-later
// What shares one light: a mesh, with its plate or its ground. Holds the key light's shadow map and bakes
// how much of the sky each vertex sees (ambient occlusion, by shadow maps from many directions).
import * as THREE from 'three';
import type { Vec3 } from '../api';
import type { GroundShadow } from '../overlay/ground_shadow';
import type { Quality } from './quality';
import { type Support, sphereDirections, supportOf } from '../mesh/support';
import type { Surface, Uniforms } from './surface';
import { dot, perpendicular, viewerAxes } from '../vector';

/** Light that comes back from the ground, as a share of the sky's. */
const GROUND_BOUNCE = 0.45;

function depthTarget(size: number): THREE.WebGLRenderTarget {
  const depthTexture = new THREE.DepthTexture(size, size, THREE.UnsignedIntType);
  depthTexture.compareFunction = THREE.LessEqualCompare;
  depthTexture.minFilter = THREE.LinearFilter;
  depthTexture.magFilter = THREE.LinearFilter;
  return new THREE.WebGLRenderTarget(size, size, {
    depthTexture,
    format: THREE.RedFormat,
    generateMipmaps: false,
    minFilter: THREE.NearestFilter,
    magFilter: THREE.NearestFilter,
  });
}

export function newBakeUniforms(): Uniforms {
  return {
    uClip: { value: new THREE.Matrix4() },
    uDirection: { value: new THREE.Vector3() },
    uShadowMatrix: { value: new THREE.Matrix4() },
    uShadow: { value: null },
    uShadowOffset: { value: 0 },
    uSeen: { value: 1 },
  };
}

/** Draws depth from far away along `towards`; returns the texel's size, mm. */
export class DepthView {
  readonly scene = new THREE.Scene();
  readonly camera = new THREE.Camera();
  constructor() {
    this.scene.matrixWorldAutoUpdate = false;
    this.camera.matrixWorldAutoUpdate = false;
  }
}

function jointSupport(surfaces: readonly Surface[]): Support {
  const all = surfaces.map((s) => s.support.points);
  const joined = new Float32Array(all.reduce((n, p) => n + p.length, 0));
  let at = 0;
  for (const p of all) {
    joined.set(p, at);
    at += p.length;
  }
  return supportOf(joined);
}

export class Subject {
  readonly uniforms: Uniforms = {
    uShadow: { value: null },
    uShadowMatrix: { value: new THREE.Matrix4() },
    uShadowOffset: { value: 0 },
    uShadowRadius: { value: new THREE.Vector2() },
    uShadowOn: { value: 0 },
  };
  /** Below the object, where there is one. It receives the object's shadow and throws none. */
  ground: GroundShadow | null = null;
  /** Everything drawn, in order. */
  surfaces: Surface[] = [];
  support: Support = supportOf(new Float32Array(0));
  /** Of what the picture is framed for. */
  framing: Support = this.support;
  private shadow: THREE.WebGLRenderTarget | null = null;
  private shadowKey = '';
  private texelMm = 0;
  private skyNext = 0;
  private skyDone = false;

  private readonly directions: Float32Array;

  constructor(
    private readonly bakeUniforms: Uniforms,
    private readonly quality: Quality,
  ) {
    this.directions = sphereDirections(quality.skyDirections);
  }

  /** Shape or parts changed: bounds anew; shadow and sky follow when next drawn or at rest. */
  changed(): void {
    this.support = jointSupport(this.surfaces);
    const framed = this.surfaces.filter((s) => s.framed);
    this.framing = framed.length === this.surfaces.length ? this.support : jointSupport(framed);
    this.shadowKey = '';
    this.skyNext = 0;
    this.skyDone = false;
  }

  /** What is inside an opaque mesh lies in its shadow anyway; what is seen through throws none. */
  private casters(): Surface[] {
    const open = this.surfaces.some((s) => s.opacity < 1);
    return this.surfaces.filter((s) => s.opacity === 1 && (open || !s.within));
  }

  get triangleCount(): number {
    return this.surfaces.reduce((n, s) => n + s.triangleCount, 0);
  }

  /** Sets clip matrix and look-up matrix for depth seen along -towards. Returns mm per texel. */
  private aim(towards: Vec3, size: number, lookup: THREE.Matrix4): number {
    const axes = viewerAxes([-towards[0], -towards[1], -towards[2]], perpendicular(towards));
    const lo: [number, number, number] = [Infinity, Infinity, Infinity];
    const hi: [number, number, number] = [-Infinity, -Infinity, -Infinity];
    const { points } = this.support;
    for (let i = 0; i < points.length; i += 3) {
      [axes.right, axes.up, axes.forward].forEach((axis, k) => {
        const s =
          axis[0] * (points[i] as number) +
          axis[1] * (points[i + 1] as number) +
          axis[2] * (points[i + 2] as number);
        if (s < (lo[k] as number)) lo[k] = s;
        if (s > (hi[k] as number)) hi[k] = s;
      });
    }
    // The outline points are a sample: leave a margin.
    const margin = 0.03 * this.support.radius;
    const centre = lo.map((l, k) => (l + (hi[k] as number)) / 2);
    const half = lo.map((l, k) => ((hi[k] as number) - l) / 2 + margin);
    const [r, u, f] = [axes.right, axes.up, axes.forward];
    const [cx, cy, cz] = centre as [number, number, number];
    const [hx, hy, hz] = half as [number, number, number];
    const clip = this.bakeUniforms['uClip']?.value as THREE.Matrix4;
    // prettier-ignore
    clip.set(
      r[0] / hx, r[1] / hx, r[2] / hx, -cx / hx,
      u[0] / hy, u[1] / hy, u[2] / hy, -cy / hy,
      f[0] / hz, f[1] / hz, f[2] / hz, -cz / hz,
      0, 0, 0, 1,
    );
    // prettier-ignore
    lookup.set(0.5, 0, 0, 0.5, 0, 0.5, 0, 0.5, 0, 0, 0.5, 0.5, 0, 0, 0, 1).multiply(clip);
    return (2 * Math.max(hx, hy)) / size;
  }

  private drawDepth(renderer: THREE.WebGLRenderer, view: DepthView, target: THREE.WebGLRenderTarget): void {
    view.scene.children = this.casters().map((s) => s.depth);
    renderer.setRenderTarget(target);
    renderer.clear(false, true, false);
    renderer.render(view.scene, view.camera);
    view.scene.children = [];
  }

  /** Makes sure the shadow map holds the light from `towards`. `softness`: blur on the map, mm. */
  prepareShadow(
    renderer: THREE.WebGLRenderer,
    view: DepthView,
    towards: Vec3,
    softness: number,
    sectionKey: string,
  ): void {
    const key = `${towards.join()}|${sectionKey}`;
    (this.uniforms['uShadowRadius']?.value as THREE.Vector2).setScalar(softness / (2 * this.support.radius));
    if (key !== this.shadowKey && this.surfaces.length > 0) this.drawShadow(renderer, view, towards, key);
    // Blurred look-ups reach into the slope beside the point: stand further off.
    this.uniform('uShadowOffset').value = 1.2 * this.texelMm + 0.45 * softness;
  }

  private drawShadow(renderer: THREE.WebGLRenderer, view: DepthView, towards: Vec3, key: string): void {
    const { shadowSize } = this.quality;
    this.shadow ??= depthTarget(shadowSize);
    const lookup = this.uniforms['uShadowMatrix'] as THREE.IUniform<THREE.Matrix4>;
    const mm = this.aim(towards, shadowSize, lookup.value);
    this.drawDepth(renderer, view, this.shadow);
    this.uniform('uShadow').value = this.shadow.depthTexture;
    this.texelMm = mm;
    this.uniform('uShadowOn').value = 1;
    this.shadowKey = key;
  }

  private uniform(name: string): THREE.IUniform {
    return this.uniforms[name] as THREE.IUniform;
  }

  get bakePending(): boolean {
    if (this.surfaces.length === 0 || this.skyDone) return false;
    return this.ground !== null || this.worthSky;
  }

  private get worthSky(): boolean {
    return this.triangleCount <= this.quality.skyTriangles;
  }

  get baked(): boolean {
    return this.surfaces.some((s) => s.baked);
  }

  /** Bakes some more directions of the sky; true when that finished it. `scratch` is shared by all subjects. */
  bake(renderer: THREE.WebGLRenderer, view: DepthView, scratch: SkyScratch, steps: number): boolean {
    if (!this.bakePending) return false;
    if (this.skyNext === 0) {
      this.ground?.prepare(renderer, this.casters(), this.bakeUniforms['uClip']?.value as THREE.Matrix4);
      if (!this.worthSky) return (this.skyDone = true);
      for (const surface of this.surfaces) {
        renderer.setRenderTarget(surface.beginBake());
        renderer.clear(true, false, false);
      }
    }
    const lookup = this.bakeUniforms['uShadowMatrix']?.value as THREE.Matrix4;
    const { directions } = this;
    const { skyDirections, skySize } = this.quality;
    const target = scratch.target();
    for (let i = 0; i < steps && this.skyNext < skyDirections; ++i, ++this.skyNext) {
      const d = 3 * this.skyNext;
      const towards: Vec3 = [
        directions[d] as number,
        directions[d + 1] as number,
        directions[d + 2] as number,
      ];
      const mm = this.aim(towards, skySize, lookup);
      (this.bakeUniforms['uDirection']?.value as THREE.Vector3).set(...towards);
      (this.bakeUniforms['uSeen'] as THREE.IUniform).value =
        this.ground && dot(towards, this.ground.up) < 0 ? GROUND_BOUNCE : 1;
      this.drawDepth(renderer, view, target);
      (this.bakeUniforms['uShadow'] as THREE.IUniform).value = target.depthTexture;
      (this.bakeUniforms['uShadowOffset'] as THREE.IUniform).value = 2.5 * mm;
      for (const surface of this.surfaces) {
        view.scene.children = [surface.bake];
        renderer.setRenderTarget(surface.baking);
        renderer.render(view.scene, view.camera);
      }
      view.scene.children = [];
    }
    if (this.skyNext < skyDirections) return false;
    for (const surface of this.surfaces) surface.finishBake();
    this.skyDone = true;
    return true;
  }

  setOcclusionStrength(strength: number): void {
    for (const surface of this.surfaces) surface.setOcclusionStrength(strength);
  }

  forgetGpu(): void {
    this.shadow?.dispose();
    this.shadow = null;
    this.shadowKey = '';
    this.uniform('uShadow').value = null;
    this.uniform('uShadowOn').value = 0;
    this.skyNext = 0;
    this.skyDone = false;
    this.ground?.forgetGpu();
    for (const surface of this.surfaces) surface.forgetBake();
  }

  dispose(): void {
    this.forgetGpu();
    for (const surface of this.surfaces) surface.dispose();
    this.surfaces = [];
  }
}

/** The depth map all sky samples share. */
export class SkyScratch {
  private depth: THREE.WebGLRenderTarget | null = null;
  constructor(private readonly size: number) {}
  target(): THREE.WebGLRenderTarget {
    this.depth ??= depthTarget(this.size);
    return this.depth;
  }
  dispose(): void {
    this.depth?.dispose();
    this.depth = null;
  }
}
