// SPDX-License-Identifier: GPL-3.0-or-later
// What shaders share. Fragments are written in sRGB: still pictures average many of them, as multisampling
// averages the moving ones.

export const HEAD = /* glsl */ `
precision highp float;
precision highp int;
`;

export const CLIP = /* glsl */ `
uniform vec4 uSection;   // plane: keep dot(xyz, p) <= w; xyz = 0 keeps everything
bool cutAway(vec3 p) { return dot(uSection.xyz, p) > uSection.w; }
`;

export const SRGB = /* glsl */ `
vec3 toLinear(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c)); }
vec3 toSrgb(vec3 c) { return mix(12.92 * c, 1.055 * pow(max(c, 0.0), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c)); }
`;

/** Light map look-up: texel of a drawn vertex. */
export const TEXEL = /* glsl */ `
ivec2 texelOf(int vertex, int width) { return ivec2(vertex % width, vertex / width); }
`;
