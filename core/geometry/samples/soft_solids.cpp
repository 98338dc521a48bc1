// SPDX-License-Identifier: GPL-3.0-or-later
// Smooth solids with few features: star, heart, torus. Their fields are symmetric by construction, unlike
// a chain of smooth minima, which depends on the order.
#include <array>

#include "geometry/samples/remeshing/mesh_implicit.h"
#include "geometry/samples/sculpting/noise.h"
#include "geometry/samples/shapes.h"

namespace formwright::samples {
namespace {

// -k log sum exp(-d / k): smooth everywhere, and the same whichever part comes first.
// The sum is anchored at the least distance, so that nothing overflows.
template <std::size_t n>
double blended(const std::array<double, n>& d, double k) {
  double minimum = d[0], sum = 0;
  for (double x : d) minimum = x < minimum ? x : minimum;
  for (double x : d) sum += exponential((minimum - x) / k);
  // log by Newton on exp: sum lies between 1 and n.
  double log = sum - 1 < 1 ? sum - 1 : 1;
  for (int i = 0; i < 6; ++i) log -= 1 - sum * exponential(-log);
  return minimum - k * log;
}

Model meshed(const Field& field, const Box& bounds, double area_mm2, int vertices, const Colouring& colouring,
             Context& context) {
  ImplicitShape shape;
  shape.field = field;
  shape.bounds = bounds;
  shape.largest_cell_mm = 3;
  return finished(mesh_implicit(shape, area_mm2, vertices, context), colouring);
}

}  // namespace

Model make_star(int vertices, Context& context) {
  constexpr double squeeze = 1.75;  // pillow-like: thinner in z
  std::array<RoundCone, 5> limbs;
  for (int k = 0; k < 5; ++k) {
    const double a = k * 2 * pi / 5;
    limbs[static_cast<std::size_t>(k)] = RoundCone({0, 0, 0}, {45.5 * sine(a), 45.5 * cosine(a), 0}, 16.5, 6.0);
  }
  const Field field = [limbs](const Point& p) {
    const Point q{std::fabs(p.x), p.y, std::fabs(p.z) * squeeze};  // both mirror symmetries to the last bit
    std::array<double, 5> d;
    for (std::size_t k = 0; k < 5; ++k) d[k] = limbs[k](q);
    return blended(d, 2.6) / 1.3;
  };
  static const Point gold = srgb(244, 190, 72), amber = srgb(224, 128, 44), cream = srgb(255, 236, 184);
  return meshed(
      field, {{-58, -50, -20}, {58, 60, 20}}, 9000, vertices,
      [](const Point& p, const Point&) {
        const double r = std::sqrt(p.x * p.x + p.y * p.y);
        const CellDistances dots = cell_noise(Point{p.x, p.y, p.z} / 6.5, 3);
        const Point ground = mix(gold, amber, smooth_step(8, 46, r + 4 * noise(p / 9, 2)));
        return mix(ground, cream, 0.8 * smooth_step(0.3, 0.22, dots.nearest));
      },
      context);
}

Model make_heart(int vertices, Context& context) {
  // A limb from the tip to each lobe; a gentle pillow in depth.
  const RoundCone limb({20.5, 20, 0}, {0, -45, 0}, 26, 5);
  const Field field = [limb](const Point& p) {
    const double x = std::fabs(p.x), z = std::fabs(p.z) * 1.25;
    const std::array<double, 2> d{limb({x, p.y, z}), limb({-x, p.y, z})};
    return blended(d, 3.5) / 1.1;
  };
  static const Point red = srgb(190, 32, 48), deep = srgb(122, 14, 36), blush = srgb(232, 88, 92);
  return meshed(
      field, {{-56, -56, -34}, {56, 58, 34}}, 16700, vertices,
      [](const Point& p, const Point&) {
        const double cloud = 0.5 + 0.7 * fractal_noise(p / 30, 4, 0.5, 5);
        return mix(mix(deep, red, smooth_step(-50, 10, p.y)), blush,
                   0.45 * clamp(cloud, 0, 1) * smooth_step(0, 30, p.y));
      },
      context);
}

Model make_torus(int vertices, Context& context) {
  constexpr double ring = 35, tube = 15;
  const Field field = [](const Point& p) {
    const double r = std::sqrt(p.x * p.x + p.y * p.y) - ring;
    return std::sqrt(r * r + p.z * p.z) - tube;
  };
  static const Point teal = srgb(60, 140, 150), sand = srgb(236, 214, 170);
  return meshed(
      field, {{-54, -54, -18}, {54, 54, 18}}, 4 * pi * pi * ring * tube, vertices,
      [](const Point& p, const Point&) {
        const double around = arc_tangent(p.y, p.x) / (2 * pi), r = std::sqrt(p.x * p.x + p.y * p.y) - ring,
                     tube_angle = arc_tangent(p.z, r) / (2 * pi);
        const double band = 0.5 + 0.5 * cosine(2 * pi * (12 * around + tube_angle));
        return mix(teal, sand, smooth_step(0.35, 0.65, band));
      },
      context);
}

}  // namespace formwright::samples
