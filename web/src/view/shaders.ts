// SPDX-License-Identifier: GPL-3.0-or-later
// The shaders. Positions are mm from the scene's origin; `projectionMatrix` is the whole clip matrix of
// camera.ts (computed in double precision), so there is no model or view matrix. Fragments are written in
// sRGB: still pictures average many of them, as multisampling averages the moving ones.

const HEAD = /* glsl */ `
precision highp float;
precision highp int;
`;

const CLIP = /* glsl */ `
uniform vec4 uSection;   // plane: keep dot(xyz, p) <= w; xyz = 0 keeps everything
bool cutAway(vec3 p) { return dot(uSection.xyz, p) > uSection.w; }
`;

const SRGB = /* glsl */ `
vec3 toLinear(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c)); }
vec3 toSrgb(vec3 c) { return mix(12.92 * c, 1.055 * pow(max(c, 0.0), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c)); }
`;

/** Light map look-up: texel of a drawn vertex. */
const TEXEL = /* glsl */ `
ivec2 texelOf(int vertex, int width) { return ivec2(vertex % width, vertex / width); }
`;

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

/** Matt plaster: Oren-Nayar under one raking key light, a sky, a bounce from below and a weak light from
 *  the viewer that keeps shadows readable. */
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
uniform float uOcclusionStrength;
uniform float uHighlight;
uniform sampler2D uOcclusion;
uniform sampler2DShadow uShadow;
uniform mat4 uShadowMatrix;
uniform float uShadowOffset;    // mm along the normal
uniform vec2 uShadowRadius;     // PCF radius, texture units
uniform float uShadowOn;
uniform float uNoise;
#ifdef SCALAR
uniform sampler2D uMap;
uniform vec2 uMapRange;
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
  return nl * (0.9156 + 0.156 * s / t);
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
  vec3 keyColour = vec3(1.0, 0.985, 0.955);
  vec3 skyColour = mix(vec3(0.84, 0.80, 0.76), vec3(1.02, 1.05, 1.12), 0.5 + 0.5 * dot(n, normalize(uUp + 0.7 * uFront)));
  float viewer = max(dot(n, v), 0.0);
  vec3 light = uKey * lit * keyColour
             + uAmbient * (skyColour + 0.35 * viewer) * ambientVisibility;
  vec3 h = normalize(uLight + v);
  float nh = max(dot(n, h), 0.0);
  vec3 sheen = vec3(0.035 * pow(nh, 14.0) * lit * uKey);
  // Colours that carry values keep their lightness: half the modelling is enough.
  light = mix(light, 0.36 + 0.62 * light, mapped);
  vec3 c = shoulder(albedo * light + sheen * (1.0 - mapped));
  c = mix(c, vec3(0.69, 0.36, 0.0), uHighlight);
  outColour = vec4(toSrgb(c), 1.0);
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

/** Ground under an object: darkens the bench by what of the sky it hides, fading outwards. */
export const groundFragment = /* glsl */ `${HEAD}
in vec2 vUv;
uniform sampler2D uOcclusion;
uniform float uStrength;
out vec4 outColour;
void main() {
  vec2 sums = texture(uOcclusion, vUv).rg;
  float open = sums.y > 0.0 ? clamp(sums.x / sums.y, 0.0, 1.0) : 1.0;
  float fade = 1.0 - smoothstep(0.6, 1.0, 2.0 * length(vUv - 0.5));
  float a = uStrength * (1.0 - open) * fade;
  outColour = vec4(vec3(0.085, 0.070, 0.047) * a, a);
}
`;

/** Lines some pixels wide: one quad per piece, drawn a touch nearer than the surface they lie on. */
export const lineVertex = /* glsl */ `${HEAD}
in vec3 position;      // x: 0 start, 1 end; y: side
in vec3 start;
in vec3 end;
in vec2 run;           // length before and after the piece, mm
uniform mat4 projectionMatrix;
uniform vec2 uViewport;   // device pixels
uniform float uWidth;
uniform float uNearer;
out vec3 vPosition;
out float vRun;
out float vSide;
void main() {
  vec4 a = projectionMatrix * vec4(start, 1.0);
  vec4 b = projectionMatrix * vec4(end, 1.0);
  vec2 pa = a.xy / a.w * uViewport;
  vec2 pb = b.xy / b.w * uViewport;
  vec2 d = pb - pa;
  float l = length(d);
  d = l > 1e-6 ? d / l : vec2(1.0, 0.0);
  vec4 p = position.x < 0.5 ? a : b;
  float halfWidth = 0.5 * uWidth + 0.75;
  vec2 offset = (vec2(-d.y, d.x) * position.y + d * (2.0 * position.x - 1.0)) * halfWidth * 2.0;
  p.xy += offset / uViewport * p.w;
  p.z -= uNearer * p.w;
  vPosition = position.x < 0.5 ? start : end;
  vRun = position.x < 0.5 ? run.x : run.y;
  vSide = position.y * halfWidth;
  gl_Position = p;
}
`;
export const lineFragment = /* glsl */ `${HEAD}${CLIP}
in vec3 vPosition;
in float vRun;
in float vSide;
uniform vec3 uColour;
uniform float uOpacity;
uniform float uWidth;
uniform float uDash;     // mm; 0 is solid
out vec4 outColour;
void main() {
#ifdef SECTIONED
  if (cutAway(vPosition)) discard;
#endif
  if (uDash > 0.0 && fract(vRun / uDash) > 0.55) discard;
  float a = uOpacity * clamp(0.5 * uWidth + 0.5 - abs(vSide), 0.0, 1.0);
  outColour = vec4(uColour * a, a);
}
`;

/** The face of a cut: warm, hatched, unlit. */
export const capVertex = /* glsl */ `${HEAD}
in vec3 position;
uniform mat4 projectionMatrix;
void main() { gl_Position = projectionMatrix * vec4(position, 1.0); }
`;
export const capFragment = /* glsl */ `${HEAD}
uniform vec3 uColour;
uniform vec3 uHatch;
uniform float uPitch;    // device pixels
out vec4 outColour;
void main() {
  float s = abs(fract((gl_FragCoord.x + gl_FragCoord.y) / uPitch) - 0.5) * uPitch;
  outColour = vec4(mix(uHatch, uColour, smoothstep(0.6, 1.4, s)), 1.0);
}
`;
