// SPDX-License-Identifier: GPL-3.0-or-later
// How much of the sky a point sees, one direction at a time.
import { HEAD, TEXEL } from './shaders';

const VISIBLE = /* glsl */ `
precision highp sampler2DShadow;
uniform vec3 uDirection;
uniform mat4 uShadowMatrix;
uniform sampler2DShadow uShadow;
uniform float uShadowOffset;
uniform float uBlur;     // of the depth map's width
uniform float uSeen;     // 1, or less for directions in which the ground stands in the way
// What one direction of the sky adds to a point: cosine weight, and that weight where the sky is seen.
vec2 skySample(vec3 p, vec3 n) {
  float weight = max(dot(n, uDirection), 0.0);
  if (weight == 0.0) return vec2(0.0);
  vec3 s = (uShadowMatrix * vec4(p + n * uShadowOffset, 1.0)).xyz;
  float seen = 0.0;
  for (int i = 0; i < BAKE_TAPS; ++i) {
    float r = uBlur * sqrt((float(i) + 0.5) / float(BAKE_TAPS));
    float a = 2.3999632 * float(i);
    seen += texture(uShadow, vec3(s.xy + r * vec2(cos(a), sin(a)), min(s.z, 0.99999)));
  }
  seen *= uSeen / float(BAKE_TAPS);
  return 0.125 * vec2(weight * seen, weight);
}
`;

/** One point per vertex, into that vertex's texel. */
export const bakeVertex = /* glsl */ `${HEAD}${TEXEL}${VISIBLE}
in vec3 position;
in vec3 normal;
uniform int uOcclusionWidth;
uniform int uOcclusionHeight;
out vec2 vSums;
void main() {
  vSums = skySample(position, normal);
  vec2 texel = (vec2(texelOf(gl_VertexID, uOcclusionWidth)) + 0.5) / vec2(uOcclusionWidth, uOcclusionHeight);
  gl_Position = vec4(2.0 * texel - 1.0, 0.0, 1.0);
  gl_PointSize = 1.0;
}
`;

export const bakeFragment = /* glsl */ `${HEAD}
in vec2 vSums;
out vec4 outColour;
void main() { outColour = vec4(vSums, 0.0, 1.0); }
`;

/** A flat face baked as a picture: corners of the quad are its texture's corners. */
export const bakeQuadVertex = /* glsl */ `${HEAD}
in vec3 position;
in vec3 normal;
in vec2 uv;
out vec3 vPosition;
out vec3 vNormal;
void main() {
  vPosition = position;
  vNormal = normal;
  gl_Position = vec4(2.0 * uv - 1.0, 0.0, 1.0);
}
`;

export const bakeQuadFragment = /* glsl */ `${HEAD}${VISIBLE}
in vec3 vPosition;
in vec3 vNormal;
out vec4 outColour;
void main() { outColour = vec4(skySample(vPosition, normalize(vNormal)), 0.0, 1.0); }
`;
