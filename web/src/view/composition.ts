// SPDX-License-Identifier: GPL-3.0-or-later
// What the picture is composed of: the parts and their columns, camera and light, and the elements laid over it.
import type { LightDirection } from './api';
import { projectToPixels } from './camera/camera';
import type { CameraRig } from './camera/camera_rig';
import type { Content } from './content';
import type { Furniture } from './overlay/furniture';
import { plateCorners, plateFrame } from './overlay/plate';
import { towardsLight } from './render/light';
import type { Picture, PicturePart } from './render/picture';
import { scale, viewerAxes } from './vector';

/** Narrower viewports go without dimension lines, px. */
const DIMENSION_MIN_WIDTH = 560;

export class Composition {
  /** Position of the divider between the parts, 0..1. */
  swipe = 0.5;

  constructor(
    private readonly rig: CameraRig,
    private readonly furniture: Furniture,
    /** Null where WebGL 2 is missing. */
    private readonly content: () => Content | null,
    public light: LightDirection,
    public showDimensions: boolean,
  ) {}

  hasDimensions(): boolean {
    const content = this.content();
    const wide = this.rig.screen.width >= DIMENSION_MIN_WIDTH;
    return this.showDimensions && wide && Boolean(content?.plate) && Boolean(content?.meshes.relief);
  }

  picture(parts: readonly PicturePart[]): Picture {
    const { camera, screen, viewpoint } = this.rig;
    const axes = this.light.follows === 'camera' ? camera : viewerAxes(viewpoint.direction, viewpoint.up);
    return {
      camera,
      screen,
      parts,
      towardsLight: towardsLight(this.light, axes),
      lightUp: axes.up,
      lightFront: scale(axes.forward, -1),
      backdrop: true,
      plateShadow: true,
      ground: this.content()?.ground ?? false,
    };
  }

  /** Two parts stand on both sides of the divider. */
  parts(): PicturePart[] {
    const names = this.content()?.parts() ?? [];
    if (names.length < 2) return names.map((part) => ({ part, from: 0, to: 1 }));
    const split = this.furniture.dividerX / this.rig.screen.width;
    return [
      { part: 'original', from: 0, to: split },
      { part: 'relief', from: split, to: 1 },
    ];
  }

  /** Places the elements over the picture. */
  layOut(): void {
    const content = this.content();
    if (!content) return;
    const { camera, screen, viewpoint } = this.rig;
    const { plate } = content;
    this.furniture.layOut({
      screen,
      extent: this.rig.extentPx(content.bounds(camera, 'shown')),
      swipe: content.parts().length === 2 ? this.swipe : null,
      corners:
        plate && this.hasDimensions() && content.parts().includes('relief')
          ? plateCorners(plateFrame(plate, viewpoint))
          : null,
      plate,
      project: (p) => projectToPixels(camera, screen, p),
    });
  }
}
