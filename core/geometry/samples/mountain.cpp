// SPDX-License-Identifier: GPL-3.0-or-later
// A square of eroded mountain, open at its rim. Height y over (x, z).
#include <algorithm>

#include "base/parallel.h"
#include "geometry/samples/sculpting/erosion.h"
#include "geometry/samples/sculpting/noise.h"
#include "geometry/samples/shapes.h"
#include "geometry/samples/texture_painting.h"

namespace formwright::samples {
namespace {

constexpr double side_mm = 100, height_mm = 40;

class Mountain {
 public:
  explicit Mountain(Context& context) : terrain_(side_mm, height_mm, context) {}

  /// Height with the roughness that `edge` long triangles can show.
  double height(double x, double z, double edge) const {
    const double h = terrain_.at(x, z).height;
    const double inland = smooth_step(0, 4, std::min(side_mm / 2 - std::fabs(x), side_mm / 2 - std::fabs(z)));
    double rough = 0, amplitude = 0.45, wavelength = 4;
    for (std::uint32_t octave = 0; octave < 6 && wavelength > 2 * edge; ++octave) {
      const double n = noise(x / wavelength, z / wavelength, 60 + octave);
      rough += amplitude * (1 - 2 * std::fabs(n)) * smooth_step(2 * edge, 4 * edge, wavelength);  // ridged
      amplitude *= 0.52;
      wavelength *= 0.48;
    }
    return std::max(0.0, h + inland * rough * smooth_step(0.5, 14, h));
  }

  Point colour(double x, double y, double z, const Point& normal) const {
    static const Point snow = srgb(244, 247, 250), rock = srgb(146, 136, 126), dark = srgb(104, 96, 92),
                       scree = srgb(158, 146, 128), grass = srgb(132, 148, 82), forest = srgb(66, 94, 60),
                       water = srgb(92, 138, 160);
    const double patch = fractal_noise({x / 9, y / 9, z / 9}, 4, 0.55, 70),
                 grain = noise(Point{x / 0.7, y / 0.7, z / 0.7}, 75);
    const double flat = normal.y;
    const double strata = 0.5 + 0.5 * sine(2 * pi * (y / 2.6 + 0.5 * patch));
    Point c = mix(dark, rock, clamp(0.35 + 0.5 * strata + 0.3 * patch, 0, 1));
    c = mix(c, scree, smooth_step(0.68, 0.85, flat + 0.1 * patch) * 0.8);
    const double green = smooth_step(19, 12, y + 5 * patch) * smooth_step(0.5, 0.68, flat + 0.08 * patch);
    c = mix(c, mix(grass, forest, smooth_step(-0.05, 0.25, noise(x / 3.3, z / 3.3, 77) + 0.4 * patch)), green);
    const double stream = smooth_step(0.006, 0.02, terrain_.at(x, z).drainage) * smooth_step(18, 10, y);
    c = mix(c, water, 0.85 * stream);
    const double white =
        smooth_step(20, 25, y + 5 * patch + 1.5 * grain) * smooth_step(0.18, 0.42, flat + 0.12 * patch);
    return mix(c * (1 + 0.12 * grain), snow, white);
  }

 private:
  ErodedTerrain terrain_;
};

// y = height(x, z), and the sides x, z = -50, 50 on the rim.
class MountainTarget : public TargetShape {
 public:
  MountainTarget(const Mountain& mountain, double edge) : mountain_(mountain), edge_(edge) {}
  Point project(const Point& p, std::uint32_t patches, double step, Point& slope) const override {
    constexpr double half = side_mm / 2;
    Point q{clamp(p.x, -half, half), p.y, clamp(p.z, -half, half)};
    const std::uint32_t rim = patches >> first_rim_patch;
    if (rim != 0U) {
      if ((rim & 1U) != 0U) q.x = -half;
      if ((rim & 2U) != 0U) q.x = half;
      if ((rim & 4U) != 0U) q.z = -half;
      if ((rim & 8U) != 0U) q.z = half;
      return {q.x, mountain_.height(q.x, q.z, edge_), q.z};
    }
    const double h = mountain_.height(q.x, q.z, edge_);
    if (slope == Point{}) {
      const double hx = (mountain_.height(q.x + step, q.z, edge_) - h) / step,
                   hz = (mountain_.height(q.x, q.z + step, edge_) - h) / step;
      slope = Point{-hx, 1, -hz} / (1 + hx * hx + hz * hz);
    }
    return q - slope * (q.y - h);
  }

 private:
  const Mountain& mountain_;
  double edge_;
};

// Rows of equilateral triangles over the square, every second row shifted by half and closed with half triangles.
Surface lattice(int vertices, const Mountain& mountain, double edge, Context& context) {
  const int rows = std::max(4, static_cast<int>(std::sqrt(vertices / 0.866))),
            columns = static_cast<int>(rows * 0.866 + 0.5);
  Surface surface;
  std::vector<int> first;
  for (int r = 0; r <= rows; ++r) {
    first.push_back(static_cast<int>(surface.points.size()));
    const int shifted = r % 2;
    for (int c = 0; c <= columns + shifted; ++c) {
      const double x = clamp(shifted == 0 ? c : c - 0.5, 0, columns) / columns - 0.5;
      surface.points.push_back({side_mm * x, 0, side_mm * (static_cast<double>(r) / rows - 0.5)});
    }
  }
  parallel_for(surface.points.size(), 1024, [&](std::size_t from, std::size_t to) {
    context.check_cancelled();
    for (std::size_t v = from; v < to; ++v)
      surface.points[v].y = mountain.height(surface.points[v].x, surface.points[v].z, edge);
  });
  for (int r = 0; r < rows; ++r) {
    const bool even = r % 2 == 0;
    const int a = first[static_cast<std::size_t>(even ? r : r + 1)],
              b = first[static_cast<std::size_t>(even ? r + 1 : r)];
    const auto add = [&](int p, int q, int s) {
      surface.triangles.push_back(even ? Corners{p, q, s} : Corners{p, s, q});
    };
    for (int c = 0; c <= columns; ++c) {
      add(a + c, b + c, b + c + 1);
      if (c < columns) add(a + c, b + c + 1, a + c + 1);
    }
  }
  return surface;
}

}  // namespace

Model make_mountain(int vertices, Context& context) {
  context.progress(0, "Eroding");
  const Mountain mountain(context);
  context.progress(0.2, "Meshing");
  const double edge = edge_length_of(16000, vertices);
  const auto side = [](const Point& a, const Point& b) {
    const double x = a.x + b.x, z = a.z + b.z;
    return std::fabs(x) > std::fabs(z) ? (x < 0 ? 0 : 1) : (z < 0 ? 2 : 3);
  };
  const Surface surface =
      remesh_open(lattice(vertices, mountain, edge, context), side, MountainTarget(mountain, edge), vertices, context);
  const double step = std::max(edge, 0.1);
  const auto colour = [&](double x, double z, double reach) {
    const double y = mountain.height(x, z, reach);
    const double dx = mountain.height(x + reach, z, reach) - y, dz = mountain.height(x, z + reach, reach) - y;
    return mountain.colour(x, y, z, normalized(Point{-dx, reach, -dz}));
  };
  Model model = finished(surface, [&](const Point& p, const Point&) { return colour(p.x, p.z, step); });
  paint_from_above(
      model, side_mm, [&](double x, double z) { return colour(x, z, 0.2); }, vertices < 20000 ? 512 : 1024, "mountain",
      context);
  return model;
}

}  // namespace formwright::samples
