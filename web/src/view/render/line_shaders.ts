// SPDX-License-Identifier: GPL-3.0-or-later
// Lines some pixels wide, and the faces of cuts.
import { HEAD, CLIP } from './shaders';

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
#ifdef VALUES
in vec2 value;         // at start and end
out float vValue;
#endif
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
#ifdef VALUES
  vValue = position.x < 0.5 ? value.x : value.y;
#endif
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
#ifdef VALUES
in float vValue;
uniform float uReach;
#endif
#ifdef BLEND
uniform vec4 uBlendAxis;  // along it 0 at the first end, 1 at the second
uniform vec3 uBlendColour;
#endif
out vec4 outColour;
void main() {
#ifdef SECTIONED
  if (cutAway(vPosition)) discard;
#endif
  if (uDash > 0.0 && fract(vRun / uDash) > 0.55) discard;
  float a = uOpacity;
#ifdef VALUES
  if (vValue > uReach) a *= 0.05;
#endif
  a *= clamp(0.5 * uWidth + 0.5 - abs(vSide), 0.0, 1.0);
  vec3 colour = uColour;
#ifdef BLEND
  colour = mix(colour, uBlendColour, clamp(dot(uBlendAxis, vec4(vPosition, 1.0)), 0.0, 1.0));
#endif
  outColour = vec4(colour * a, a);
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
