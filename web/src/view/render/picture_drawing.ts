// SPDX-License-Identifier: GPL-3.0-or-later
// Draws one picture of the parts: shadows first, then each part in its columns, its section and its lines.
import * as THREE from 'three';
import type { Vec3 } from '../api';
import { clipMatrix, viewCoordinates } from '../camera/camera';
import { SectionCaps } from '../overlay/caps';
import { LineSet } from '../overlay/lines';
import { jitter } from './jitter';
import type { Part, PartName } from './part';
import { ScreenPass } from './passes';
import type { Lines, Picture, PictureUniforms } from './picture';
import type { Quality } from './quality';
import { backdropFragment } from './screen_shaders';
import type { StageParts } from './stage_parts';
import type { Subject } from './subject';
import type { Palette } from '../theme';
import { add, perpendicular, rotate } from '../vector';

/** Half angle of the key light as seen from the object, degrees: how soft its shadows are. */
const LIGHT_HALF_ANGLE = 2.6;
const OCCLUSION = 0.92;

export class PictureDrawing {
  readonly camera = new THREE.Camera();
  readonly scene = new THREE.Scene();
  private readonly backdrop = new ScreenPass(backdropFragment, {
    uCentre: { value: new THREE.Vector3() },
    uRim: { value: new THREE.Vector3() },
    uAspect: { value: new THREE.Vector2(1, 1) },
  });
  private readonly caps: SectionCaps;
  private lines: { set: LineSet; part: PartName | null }[] = [];
  private dark = false;

  constructor(
    private readonly renderer: THREE.WebGLRenderer,
    private readonly uniforms: PictureUniforms,
    private readonly parts: StageParts,
    private readonly quality: Quality,
  ) {
    this.camera.matrixWorldAutoUpdate = false;
    this.scene.matrixWorldAutoUpdate = false;
    this.caps = new SectionCaps(uniforms.values);
  }

  setPalette(palette: Palette): void {
    this.dark = palette.dark;
    (this.backdrop.uniforms['uCentre']?.value as THREE.Vector3).set(...palette.viewCentre);
    (this.backdrop.uniforms['uRim']?.value as THREE.Vector3).set(...palette.viewRim);
  }

  setLines(lines: readonly Lines[], pixelRatio: number): void {
    for (const { set } of this.lines) set.dispose();
    this.lines = lines.map(({ pieces, style, part, values }) => ({
      set: new LineSet(pieces, style, this.uniforms.values, pixelRatio, values),
      part: part ?? null,
    }));
  }

  /** Draws `picture` into the canvas or a target of `width` x `height` pixels. `sample` >= 0 is one of the
   *  jittered pictures of a refinement: its own place within the pixel and on the light. */
  draw(
    picture: Picture,
    target: THREE.WebGLRenderTarget | null,
    width: number,
    height: number,
    sample: number,
  ): void {
    const { renderer } = this;
    const [jitterX, jitterY, discX, discY] = sample < 0 ? [0, 0, 0, 0] : jitter(sample);
    const still = sample >= 0 && this.quality.softLight;
    const towards = lightWithin(picture.towardsLight, still ? [discX, discY] : [0, 0]);
    this.prepareShadows(picture, towards, still);
    this.uniforms.setPicture(picture, towards, width, height, sample);
    (this.backdrop.uniforms['uAspect']?.value as THREE.Vector2).set(
      Math.max(1, width / height) ** 0.5,
      Math.max(1, height / width) ** 0.5,
    );
    renderer.setRenderTarget(target);
    this.setScissor(target, 0, width, height, width);
    renderer.setClearColor(0x000000, picture.backdrop ? 1 : 0);
    renderer.clear(true, true, true);
    for (const { part, from, to } of picture.parts) {
      const left = Math.round(from * width);
      const right = Math.round(to * width);
      if (right <= left) continue;
      this.setScissor(target, left, width, height, right);
      this.setClip(picture, this.parts.parts[part].subject, width, height, [jitterX, jitterY]);
      this.drawPart(picture, this.parts.parts[part], part);
    }
    if (picture.parts.length === 0 && picture.backdrop) this.drawScene([this.backdrop.mesh]);
    this.setScissor(target, 0, width, height, width);
    renderer.setRenderTarget(null);
  }

  private prepareShadows(picture: Picture, towards: Vec3, still: boolean): void {
    for (const { part } of picture.parts) {
      const { subject, mesh } = this.parts.parts[part];
      // A still picture samples the light itself; a moving one blurs the shadow's edge instead.
      const softness = (still ? 0.0015 : 0.011) * (mesh ? subject.support.radius : 1);
      subject.prepareShadow(this.renderer, this.parts.depthView, towards, softness, this.uniforms.shadowKey);
      subject.setOcclusionStrength(OCCLUSION);
    }
  }

  private drawPart(picture: Picture, part: Part, name: PartName): void {
    if (picture.backdrop) this.drawScene([this.backdrop.mesh]);
    const objects: THREE.Object3D[] = [];
    const cut = this.uniforms.cutTest() !== null;
    for (const surface of part.subject.surfaces) {
      surface.setCut(cut);
      if (surface.within && part.opacity === 1) continue;
      if (surface.opacity === 1) objects.push(surface.main);
    }
    const { groundShadow, plateShadow } = part;
    if (groundShadow && picture.ground && groundShadow.seenFrom(picture.camera))
      objects.push(groundShadow.mesh);
    if (plateShadow && picture.plateShadow && !cut && plateShadow.seenFrom(picture.camera)) {
      plateShadow.aim(picture.towardsLight, this.dark);
      objects.push(plateShadow.mesh);
    }
    // What is seen through comes after what is behind it.
    for (const surface of part.subject.surfaces) if (surface.opacity < 1) objects.push(surface.main);
    this.drawScene(objects);
    if (cut) {
      this.renderer.clear(false, false, true);
      for (const step of this.caps.steps(part.subject, part.plate !== null)) this.drawScene(step);
    }
    const lines = this.lines.filter((l) => l.part === null || l.part === name).flatMap((l) => l.set.objects);
    if (lines.length > 0) this.drawScene(lines);
  }

  private drawScene(objects: THREE.Object3D[]): void {
    this.scene.children = objects;
    this.renderer.render(this.scene, this.camera);
    this.scene.children = [];
  }

  private setScissor(
    target: THREE.WebGLRenderTarget | null,
    left: number,
    width: number,
    height: number,
    right: number,
  ): void {
    if (target) {
      target.viewport.set(0, 0, width, height);
      target.scissor.set(left, 0, right - left, height);
      target.scissorTest = true;
      this.renderer.setRenderTarget(target);
    } else {
      this.renderer.setViewport(0, 0, width, height);
      this.renderer.setScissor(left, 0, right - left, height);
      this.renderer.setScissorTest(true);
    }
  }

  private setClip(
    picture: Picture,
    subject: Subject,
    width: number,
    height: number,
    offset: readonly [number, number],
  ): void {
    const { camera, screen } = picture;
    const { origin } = this.uniforms;
    const { centre, radius } = subject.support;
    const c = viewCoordinates(camera, add(centre, origin))[2];
    // The ground reaches further than its object.
    const reach = (subject.ground ? 4 : 1.6) * radius;
    const m = clipMatrix(camera, screen, origin, c - reach, c + reach);
    // Jitter in pixels: x' = x + 2 jitter / width * w.
    for (let k = 0; k < 4; ++k) {
      const w = m[4 * k + 3] as number;
      m[4 * k] = (m[4 * k] as number) + ((2 * offset[0]) / width) * w;
      m[4 * k + 1] = (m[4 * k + 1] as number) + ((2 * offset[1]) / height) * w;
    }
    this.camera.projectionMatrix.fromArray(m);
  }

  dispose(): void {
    for (const { set } of this.lines) set.dispose();
    this.caps.dispose();
    this.backdrop.dispose();
  }
}

/** The direction to a point of the light's disc, from its middle (0, 0) to its edge (length 1). */
function lightWithin(towardsLight: Vec3, [x, y]: readonly [number, number]): Vec3 {
  const angle = (LIGHT_HALF_ANGLE * Math.PI) / 180;
  const side = perpendicular(towardsLight);
  return rotate(rotate(towardsLight, side, angle * x), rotate(side, towardsLight, Math.PI / 2), angle * y);
}
