// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/samples/sculpting/noise.h"

namespace formwright::samples {
namespace {

std::uint32_t lattice_hash(std::int32_t i, std::int32_t j, std::int32_t k, std::uint32_t seed) {
  return hash(static_cast<std::uint32_t>(i) * 0x8da6b343U ^ static_cast<std::uint32_t>(j) * 0xd8163841U ^
              static_cast<std::uint32_t>(k) * 0xcb1ab31fU ^ seed * 0x9e3779b9U);
}

// Dot product with one of the twelve edge directions of the cube (Perlin 2002).
double gradient_dot(std::uint32_t h, double x, double y, double z) {
  const double sign_a = (h & 1U) != 0U ? -1 : 1, sign_b = (h & 2U) != 0U ? -1 : 1;
  switch ((h >> 2) % 3U) {
    case 0: return sign_a * x + sign_b * y;
    case 1: return sign_a * x + sign_b * z;
    default: return sign_a * y + sign_b * z;
  }
}
double fade(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }

}  // namespace

double noise(const Point& p, std::uint32_t seed) {
  const double fx = std::floor(p.x), fy = std::floor(p.y), fz = std::floor(p.z);
  const double x = p.x - fx, y = p.y - fy, z = p.z - fz;
  const double u = fade(x), v = fade(y), w = fade(z);
  const auto i = static_cast<std::int32_t>(fx), j = static_cast<std::int32_t>(fy), k = static_cast<std::int32_t>(fz);
  double corner[2][2][2];
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b)
      for (int c = 0; c < 2; ++c)
        corner[a][b][c] = gradient_dot(lattice_hash(i + a, j + b, k + c, seed), x - a, y - b, z - c);
  const double y0 = mix(mix(corner[0][0][0], corner[1][0][0], u), mix(corner[0][1][0], corner[1][1][0], u), v);
  const double y1 = mix(mix(corner[0][0][1], corner[1][0][1], u), mix(corner[0][1][1], corner[1][1][1], u), v);
  return mix(y0, y1, w);
}

double noise(double x, double y, std::uint32_t seed) { return noise(Point{x, y, 0.37}, seed); }

double fractal_noise(const Point& p, int octaves, double gain, std::uint32_t seed) {
  double sum = 0, height = 1, frequency = 1;
  for (int octave = 0; octave < octaves; ++octave) {
    sum += height * noise(p * frequency, seed + static_cast<std::uint32_t>(octave));
    height *= gain;
    frequency *= 2.03;  // not 2: keeps the lattices of the octaves from coinciding
  }
  return sum;
}

CellDistances cell_noise(const Point& p, std::uint32_t seed) {
  const auto i = static_cast<std::int32_t>(std::floor(p.x)), j = static_cast<std::int32_t>(std::floor(p.y)),
             k = static_cast<std::int32_t>(std::floor(p.z));
  CellDistances result{1e30, 1e30, 0};
  for (int a = -1; a <= 1; ++a)
    for (int b = -1; b <= 1; ++b)
      for (int c = -1; c <= 1; ++c) {
        const std::uint32_t h = lattice_hash(i + a, j + b, k + c, seed);
        const double ux = (h & 1023U) / 1024.0, uy = ((h >> 10) & 1023U) / 1024.0, uz = ((h >> 20) & 1023U) / 1024.0;
        const double d = distance2(p, Point{i + a + ux, j + b + uy, k + c + uz});
        if (d < result.nearest) {
          result = {d, result.nearest, h};
        } else if (d < result.second) {
          result.second = d;
        }
      }
  return {std::sqrt(result.nearest), std::sqrt(result.second), result.nearest_id};
}

}  // namespace formwright::samples
