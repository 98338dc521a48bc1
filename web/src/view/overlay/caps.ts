// SPDX-License-Identifier: GPL-3.0-or-later
// The filled face of a cut. Looking through the cut, a ray that enters a closed mesh without having left it
// starts inside: counting back faces against front faces in the stencil marks those pixels.
import * as THREE from 'three';
import { capFragment, capVertex } from '../render/line_shaders';
import { depthFragment } from '../render/surface_shaders';
import type { Subject } from '../render/subject';
import { type Surface, type Uniforms, still } from '../render/surface';
import type { Vec3 } from '../api';
import { add, perpendicular, rotate, scale } from '../vector';

const countVertex = /* glsl */ `
precision highp float;
in vec3 position;
uniform mat4 projectionMatrix;
out vec3 vPosition;
void main() { vPosition = position; gl_Position = projectionMatrix * vec4(position, 1.0); }
`;

export class SectionCaps {
  private readonly counting: THREE.RawShaderMaterial[];
  private readonly quad: THREE.Mesh<THREE.BufferGeometry, THREE.RawShaderMaterial>;
  private readonly counters = new WeakMap<Surface, THREE.Mesh[]>();

  constructor(private readonly picture: Uniforms) {
    this.counting = ([THREE.BackSide, THREE.FrontSide] as const).map((side) => {
      const operation = side === THREE.BackSide ? THREE.IncrementWrapStencilOp : THREE.DecrementWrapStencilOp;
      const material = new THREE.RawShaderMaterial({
        glslVersion: THREE.GLSL3,
        vertexShader: countVertex,
        fragmentShader: depthFragment,
        uniforms: { uSection: picture['uSection'] as THREE.IUniform },
        side,
        depthTest: false,
        depthWrite: false,
        stencilWrite: true,
        stencilFunc: THREE.AlwaysStencilFunc,
        stencilFail: operation,
        stencilZFail: operation,
        stencilZPass: operation,
      });
      material.colorWrite = false;
      return material;
    });
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(12), 3));
    geometry.setIndex(new THREE.BufferAttribute(Uint32Array.of(0, 1, 2, 0, 2, 3), 1));
    this.quad = still(
      new THREE.Mesh(
        geometry,
        new THREE.RawShaderMaterial({
          glslVersion: THREE.GLSL3,
          vertexShader: capVertex,
          fragmentShader: capFragment,
          uniforms: {
            uColour: { value: new THREE.Vector3(0.93, 0.78, 0.62) },
            uHatch: { value: new THREE.Vector3(0.72, 0.49, 0.3) },
            uPitch: { value: 10 },
          },
          side: THREE.DoubleSide,
          stencilWrite: true,
          stencilFunc: THREE.NotEqualStencilFunc,
          stencilRef: 0,
          stencilFail: THREE.KeepStencilOp,
          stencilZFail: THREE.KeepStencilOp,
          stencilZPass: THREE.KeepStencilOp,
        }),
      ),
    );
  }

  /** What to draw, one step after the other, once the stencil is cleared. Open meshes have no inside: no cap. */
  steps(subject: Subject, hasPlate: boolean): THREE.Object3D[][] {
    const solid = subject.surfaces.filter((surface, i) => {
      // Front and body of a plate are closed together.
      if (hasPlate && i > 0) return true;
      return surface.closed;
    });
    if (solid.length === 0) return [];
    const meshes = solid.map((surface) => {
      let pair = this.counters.get(surface);
      if (!pair) {
        pair = this.counting.map((material) => still(new THREE.Mesh(surface.geometry, material)));
        this.counters.set(surface, pair);
      }
      return pair;
    });
    this.aim(subject);
    return [meshes.flat(), [this.quad]];
  }

  private aim(subject: Subject): void {
    const s = this.picture['uSection']?.value as THREE.Vector4;
    const n: Vec3 = [s.x, s.y, s.z];
    const { centre, radius } = subject.support;
    const level = s.w - (n[0] * centre[0] + n[1] * centre[1] + n[2] * centre[2]);
    const middle = add(centre, scale(n, level));
    const a = scale(perpendicular(n), 1.5 * radius);
    const b = rotate(a, n, Math.PI / 2);
    const positions = this.quad.geometry.getAttribute('position') as THREE.BufferAttribute;
    [add(a, b), add(scale(a, -1), b), add(scale(a, -1), scale(b, -1)), add(a, scale(b, -1))].forEach((p, i) =>
      positions.setXYZ(i, ...add(middle, p)),
    );
    positions.needsUpdate = true;
  }

  dispose(): void {
    for (const material of this.counting) material.dispose();
    this.quad.geometry.dispose();
    this.quad.material.dispose();
  }
}
