// SPDX-License-Identifier: GPL-3.0-or-later
// A sitting tabby cat at life size in centimetres. Legs and tail lie close to the body: no holes.
#include <algorithm>

#include "geometry/samples/remeshing/mesh_implicit.h"
#include "geometry/samples/sculpting/locks.h"
#include "geometry/samples/sculpting/noise.h"
#include "geometry/samples/shapes.h"
#include "geometry/samples/texture_painting.h"

namespace formwright::samples {
namespace {

constexpr double unit_mm = 2.45, area_mm2 = 17000;
const Point nose_tip{0, 30.1, 9.1};
const Point left_eye{2.2, 31.9, 5.85};

const std::vector<Point>& tail_path() {
  static const std::vector<Point> path = curve({{0, 4.5, -11.5},
                                                {4.5, 2.2, -12.0},
                                                {8.9, 1.7, -7.5},
                                                {9.5, 1.55, -1.5},
                                                {8.3, 1.5, 4.0},
                                                {6.6, 1.45, 7.4},
                                                {4.6, 1.5, 9.3},
                                                {2.6, 1.7, 9.6}},
                                               5);
  return path;
}

void model_body(Sculpture& s) {
  s.add_ellipsoid(0, posed({0, 8.5, -5.5}, 0), {6.6, 8.4, 6.6});
  s.add_cone(4, {0, 11, -5}, {0, 19.5, -0.5}, 5.6, 5.0);
  s.add_ellipsoid(3, posed({0, 18.5, 0.8}, 0, 8), {5.2, 7.0, 5.0});
  s.add_cone(3, {0, 21, 0.2}, {0, 29, 2.2}, 4.4, 3.7);
  s.add_ellipsoid(2, posed({0, 8, 0}, 0), {4.6, 9, 4.6});  // closes the gaps between the legs
  s.add_ellipsoid(0.8, posed({0, 2.2, -1.0}, 0), {5.8, 2.9, 7.0});
  s.add_ellipsoid(0.6, posed({6.2, 0.4, 2.8}, 0), {3.0, 1.3, 5.0});
  s.add_ellipsoid(0.6, posed({5.5, 1.0, -8.5}, 25), {4.5, 2.0, 3.0});
  // Haunches and hind paws.
  s.add_ellipsoid(1.6, posed({5.4, 7.2, -4.0}, 8, 12), {3.4, 6.6, 6.2}, true);
  s.add_cone(1.2, {6.2, 2.0, -3}, {5.6, 1.3, 4.6}, 2.0, 1.45, true);
  s.add_ellipsoid(0.8, posed({5.5, 1.1, 5.2}, -6), {1.75, 1.35, 2.3}, true);
  // Shoulders and fore legs.
  s.add_ellipsoid(2.5, posed({4.0, 17.5, 0.6}, 0, 0, 6), {2.6, 5.0, 3.8}, true);
  s.add_cone(1.6, {3.2, 15.5, 2.4}, {2.75, 10, 3.2}, 2.5, 1.85, true);
  s.add_cone(0.9, {2.75, 10, 3.2}, {2.35, 3.5, 4.4}, 1.8, 1.4, true);
  s.add_ellipsoid(0.8, posed({2.35, 1.3, 5.4}, 0), {1.75, 1.5, 2.3}, true);
  for (int toe = 0; toe < 4; ++toe) {
    const double x = -1.2 + 0.8 * toe, z = 1.65 - 0.3 * (toe - 1.5) * (toe - 1.5);
    s.add_ellipsoid(0.25, posed({2.35 + x, 1.05, 5.4 + z}, 12 * (toe - 1.5)), {0.52, 0.75, 0.85}, true);
    s.add_ellipsoid(0.25, posed({5.45 + x, 0.95, 5.1 + z}, 12 * (toe - 1.5) - 6), {0.52, 0.7, 0.85}, true);
  }
}

void model_tail(Sculpture& s) {
  Tube tail;
  tail.path = tail_path();
  for (std::size_t i = 0; i < tail.path.size(); ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(tail.path.size() - 1);
    tail.radius.push_back(mix(1.9, 1.25, t) * (1 - 0.35 * smooth_step(0.9, 1, t)));
  }
  Point c;
  double r;
  tail.enclose(c, r);
  s.unite(0.7, c, r, tail);
}

void model_head(Sculpture& s) {
  s.add_ellipsoid(2.2, posed({0, 31.6, 2.8}, 0), {4.7, 4.2, 4.5});
  s.add_ellipsoid(1.6, posed({2.7, 30.0, 4.0}, 20), {2.5, 2.2, 2.7}, true);
  s.add_ellipsoid(1.5, posed({0, 33.6, 4.4}, 0), {3.4, 2.0, 2.4});
  s.add_ellipsoid(1.2, posed({0, 29.6, 6.3}, 0), {2.0, 1.9, 1.9});
  s.carve_ellipsoid(1.0, posed({2.5, 31.9, 8.3}, 25), {1.5, 1.1, 1.3}, true);
  s.add_cone(1.0, {0, 33.0, 6.2}, {0, 30.6, 8.3}, 1.0, 0.75);
  s.add_ellipsoid(0.45, posed({1.0, 29.2, 7.7}, 12), {1.25, 1.0, 1.25}, true);
  s.add_ellipsoid(0.4, posed({0, 28.3, 7.2}, 0), {1.05, 0.75, 1.0});
  s.add_ellipsoid(0.25, posed({0, 30.15, 8.85}, 0, 20), {0.72, 0.45, 0.5});
  s.carve_ellipsoid(0.12, posed({0.42, 30.02, 9.15}, 30), {0.2, 0.14, 0.25}, true);
  s.line(-0.25, 0.3, {{0, 29.9, 9.2}, {0, 29.0, 9.0}}, 0.1);
  s.line(-0.3, 0.32, curve({{0, 29.05, 9.0}, {0.7, 28.65, 8.7}, {1.6, 28.6, 7.9}, {2.4, 29.0, 7.0}}, 4), 0.1, true);
}

void model_eyes(Sculpture& s) {
  constexpr double ball = 1.5, lid = 0.17;
  const auto opening = [](const Point& p) {
    // The almond, raised outwards by 16 degrees.
    const double c = 0.961, sn = 0.276;
    const double ex = p.x - left_eye.x - 0.14, ey = p.y - left_eye.y;
    const double x = c * ex + sn * ey, y = -sn * ex + c * ey, half = 1.28;
    const auto arc = [&](double sag, double sign) {
      const double radius = (half * half + sag * sag) / (2 * sag), h = sign * y + radius - sag;
      return std::sqrt(x * x + h * h) - radius;
    };
    return smooth_max(smooth_max(arc(0.86, 1), arc(0.66, -1), 0.15), 0.2 - (p.z - left_eye.z), 0.2);
  };
  s.add_ellipsoid(0.8, posed(left_eye, 0), {ball + lid, ball + lid, ball + lid}, true);
  for (int side = 0; side < 2; ++side) {
    const Point c = side == 0 ? left_eye : mirrored(left_eye);
    s.carve(0.1, c + Point{0, 0, 1.2}, 1.7,
            [opening, side](const Point& p) { return opening(side == 0 ? p : mirrored(p)); });
    s.unite(0.03, c, ball, [c](const Point& p) {
      const Point q = p - c - Point{c.x > 0 ? 0.05 : -0.05, 0.08, 0};
      const double rim = q.z > 0 ? 0.05 * bell((std::sqrt(q.x * q.x + q.y * q.y) - 0.78) / 0.12) : 0;
      const double slit = q.z > 0 ? 0.13 * bell(std::sqrt(q.x * q.x / 0.05 + q.y * q.y / 0.36)) : 0;
      return length(p - c) - ball + rim + slit;
    });
  }
}

void model_ears(Sculpture& s) {
  const Point base{2.75, 34.2, 2.2}, tip{4.3, 39.4, 1.5};
  const Point axis = normalized(tip - base);
  const Point facing{0.5, 0, 1};
  const Point front = normalized(facing - axis * dot(facing, axis));
  const Frame ear{base, cross(axis, front), axis, front};
  const double height = length(tip - base);
  // A pointed half cone: broad below, its sides a little bulged.
  const auto horn = [ear, height](const Point& p, double width, double depth, double top, double forward) {
    const Point q = ear.local(p);
    const double v = clamp(q.y / (height * top), -0.4, 1);
    const double taper = (1 - v) * (1 + 0.55 * v) + 0.04;
    const double u = q.x / (width * taper), w = (q.z - forward * (1 - 0.6 * v)) / (depth * taper);
    return smooth_max((std::sqrt(u * u + w * w) - 1) * depth * taper * 0.85, q.y - height * top, 0.3);
  };
  for (int side = 0; side < 2; ++side) {
    const auto here = [side](const Point& p) { return side == 0 ? p : mirrored(p); };
    const Point c = here(ear.global({0, height * 0.4, 0}));
    s.unite(0.8, c, 4.2, [horn, here](const Point& p) { return horn(here(p), 2.3, 1.25, 1, 0); });
    s.carve(0.3, c, 4.2, [horn, here](const Point& p) {
      const double below = 0.9 - dot(here(p) - Point{2.75, 34.2, 2.2}, Point{0.27, 0.955, -0.12});
      return smooth_max(horn(here(p), 1.75, 1.25, 0.86, 0.95), below, 0.5);
    });
  }
}

// The direction of the fur.
Point fur_direction(const Point& p) {
  const Point head = p - nose_tip;
  const double on_head = smooth_step(24.5, 28.5, p.y);
  Point body{p.x * 0.02, -1, -0.55 * smooth_step(1, -6, p.z)};
  if (p.y < 4.5) {  // the tail, where it is nearer than the paws
    const auto& tail = tail_path();
    double best = 5;
    for (std::size_t i = 0; i + 1 < tail.size(); ++i) {
      const double d = distance2(p, tail[i]);
      if (d < best) {
        best = d;
        body = tail[i + 1] - tail[i];
      }
    }
  }
  return mix(normalized(body), normalized(head), on_head);
}

void lay_fur(LockLayer& fur, const Sculpture& skin, const Box& bounds, Context& context) {
  // The vertices of a coarse mesh are evenly spread roots.
  ImplicitShape shape;
  shape.field = [&skin](const Point& p) { return skin.at(p); };
  shape.bounds = bounds;
  const Surface roots = marching_cubes(shape, 1.15, context);
  Dice dice(3);
  std::size_t laid = 0;
  for (const Point& root : roots.points) {
    if ((laid++ & 0x3f) == 0) context.check_cancelled();
    const double size = dice.uniform(0.8, 1.2), turn = 0.35 * dice.bell(), phase = dice.uniform(0, 6.28),
                 skip = dice.uniform();
    const Point side{std::fabs(root.x), root.y, root.z};
    if (length(side - left_eye) < 2.0 || length(root - nose_tip) < 2.6 || root.y < 0.4 || root.y > 35.2 || skip < 0.15)
      continue;
    if (root.y < 2.4 && root.z > 5.8 && std::fabs(root.x) < 8 && side.x > 0.9) continue;  // toes
    const double chest = smooth_step(1, 3, root.z) * smooth_step(13, 17, root.y) * smooth_step(29, 26, root.y);
    const double cheek = smooth_step(2.6, 3.6, side.x) * smooth_step(27.5, 28.5, root.y) * smooth_step(32, 31, root.y);
    const double face = smooth_step(3, 6, root.z) * smooth_step(28, 30, root.y);
    LockStyle style;
    style.length = size * mix(mix(2.6, 3.6, std::max(chest, cheek)), 1.3, face);
    style.width = size * mix(mix(0.62, 0.85, chest), 0.35, face);
    style.height = size * mix(mix(0.17, 0.42, std::max(chest, 0.8 * cheek)), 0.07, face);
    style.root = 0.1;
    style.tip_width = 0.12;
    style.tip_height = 0.9;
    style.turn = turn;
    style.curl = 0.5 * turn;
    style.strands = 3;
    style.groove = 0.35;
    fur.lay(skin, root, fur_direction(root), style, phase);
  }
}

// ---- colour --------------------------------------------------------------------------------------

// 0 between stripes, 1 on them; `phase` counts stripes, `share` is the part that is dark.
double stripe(double phase, double share) {
  const double wave = 0.5 + 0.5 * cosine(2 * pi * phase);
  return smooth_step(1 - share - 0.12, 1 - share + 0.12, wave);
}

// The coat of a mackerel tabby; p in model units.
Point tabby(const Point& p) {
  static const Point sand = srgb(190, 150, 108), warm = srgb(206, 168, 124), dark = srgb(74, 54, 40),
                     white = srgb(243, 237, 226), pink = srgb(214, 140, 130), inner = srgb(222, 176, 160),
                     iris = srgb(150, 170, 70), gold = srgb(196, 178, 86), black = srgb(18, 16, 15);
  const double ax = std::fabs(p.x);
  const double wobble = noise(p * 0.23, 5) * 0.55 + noise(p * 0.6, 6) * 0.16;
  const double hair = noise(Point{p.x * 5, p.y * 1.7, p.z * 5}, 8);
  Point coat = mix(sand, warm, clamp(0.5 + noise(p * 0.3, 9) * 0.8, 0, 1));
  // Stripes: bands around the body, rings on legs and tail, an M on the forehead, lines on the cheeks.
  double mark = 0;
  const double on_head = smooth_step(27.5, 28.8, p.y);
  const double spine = (0.82 * p.y - 0.57 * p.z) / 2.7;
  const double back = smooth_step(3.5, 0.5, p.z) * smooth_step(2.0, 4.0, p.y);
  mark = std::max(mark, back * stripe(spine + wobble, 0.42 + 0.25 * noise(p * 0.35, 3)));
  mark = std::max(mark, smooth_step(1.3, 0.5, ax + 0.5 * wobble) * smooth_step(-1, -3, p.z) * 0.9);  // along the spine
  const double leg = smooth_step(2.0, 3.0, p.z) * smooth_step(15, 12, p.y);
  mark = std::max(mark, leg * stripe(p.y / 2.5 + 0.6 * wobble, 0.38) * 0.85);
  mark *= 1 - on_head;
  const double brow = smooth_step(32.8, 34.2, p.y);
  mark = std::max(mark, on_head * brow * stripe(ax / 1.35 + 0.04 * (p.y - 33) + 0.25 * wobble, 0.45));
  const double cheek = smooth_step(2.6, 3.4, ax) * smooth_step(32.6, 31.8, p.y) * on_head;
  mark = std::max(mark, cheek * stripe((p.y + 0.35 * p.z) / 1.55 + 0.2 * wobble, 0.35) * 0.9);
  const auto& tail = tail_path();
  if (p.y < 6.5) {
    double best = 5.2, along = -1, s = 0;
    for (std::size_t i = 0; i + 1 < tail.size(); ++i) {
      const Point ab = tail[i + 1] - tail[i];
      const double t = clamp(dot(p - tail[i], ab) / length2(ab), 0, 1), d = distance2(p, tail[i] + ab * t);
      if (d < best) {
        best = d;
        along = s + t * length(ab);
      }
      s += length(ab);
    }
    if (along >= 0) mark = std::max(stripe(along / 3.0 + 0.3 * wobble, 0.42), smooth_step(s - 3, s - 1.6, along));
  }
  coat = mix(coat, dark, clamp(mark, 0, 1) * 0.88);
  // White: muzzle and chin, bib, paws.
  const double muzzle = smooth_step(3.0, 2.2, length(Point{p.x, 1.15 * (p.y - 28.7), p.z - 7.2}));
  const double bib = smooth_step(2.8, 1.6, ax + 0.9 * wobble) * smooth_step(2.6, 4.2, p.z) * smooth_step(27, 25, p.y) *
                     smooth_step(12, 15, p.y);
  const double paws = smooth_step(3.2 + wobble, 2.4 + wobble, p.y) * smooth_step(3.2, 4.2, p.z) *
                      (p.y < 3.4 && ax < 7.4 && length(Point{p.x - 5.6, 0, p.z - 8.5}) > 2.2 ? 1 : 0);
  coat = mix(coat, white, std::max({muzzle, bib, paws}));
  coat = coat * (1 + 0.16 * hair);
  const double nose = smooth_step(0.95, 0.75, length(Point{p.x, 1.5 * (p.y - 30.15), 0.8 * (p.z - 9.2)}));
  coat = mix(coat, pink, nose);
  // Eyes: by the ball they lie on.
  const Point eye = Point{ax, p.y, p.z} - left_eye;
  const double depth = length(eye);
  if (depth < 1.56 && eye.z > 0.3) {
    const double r = std::sqrt(eye.x * eye.x + eye.y * eye.y);
    const double slit = std::sqrt((eye.x - 0.05) * (eye.x - 0.05) / 0.045 + (eye.y - 0.08) * (eye.y - 0.08) / 0.42);
    const Point ball = mix(mix(mix(gold, iris, smooth_step(0.2, 0.7, r)), black, smooth_step(0.85, 1.05, r)), black,
                           smooth_step(1.05, 0.9, slit));
    coat = mix(ball, coat, smooth_step(1.51, 1.55, depth));
  }
  // Inside the ears.
  const Point q = Point{ax, p.y, p.z} - Point{2.75, 34.2, 2.2};
  const double in_ear = smooth_step(0.2, 0.5, dot(q, Point{0.42, 0.05, 0.9}) + 0.08 * q.y) * smooth_step(1.0, 1.8, q.y);
  coat = mix(coat, inner, 0.8 * in_ear * smooth_step(5.2, 3.6, q.y));
  return coat;
}

}  // namespace

Model make_cat(int vertices, Context& context) {
  const double edge = edge_length_of(area_mm2, vertices) / unit_mm;
  const double strands = 1 - smooth_step(0.12, 0.3, edge), tufts = 1 - smooth_step(0.3, 0.7, edge);
  const Box bounds{{-12, -3, -16}, {13, 42, 13}};
  Sculpture s(unit_mm, bounds);
  model_body(s);
  model_tail(s);
  model_head(s);
  model_ears(s);
  LockLayer fur(bounds, 0.6);
  if (tufts > 0) {
    Sculpture skin = s;
    skin.finish();
    lay_fur(fur, skin, bounds, context);
    context.check_cancelled();
    fur.finish(0.05, strands);
    context.check_cancelled();
    s.raise(
        {0, 20, -1}, 30, [&fur, tufts](const Point& p) { return tufts * fur(p); }, fur.greatest_height());
  }
  model_eyes(s);
  s.carve(0.3, {0, -10, 0}, 60, [](const Point& p) { return p.y; });  // flat on the ground
  s.finish();
  ImplicitShape shape;
  shape.field = [&s](const Point& p) { return s(p); };
  shape.bounds = {bounds.low * unit_mm, bounds.high * unit_mm};
  const Surface surface = mesh_implicit(shape, area_mm2, vertices, context);
  const auto colour = [](const Point& p, const Point&) { return tabby(p / unit_mm); };
  Point shift;
  Model model = finished(surface, colour, &shift);
  const auto broad = [&](const Point& p) {
    constexpr double step = 3.5;
    const Point q = p + shift;
    const double a = s({q.x + step, q.y - step, q.z - step}), b = s({q.x - step, q.y - step, q.z + step}),
                 c = s({q.x - step, q.y + step, q.z - step}), d = s({q.x + step, q.y + step, q.z + step});
    return Point{a - b - c + d, c + d - a - b, b + d - a - c};
  };
  paint_texture(
      model, broad, [&](const Point& p, const Point& n) { return colour(p + shift, n); }, vertices < 20000 ? 512 : 1024,
      "tabby", context);
  return model;
}

}  // namespace formwright::samples
