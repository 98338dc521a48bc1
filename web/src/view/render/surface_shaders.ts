// SPDX-License-Identifier: GPL-3.0-or-later
// The mesh itself, and its depth as the light sees it. Positions are mm from the scene's origin;
// `projectionMatrix` is the whole clip matrix of camera.ts (computed in double precision), so there is no
// model or view matrix.
import type { Vec3 } from '../api';
import {
  BOUNCE_COLOUR,
  DIFFUSE,
  FILL_COLOUR,
  FILL_IN_HOLLOWS,
  KEY_COLOUR,
  ROUGH,
  SKY_COLOUR,
  SKY_LEAN,
  VIEWER,
} from './lighting';
import { HEAD, CLIP, SRGB, TEXEL } from './shaders';

const float = (value: number): string => value.toFixed(6);
const vec3 = (value: Vec3): string => `vec3(${value.map(float).join()})`;

export const surfaceVertex = /* glsl */ `${HEAD}${TEXEL}
in vec3 position;
in vec3 normal;
#ifdef SCALAR
in float scalar;
#endif
#ifdef COLOURS
in vec3 colour;
#endif
#if defined(TEXTURED) || defined(OCCLUSION_MAP)
in vec2 uv;
#endif
uniform mat4 projectionMatrix;
uniform sampler2D uOcclusion;
uniform int uOcclusionWidth;
out vec3 vPosition;
out vec3 vNormal;
out float vOcclusion;
out float vScalar;
out vec3 vColour;
out vec2 vUv;
void main() {
  vPosition = position;
  vNormal = normal;
  vOcclusion = 1.0;
  vScalar = 0.0;
  vColour = vec3(1.0);
  vUv = vec2(0.0);
#ifdef SCALAR
  vScalar = scalar;
#endif
#ifdef COLOURS
  vColour = colour;
#endif
#if defined(TEXTURED) || defined(OCCLUSION_MAP)
  vUv = uv;
#endif
#ifndef OCCLUSION_MAP
  vec2 sums = texelFetch(uOcclusion, texelOf(gl_VertexID, uOcclusionWidth), 0).rg;
  vOcclusion = sums.y > 0.0 ? clamp(sums.x / sums.y, 0.0, 1.0) : 1.0;
#endif
  gl_Position = projectionMatrix * vec4(position, 1.0);
}
`;

/** Matt plaster: Oren-Nayar under one raking key light, a sky, a bounce from below, a weak light from the viewer that
 *  keeps shadows readable, and a fill light on the sides that the key light does not reach (`lighting.ts`). */
export const surfaceFragment = /* glsl */ `${HEAD}
precision highp sampler2DShadow;
${CLIP}${SRGB}
in vec3 vPosition;
in vec3 vNormal;
in float vOcclusion;
in float vScalar;
in vec3 vColour;
in vec2 vUv;
uniform vec4 uEye;              // xyz eye, w = 1; or xyz the direction towards the viewer, w = 0
uniform vec3 uUp;               // up of the light's frame: where the sky is
uniform vec3 uFront;            // towards the viewer of the light's frame
uniform vec3 uLight;            // towards the key light
uniform vec3 uAlbedo;
uniform vec3 uInside;           // seen through a cut
uniform float uKey;
uniform float uAmbient;
uniform vec4 uFill;             // xyz towards the fill light, w its strength
uniform float uOcclusionStrength;
uniform float uHighlight;
uniform sampler2D uOcclusion;
uniform sampler2DShadow uShadow;
uniform mat4 uShadowMatrix;
uniform float uShadowOffset;    // mm along the normal
uniform vec2 uShadowRadius;     // PCF radius, texture units
uniform float uShadowOn;
uniform float uOpacity;
uniform float uNoise;
#ifdef SCALAR
uniform sampler2D uMap;
uniform vec2 uMapRange;
uniform float uUnlit;            // values are light themselves
#endif
#ifdef TEXTURED
uniform sampler2D uTexture;
#endif
out vec4 outColour;

float interleavedNoise(vec2 p) { return fract(52.9829189 * fract(dot(p, vec2(0.06711056, 0.00583715)))); }

float keyVisibility(vec3 n) {
  if (uShadowOn < 0.5) return 1.0;
  vec3 p = (uShadowMatrix * vec4(vPosition + n * uShadowOffset, 1.0)).xyz;
  if (any(lessThan(p, vec3(0.0))) || any(greaterThan(p, vec3(1.0)))) return 1.0;
  float turn = 6.2831853 * fract(interleavedNoise(gl_FragCoord.xy) + uNoise);
  float lit = 0.0;
  for (int i = 0; i < SHADOW_TAPS; ++i) {
    float r = sqrt((float(i) + 0.5) / float(SHADOW_TAPS));
    float a = turn + 2.3999632 * float(i);
    lit += texture(uShadow, vec3(p.xy + uShadowRadius * r * vec2(cos(a), sin(a)), p.z));
  }
  return lit / float(SHADOW_TAPS);
}

// Oren and Nayar 1994, in Fujii's form without trigonometry; sigma = 0.3.
float orenNayar(vec3 l, vec3 v, vec3 n) {
  float nl = max(dot(n, l), 0.0);
  float nv = max(dot(n, v), 0.0);
  float s = dot(l, v) - nl * nv;
  float t = s > 0.0 ? max(max(nl, nv), 1e-3) : 1.0;
  return nl * (${float(DIFFUSE)} + ${float(ROUGH)} * s / t);
}

vec3 shoulder(vec3 c) {
  vec3 over = max(c - 0.8, 0.0);
  return min(c, 0.8) + 0.2 * (1.0 - exp(-over / 0.2));
}

void main() {
  if (cutAway(vPosition)) discard;
  vec3 v = normalize(uEye.xyz - uEye.w * vPosition);
  vec3 n = normalize(vNormal);
  vec3 albedo = uAlbedo;
  float mapped = 0.0;
  float unlit = 0.0;
#ifdef COLOURS
  albedo = toLinear(vColour);
#endif
#ifdef TEXTURED
  albedo = toLinear(texture(uTexture, vUv).rgb);
#endif
#ifdef SCALAR
  if (vScalar == vScalar) {
    float f = clamp((vScalar - uMapRange.x) / max(uMapRange.y - uMapRange.x, 1e-20), 0.0, 1.0);
    float texels = float(textureSize(uMap, 0).x);
    albedo = toLinear(texture(uMap, vec2((f * (texels - 1.0) + 0.5) / texels, 0.5)).rgb);
    mapped = 1.0;
    unlit = uUnlit;
  }
#endif
  // Facing the viewer, for open surfaces and cuts; a little slack where smooth normals lean away.
  bool back = !gl_FrontFacing;
  if (back) n = -n;
  if (back && uInside.r >= 0.0) { outColour = vec4(toSrgb(uInside * (0.75 + 0.25 * abs(dot(n, v)))), 1.0); return; }

#ifdef OCCLUSION_MAP
  vec2 sums = texture(uOcclusion, vUv).rg;
  float occlusion = sums.y > 0.0 ? clamp(sums.x / sums.y, 0.0, 1.0) : 1.0;
#else
  float occlusion = back ? 0.6 * vOcclusion : vOcclusion;
#endif
  occlusion = mix(1.0, occlusion, uOcclusionStrength);
  // Light bounced between plaster walls, by albedo: Jimenez et al. 2016, eq. 5.
  vec3 ka = 2.0404 * albedo - 0.3324;
  vec3 kb = -4.7951 * albedo + 0.6417;
  vec3 kc = 2.7552 * albedo + 0.6903;
  vec3 ambientVisibility = max(vec3(occlusion), ((occlusion * ka + kb) * occlusion + kc) * occlusion);

  float lit = orenNayar(uLight, v, n);
  if (lit > 0.0) lit *= keyVisibility(n);
  vec3 sky = mix(${vec3(BOUNCE_COLOUR)}, ${vec3(SKY_COLOUR)}, 0.5 + 0.5 * dot(n, normalize(uUp + ${float(SKY_LEAN)} * uFront)));
  float viewer = ${float(VIEWER)} * max(dot(n, v), 0.0);
  float filled = uFill.w * max(dot(n, uFill.xyz), 0.0);
  vec3 light = uKey * lit * ${vec3(KEY_COLOUR)}
             + uAmbient * (sky + viewer) * ambientVisibility
             + filled * ${vec3(FILL_COLOUR)} * mix(vec3(1.0), ambientVisibility, ${float(1 - FILL_IN_HOLLOWS)});
  vec3 h = normalize(uLight + v);
  float nh = max(dot(n, h), 0.0);
  vec3 sheen = vec3(0.035 * pow(nh, 14.0) * lit * uKey);
  // Colours that carry values keep their lightness: half the modelling is enough.
  light = mix(light, 0.36 + 0.62 * light, mapped);
  vec3 c = mix(shoulder(albedo * light + sheen * (1.0 - mapped)), albedo, unlit);
  c = mix(c, vec3(0.69, 0.36, 0.0), uHighlight);
  outColour = vec4(toSrgb(c) * uOpacity, uOpacity);
}
`;

export const depthVertex = /* glsl */ `${HEAD}
in vec3 position;
uniform mat4 uClip;
out vec3 vPosition;
void main() { vPosition = position; gl_Position = uClip * vec4(position, 1.0); }
`;

export const depthFragment = /* glsl */ `${HEAD}${CLIP}
in vec3 vPosition;
out vec4 outColour;
void main() { if (cutAway(vPosition)) discard; outColour = vec4(1.0); }
`;
