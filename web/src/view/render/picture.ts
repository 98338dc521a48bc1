// SPDX-License-Identifier: GPL-3.0-or-later
// What a picture is made of, and the values of it that all shaders share: section, light and camera.
import * as THREE from 'three';
import type { Vec3 } from '../api';
import type { CameraState, Screen } from '../camera/camera';
import type { LineStyle } from '../overlay/lines';
import { AMBIENT, KEY, fillLight } from './lighting';
import type { PartName } from './part';
import type { Uniforms } from './surface';
import { along, dot, scale, subtract } from '../vector';

export interface PicturePart {
  part: PartName;
  /** Columns of the canvas this part may draw in, 0..1. */
  from: number;
  to: number;
}

export interface Picture {
  camera: CameraState;
  screen: Screen;
  parts: readonly PicturePart[];
  /** Unit vectors in the model's axes. */
  towardsLight: Vec3;
  lightUp: Vec3;
  lightFront: Vec3;
  backdrop: boolean;
  /** Shadow of the plate on the bench. */
  plateShadow: boolean;
  ground: boolean;
}

/** Pieces of lines as `LineSet` takes them; without a part they are drawn with both. */
export interface Lines {
  readonly pieces: Float32Array;
  readonly style: LineStyle;
  readonly part?: PartName;
  readonly values?: Float32Array;
}

const NO_REACH = 3e38;

export class PictureUniforms {
  /** The scene's zero in model mm: single precision is fine near it. */
  origin: Vec3 = [0, 0, 0];
  readonly values: Uniforms = {
    uSection: { value: new THREE.Vector4(0, 0, 0, 1) },
    uEye: { value: new THREE.Vector4(0, 0, 1, 0) },
    uUp: { value: new THREE.Vector3(0, 1, 0) },
    uFront: { value: new THREE.Vector3(0, 0, 1) },
    uLight: { value: new THREE.Vector3(0, 0, 1) },
    uInside: { value: new THREE.Vector3(-1, 0, 0) },
    uKey: { value: KEY },
    uAmbient: { value: AMBIENT },
    uFill: { value: new THREE.Vector4(0, 0, 1, 0) },
    uNoise: { value: 0 },
    uViewport: { value: new THREE.Vector2(1, 1) },
    uReach: { value: NO_REACH },
  };
  private sectionKey = '';

  /** Changes with the section and with every shape: a shadow of another key is out of date. */
  get shadowKey(): string {
    return this.sectionKey;
  }

  shapeChanged(): void {
    this.sectionKey += '!';
  }

  /** Takes away what lies beyond normal . p = offset (model mm); null keeps everything. */
  setSection(section: { normal: Vec3; offset: number } | null): void {
    const value = this.section;
    const inside = this.values['uInside']?.value as THREE.Vector3;
    if (section) {
      value.set(...section.normal, section.offset - dot(section.normal, this.origin));
      inside.set(0.32, 0.25, 0.17);
    } else {
      value.set(0, 0, 0, 1);
      inside.set(-1, 0, 0);
    }
    this.sectionKey = value.toArray().join();
  }

  /** Whether the section leaves a point (from the scene's origin); null keeps everything. */
  cutTest(): ((p: Vec3) => boolean) | null {
    const { x, y, z, w } = this.section;
    return x === 0 && y === 0 && z === 0 ? null : (p) => x * p[0] + y * p[1] + z * p[2] <= w;
  }

  private get section(): THREE.Vector4 {
    return this.values['uSection']?.value as THREE.Vector4;
  }

  setReach(value: number | null): void {
    (this.values['uReach'] as THREE.IUniform).value = value ?? NO_REACH;
  }

  /** Camera and light of one picture of `width` x `height` pixels; `sample` as in `PictureDrawing.draw`. */
  setPicture(picture: Picture, towardsLight: Vec3, width: number, height: number, sample: number): void {
    const { camera } = picture;
    const eye = this.values['uEye']?.value as THREE.Vector4;
    if (camera.kappa > 0)
      eye.set(...subtract(along(camera.target, camera.forward, -1 / camera.kappa), this.origin), 1);
    else eye.set(...scale(camera.forward, -1), 0);
    (this.values['uUp']?.value as THREE.Vector3).set(...picture.lightUp);
    (this.values['uFront']?.value as THREE.Vector3).set(...picture.lightFront);
    (this.values['uLight']?.value as THREE.Vector3).set(...towardsLight);
    const fill = fillLight(picture.towardsLight, camera);
    (this.values['uFill']?.value as THREE.Vector4).set(...fill.towards, fill.strength);
    (this.values['uNoise'] as THREE.IUniform).value = sample < 0 ? 0 : (sample * 0.61803399) % 1;
    (this.values['uViewport']?.value as THREE.Vector2).set(width, height);
  }
}
