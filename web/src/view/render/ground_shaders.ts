// SPDX-License-Identifier: GPL-3.0-or-later
// The shadow on the ground: how high the object is above each place, as four layers, each blurred by its height.
import { HEAD } from './shaders';

/** Heights above the ground in bounding radii, one per layer; what lies between is shared by both. */
const LAYER_HEIGHTS = [0.02, 0.14, 0.42, 1] as const;
/** Standard deviation of each layer's blur, in radii: an object further up throws a softer shadow. */
export const LAYER_BLURS = [0.025, 0.07, 0.18, 0.42] as const;
/** How much of the sky each layer takes from the ground below it. */
const LAYER_STRENGTHS = [0.9, 0.62, 0.4, 0.2] as const;

const vec4 = (values: readonly number[]): string => `vec4(${values.map((value) => value.toFixed(6)).join()})`;

export const groundLayersFragment = /* glsl */ `${HEAD}
in vec2 vUv;
uniform sampler2D uDepth;
uniform float uHighest;      // radii
out vec4 outColour;
void main() {
  float depth = texture(uDepth, vUv).r;
  float h = depth * uHighest;
  const vec4 at = ${vec4(LAYER_HEIGHTS)};
  vec3 up = clamp((vec3(h) - at.xyz) / (at.yzw - at.xyz), 0.0, 1.0);
  outColour = depth < 1.0 ? vec4(1.0 - up.x, up.x - up.y, up.y - up.z, up.z) : vec4(0.0);
}
`;

/** One direction of the blur; RADIUS texels to both sides. */
export const groundBlurFragment = /* glsl */ `${HEAD}
in vec2 vUv;
uniform sampler2D uImage;
uniform vec2 uStep;          // one texel along the direction
uniform float uTexel;        // its length, radii
out vec4 outColour;
void main() {
  vec4 falloff = -0.5 * uTexel * uTexel / (${vec4(LAYER_BLURS)} * ${vec4(LAYER_BLURS)});
  vec4 sum = vec4(0.0), all = vec4(0.0);
  for (int i = -RADIUS; i <= RADIUS; ++i) {
    vec4 weight = exp(falloff * float(i * i));
    sum += weight * texture(uImage, vUv + float(i) * uStep);
    all += weight;
  }
  outColour = sum / all;
}
`;

export const groundVertex = /* glsl */ `${HEAD}
in vec3 position;
in vec2 uv;
uniform mat4 projectionMatrix;
out vec2 vUv;
void main() { vUv = uv; gl_Position = projectionMatrix * vec4(position, 1.0); }
`;

/** Darkens the bench, fading outwards. */
export const groundFragment = /* glsl */ `${HEAD}
in vec2 vUv;
uniform sampler2D uLayers;
uniform float uReady;
out vec4 outColour;
void main() {
  float fade = 1.0 - smoothstep(0.6, 1.0, 2.0 * length(vUv - 0.5));
  float a = uReady * fade * min(dot(texture(uLayers, vUv), ${vec4(LAYER_STRENGTHS)}), 1.0);
  outColour = vec4(vec3(0.085, 0.070, 0.047) * a, a);
}
`;
