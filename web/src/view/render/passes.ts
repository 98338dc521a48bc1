// SPDX-License-Identifier: GPL-3.0-or-later
// Passes over the whole screen, and the average of many jittered pictures that a still view becomes.
import * as THREE from 'three';
import { copyFragment, screenVertex } from './screen_shaders';
import { type Uniforms, still } from './surface';

const TRIANGLE = Float32Array.of(-1, -1, 0, 3, -1, 0, -1, 3, 0);

export class ScreenPass {
  readonly mesh: THREE.Mesh<THREE.BufferGeometry, THREE.RawShaderMaterial>;
  constructor(
    fragment: string,
    readonly uniforms: Uniforms,
    options: { additive?: boolean; defines?: Record<string, number> } = {},
  ) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(TRIANGLE, 3));
    const material = new THREE.RawShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: screenVertex,
      fragmentShader: fragment,
      uniforms,
      defines: options.defines ?? {},
      depthTest: false,
      depthWrite: false,
      blending: options.additive ? THREE.CustomBlending : THREE.NoBlending,
      blendSrc: THREE.OneFactor,
      blendDst: THREE.OneFactor,
    });
    this.mesh = still(new THREE.Mesh(geometry, material));
  }
  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}

export class Accumulation {
  readonly frame: THREE.WebGLRenderTarget;
  private readonly sum: THREE.WebGLRenderTarget;
  private readonly adding = new ScreenPass(
    copyFragment,
    { uImage: { value: null }, uWeight: { value: 1 } },
    { additive: true, defines: { ACCUMULATE: 1 } },
  );
  private readonly showing = new ScreenPass(copyFragment, { uImage: { value: null }, uWeight: { value: 1 } });
  private readonly dividing = new ScreenPass(
    copyFragment,
    { uImage: { value: null }, uWeight: { value: 1 } },
    { defines: { ACCUMULATE: 1 } },
  );
  private readonly scene = new THREE.Scene();
  private readonly camera = new THREE.Camera();
  private count = 0;

  constructor(
    readonly width: number,
    readonly height: number,
  ) {
    this.frame = new THREE.WebGLRenderTarget(width, height, {
      depthBuffer: true,
      stencilBuffer: true,
      minFilter: THREE.NearestFilter,
      magFilter: THREE.NearestFilter,
      generateMipmaps: false,
    });
    this.sum = new THREE.WebGLRenderTarget(width, height, {
      type: THREE.FloatType,
      depthBuffer: false,
      minFilter: THREE.NearestFilter,
      magFilter: THREE.NearestFilter,
      generateMipmaps: false,
    });
    this.scene.matrixWorldAutoUpdate = false;
    this.camera.matrixWorldAutoUpdate = false;
  }

  private pass(
    renderer: THREE.WebGLRenderer,
    pass: ScreenPass,
    target: THREE.WebGLRenderTarget | null,
  ): void {
    renderer.setRenderTarget(target);
    this.scene.children = [pass.mesh];
    renderer.render(this.scene, this.camera);
    this.scene.children = [];
  }

  /** Adds `frame` as picture number `index`; 0 begins anew. */
  add(renderer: THREE.WebGLRenderer, index: number): void {
    if (index === 0) {
      renderer.setRenderTarget(this.sum);
      renderer.setClearColor(0x000000, 0);
      renderer.clear(true, false, false);
      this.count = 0;
    }
    (this.adding.uniforms['uImage'] as THREE.IUniform).value = this.frame.texture;
    this.pass(renderer, this.adding, this.sum);
    ++this.count;
  }

  /** Shows the average, or the picture in `frame`, on the canvas. */
  show(renderer: THREE.WebGLRenderer, what: 'average' | 'frame'): void {
    const average = what === 'average';
    (this.showing.uniforms['uImage'] as THREE.IUniform).value = average
      ? this.sum.texture
      : this.frame.texture;
    (this.showing.uniforms['uWeight'] as THREE.IUniform).value = average ? 1 / Math.max(1, this.count) : 1;
    renderer.setViewport(0, 0, this.width, this.height);
    renderer.setScissorTest(false);
    this.pass(renderer, this.showing, null);
  }

  async read(renderer: THREE.WebGLRenderer): Promise<Uint8ClampedArray<ArrayBuffer>> {
    (this.dividing.uniforms['uImage'] as THREE.IUniform).value = this.sum.texture;
    (this.dividing.uniforms['uWeight'] as THREE.IUniform).value = 1 / Math.max(1, this.count);
    this.frame.scissorTest = false;
    this.pass(renderer, this.dividing, this.frame);
    const { width, height } = this;
    const raw = new Uint8Array(4 * width * height);
    await renderer.readRenderTargetPixelsAsync(this.frame, 0, 0, width, height, raw);
    const flipped = new Uint8ClampedArray(raw.length);
    for (let y = 0; y < height; ++y) {
      flipped.set(raw.subarray(4 * width * y, 4 * width * (y + 1)), 4 * width * (height - 1 - y));
    }
    // Straight alpha, as images want it.
    for (let i = 0; i < flipped.length; i += 4) {
      const a = flipped[i + 3] as number;
      if (a === 0 || a === 255) continue;
      for (let k = 0; k < 3; ++k) flipped[i + k] = ((flipped[i + k] as number) * 255) / a;
    }
    return flipped;
  }

  dispose(): void {
    this.frame.dispose();
    this.sum.dispose();
    this.adding.dispose();
    this.showing.dispose();
    this.dividing.dispose();
  }
}
