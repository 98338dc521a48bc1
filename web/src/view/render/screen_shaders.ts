// SPDX-License-Identifier: GPL-3.0-or-later
// What lies behind the object, and passes over the whole picture.
import { HEAD } from './shaders';

export const screenVertex = /* glsl */ `${HEAD}
in vec3 position;
out vec2 vUv;
void main() { vUv = 0.5 * position.xy + 0.5; gl_Position = vec4(position.xy, 0.0, 1.0); }
`;

/** The bench behind the object: token --view-a at the centre, --view-b at the rim. */
export const backdropFragment = /* glsl */ `${HEAD}
in vec2 vUv;
uniform vec3 uCentre;
uniform vec3 uRim;
uniform vec2 uAspect;
out vec4 outColour;
float noise(vec2 p) { return fract(52.9829189 * fract(dot(p, vec2(0.06711056, 0.00583715)))); }
void main() {
  vec2 d = (vUv - vec2(0.5, 0.55)) * uAspect;
  float t = smoothstep(0.05, 1.0, length(d) / 0.82);
  outColour = vec4(mix(uCentre, uRim, t) + (noise(gl_FragCoord.xy) - 0.5) / 255.0, 1.0);
}
`;

export const copyFragment = /* glsl */ `${HEAD}
in vec2 vUv;
uniform sampler2D uImage;
uniform float uWeight;
out vec4 outColour;
float noise(vec2 p) { return fract(52.9829189 * fract(dot(p, vec2(0.06711056, 0.00583715)))); }
void main() {
  vec4 c = texture(uImage, vUv);
#ifdef ACCUMULATE
  outColour = c * uWeight;
#else
  c *= uWeight;
  outColour = vec4(c.rgb + (noise(gl_FragCoord.xy) - 0.5) / 255.0 * c.a, c.a);
#endif
}
`;

/** Shadow the plate throws on the bench behind it: a rectangle blurred by a Gaussian, in closed form. */
export const plateShadowVertex = /* glsl */ `${HEAD}
in vec3 position;
in vec2 uv;
uniform mat4 projectionMatrix;
out vec2 vUv;
void main() { vUv = uv; gl_Position = projectionMatrix * vec4(position, 1.0); }
`;

export const plateShadowFragment = /* glsl */ `${HEAD}
in vec2 vUv;                 // mm from the plate's centre
uniform vec2 uHalf;
uniform vec2 uShift;
uniform float uBlur;
uniform float uStrength;
out vec4 outColour;
vec2 erf2(vec2 x) {
  vec2 s = sign(x), a = abs(x);
  vec2 p = 1.0 + (0.278393 + (0.230389 + 0.078108 * (a * a)) * a) * a;
  p *= p;
  return s - s / (p * p);
}
float box(vec2 p, float sigma) {
  vec2 k = (uHalf - p) / (1.4142136 * sigma), m = (-uHalf - p) / (1.4142136 * sigma);
  vec2 e = 0.5 * (erf2(k) - erf2(m));
  return e.x * e.y;
}
void main() {
  float near = box(vUv - 0.35 * uShift, 0.3 * uBlur);
  float wide = box(vUv - uShift, uBlur);
  float a = uStrength * (0.4 * near + 0.6 * wide);
  outColour = vec4(vec3(0.085, 0.070, 0.047) * a, a);
}
`;
