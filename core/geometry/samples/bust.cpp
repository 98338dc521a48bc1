// SPDX-License-Identifier: GPL-3.0-or-later
// A bearded head in the antique manner. Modelled at life size in centimetres: x to the sitter's left,
// y up from the chin, z forward from the ears; proportions after the usual anthropometric means.
#include <algorithm>

#include "geometry/samples/remeshing/mesh_implicit.h"
#include "geometry/samples/sculpting/locks.h"
#include "geometry/samples/sculpting/noise.h"
#include "geometry/samples/shapes.h"

namespace formwright::samples {
namespace {

constexpr double unit_mm = 1.95, area_mm2 = 21000;

void model_skull(Sculpture& s) {
  s.add_ellipsoid(0, posed({0, 14.2, -0.7}, 0), {7.4, 8.8, 9.3});
  s.add_ellipsoid(2.5, posed({0, 15.4, 3.4}, 0), {6.1, 5.4, 5.7});
  s.add_ellipsoid(2.5, posed({0, 8.4, 3.2}, 0), {5.3, 7.2, 5.4});
  // Jaw: ramus, body, chin.
  s.add_cone(1.6, {5.4, 9.5, 0.4}, {4.8, 4.8, 0.9}, 1.2, 1.2, true);
  s.add_cone(1.6, {4.8, 4.8, 0.9}, {1.5, 1.4, 6.9}, 1.2, 1.4, true);
  s.add_ellipsoid(1.2, posed({0, 1.6, 7.7}, 0), {1.8, 1.5, 1.3});
  // Cheek bones and arches.
  s.add_ellipsoid(1.8, posed({4.7, 9.6, 5.5}, 35), {1.9, 1.2, 1.6}, true);
  s.add_cone(1.8, {5.5, 9.8, 4.4}, {6.3, 10.4, 0.8}, 0.8, 0.6, true);
  // Flesh of the cheeks, the chewing muscles, below the eyes.
  s.add_ellipsoid(2.0, posed({3.4, 6.9, 5.0}, 30), {2.4, 3.6, 2.9}, true);
  s.add_ellipsoid(1.5, posed({4.9, 6.6, 2.2}, 0), {1.3, 3.4, 2.6}, true);
  s.add_ellipsoid(1.2, posed({3.2, 9.5, 7.0}, 20), {2.2, 1.4, 1.5}, true);
  // Muzzle.
  s.add_ellipsoid(1.6, posed({0, 4.9, 7.3}, 0), {2.9, 2.5, 2.2});
  s.swell(-0.3, posed({7.1, 13.6, 5.2}, 0), {3, 3, 3}, true);
}

void model_brow_and_nose(Sculpture& s) {
  const std::vector<Point> brow = curve({{0.7, 12.9, 9.0}, {2.4, 13.35, 9.1}, {4.3, 13.3, 8.1}, {5.7, 12.2, 6.2}}, 3);
  Tube ridge{brow, {}, {}, 1, 0, 0, 0};
  for (std::size_t i = 0; i < brow.size(); ++i)
    ridge.radius.push_back(0.75 - 0.35 * static_cast<double>(i) / static_cast<double>(brow.size()));
  Point c;
  double r;
  ridge.enclose(c, r);
  s.unite(1.3, c, r, ridge);
  s.unite(1.3, mirrored(c), r, [ridge](const Point& p) { return ridge(mirrored(p)); });
  s.carve_ellipsoid(1.0, posed({3.1, 11.6, 10.2}, 8), {2.0, 1.25, 1.9}, true);
  s.add_cone(0.9, {0, 12.4, 8.9}, {0, 8.3, 11.0}, 0.75, 0.75);
  s.add_cone(0.8, {0, 11.0, 8.2}, {0, 7.8, 9.4}, 1.0, 1.5);
  s.add_ellipsoid(0.6, posed({0, 7.75, 11.3}, 0), {0.85, 0.72, 0.8});
  s.add_ellipsoid(0.5, posed({1.1, 7.45, 10.0}, 20), {0.68, 0.72, 1.05}, true);
  s.add_cone(0.3, {0, 7.15, 11.1}, {0, 6.8, 9.9}, 0.36, 0.4);
  s.carve_ellipsoid(0.2, posed({0.66, 6.9, 10.4}, 15, 20), {0.33, 0.45, 0.62}, true);
  s.line(-0.16, 0.5, curve({{0.9, 8.4, 10.6}, {1.65, 8.2, 10.0}, {1.95, 7.5, 9.4}, {1.75, 6.8, 9.2}}, 3), 0.3, true);
}

void model_eyes(Sculpture& s) {
  const Point eye{3.1, 11.4, 7.3};
  constexpr double ball = 1.6, lid = 0.24;
  // Almond between two arcs through the corners of the eye, pushed through along z.
  const auto opening = [eye](const Point& p) {
    const double half = 1.5, x = p.x - eye.x - 0.05, y = p.y - eye.y - 0.06 * (p.x - eye.x);
    const auto arc = [&](double sag, double sign) {
      const double radius = (half * half + sag * sag) / (2 * sag), h = sign * y + radius - sag;
      return std::sqrt(x * x + h * h) - radius;
    };
    return smooth_max(smooth_max(arc(0.62, 1), arc(0.5, -1), 0.12), 0.3 - (p.z - eye.z), 0.2);
  };
  s.add_ellipsoid(0.8, posed(eye, 0), {ball + lid, ball + lid, ball + lid}, true);
  s.line(0.07, 0.28,
         curve({{1.55, 11.35, 8.5}, {2.3, 11.95, 9.0}, {3.15, 12.1, 9.1}, {4.0, 11.95, 8.8}, {4.8, 11.45, 8.1}}, 4),
         0.1, true);
  s.line(-0.2, 0.34,
         curve({{1.6, 12.0, 8.5}, {2.4, 12.5, 8.9}, {3.2, 12.65, 8.9}, {4.2, 12.45, 8.5}, {5.0, 11.8, 7.6}}, 4), 0.2,
         true);
  for (int side = 0; side < 2; ++side) {
    const Point c = side == 0 ? eye : mirrored(eye);
    s.carve(0.08, c + Point{0, 0, 1.5}, 1.9,
            [opening, side](const Point& p) { return opening(side == 0 ? p : mirrored(p)); });
    // The iris is engraved and the pupil drilled, as in imperial Rome: it gives the gaze.
    s.unite(0.03, c, ball, [c](const Point& p) {
      const Point q = p - c - Point{0, 0.05, 0};
      const double r = std::sqrt(q.x * q.x + q.y * q.y);
      const double rim = q.z > 0 ? 0.07 * bell((r - 0.56) / 0.14) : 0;
      const double lit = std::sqrt((q.x) * (q.x) + (q.y - 0.12) * (q.y - 0.12));
      const double pupil = q.z > 0 ? 0.16 * bell(lit / 0.34) : 0;
      return length(p - c) - ball + rim + pupil;
    });
  }
}

void model_mouth(Sculpture& s) {
  const std::vector<Point> upper = curve({{2.5, 4.55, 8.2}, {1.5, 4.75, 9.15}, {0.55, 5.02, 9.62}, {0, 4.9, 9.62}}, 3);
  const std::vector<Point> lower = curve({{2.3, 4.4, 8.3}, {1.3, 3.95, 9.15}, {0, 3.85, 9.5}}, 3);
  const auto lip = [&](const std::vector<Point>& half, double thick) {
    Tube t;
    t.path = half;
    for (std::size_t i = half.size() - 1; i-- > 0;) t.path.push_back(mirrored(half[i]));
    const double n = static_cast<double>(t.path.size() - 1);
    for (std::size_t i = 0; i < t.path.size(); ++i) {
      const double u = 2 * static_cast<double>(i) / n - 1;
      t.radius.push_back(thick * (0.35 + 0.65 * (1 - u * u)));
    }
    Point c;
    double r;
    t.enclose(c, r);
    s.unite(0.35, c, r, t);
  };
  lip(upper, 0.42);
  lip(lower, 0.5);
  const std::vector<Point> slit = curve({{2.7, 4.6, 8.3},
                                         {1.5, 4.4, 9.4},
                                         {0.5, 4.5, 9.95},
                                         {0, 4.42, 10.0},
                                         {-0.5, 4.5, 9.95},
                                         {-1.5, 4.4, 9.4},
                                         {-2.7, 4.6, 8.3}},
                                        4);
  s.line(-0.35, 0.32, slit, 0.1);
}

void model_neck(Sculpture& s) {
  s.add_cone(2.0, {0, 6, -2.6}, {0, -8, -4.2}, 5.0, 5.9);
  s.add_ellipsoid(2.0, posed({0, 8, -5.6}, 0), {5.3, 5.0, 3.4});
  s.add_cone(1.0, {5.4, 7.4, -1.6}, {1.4, -7.6, 1.6}, 1.2, 0.9, true);
}

void model_ears(Sculpture& s) {
  // In the plane of the ear: u forward, v up, w outward.
  Frame ear = posed({6.75, 10.4, -0.6}, 90 - 22, 0, 0);  // w points sideways and a little forward
  const Point forward = -ear.u;
  ear = {ear.o, normalized(forward * 0.97 + ear.v * 0.22), normalized(ear.v * 0.97 - forward * 0.22), ear.w};
  const auto tube = [&](const std::vector<Point>& knots, double r0, double r1, double softness) {
    std::vector<Point> global;
    for (const Point& q : knots) global.push_back(ear.global(q));
    Tube t;
    t.path = curve(global, 3);
    for (std::size_t i = 0; i < t.path.size(); ++i)
      t.radius.push_back(mix(r0, r1, static_cast<double>(i) / static_cast<double>(t.path.size() - 1)));
    Point c;
    double r;
    t.enclose(c, r);
    s.unite(softness, c, r, t);
    s.unite(softness, mirrored(c), r, [t](const Point& p) { return t(mirrored(p)); });
  };
  Frame shell = ear;
  shell.o = ear.global({-0.5, 0.2, 0.15});
  s.add_ellipsoid(0.6, shell, {1.7, 2.8, 0.6}, true);
  tube({{0.2, 0.0, 0.3},
        {0.85, 0.9, 0.3},
        {0.7, 2.2, 0.35},
        {-0.35, 2.75, 0.45},
        {-1.5, 2.2, 0.5},
        {-1.8, 0.8, 0.5},
        {-1.4, -0.9, 0.45},
        {-0.7, -2.1, 0.4}},
       0.32, 0.36, 0.25);
  tube({{0.0, 1.9, 0.35}, {-0.75, 1.3, 0.45}, {-0.95, 0.1, 0.5}, {-0.6, -1.1, 0.45}, {0.1, -1.4, 0.4}}, 0.22, 0.3,
       0.25);
  tube({{-0.4, -2.2, 0.4}, {0.15, -2.6, 0.4}, {0.5, -2.1, 0.3}}, 0.5, 0.4, 0.3);
  Frame concha = ear;
  concha.o = ear.global({0.05, -0.25, 0.75});
  s.carve_ellipsoid(0.3, concha, {0.6, 0.9, 0.6}, true);
  tube({{0.75, 0.1, 0.25}, {0.6, -0.5, 0.5}, {0.7, -1.0, 0.3}}, 0.3, 0.3, 0.25);
}

// ---- hair ----------------------------------------------------------------------------------------

// How far inside the hair a point of the head is, in units; negative on the bare skin.
double hair_depth(const Point& p) {
  const double azimuth = std::fabs(arc_tangent(p.x, p.z + 0.8)) * 180 / pi;
  const double line = azimuth < 38    ? mix(18.4, 17.6, azimuth / 38)
                      : azimuth < 62  ? mix(17.6, 14.0, (azimuth - 38) / 24)
                      : azimuth < 78  ? mix(14.0, 9.8, (azimuth - 62) / 16)
                      : azimuth < 88  ? mix(9.8, 13.2, (azimuth - 78) / 10)
                      : azimuth < 104 ? 13.4
                      : azimuth < 122 ? mix(13.4, 6.0, (azimuth - 104) / 18)
                                      : mix(6.0, 4.0, (azimuth - 122) / 58);
  return p.y - line;
}

void lay_hair(LockLayer& layer, const Sculpture& skin) {
  const Point heart{0, 14, -0.8}, crown{0.6, 22, -5};
  Dice dice(7);
  constexpr int seeds = 440;
  for (int i = 0; i < seeds; ++i) {
    // Fibonacci spiral from the top of the head down.
    const double up = 1 - 1.93 * (i + 0.5) / seeds, around = i * 2.39996322972865332;
    const double flat = std::sqrt(1 - up * up);
    const Point out{flat * sine(around), up, flat * cosine(around)};
    Point p = heart + Point{out.x * 7.6, out.y * 9.4, out.z * 9.4};
    for (int k = 0; k < 3; ++k) p -= skin.normal_at(p, 0.3) * skin.at(p);
    const double depth = hair_depth(p);
    const double jitter = dice.uniform(), side = dice.uniform() < 0.5 ? -1 : 1, phase = dice.uniform(0, 6.28);
    const double size = dice.uniform(0.85, 1.15);
    if (depth < 0.1) continue;
    Point direction = p - crown;
    if (length(direction) < 1.5) direction = Point{dice.bell(), 0, dice.bell()};
    direction = normalized(direction);
    LockStyle style;
    style.length = 4.2 * size;
    style.width = 1.0 * size;
    style.height = 0.75 + 0.5 * jitter;
    style.turn = -0.25 * side;
    style.curl = 1.15 * side;
    layer.lay(skin, p, direction, style, phase);
  }
}

// ---- beard ---------------------------------------------------------------------------------------

void model_beard(Sculpture& s) {
  const auto mass = [&](const std::vector<Point>& knots, const std::vector<double>& radii, double softness) {
    for (std::size_t i = 0; i + 1 < knots.size(); ++i)
      s.add_cone(softness, knots[i], knots[i + 1], radii[i], radii[i + 1], true);
  };
  mass({{5.9, 8.6, 2.2}, {5.2, 5.0, 2.8}, {3.4, 1.3, 6.2}, {0.8, 0.0, 8.0}}, {0.9, 1.5, 2.0, 2.1}, 1.4);
  s.add_ellipsoid(1.2, posed({0, -0.5, 7.2}, 0, 15), {2.9, 2.6, 1.9});
}

void lay_beard(LockLayer& layer, const Sculpture& skin) {
  Dice dice(21);
  // Rows from the throat up, each a little nearer to the cheek line; upper locks fall over the lower ones.
  const Point heart{0, 2.2, 3.0};
  for (int row = 0; row < 8; ++row)
    for (int column = -9; column <= 9; ++column) {
      const double azimuth = (column + (row % 2) * 0.5 + 0.25 * dice.bell()) * 10.5;
      const double side = dice.uniform() < 0.5 ? -1 : 1, phase = dice.uniform(0, 6.28), size = dice.uniform(0.85, 1.15);
      const double a = std::fabs(azimuth) / 97;
      if (a > 1) continue;
      const double elevation = mix(mix(-66, -20, a), mix(7, 50, a * std::sqrt(a)), row / 7.0) + 3 * dice.bell();
      const double ce = cosine(elevation * pi / 180);
      const Point out{sine(azimuth * pi / 180) * ce, sine(elevation * pi / 180), cosine(azimuth * pi / 180) * ce};
      Point p = heart + out * 11;
      for (int k = 0; k < 40 && skin.at(p) > 0.05; ++k) p -= out * (0.7 * skin.at(p));
      LockStyle style;
      style.length = 2.9 * size;
      style.width = 0.8 * size;
      style.height = 0.6 + 0.4 * dice.uniform();
      style.turn = -0.5 * side;
      style.curl = 2.3 * side;
      style.tip_width = 0.35;
      layer.lay(skin, p, Point{0.25 * (azimuth > 0 ? 1.0 : -1.0), -1, -0.4}, style, phase);
    }
  // Moustache: from under the nose outwards and down.
  for (double side : {-1.0, 1.0})
    for (int k = 0; k < 4; ++k) {
      LockStyle style;
      style.width = 0.55;
      style.height = 0.55;
      style.root = 0.25;
      style.tip_width = 0.4;
      const double low = k * 0.22, out = (k % 2) * 0.45;
      layer.lay(skin,
                curve({{side * (0.18 + out), 6.25 - low, 10.1 - 0.3 * out},
                       {side * (1.25 + out), 5.85 - low, 9.7 - 0.3 * out},
                       {side * (2.75 + 0.6 * out), 5.0 - low, 8.6},
                       {side * (3.3 + 0.8 * out), 3.5 - 0.6 * low, 8.0}},
                      4),
                style, 1.3 * k + side);
    }
  for (int side = -1; side <= 1; side += 2)
    for (int k = 0; k < 2; ++k) {  // under the lower lip
      LockStyle style;
      style.length = 1.6;
      style.width = 0.45;
      style.height = 0.4;
      style.curl = 0.8 * side;
      layer.lay(skin, Point{side * (0.3 + 0.6 * k), 3.1, 9.4}, Point{side * 0.2, -1, 0}, style, k);
    }
  // Eyebrows.
  for (int side = -1; side <= 1; side += 2)
    for (int k = 0; k < 9; ++k) {
      const double t = k / 8.0;
      LockStyle style;
      style.length = 1.25;
      style.width = 0.3;
      style.height = 0.2 * (1 - 0.5 * t);
      style.strands = 2;
      layer.lay(skin, Point{side * mix(0.9, 4.6, t), 13.0 + 0.75 * t - 0.7 * t * t * t, 10.0 - 1.9 * t * t},
                Point{side * 1.0, 0.7 - 1.0 * t, -0.4}, style, k);
    }
}

// ---- shoulders, cloak and socle ------------------------------------------------------------------

void model_torso(Sculpture& s) {
  s.add_ellipsoid(0, posed({0, -15.5, -3.5}, 0), {16, 9.5, 8.6});
  s.add_cone(2.5, {2.5, 0.2, -5.2}, {12.5, -9.2, -4.2}, 3.0, 3.2, true);
  s.add_ellipsoid(2.5, posed({15.0, -13.5, -3.5}, 0), {4.6, 6.5, 5.2}, true);
  s.add_ellipsoid(2.0, posed({5.5, -13, 2.2}, 15), {5.2, 4.2, 2.9}, true);
}

// Rounded off below and at the arms.
void crop_torso(Sculpture& s) {
  s.carve(1.2, {0, -7, -3}, 60, [](const Point& p) { return -ellipsoid(p - Point{0, -6, -3}, {17.3, 14.8, 12.5}); });
}

void model_socle(Sculpture& s) {
  const auto turned = [](const Point& p) {
    const double r = std::sqrt(p.x * p.x + (p.z + 2.5) * (p.z + 2.5));
    const auto disc = [&](double y, double radius, double half, double round) {
      const double a = r - radius + round, b = std::fabs(p.y - y) - half + round;
      const double oa = a > 0 ? a : 0, ob = b > 0 ? b : 0, inside = a > b ? a : b;
      return std::sqrt(oa * oa + ob * ob) + (inside < 0 ? inside : 0) - round;
    };
    const double u = clamp((p.y + 22.9) / 1.9, -1, 1);
    const double waist = smooth_max((r - 3.1 - 1.4 * u * u) * 0.75, std::fabs(p.y + 22.5) - 2.4, 0.1);
    return smooth_min(smooth_min(disc(-25.4, 6.2, 0.8, 0.25), waist, 0.25), disc(-21.3, 4.6, 0.5, 0.45), 0.25);
  };
  s.unite(0.3, {0, -23.2, -2.5}, 7.0, turned);
}

void lay_cloak(LockLayer& layer, const Sculpture& skin) {
  const Point brooch{-9.2, -8.1, 1.6};
  const auto fold = [&](const std::vector<Point>& knots, double width, double height, double phase,
                        double tip_height = 0.9) {
    LockStyle style;
    style.width = width;
    style.height = height;
    style.strands = 2;
    style.groove = 0.12;
    style.tip_width = 1.2;
    style.tip_height = tip_height;
    style.root = 0.6;
    layer.lay(skin, curve(knots, 5), style, phase);
  };
  // The rolled edge: from the brooch below the throat to the left shoulder.
  fold({brooch, {-4.5, -9.4, 5}, {1.5, -9.0, 6}, {6.5, -5.0, 2.5}, {7.2, -2.6, -4}, {6, -4.5, -9}}, 0.75, 1.25, 0.4);
  // Folds that fan out from the brooch over the chest and under.
  for (int k = 0; k < 10; ++k) {
    const double t = k / 9.0;
    const Point end{mix(13.5, -5, t), mix(-7.0, -20, std::sqrt(t)), mix(-1.5, 1, t)};
    const Point middle = mix(brooch, end, 0.5) + Point{-1.5 * t, -2.9 + 1.0 * t, 7};
    fold({brooch, middle, end, Point{end.x * 0.6 + 2, -20.2, -3}}, 0.85 + 0.25 * (k % 2), 0.8 + 0.35 * ((k + 1) % 2),
         k);
  }
  // Over the left shoulder: a few come to the front and die out, the rest fall along the arm.
  for (int k = 0; k < 3; ++k) {
    const double x = 8.6 + 1.7 * k;
    fold({{x * 0.85, -4.2 - 0.3 * k, -7.5},
          {x * 0.9, -3.7 - 0.5 * k, -3.5},
          {x, -7 - 0.4 * k, 2.5},
          {x * 0.95, -10.5, 4.5}},
         0.75, 0.75, k, 0.05);
  }
  for (int side = -1; side <= 1; side += 2)
    for (int k = 0; k < 9; ++k) {
      const double azimuth = side * (42 + 11.0 * k) * pi / 180;
      const Point out{sine(azimuth), 0, cosine(azimuth)};
      const Point top = side > 0 ? Point{9.5 + 0.35 * k, -4.2 - 0.2 * k, -2.5 - 0.35 * k}
                                 : mix(brooch, Point{-11, -6.5, -5}, k / 8.0);
      fold({top, Point{out.x * 15.5, -8.5, -3 + 9 * out.z}, Point{out.x * 16.5, -13, -3 + 9 * out.z},
            Point{out.x * 8, -20.2, -3 + 5 * out.z}},
           0.85, 0.65 + 0.35 * (k % 2), k);
    }
  // The back hangs in shallow bows.
  for (int k = 0; k < 9; ++k) {
    const double y = -5.0 - 1.9 * k;
    fold({{-17.5, y + 1, -4},
          {-12.5, y + 0.6, -9},
          {-5, y - 1.3, -13},
          {4, y - 1.2, -13},
          {12, y + 1.5, -9},
          {16.5, y + 3, -4}},
         0.8, 0.55 + 0.2 * (k % 2), k);
  }
}

void add_brooch(Sculpture& s) {
  Point centre{-9.2, -8.1, 3.0};
  for (int k = 0; k < 12; ++k) centre -= s.normal_at(centre, 0.3) * s.at(centre);
  const Point w = s.normal_at(centre, 1.0);
  centre -= w * 0.25;
  const Point u = normalized(cross(Point{0, 1, 0}, w));
  const Frame frame{centre, u, cross(w, u), w};
  const auto disc = [frame](const Point& p) {
    const Point q = frame.local(p);
    const double r = std::sqrt(q.x * q.x + q.y * q.y);
    const double ring = std::sqrt((r - 1.45) * (r - 1.45) + (q.z - 0.4) * (q.z - 0.4)) - 0.3;
    const double boss = ellipsoid(q - Point{0, 0, 0.3}, {0.7, 0.7, 0.5});
    const double plate = ellipsoid(q, {1.6, 1.6, 0.6});
    return smooth_min(smooth_min(plate, ring, 0.1), boss, 0.1);
  };
  s.unite(0.15, centre, 2.2, disc);
}

}  // namespace

Model make_bust(int vertices, Context& context) {
  // Detail finer than the triangles would only be noise: strands, then locks, then folds fade away.
  const double edge = edge_length_of(area_mm2, vertices) / unit_mm;
  const double strands = 1 - smooth_step(0.15, 0.45, edge), locks = 1 - smooth_step(0.5, 1.6, edge),
               folds = 1 - smooth_step(1.0, 3.0, edge);
  const Box bounds{{-21, -27.5, -17}, {21, 26, 15}};
  Sculpture s(unit_mm, bounds);
  model_torso(s);
  crop_torso(s);
  model_neck(s);
  LockLayer cloak({{-21, -22, -17}, {21, 2, 12}}, 0.8), hair(bounds, 0.7);
  {
    Sculpture skin = s;
    skin.finish();
    lay_cloak(cloak, skin);
  }
  context.check_cancelled();
  cloak.finish(std::max(0.5, 0.4 * edge), folds);
  s.raise(
      {0, -14, -3}, 24, [&cloak, folds](const Point& p) { return folds * cloak(p); }, cloak.greatest_height());
  add_brooch(s);
  model_skull(s);
  model_brow_and_nose(s);
  model_eyes(s);
  model_mouth(s);
  model_beard(s);
  {
    Sculpture skin = s;
    skin.finish();
    context.check_cancelled();
    lay_hair(hair, skin);
    context.check_cancelled();
    lay_beard(hair, skin);
  }
  context.check_cancelled();
  hair.finish(std::max(0.08, 0.3 * edge), strands);
  s.raise(
      {0, 11, 0}, 20,
      [&hair, locks](const Point& p) {
        const double cap = locks < 1 ? (1 - locks) * 0.6 * smooth_step(-0.2, 1.2, hair_depth(p)) : 0;
        return locks * hair(p) + cap;
      },
      hair.greatest_height());
  model_ears(s);
  model_socle(s);
  s.finish();
  ImplicitShape shape;
  shape.field = [&s](const Point& p) { return s(p); };
  shape.bounds = {bounds.low * unit_mm, bounds.high * unit_mm};
  const Point plaster = srgb(232, 226, 214);
  return finished(mesh_implicit(shape, area_mm2, vertices, context),
                  [&](const Point&, const Point&) { return plaster; });
}

}  // namespace formwright::samples
