// SPDX-License-Identifier: GPL-3.0-or-later
// A fish seen from its left side: scales in overlapping rows, rayed fins. Millimetres; head at +x.
#include <algorithm>

#include "geometry/samples/remeshing/mesh_implicit.h"
#include "geometry/samples/sculpting/noise.h"
#include "geometry/samples/shapes.h"

namespace formwright::samples {
namespace {

constexpr double area_mm2 = 11000;
constexpr double tall = 1.62;  // height of a section over its width
const Point left_eye{33.5, 3.8, 7.4};

// Half width of the body at x, and how its middle line rises.
double half_width(double x) {
  const double t = clamp((x + 34) / 80, 0, 1);
  return 2.6 + 9.6 * std::sqrt(clamp(4 * t * (1 - t), 0, 1)) * (0.42 + 0.58 * smooth_step(0, 0.75, t));
}
double middle(double x) { return 1.5 * sine((x + 10) * 0.035) - 1; }

double body(const Point& p) {
  const double x = clamp(p.x, -34, 44);
  const double r = half_width(x) * (x > 30 ? std::sqrt(clamp(1 - (x - 30) * (x - 30) / 330, 0.05, 1)) : 1);
  const double y = (p.y - middle(x)) / tall, beyond = p.x - x;
  return (std::sqrt(y * y + p.z * p.z + beyond * beyond) - r) * 0.86;
}

// A thin leaf in a plane: an ellipse with rays that leave `root`; coordinates in the frame, in mm.
struct Fin {
  Frame frame;
  Point radii;  // x, y in the plane, z half thickness at the root
  Point root;   // in the frame
  double rays;  // per radian
  double soft;
};

const std::vector<Fin>& fins() {
  static const std::vector<Fin> all = [] {
    std::vector<Fin> list;
    const auto upright = [](const Point& o, double roll) { return posed(o, 0, 0, roll); };
    list.push_back({upright({-43, 8.2, 0}, -38), {14.5, 6.6, 2.0}, {11, -1, 0}, 26, 1.6});  // tail, upper lobe
    list.push_back({upright({-43, -9.4, 0}, 38), {14.5, 6.2, 2.0}, {11, 1, 0}, 26, 1.6});   // tail, lower lobe
    list.push_back({upright({3, 17.5, 0}, -9), {21, 11.5, 2.1}, {8, -26, 0}, 30, 1.2});     // back
    list.push_back({upright({-17, -11.5, 0}, 28), {9.5, 7, 1.8}, {5, 14, 0}, 24, 1.0});     // anal
    for (double side : {1.0, -1.0}) {
      list.push_back({posed({13.5, -7.5, side * 11.5}, side * 40, side * 18, -24),
                      {10.5, 4.8, 1.5},
                      {10, 1.5, 0},
                      30,
                      1.0});  // breast
      list.push_back(
          {posed({4, -18, side * 5.2}, side * 12, side * -28, 36), {7.5, 4.2, 1.5}, {7, 2, 0}, 30, 0.9});  // belly
    }
    return list;
  }();
  return all;
}

void add_fins(Sculpture& s, double fine) {
  for (const Fin& fin : fins()) {
    s.unite(fin.soft, fin.frame.o, fin.radii.x + 1, [fin, fine](const Point& p) {
      const Point q = fin.frame.local(p);
      const double angle = arc_tangent(q.y - fin.root.y, q.x - fin.root.x);
      const double rim = 1 + 0.035 * fine * cosine(fin.rays * angle);
      const double u = q.x / (fin.radii.x * rim), v = q.y / (fin.radii.y * rim);
      const double out = std::sqrt(u * u + v * v);
      const double edge = (out - 1) * fin.radii.y;
      const double ridge = 0.5 + 0.5 * cosine(2 * fin.rays * angle);
      const double from_root =
          std::sqrt((q.x - fin.root.x) * (q.x - fin.root.x) + (q.y - fin.root.y) * (q.y - fin.root.y));
      const double ray = 0.42 * fine * ridge * ridge * smooth_step(4, 11, from_root);  // they would crowd at the root
      const double thick = fin.radii.z * (1 - 0.35 * clamp(out, 0, 1)) - 0.3 + ray;
      return smooth_max(edge, std::fabs(q.z) - thick, 1.0) * 0.85;
    });
  }
}

// Overlapping scales: each rises towards the tail and covers the front of the next.
struct Scale {
  double height;  // 0 to 1
  std::uint32_t id;
};
Scale scale_at(const Point& p) {
  constexpr double row = 2.5;    // mm between rows
  constexpr double around = 28;  // scales around the body
  const double u = -p.x / row, v = arc_tangent(p.z, (p.y - middle(p.x)) / tall) * around / (2 * pi);
  Scale best{0, 0};
  const double base = std::floor(u);
  for (double i = base - 1; i <= base + 1; ++i) {
    const double shift = std::fmod(std::fabs(i), 2) < 0.5 ? 0 : 0.5;
    const double j = std::floor(v - shift + 0.5);
    const double du = u - i, dv = v - shift - j;
    // Round at the tail end, straight at the front.
    const double r = std::sqrt((du > 0 ? du * du * 0.42 : 0) + dv * dv * 2.6);
    if (du < -0.2 || r >= 1) continue;
    const double h = (0.3 + 0.7 * clamp(du / 1.5, 0, 1)) * smooth_step(1, 0.82, r) * smooth_step(-0.2, 0.1, du);
    if (h > best.height)
      best = {h, hash(static_cast<std::uint32_t>(static_cast<int>(i) * 131 + (static_cast<int>(j) + 60) % 28))};
  }
  return best;
}
double scaled_skin(const Point& p) {  // where the scales are
  return smooth_step(25, 22, p.x) * smooth_step(-33, -30, p.x);
}

Point fish_colour(const Point& p) {
  static const Point back = srgb(34, 86, 110), flank = srgb(64, 150, 160), belly = srgb(236, 232, 214),
                     fin = srgb(232, 130, 52), fin_edge = srgb(248, 190, 96), gold = srgb(230, 184, 84),
                     black = srgb(16, 18, 22);
  const double d = body(p);
  const double y = (p.y - middle(clamp(p.x, -34, 44))) / (tall * half_width(clamp(p.x, -34, 44)));
  Point c =
      mix(mix(belly, flank, smooth_step(-0.75, -0.2, y)), back, smooth_step(0.1, 0.75, y + 0.25 * noise(p / 9, 3)));
  const double stripe = smooth_step(0.55, 0.85, 0.5 + 0.5 * cosine(2 * pi * (p.x / 13 + 0.25 * noise(p / 12, 4)))) *
                        smooth_step(-0.5, 0, y);
  c = mix(c, back * 0.7, 0.6 * stripe * smooth_step(28, 24, p.x));
  const Scale scale = scale_at(p);
  const double shade = ((scale.id >> 8 & 255U) / 255.0 - 0.5) * 0.25 + 0.35 * (scale.height - 0.5);
  c = c * (1 + shade * scaled_skin(p));
  const double on_fin = smooth_step(1.2, 2.0, d);  // scales rise to 0.7
  c = mix(c, mix(fin, fin_edge, smooth_step(2, 14, d)), on_fin);
  const Point e = Point{p.x, p.y, std::fabs(p.z)} - left_eye;
  const double r = std::sqrt(e.x * e.x + e.y * e.y);
  if (length(e) < 3.25 && e.z > 0.2)
    c = mix(mix(black, gold, smooth_step(1.25, 1.45, r)), black, smooth_step(2.55, 2.75, r));
  return c;
}

}  // namespace

Model make_fish(int vertices, Context& context) {
  const double edge = edge_length_of(area_mm2, vertices);
  const double scales = 1 - smooth_step(0.6, 1.3, edge), rays = 1 - smooth_step(0.6, 1.1, edge);
  const Box bounds{{-66, -34, -24}, {54, 36, 24}};
  Sculpture s(1, bounds);
  s.unite(0, {5, 0, 0}, 60, body);
  // Gill covers, mouth, cheeks.
  s.swell(1.0, posed({27, -0.5, 7.5}, 0), {9, 13, 7}, true);
  const auto mark = [&](double height, double width, const std::vector<Point>& knots) {
    s.line(height, width, s.dropped(curve(knots, 5)), 0.15, true);
  };
  mark(-0.95, 1.5, {{23.0, 15, 3}, {20.4, 8, 9}, {19.6, 1, 11}, {20.2, -6, 10}, {23.5, -13, 6}, {28, -16, 1.5}});
  mark(0.5, 2.4, {{25.4, 13, 4}, {22.8, 7, 9}, {22.0, 1, 11}, {22.6, -5, 10}, {25.5, -11, 6}});
  mark(-0.55, 1.1, {{29.5, 9, 6}, {27.3, 3, 9}, {27.8, -4, 9}, {31.5, -10, 6}});
  mark(-1.0, 1.2, {{37.8, -6.6, 6}, {41.0, -5.0, 5}, {44.0, -3.4, 2}, {45, -3.0, 0}});
  mark(0.5, 1.4, {{38.8, -4.6, 6}, {41.6, -3.2, 5}, {44.4, -1.6, 2}, {45, -1.2, 0}});
  mark(0.5, 1.4, {{38.5, -8.4, 5}, {41.2, -7.0, 4.5}, {43.6, -5.4, 2}, {44.4, -5.0, 0}});
  if (scales > 0) {
    s.raise(
        {-4, 0, 0}, 45,
        [scales](const Point& p) {
          const double mask = scaled_skin(p);
          return mask > 0 ? 0.62 * scales * mask * scale_at(p).height : 0;
        },
        0.7);
  }
  add_fins(s, rays);
  for (double side : {1.0, -1.0}) {
    const Point c{left_eye.x, left_eye.y, side * left_eye.z};
    // The socket lies further out than the ball, which grows from its ground.
    const Point socket = c + Point{0, 0, side * 1.9};
    s.carve(0.5, socket, 3.9, [socket](const Point& p) { return length(p - socket) - 3.7; });
    s.unite(0.1, c, 3.1, [c](const Point& p) {
      const double r = std::sqrt((p.x - c.x) * (p.x - c.x) + (p.y - c.y) * (p.y - c.y));
      return length(p - c) - 3.1 + 0.28 * bell(r / 1.5);
    });
  }
  s.finish();
  ImplicitShape shape;
  shape.field = [&s](const Point& p) { return s(p); };
  shape.bounds = bounds;
  shape.lipschitz = 1.8;
  shape.largest_cell_mm = 1.1;
  return finished(mesh_implicit(shape, area_mm2, vertices, context),
                  [](const Point& p, const Point&) { return fish_colour(p); });
}

}  // namespace formwright::samples
