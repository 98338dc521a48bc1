// SPDX-License-Identifier: GPL-3.0-or-later
// What stands over the picture as ordinary elements: swipe divider, names of its sides, dimension lines,
// markers, the value under the pointer, and messages.
import type { ColourMapping, Hit, Marker, Plate, Vec3 } from '../api';
import type { Screen } from '../camera/camera';
import { formatValue } from '../mesh/colour_map';
import { Dimensions, type Point } from './dimensions';
import { readable } from './labels';
import { type Extent, SwipeDivider } from './swipe_divider';

export interface Layout {
  screen: Screen;
  extent: Extent | null;
  /** Position of the divider, or null without one. */
  swipe: number | null;
  /** Corners of the plate's front, mm; null without dimension lines. */
  corners: readonly [Vec3, Vec3, Vec3, Vec3] | null;
  plate: Plate | null;
  project(p: Vec3): Point | null;
}

/** A tag is hidden where its side of the divider is narrower than this, px. */
const LEAST_SIDE = 110;

export class Furniture {
  readonly element = document.createElement('div');
  /** The divider's x in the last layout, CSS px. */
  dividerX = 0;
  private readonly divider: SwipeDivider;
  private readonly dimensions = new Dimensions();
  private readonly tags: readonly HTMLElement[];
  private readonly markers = new Map<string, { marker: Marker; element: HTMLElement }>();
  private readonly value = document.createElement('div');
  private readonly message = document.createElement('div');
  private readonly spoken = document.createElement('div');
  private atViewpoint: boolean | null = null;

  constructor(root: HTMLElement, partNames: readonly string[], onSwipe: (position: number) => void) {
    this.element.className = 'fw-overlay';
    this.tags = partNames.map((name) => {
      const tag = document.createElement('span');
      tag.className = 'fw-tag';
      tag.textContent = name;
      tag.setAttribute('aria-hidden', 'true');
      tag.hidden = true;
      return tag;
    });
    this.divider = new SwipeDivider(root, onSwipe);
    this.value.className = 'fw-value';
    this.value.hidden = true;
    this.message.className = 'fw-message';
    this.message.hidden = true;
    this.message.setAttribute('role', 'alert');
    this.spoken.className = 'fw-spoken';
    this.spoken.setAttribute('role', 'status');
    this.divider.element.hidden = true;
    this.element.append(
      this.dimensions.element,
      ...this.tags,
      this.divider.element,
      this.value,
      this.spoken,
      this.message,
    );
  }

  layOut(layout: Layout): void {
    const { screen, extent, swipe } = layout;
    const divided = swipe !== null && extent !== null;
    this.divider.element.hidden = !divided;
    if (divided) {
      this.dividerX = this.divider.place(extent, screen.width, screen.height, swipe);
      this.placeTags(extent, screen.width);
    } else {
      this.dividerX = 0;
      for (const tag of this.tags) tag.hidden = true;
    }
    const corners = layout.corners?.map((c) => layout.project(c));
    const all = corners?.every((c): c is Point => c !== null)
      ? (corners as [Point, Point, Point, Point])
      : null;
    this.dimensions.draw(all, layout.plate?.widthMm ?? 0, layout.plate?.heightMm ?? 0);
    const placed = [...this.markers.values()].map(({ marker, element }) => ({
      element,
      at: layout.project(marker.positionMm),
      text: marker.label ?? '',
    }));
    const shown = readable(placed);
    for (const [i, { element, at }] of placed.entries()) {
      element.hidden = at === null;
      if (at) element.style.transform = `translate(${at.xPx.toFixed(2)}px, ${at.yPx.toFixed(2)}px)`;
      element.toggleAttribute('data-crowded', !shown[i]);
    }
  }

  setPartNames(names: readonly string[]): void {
    for (const [i, tag] of this.tags.entries()) tag.textContent = names[i] ?? '';
  }

  private placeTags(extent: Extent, width: number): void {
    const [original, relief] = this.tags;
    if (!original || !relief) return;
    const left = Math.max(extent.left, 12);
    const right = Math.min(extent.right, width - 12);
    const top = Math.max(extent.top, 8) + 6;
    original.hidden = this.dividerX - left < LEAST_SIDE;
    relief.hidden = right - this.dividerX < LEAST_SIDE;
    original.style.transform = `translate(${left.toFixed(1)}px, ${top.toFixed(1)}px)`;
    relief.style.transform = `translate(${(right - 10).toFixed(1)}px, ${top.toFixed(1)}px) translateX(-100%)`;
  }

  setMarkers(markers: readonly Marker[]): void {
    const wanted = new Set(markers.map((m) => m.id));
    for (const [id, { element }] of this.markers) {
      if (wanted.has(id)) continue;
      element.remove();
      this.markers.delete(id);
    }
    for (const marker of markers) {
      const element = this.markers.get(marker.id)?.element ?? document.createElement('div');
      element.className = 'fw-marker';
      element.dataset['kind'] = marker.kind;
      element.replaceChildren();
      if (marker.label) {
        const label = document.createElement('span');
        label.textContent = marker.label;
        element.append(label);
      }
      if (!element.isConnected) this.element.insertBefore(element, this.value);
      this.markers.set(marker.id, { marker, element });
    }
  }

  showValue(hit: Hit, mapping: ColourMapping): void {
    if (hit.value === null) return;
    this.value.hidden = false;
    this.value.textContent = formatValue(hit.value, mapping.unit);
    const right = hit.xPx > this.element.clientWidth - 90;
    this.value.style.transform = `translate(${hit.xPx + (right ? -12 : 14)}px, ${hit.yPx - 28}px)${right ? ' translateX(-100%)' : ''}`;
  }

  clearValue(): void {
    this.value.hidden = true;
  }

  /** Said once when the camera reaches or leaves the viewpoint, not on every step. */
  setAtViewpoint(atViewpoint: boolean): void {
    if (this.atViewpoint === atViewpoint) return;
    if (this.atViewpoint !== null) {
      this.spoken.textContent = atViewpoint ? 'Seen from the viewpoint' : 'Turned away from the viewpoint';
    }
    this.atViewpoint = atViewpoint;
  }

  setMessage(message: string | null): void {
    this.message.hidden = message === null;
    this.message.replaceChildren();
    if (message === null) return;
    const paragraph = document.createElement('p');
    paragraph.textContent = message;
    this.message.append(paragraph);
  }
}
