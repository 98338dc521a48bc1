// SPDX-License-Identifier: GPL-3.0-or-later
// A medal after the owls of Athens: fine, flat detail on both faces. Millimetres, front towards +z.
#include <algorithm>

#include "geometry/samples/remeshing/mesh_implicit.h"
#include "geometry/samples/sculpting/locks.h"
#include "geometry/samples/shapes.h"

namespace formwright::samples {
namespace {

constexpr double radius = 49, half_thickness = 3.2, face = half_thickness, area_mm2 = 18500;

void model_flan(Sculpture& s) {
  s.unite(0, {0, 0, 0}, radius + half_thickness, [](const Point& p) {
    const double r = std::sqrt(p.x * p.x + p.y * p.y);
    const double round = 1.1, a = r - radius + round, b = std::fabs(p.z) - half_thickness + round;
    const double oa = a > 0 ? a : 0, ob = b > 0 ? b : 0, inside = a > b ? a : b;
    const double disc = std::sqrt(oa * oa + ob * ob) + (inside < 0 ? inside : 0) - round;
    // Raised rim, slightly dished fields.
    const double rim = std::sqrt((r - 46.2) * (r - 46.2) + (std::fabs(p.z) - face) * (std::fabs(p.z) - face)) - 1.5;
    return smooth_min(disc, rim, 0.8);
  });
  for (int k = 0; k < 72; ++k) {
    const double a = 2 * pi * k / 72;
    for (double side : {1.0, -1.0}) {
      const Point c{41.9 * sine(a), 41.9 * cosine(a), side * face};
      s.unite(0.2, c, 1.25, [c](const Point& p) { return length(p - c) - 1.25; });
    }
  }
}

// Strokes of capital letters in a box 4 wide and 6 high, as pairs of points.
struct Letter {
  char name;
  std::vector<std::vector<Point>> strokes;
};
const std::vector<Letter>& alphabet() {
  static const std::vector<Letter> letters{
      {'F', {{{0, 0}, {0, 6}}, {{0, 6}, {3.4, 6}}, {{0, 3.2}, {2.7, 3.2}}}},
      {'O', {{{2, 6}, {0.6, 5.2}, {0, 3}, {0.6, 0.8}, {2, 0}, {3.4, 0.8}, {4, 3}, {3.4, 5.2}, {2, 6}}}},
      {'R',
       {{{0, 0}, {0, 6}},
        {{0, 6}, {2.4, 6}, {3.3, 5.4}, {3.5, 4.5}, {3.2, 3.6}, {2.3, 3.1}, {0, 3.1}},
        {{1.8, 3.1}, {3.6, 0}}}},
      {'M', {{{0, 0}, {0, 6}}, {{0, 6}, {2.1, 2.2}}, {{2.1, 2.2}, {4.2, 6}}, {{4.2, 6}, {4.2, 0}}}},
      {'W', {{{0, 6}, {1.2, 0}}, {{1.2, 0}, {2.4, 4.4}}, {{2.4, 4.4}, {3.6, 0}}, {{3.6, 0}, {4.8, 6}}}},
      {'I', {{{1, 0}, {1, 6}}}},
      {'G',
       {{{3.8, 4.9}, {2.9, 5.8}, {1.9, 6}, {0.6, 5.1}, {0, 3}, {0.6, 0.9}, {2, 0}, {3.3, 0.5}, {3.8, 1.4}, {3.8, 2.7}},
        {{3.8, 2.7}, {2.4, 2.7}}}},
      {'H', {{{0, 0}, {0, 6}}, {{3.6, 0}, {3.6, 6}}, {{0, 3.1}, {3.6, 3.1}}}},
      {'T', {{{0, 6}, {4, 6}}, {{2, 6}, {2, 0}}}}};
  return letters;
}
double letter_width(const Letter& letter) {
  double w = 0;
  for (const auto& stroke : letter.strokes)
    for (const Point& p : stroke) w = std::max(w, p.x);
  return letter.name == 'I' ? 2 : w;
}

void write_around(Sculpture& s, const char* text, double baseline) {
  double total = 0;
  std::vector<const Letter*> word;
  for (const char* c = text; *c != 0; ++c)
    for (const Letter& letter : alphabet())
      if (letter.name == *c) {
        word.push_back(&letter);
        total += letter_width(letter) + 2.6;
      }
  double at = -0.5 * (total - 2.6);
  for (const Letter* letter : word) {
    for (const auto& stroke : letter->strokes)
      for (std::size_t k = 0; k + 1 < stroke.size(); ++k) {
        const auto place = [&](const Point& q) {
          const double angle = (at + q.x) / (baseline + 3), r = baseline + q.y;
          return Point{r * sine(angle), r * cosine(angle), face + 0.1};
        };
        s.add_cone(0.25, place(stroke[k]), place(stroke[k + 1]), 0.72, 0.72);
      }
    at += letter_width(*letter) + 2.6;
  }
}

void model_owl(Sculpture& s) {
  const auto egg = [&](double x, double y, double z, double roll, double rx, double ry, double rz, double soft,
                       bool twin = false) {
    s.add_ellipsoid(soft, posed({x, y, z}, 0, 0, roll), {rx, ry, rz}, twin);
  };
  egg(0, -6, 3.0, 0, 11.5, 17, 4.4, 0.6);             // body
  egg(0, 12.5, 3.2, 0, 10.6, 9.2, 4.8, 1.4);          // head
  egg(9.2, -7.5, 3.6, 9, 4.6, 14.5, 3.6, 0.5, true);  // wings
  egg(0, -25, 2.8, 0, 4.6, 6.5, 2.6, 0.6);            // tail
  // Face: two discs, eyes, brows, beak.
  for (double side : {1.0, -1.0}) {
    const Point c{side * 4.5, 13.2, 6.9};
    s.carve(0.8, {c.x, c.y, c.z + 1.4}, 4.4, [c](const Point& p) {
      return ellipsoid(p - c - Point{0, 0, 1.6}, {4.3, 4.3, 2.2});
    });
    s.unite(0.4, c, 5, [c](const Point& p) {
      const double r = std::sqrt((p.x - c.x) * (p.x - c.x) + (p.y - c.y) * (p.y - c.y)) - 4.2;
      return std::sqrt(r * r + (p.z - c.z + 0.2) * (p.z - c.z + 0.2)) - 0.55;
    });
    s.unite(0.15, c, 2.5, [c](const Point& p) {
      const double r = std::sqrt((p.x - c.x) * (p.x - c.x) + (p.y - c.y) * (p.y - c.y));
      return length(p - c + Point{0, 0, 0.6}) - 2.3 + 0.35 * bell(r / 0.9);
    });
    s.add_cone(0.5, {0, 15.2, 7.6}, {side * 9.4, 20.6, 4.8}, 1.1, 0.55);
  }
  s.add_cone(0.4, {0, 13.4, 8.0}, {0, 9.2, 7.4}, 1.25, 0.45);
  // Legs, toes, the branch they hold.
  s.add_cone(0.5, {-19, -27.6, 3.4}, {18, -26.4, 3.4}, 1.5, 1.1);
  for (double side : {1.0, -1.0}) {
    s.add_cone(0.6, {side * 4.6, -20, 4.6}, {side * 4.8, -25, 4.6}, 2.3, 1.3);
    for (int toe = -1; toe <= 1; ++toe)
      s.add_cone(0.25, {side * 4.8 + 0.4 * toe, -25, 4.8}, {side * 4.8 + 1.5 * toe, -28.4, 4.4}, 0.85, 0.5);
  }
}

void lay_feathers(LockLayer& layer, const Sculpture& skin) {
  const auto feather = [&](double x, double y, double dx, double dy, double length, double width, double height) {
    LockStyle style;
    style.length = length;
    style.width = width;
    style.height = height;
    style.root = 0.1;
    style.tip_width = 0.45;
    style.tip_height = 1;
    style.strands = 2;
    style.groove = 0.3;
    layer.lay(skin, Point{x, y, face + 4}, Point{dx, dy, 0}, style, 0);
  };
  for (int row = 0; row < 8; ++row)  // breast: short rounded rows
    for (int k = -3; k <= 3; ++k) {
      const double x = (k + (row % 2) * 0.5) * 2.0;
      if (std::fabs(x) < 6.2) feather(x, -18 + 2.9 * row, 0, -1, 2.9, 1.1, 0.5);
    }
  for (double side : {1.0, -1.0}) {
    for (int k = 0; k < 6; ++k)
      feather(side * (6.6 + 1.15 * k), -4 + 0.6 * k, side * 0.05, -1, 14.5 - 0.7 * k, 0.85, 0.75);  // pinions
    for (int row = 0; row < 3; ++row)
      for (int k = 0; k < 5; ++k)
        feather(side * (6.6 + 1.35 * k + 0.5 * (row % 2)), -2 + 2.6 * row + 0.5 * k, side * 0.08, -1, 3.4, 0.95, 0.65);
    for (int k = 0; k < 5; ++k) {  // crown
      feather(side * (1.2 + 1.7 * k), 21 - 0.35 * k * k, side * (0.15 + 0.1 * k), -1, 2.6, 0.8, 0.35);
    }
  }
  for (int k = -2; k <= 2; ++k) feather(1.5 * k, -22, 0.06 * k, -1, 8.5, 0.95, 0.6);
}

void add_sprig(Sculpture& s, double mirror) {
  const std::vector<Point> stem = curve({{mirror * 5, -36.5, face},
                                         {mirror * 18, -32.5, face},
                                         {mirror * 28.5, -23.5, face},
                                         {mirror * 34.5, -10, face},
                                         {mirror * 36, 0, face}},
                                        5);
  for (std::size_t k = 0; k + 1 < stem.size(); ++k) s.add_cone(0.2, stem[k], stem[k + 1], 0.65, 0.6);
  for (std::size_t k = 2; k < stem.size(); k += 2) {
    const Point along = normalized(stem[k] - stem[k - 1]);
    const Point across{-along.y, along.x, 0};
    for (double side : {1.0, -1.0}) {
      const Point axis = normalized(along * 0.8 + across * side * 0.62);
      const Point centre = stem[k] + axis * 3.1;
      const Frame leaf{centre + Point{0, 0, 0.1}, axis, Point{-axis.y, axis.x, 0}, {0, 0, 1}};
      s.unite(0.15, leaf.o, 3.2, [leaf](const Point& p) {
        const Point q = leaf.local(p);
        const double vein = 0.22 * bell(q.y / 0.4);
        return ellipsoid(q, {3.0, 1.15, 1.0}) + vein;
      });
    }
    if (k % 4 == 0) {
      const Point olive = stem[k] + across * (mirror * 2.4) - along * 1.6;
      s.unite(0.15, olive, 1.0, [olive](const Point& p) { return length(p - olive) - 1.0; });
    }
  }
}

void model_reverse(Sculpture& s) {
  const double z = -face;
  for (int k = 0; k < 16; ++k) {
    const double a = 2 * pi * k / 16, length = k % 2 == 0 ? 25 : 17.5;
    const Point out{sine(a), cosine(a), 0};
    const Frame ray{out * (11.2 + length / 2) + Point{0, 0, z}, out, Point{-out.y, out.x, 0}, {0, 0, 1}};
    s.unite(0.2, ray.o, length / 2 + 1, [ray, length](const Point& p) {
      const Point q = ray.local(p);
      const double w = 2.5 * (1 - clamp((q.x + length / 2) / length, 0, 1)) + 0.15;  // a keeled, tapering ray
      return smooth_max((std::fabs(q.y) + std::fabs(q.z) * 1.3 - w) * 0.62, std::fabs(q.x) - length / 2, 0.4);
    });
  }
  s.add_ellipsoid(0.3, posed({0, 0, z}, 0), {8.6, 8.6, 3.0});
  for (double r : {10.4, 37.8}) {
    s.unite(0.3, {0, 0, z}, r + 1, [r, z](const Point& p) {
      const double d = std::sqrt(p.x * p.x + p.y * p.y) - r;
      return std::sqrt(d * d + (p.z - z) * (p.z - z)) - 0.6;
    });
  }
}

}  // namespace

Model make_coin(int vertices, Context& context) {
  const double edge = edge_length_of(area_mm2, vertices);
  const double plumage = 1 - smooth_step(0.6, 1.4, edge);
  const Box bounds{{-54, -54, -9}, {54, 54, 14}};
  Sculpture s(1, bounds);
  model_flan(s);
  model_owl(s);
  LockLayer feathers({{-16, -34, 0}, {16, 26, 14}}, 1);
  if (plumage > 0) {
    Sculpture skin = s;
    skin.finish();
    lay_feathers(feathers, skin);
    context.check_cancelled();
    feathers.finish(0.06, plumage);
    s.raise(
        {0, -4, 4}, 32, [&feathers, plumage](const Point& p) { return p.z > 2 ? plumage * feathers(p) : 0; },
        feathers.greatest_height());
  }
  write_around(s, "FORMWRIGHT", 31.2);
  add_sprig(s, 1);
  add_sprig(s, -1);
  model_reverse(s);
  s.finish();
  ImplicitShape shape;
  shape.field = [&s](const Point& p) { return s(p); };
  shape.bounds = bounds;
  shape.largest_cell_mm = 1.6;
  static const Point bronze = srgb(176, 132, 78), dark = srgb(92, 74, 52), green = srgb(104, 136, 112);
  return finished(mesh_implicit(shape, area_mm2, vertices, context), [](const Point& p, const Point& n) {
    const double raised = smooth_step(face - 0.1, face + 2.5, std::fabs(p.z));
    const double steep = 1 - std::fabs(n.z);
    return mix(mix(mix(dark, green, 0.35 * smooth_step(0.2, 0.7, steep)), bronze, 0.35 + 0.65 * raised), dark,
               0.35 * steep);
  });
}

}  // namespace formwright::samples
