// SPDX-License-Identifier: GPL-3.0-or-later
// The shadow a plate throws on the bench behind it, blurred in closed form.
import * as THREE from 'three';
import type { Vec3 } from '../api';
import { type CameraState } from '../camera/camera';
import { type PlateFrame, plateCorners, rectangle } from './plate';
import { plateShadowFragment, plateShadowVertex } from '../render/screen_shaders';
import { type Uniforms, still } from '../render/surface';
import { along, dot, scale, subtract } from '../vector';

export class PlateShadow {
  readonly mesh: THREE.Mesh<THREE.BufferGeometry, THREE.RawShaderMaterial>;
  private readonly uniforms: Uniforms;
  private readonly size: number;

  constructor(
    private readonly frame: PlateFrame,
    origin: Vec3,
  ) {
    this.size = 2 * Math.max(frame.halfWidth, frame.halfHeight);
    const reach = 0.45 * this.size;
    const w = frame.halfWidth + reach;
    const h = frame.halfHeight + reach;
    const wide = { ...frame, halfWidth: w, halfHeight: h };
    const quad = rectangle(plateCorners(wide, frame.thickness + 0.01 * reach), scale(frame.forward, -1));
    const geometry = new THREE.BufferGeometry();
    const positions = Float32Array.from(quad.positions, (x, i) => x - (origin[i % 3] as number));
    geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
    geometry.setAttribute('uv', new THREE.BufferAttribute(Float32Array.of(-w, -h, w, -h, w, h, -w, h), 2));
    geometry.setIndex(new THREE.BufferAttribute(quad.indices, 1));
    this.uniforms = {
      uHalf: { value: new THREE.Vector2(frame.halfWidth, frame.halfHeight) },
      uShift: { value: new THREE.Vector2() },
      uBlur: { value: 0.035 * this.size },
      uStrength: { value: 0.4 },
    };
    const material = new THREE.RawShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: plateShadowVertex,
      fragmentShader: plateShadowFragment,
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

  /** From behind there is no bench. */
  seenFrom(camera: CameraState): boolean {
    const { forward, centre } = this.frame;
    if (camera.kappa === 0) return dot(camera.forward, forward) > 0.02;
    const eye = along(camera.target, camera.forward, -1 / camera.kappa);
    return dot(subtract(centre, eye), forward) > 0;
  }

  aim(towards: Vec3, dark: boolean): void {
    const clamp = (x: number): number => Math.min(1, Math.max(-1, 2 * x));
    (this.uniforms['uShift']?.value as THREE.Vector2).set(
      -0.018 * this.size * clamp(dot(towards, this.frame.right)),
      -0.026 * this.size * clamp(dot(towards, this.frame.up)),
    );
    (this.uniforms['uStrength'] as THREE.IUniform).value = dark ? 0.55 : 0.42;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}
