// SPDX-License-Identifier: GPL-3.0-or-later
// The viewport's calls (`api.ts`), passed on to what it is made of (`viewport_base.ts`).
import type {
  ColourMapping,
  Curve,
  Fixture,
  LightDirection,
  Marker,
  MeshData,
  Plate,
  Projection,
  Section,
  Vec3,
  ViewMode,
  Viewpoint,
  ViewportApi,
} from './api';
import { type CameraState, cameraFromViewpoint, projectToPixels, rayThroughPixel } from './camera/camera';
import type { PartName } from './render/part';
import { encodePng } from './render/png';
import { qualityHere } from './render/quality';
import { readPart, readView } from './render/snapshot';
import { length, subtract } from './vector';
import { ViewportBase } from './viewport_base';

export class Viewport extends ViewportBase implements ViewportApi {
  // Meshes

  setOriginal(mesh: MeshData | null): void {
    this.shapeChanged(this.content?.setOriginal(mesh) ?? false);
  }

  setRelief(mesh: MeshData | null, plate: Plate | null): void {
    this.shapeChanged(this.content?.setRelief(mesh, plate) ?? false);
  }

  updateOriginal(positions: Float32Array | Float64Array): void {
    this.content?.update('original', positions);
    this.shapeChanged(false);
  }

  rescaleOriginal(positions: Float32Array | Float64Array): void {
    this.content?.update('original', positions, undefined, true);
    this.shapeChanged(false);
  }

  updateRelief(positions: Float32Array | Float64Array, plate?: Plate | null): void {
    this.content?.update('relief', positions, plate);
    this.shapeChanged(false);
  }

  updateColours(part: PartName, colours: Float32Array): void {
    this.content?.updateColours(part, colours);
    this.invalidate();
  }

  updateAttribute(part: PartName, name: string, values: Float32Array): void {
    this.stage?.colouring.setAttribute(part, name, values);
    this.invalidate();
  }

  setFixtures(fixtures: readonly Fixture[]): void {
    this.content?.setFixtures(fixtures);
    this.shapeChanged(false);
  }

  moveFixture(id: string, positions: Float32Array | Float64Array, turned = false): void {
    this.stage?.moveFixture(id, positions, turned);
    this.shapeChanged(false);
  }

  setOpacity(part: PartName, opacity: number): void {
    this.stage?.setOpacity(part, opacity);
    this.invalidate();
  }

  // What is shown

  setMode(mode: ViewMode): void {
    if (!this.content || mode === this.content.mode) return;
    this.content.setMode(mode);
    this.furniture.clearValue();
    this.invalidate();
  }

  setLight(light: LightDirection): void {
    this.composition.light = light;
    this.invalidate();
  }

  setColourMapping(mapping: ColourMapping | null, always = false): void {
    this.content?.setMapping(mapping, always);
    this.furniture.clearValue();
    this.invalidate();
  }

  setErrorRange(minimum: number, maximum: number): void {
    this.content?.setRange(minimum, maximum);
    this.invalidate();
  }

  setSection(section: Section | null): void {
    this.content?.setSection(section);
    this.invalidate();
  }

  setCurves(curves: readonly Curve[]): void {
    this.content?.setCurves(curves);
    this.invalidate();
  }

  get linePieces(): number {
    return qualityHere().linePieces;
  }

  setReach(value: number | null): void {
    this.stage?.setReach(value);
    this.invalidate();
  }

  setMarkers(markers: readonly Marker[]): void {
    this.furniture.setMarkers(markers);
    this.composition.layOut();
  }

  setDimensionsVisible(visible: boolean): void {
    this.composition.showDimensions = visible;
    this.rig.refit();
    this.invalidate();
  }

  setGround(visible: boolean): void {
    this.content?.setGround(visible);
    this.shapeChanged(false);
  }

  // Camera

  setViewpoint(viewpoint: Viewpoint): void {
    const before = this.rig.viewpoint;
    this.rig.setViewpoint(viewpoint);
    const turned =
      length(subtract(before.direction, viewpoint.direction)) > 1e-12 ||
      length(subtract(before.up, viewpoint.up)) > 1e-12;
    if (turned) this.content?.viewpointTurned();
    this.furniture.setAtViewpoint(this.rig.atViewpoint);
    this.invalidate();
  }

  getViewpoint(): Viewpoint {
    return this.rig.viewpoint;
  }

  getCameraAsViewpoint(): Viewpoint {
    return this.rig.asViewpoint();
  }

  get atViewpoint(): boolean {
    return this.rig.atViewpoint;
  }

  lookFromViewpoint(animated = true): void {
    this.rig.lookFromViewpoint(animated && this.content?.centre() !== null);
  }

  fit(animated = true): void {
    this.rig.fit(animated && this.content?.centre() !== null);
  }

  orbit(azimuthDeg: number, elevationDeg: number): void {
    this.rig.orbitBy((azimuthDeg * Math.PI) / 180, (elevationDeg * Math.PI) / 180);
  }

  zoom(factor: number): void {
    const { left, top, width, height } = this.rig.screen.free;
    this.rig.zoomBy(factor, left + width / 2, top + height / 2);
  }

  setProjection(projection: Projection): void {
    this.rig.setProjection(projection);
  }

  rayThrough(xPx: number, yPx: number): { originMm: Vec3; direction: Vec3 } {
    const { camera, screen } = this.rig;
    const reach = 10 * (this.content?.radius() ?? 60);
    const { origin, direction } = rayThroughPixel(camera, screen, xPx, yPx, reach);
    return { originMm: origin, direction };
  }

  project(positionMm: Vec3): { xPx: number; yPx: number } | null {
    return projectToPixels(this.rig.camera, this.rig.screen, positionMm);
  }

  // Pictures

  setResting(resting: boolean): void {
    if (qualityHere().yieldsToWork) this.loop.setHeld(resting);
  }

  renderNow(): void {
    this.loop.drawNow();
  }

  async settled(): Promise<void> {
    await this.loop.settled();
  }

  async snapshot(widthPx: number, heightPx: number, options: { transparent?: boolean } = {}): Promise<Blob> {
    const { stage } = this;
    if (!stage || this.status.state !== 'ready') {
      throw new Error('The picture cannot be saved because the 3D view is not running: reload the page.');
    }
    const picture = { ...this.composition.picture(this.composition.parts()), backdrop: !options.transparent };
    const pixels = await readView(stage, picture, widthPx, heightPx);
    this.invalidate();
    return encodePng(pixels, widthPx, heightPx);
  }

  /** A part through another camera, r, g, b, a bytes; null while there is nothing to draw. For the side view. */
  async readPart(
    part: PartName,
    camera: (centre: Vec3, radius: number) => CameraState,
    width: number,
    height: number,
  ): Promise<Uint8ClampedArray<ArrayBuffer> | null> {
    const { stage, content } = this;
    if (!stage || !content?.meshes[part] || this.status.state !== 'ready') return null;
    const pixels = await readPart(stage, this.composition.picture([]), part, camera, width, height);
    this.loop.restart();
    return pixels;
  }

  async pictureOf(
    part: PartName,
    look: Pick<Viewpoint, 'direction' | 'up'>,
    widthPx: number,
    heightPx: number,
  ): Promise<Blob | null> {
    const camera = (targetMm: Vec3, radius: number): CameraState =>
      cameraFromViewpoint(
        { projection: 'perspective', targetMm, distanceMm: 6 * radius, fieldOfViewDeg: 20, ...look },
        radius,
      );
    const pixels = await this.readPart(part, camera, widthPx, heightPx);
    return pixels && (await encodePng(pixels, widthPx, heightPx));
  }
}
