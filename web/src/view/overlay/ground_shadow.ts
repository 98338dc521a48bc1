// SPDX-License-Identifier: GPL-3.0-or-later
// The ground below an object with the object's shadow, as under a wide lamp straight above: from one depth map seen from
// below. Where the object touches the ground the shadow is dark and sharp, below what is higher it is pale and soft.
import * as THREE from 'three';
import type { Vec3 } from '../api';
import type { CameraState } from '../camera/camera';
import { type PlateFrame, groundFrame, plateFront } from './plate';
import {
  LAYER_BLURS,
  groundBlurFragment,
  groundFragment,
  groundLayersFragment,
  groundVertex,
} from '../render/ground_shaders';
import { ScreenPass } from '../render/passes';
import { type Surface, type Uniforms, still } from '../render/surface';
import type { Support } from '../mesh/support';
import { along, dot, scale, subtract } from '../vector';

/** Half the ground's side, in the object's radii. */
const REACH = 2.4;
/** Highest place of an object that has a value of its own, in radii: none is higher than twice its radius. */
const HIGHEST = 2.5;

export class GroundShadow {
  readonly mesh: THREE.Mesh<THREE.BufferGeometry, THREE.RawShaderMaterial>;
  readonly up: Vec3;
  private readonly frame: PlateFrame;
  private readonly radius: number;
  private readonly uniforms: Uniforms = { uLayers: { value: null }, uReady: { value: 0 } };
  private shown: THREE.WebGLRenderTarget | null = null;

  /** `origin`: of the scene, in model mm; `support` is measured from it. */
  constructor(
    support: Support,
    up: Vec3,
    private readonly origin: Vec3,
    /** Texels along a side. */
    private readonly size: number,
  ) {
    this.up = up;
    this.radius = support.radius;
    let lowest = Infinity;
    const { points } = support;
    for (let i = 0; i < points.length; i += 3)
      lowest = Math.min(
        lowest,
        dot(up, [points[i] as number, points[i + 1] as number, points[i + 2] as number]),
      );
    this.frame = groundFrame(support.centre as Vec3, this.radius, lowest - 1e-3 * this.radius, up, REACH);
    const square = plateFront(this.frame);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(Float32Array.from(square.positions), 3));
    geometry.setAttribute('uv', new THREE.BufferAttribute(square.uvs as Float32Array, 2));
    geometry.setIndex(new THREE.BufferAttribute(square.indices, 1));
    const material = new THREE.RawShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: groundVertex,
      fragmentShader: groundFragment,
      uniforms: this.uniforms,
      side: THREE.DoubleSide,
      transparent: true,
      depthWrite: false,
      blending: THREE.CustomBlending,
      blendSrc: THREE.OneFactor,
      blendDst: THREE.OneMinusSrcAlphaFactor,
    });
    this.mesh = still(new THREE.Mesh(geometry, material));
  }

  /** From below, the ground would stand before the object. */
  seenFrom(camera: CameraState): boolean {
    if (camera.kappa === 0) return dot(camera.forward, this.up) < 0;
    const eye = along(camera.target, camera.forward, -1 / camera.kappa);
    return dot(subtract(subtract(eye, this.origin), this.frame.centre), this.up) > 0;
  }

  /** Finds the shadow anew. `clip`: the uniform that the casters' depth materials read. */
  prepare(renderer: THREE.WebGLRenderer, casters: readonly Surface[], clip: THREE.Matrix4): void {
    const { size } = this;
    const depth = new THREE.WebGLRenderTarget(size, size, {
      depthTexture: new THREE.DepthTexture(size, size, THREE.UnsignedIntType),
      format: THREE.RedFormat,
      generateMipmaps: false,
      minFilter: THREE.NearestFilter,
      magFilter: THREE.NearestFilter,
    });
    this.aim(clip);
    draw(
      renderer,
      depth,
      casters.map((caster) => caster.depth),
    );
    const [layers, across] = [layerTarget(size), layerTarget(size)];
    const layering = new ScreenPass(groundLayersFragment, {
      uDepth: { value: depth.depthTexture },
      uHighest: { value: HIGHEST },
    });
    const texel = (2 * REACH) / size;
    const blurring = new ScreenPass(
      groundBlurFragment,
      { uImage: { value: null }, uStep: { value: new THREE.Vector2() }, uTexel: { value: texel } },
      { defines: { RADIUS: Math.ceil((2.5 * LAYER_BLURS[3]) / texel) } },
    );
    const blur = (from: THREE.WebGLRenderTarget, to: THREE.WebGLRenderTarget, x: number, y: number): void => {
      (blurring.uniforms['uImage'] as THREE.IUniform).value = from.texture;
      (blurring.uniforms['uStep']?.value as THREE.Vector2).set(x / size, y / size);
      draw(renderer, to, [blurring.mesh]);
    };
    draw(renderer, layers, [layering.mesh]);
    blur(layers, across, 1, 0);
    blur(across, layers, 0, 1);
    for (const made of [depth, across, layering, blurring]) made.dispose();
    this.shown?.dispose();
    this.shown = layers;
    (this.uniforms['uLayers'] as THREE.IUniform).value = layers.texture;
    (this.uniforms['uReady'] as THREE.IUniform).value = 1;
  }

  /** The ground's square fills the map; depth 0 is the ground, 1 is HIGHEST radii above it. */
  private aim(clip: THREE.Matrix4): void {
    const { right, up, centre, halfWidth, halfHeight } = this.frame;
    const high = 0.5 * HIGHEST * this.radius;
    const [r, u, h] = [scale(right, 1 / halfWidth), scale(up, 1 / halfHeight), scale(this.up, 1 / high)];
    // prettier-ignore
    clip.set(
      r[0], r[1], r[2], -dot(r, centre),
      u[0], u[1], u[2], -dot(u, centre),
      h[0], h[1], h[2], -dot(h, centre) - 1,
      0, 0, 0, 1,
    );
  }

  /** After the graphics context came back. */
  forgetGpu(): void {
    this.shown?.dispose();
    this.shown = null;
    (this.uniforms['uLayers'] as THREE.IUniform).value = null;
    (this.uniforms['uReady'] as THREE.IUniform).value = 0;
  }

  dispose(): void {
    this.forgetGpu();
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}

const scene = new THREE.Scene();
const camera = new THREE.Camera();
for (const object of [scene, camera]) object.matrixWorldAutoUpdate = false;

function draw(
  renderer: THREE.WebGLRenderer,
  target: THREE.WebGLRenderTarget,
  objects: THREE.Object3D[],
): void {
  renderer.setRenderTarget(target);
  renderer.setClearColor(0x000000, 0);
  renderer.clear(true, true, false);
  scene.children = objects;
  renderer.render(scene, camera);
  scene.children = [];
}

function layerTarget(size: number): THREE.WebGLRenderTarget {
  return new THREE.WebGLRenderTarget(size, size, {
    type: THREE.HalfFloatType,
    minFilter: THREE.LinearFilter,
    magFilter: THREE.LinearFilter,
    depthBuffer: false,
    generateMipmaps: false,
  });
}
