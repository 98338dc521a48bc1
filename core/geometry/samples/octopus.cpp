// SPDX-License-Identifier: GPL-3.0-or-later
// An octopus at rest, in units of 0.78 mm: mantle leaning back, eight arms curling over the ground.
#include <algorithm>

#include "geometry/samples/remeshing/mesh_implicit.h"
#include "geometry/samples/sculpting/noise.h"
#include "geometry/samples/shapes.h"

namespace formwright::samples {
namespace {

constexpr double unit_mm = 0.78, area_mm2 = 11500;
const Point left_eye{12.4, 29.0, 8.5};
constexpr double eye_ball = 5.0, eye_forward = 2.4;

struct Arm {
  Tube tube;
  std::vector<Point> up;  // per path point, away from the ground
};

double arm_radius(double s) { return mix(7.6, 1.15, 1 - (1 - s) * (1 - s * 0.35)); }

// Walks out from under the head, swings to a side and curls up at the tip.
Arm make_arm(int k) {
  struct Bend {
    double azimuth, swing, curl, lift;
  };
  static const Bend bends[8] = {{8, 26, 300, 3},    {54, 20, -250, 11}, {98, 30, 290, 3},   {146, 24, -230, 10},
                                {-170, 28, 270, 3}, {-124, 22, 250, 9}, {-80, 30, -260, 4}, {-36, 20, 300, 12}};
  const Bend& bend = bends[k];
  constexpr int steps = 40;
  constexpr double reach = 80;
  Arm arm;
  double heading = bend.azimuth;
  Point p{5.5 * sine(heading * pi / 180), 0, 5.5 * cosine(heading * pi / 180)};
  for (int i = 0; i <= steps; ++i) {
    const double s = static_cast<double>(i) / steps;
    const double radius = arm_radius(s);
    const double lie = radius * 0.82, lift = bend.lift * smooth_step(0.55, 1, s);
    const double height = mix(14, lie, smooth_step(0, 0.42, s)) + lift;
    arm.tube.path.push_back({p.x, height, p.z});
    arm.tube.radius.push_back(radius);
    const double gait = bend.swing * 0.16 * sine(2 * pi * s);
    const double tip = smooth_step(0.45, 0.95, s);
    heading += gait + bend.curl / steps * 3.2 * tip * tip;
    p += Point{sine(heading * pi / 180), 0, cosine(heading * pi / 180)} *
         (reach / steps * mix(0.8, 1, smooth_step(0, 0.3, s)));
  }
  return arm;
}

void add_suckers(Sculpture& s, const Arm& arm) {
  const auto& path = arm.tube.path;
  double travelled = 0, next = 9;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Point ab = path[i + 1] - path[i];
    const double piece = length(ab);
    while (next < travelled + piece) {
      const double t = (next - travelled) / piece;
      const Point c = path[i] + ab * t;
      const double radius = mix(arm.tube.radius[i], arm.tube.radius[i + 1], t);
      const Point side = normalized(cross(ab, Point{0, 1, 0})), down = normalized(cross(side, ab)) * -1;
      const double size = 0.42 * radius + 0.15;
      for (double hand : {-1.0, 1.0}) {
        // Low on both flanks, where they can be seen.
        const Point out = normalized(side * (hand * 0.9) + down * -0.42 * (down.y > 0 ? 1.0 : -1.0));
        const Frame rim{c + out * (radius * 0.97), normalized(ab), cross(out, normalized(ab)), out};
        s.unite(0.25 * size, rim.o, 1.4 * size, [rim, size](const Point& p) {
          const Point q = rim.local(p);
          const double r = std::sqrt(q.x * q.x + q.y * q.y);
          const double ring =
              std::sqrt((r - 0.68 * size) * (r - 0.68 * size) + (q.z - 0.12 * size) * (q.z - 0.12 * size)) - 0.3 * size;
          return ring;
        });
      }
      next += 2.15 * size;
    }
    travelled += piece;
  }
}

void model_head(Sculpture& s) {
  s.add_ellipsoid(0, posed({0, 22, 3}, 0), {15.5, 13, 14});
  s.add_ellipsoid(9, posed({0, 40, -13}, 0, -42), {18.5, 26, 19.0});
  s.add_ellipsoid(7, posed({0, 13, 0}, 0), {17, 8.5, 17});
  s.add_ellipsoid(4, posed(left_eye, 35), {6.4, 6.6, 6.0}, true);
  s.add_cone(2.5, {7, 16, 13}, {9.5, 15.5, 19}, 3.2, 2.3);  // the siphon
  s.carve_ellipsoid(0.6, posed({9.9, 15.4, 20.4}, 25), {1.4, 1.4, 2.6});
}

void model_eyes(Sculpture& s, double edge) {
  for (int side = 0; side < 2; ++side) {
    const double mirror = side == 0 ? 1 : -1;
    const Point c{mirror * left_eye.x, left_eye.y, left_eye.z};
    const Point gaze = normalized(Point{mirror * 0.72, 0.12, 0.68});
    const Point u = normalized(cross(Point{0, 1, 0}, gaze));
    const Frame eye{c + gaze * eye_forward, u, cross(gaze, u), gaze};
    s.unite(1.2, eye.o, 6.5, [eye](const Point& p) {  // the lid around it
      const Point q = eye.local(p);
      const double r = std::sqrt(q.x * q.x * 0.8 + q.y * q.y * 1.3) - 4.2;
      return std::sqrt(r * r + (q.z - 1.7) * (q.z - 1.7)) - 0.9;
    });
    s.carve(0.5, eye.o + gaze * 3, 7, [eye](const Point& p) {
      const Point q = eye.local(p);
      const double lens = std::sqrt(q.x * q.x * 0.75 + q.y * q.y * 1.35) - 3.9;
      return smooth_max(lens, 0.5 - q.z, 0.5);
    });
    s.unite(0.1, eye.o, eye_ball, [eye, edge](const Point& p) {
      const Point q = eye.local(p);
      const double slit =
          q.z > 0 ? 0.45 * bell(std::sqrt(q.x * q.x / 5.5 + q.y * q.y / std::max(0.8, edge * edge))) : 0;
      return length(q) - eye_ball + slit;
    });
  }
}

// Warts and wrinkles of the skin, in mm.
double skin_relief(const Point& p, double fine) {
  const double mantle =
      smooth_step(20, 34, p.y) * smooth_step(7, 9, length(Point{std::fabs(p.x), p.y, p.z} - left_eye));
  const CellDistances warts = cell_noise(p / 4.6, 4);
  const double dome = smooth_step(0.42, 0.1, warts.nearest) * ((warts.nearest_id >> 7 & 3U) != 0U ? 1.0 : 0.4);
  const double folds = noise(Point{p.x / 6, p.y / 3.2, p.z / 6}, 2);
  const double grain = noise(p / 1.1, 6);
  return mantle * (0.62 * dome + 0.28 * folds) + (1 - mantle) * 0.12 * folds + fine * 0.07 * grain;
}

Point skin_colour(const Point& p, const Point& normal) {
  static const Point ochre = srgb(201, 104, 66), rust = srgb(150, 58, 46), cream = srgb(243, 214, 184),
                     ring = srgb(88, 40, 46), gold = srgb(222, 180, 92), black = srgb(20, 16, 18);
  const double mottled = clamp(0.5 + 0.75 * fractal_noise(p / 13, 3, 0.5, 11), 0, 1);
  Point skin = mix(ochre, rust, mottled);
  const CellDistances spots = cell_noise(p / 7.5, 9);
  skin = mix(skin, cream, 0.75 * smooth_step(0.3, 0.2, spots.nearest));
  skin = mix(skin, ring, 0.6 * smooth_step(0.09, 0.03, std::fabs(spots.nearest - 0.36)));
  skin = mix(skin, cream, 0.85 * smooth_step(-0.05, -0.5, normal.y) * smooth_step(22, 12, p.y));  // pale below
  for (double mirror : {1.0, -1.0}) {
    const Point gaze = normalized(Point{mirror * 0.72, 0.12, 0.68});
    const Point q = p - Point{mirror * left_eye.x, left_eye.y, left_eye.z} - gaze * eye_forward;
    const double depth = length(q), ahead = dot(q, gaze);
    if (depth > eye_ball + 0.2 || ahead < 0.5) continue;
    const Point u = normalized(cross(Point{0, 1, 0}, gaze));
    const double x = dot(q, u), y = dot(q, cross(gaze, u));
    skin = mix(mix(black, gold, smooth_step(0.85, 1.15, std::sqrt(x * x / 5.5 + y * y / 0.8))), skin,
               smooth_step(eye_ball + 0.05, eye_ball + 0.15, depth));
  }
  return skin;
}

}  // namespace

Model make_octopus(int vertices, Context& context) {
  const double edge = edge_length_of(area_mm2, vertices) / unit_mm;
  const double warts = 1 - smooth_step(1.2, 3, edge), grain = 1 - smooth_step(0.3, 0.7, edge),
               suckers = smooth_step(1.4, 0.9, edge);
  const Box bounds{{-80, -5, -80}, {80, 76, 80}};
  Sculpture s(unit_mm, bounds);
  model_head(s);
  for (int k = 0; k < 8; ++k) {
    const Arm arm = make_arm(k);
    // In pieces, so that a point looks only at what is near.
    for (std::size_t i = 0; i + 1 < arm.tube.path.size(); ++i) {
      const double softness = mix(7, 0.5, smooth_step(0, 0.4, static_cast<double>(i) / 40));
      s.add_cone(i == 0 ? 7 : std::min(softness, 3.0), arm.tube.path[i], arm.tube.path[i + 1], arm.tube.radius[i],
                 arm.tube.radius[i + 1]);
    }
    if (suckers > 0) add_suckers(s, arm);
  }
  if (warts > 0)
    s.raise(
        {0, 30, 0}, 90, [warts, grain](const Point& p) { return warts * skin_relief(p, grain); }, 1.2);
  model_eyes(s, edge);
  s.carve(0.8, {0, -40, 0}, 160, [](const Point& p) { return p.y; });
  s.finish();
  ImplicitShape shape;
  shape.field = [&s](const Point& p) { return s(p); };
  shape.bounds = {bounds.low * unit_mm, bounds.high * unit_mm};
  shape.largest_cell_mm = 1.3;
  return finished(mesh_implicit(shape, area_mm2, vertices, context),
                  [](const Point& p, const Point& n) { return skin_colour(p / unit_mm, n); });
}

}  // namespace formwright::samples
