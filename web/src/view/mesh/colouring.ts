// SPDX-License-Identifier: GPL-3.0-or-later
// Which meshes show values as colours, and the colour maps as textures.
import * as THREE from 'three';
import type { ColourMapName, ColourMapping } from '../api';
import { mapTexels, stopsOf } from './colour_map';
import type { Surface } from '../render/surface';
import type { Palette } from '../theme';

export class Colouring {
  private readonly textures = new Map<ColourMapName, THREE.DataTexture>();
  private readonly attributes = new Map<string, Float32Array>();
  private tokens: Palette['maps'] = {};
  private shown: { mapping: ColourMapping; parts: readonly string[] } | null = null;

  constructor(private readonly meshes: () => readonly (readonly [string, Surface | null])[]) {}

  setTokens(tokens: Palette['maps']): void {
    this.tokens = tokens;
    this.disposeTextures();
    this.apply();
  }

  setMapping(mapping: ColourMapping | null, parts: readonly string[]): void {
    this.shown = mapping ? { mapping, parts } : null;
    this.apply();
  }

  /** Values that take the place of MeshData.attributes. */
  setAttribute(part: string, attribute: string, values: Float32Array): void {
    this.attributes.set(`${part}/${attribute}`, values);
    this.apply();
  }

  /** A new mesh comes with its own values. */
  forgetAttributes(part: string): void {
    for (const key of [...this.attributes.keys()])
      if (key.startsWith(`${part}/`)) this.attributes.delete(key);
  }

  apply(): void {
    for (const [name, surface] of this.meshes()) {
      if (!surface) continue;
      const mapping = this.shown?.parts.includes(name) ? this.shown.mapping : null;
      const values = mapping
        ? (this.attributes.get(`${name}/${mapping.attribute}`) ??
          surface.mesh.attributes?.[mapping.attribute] ??
          null)
        : null;
      if (!mapping || values?.length !== surface.vertexCount) surface.setScalar(null, null, 0, 1);
      else {
        const { map, minimum, maximum } = mapping;
        surface.setScalar(values, this.texture(map), minimum, maximum, map === 'brightness');
      }
    }
  }

  private texture(name: ColourMapName): THREE.DataTexture {
    let texture = this.textures.get(name);
    if (!texture) {
      texture = new THREE.DataTexture(mapTexels(stopsOf(name, this.tokens[name]), 256), 256, 1);
      texture.minFilter = texture.magFilter = THREE.LinearFilter;
      texture.needsUpdate = true;
      this.textures.set(name, texture);
    }
    return texture;
  }

  private disposeTextures(): void {
    for (const texture of this.textures.values()) texture.dispose();
    this.textures.clear();
  }

  dispose(): void {
    this.disposeTextures();
  }
}
