// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/forest/plan/pillar.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "formats/shared/polygon_triangulation.h"
#include "geometry/planar/plane.h"

namespace formwright {
namespace {

constexpr double radians_a_degree = std::numbers::pi / 180;
constexpr int round_corners = 48;
constexpr std::pair<PillarForm::Shape, std::string_view> shape_names[] = {{PillarForm::Shape::round, "round"},
                                                                          {PillarForm::Shape::square, "square"},
                                                                          {PillarForm::Shape::hexagon, "hexagon"}};

/// Rounded, so that the last digit of a machine's sine does not decide what a ray meets.
Vec2 rounded_place(const Vec2& p) {
  constexpr double steps_a_mm = 1 << 20;
  return (p * steps_a_mm).array().round().matrix() / steps_a_mm;
}

Outline regular_outline(const Vec2& centre, double radius_mm, int corners, double first_deg) {
  Outline outline;
  for (int k = 0; k < corners; ++k) {
    const double angle = radians_a_degree * first_deg + 2 * std::numbers::pi * k / corners;
    outline.push_back(rounded_place(centre + radius_mm * Vec2(std::cos(angle), std::sin(angle))));
  }
  return outline;
}

bool segments_meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const double c_side = cross(b - a, c - a), d_side = cross(b - a, d - a), a_side = cross(d - c, a - c),
               b_side = cross(d - c, b - c);
  if (((c_side > 0) != (d_side > 0)) && ((a_side > 0) != (b_side > 0)) && c_side != 0 && d_side != 0 && a_side != 0 &&
      b_side != 0)
    return true;
  const auto lies_on = [](const Vec2& p, const Vec2& from, const Vec2& to, double side) {
    return side == 0 && (p - from).dot(p - to) <= 0;
  };
  return lies_on(c, a, b, c_side) || lies_on(d, a, b, d_side) || lies_on(a, c, d, a_side) || lies_on(b, c, d, b_side);
}

}  // namespace

Outline round_outline(const Vec2& centre, double diameter_mm, int corners, double turn_deg) {
  return regular_outline(centre, 0.5 * diameter_mm, corners, turn_deg);
}

Outline square_outline(const Vec2& centre, double side_mm, double turn_deg) {
  return regular_outline(centre, side_mm * std::numbers::sqrt2 / 2, 4, turn_deg - 135);
}

std::string_view name_of(PillarForm::Shape shape) {
  for (const auto& [known, name] : shape_names)
    if (known == shape) return name;
  return {};
}

std::optional<PillarForm::Shape> shape_called(std::string_view name) {
  for (const auto& [shape, known] : shape_names)
    if (known == name) return shape;
  return std::nullopt;
}

Outline outline_of(const PillarForm& form) {
  switch (form.shape) {
    case PillarForm::Shape::square: return square_outline(form.centre, form.width_mm, form.turn_deg);
    case PillarForm::Shape::hexagon: return round_outline(form.centre, form.width_mm, 6, form.turn_deg);
    default: return round_outline(form.centre, form.width_mm, round_corners);
  }
}

Pillar pillar_of(const PillarForm& form, double height_mm) { return {outline_of(form), height_mm, form}; }

const Vec2& corner(const Outline& outline, int k) {
  const auto at = static_cast<std::size_t>(k);
  return outline[at < outline.size() ? at : at - outline.size()];
}

double outline_area_mm2(const Outline& outline) {
  double doubled = 0;
  for (std::size_t k = 0; k < outline.size(); ++k)
    doubled += cross(outline[k] - outline[0], corner(outline, static_cast<int>(k) + 1) - outline[0]);
  return 0.5 * doubled;
}

Vec2 outline_centroid(const Outline& outline) {
  Vec2 sum(0, 0);
  double doubled = 0;
  for (std::size_t k = 1; k + 1 < outline.size(); ++k) {
    const double area = cross(outline[k] - outline[0], outline[k + 1] - outline[0]);
    sum += area * (outline[0] + outline[k] + outline[k + 1]) / 3;
    doubled += area;
  }
  return sum / doubled;
}

bool is_inside(const Outline& outline, const Vec2& p) {
  bool inside = false;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Vec2 &a = outline[k], &b = corner(outline, static_cast<int>(k) + 1);
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    if ((cross(b - a, p - a) > 0) == (b.y() > a.y())) inside = !inside;
  }
  return inside;
}

double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 along = b - a;
  const double length2 = along.squaredNorm();
  const double share = length2 > 0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (p - a - share * along).norm();
}

double distance_to_outline(const Outline& outline, const Vec2& p) {
  double nearest = INFINITY;
  for (std::size_t k = 0; k < outline.size(); ++k)
    nearest = std::min(nearest, distance_to_segment(p, outline[k], corner(outline, static_cast<int>(k) + 1)));
  return nearest;
}

double distance_between(const Outline& a, const Outline& b, double enough) {
  Vec2 low_a = a[0], high_a = a[0], low_b = b[0], high_b = b[0];
  for (const Vec2& p : a) {
    low_a = low_a.cwiseMin(p);
    high_a = high_a.cwiseMax(p);
  }
  for (const Vec2& p : b) {
    low_b = low_b.cwiseMin(p);
    high_b = high_b.cwiseMax(p);
  }
  const double between_boxes = (low_b - high_a).cwiseMax(low_a - high_b).cwiseMax(Vec2(0, 0)).norm();
  if (between_boxes >= enough) return between_boxes;
  if (is_inside(a, b.front()) || is_inside(b, a.front())) return 0;
  double nearest = INFINITY;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) {
      const Vec2 &p = a[i], &q = corner(a, static_cast<int>(i) + 1), &r = b[j], &s = corner(b, static_cast<int>(j) + 1);
      if (segments_meet(p, q, r, s)) return 0;
      nearest = std::min({nearest, distance_to_segment(p, r, s), distance_to_segment(r, p, q)});
    }
  return nearest;
}

bool crosses_itself(const Outline& outline) {
  const std::size_t n = outline.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j + 1 == n) continue;
      if (segments_meet(outline[i], corner(outline, static_cast<int>(i) + 1), outline[j],
                        corner(outline, static_cast<int>(j) + 1)))
        return true;
    }
  return false;
}

Vec2 place_of_pin(const Outline& outline) {
  constexpr int steps = 24;
  constexpr double much_better = 1.2;
  Vec2 best = outline_centroid(outline), low = outline[0], high = outline[0];
  double room = is_inside(outline, best) ? distance_to_outline(outline, best) : 0;
  for (const Vec2& p : outline) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double from_centroid = room;
  for (int i = 0; i <= steps; ++i)
    for (int j = 0; j <= steps; ++j) {
      const Vec2 p = low + (high - low).cwiseProduct(Vec2(i, j)) / steps;
      const double here = is_inside(outline, p) ? distance_to_outline(outline, p) : 0;
      if (here > room && here > much_better * from_centroid) {
        room = here;
        best = p;
      }
    }
  return best;
}

TriangleMesh prism(const Outline& outline, double bottom_mm, double top_mm) {
  const int n = static_cast<int>(outline.size());
  std::vector<Vec3> corners;
  for (const Vec2& p : outline) corners.emplace_back(p.x(), p.y(), bottom_mm);
  PolygonTriangulator triangulator;
  const auto caps = triangulator.triangulate(corners);
  TriangleMesh mesh;
  mesh.V.resize(2 * n, 3);
  for (int k = 0; k < n; ++k) {
    const Vec2& p = outline[static_cast<std::size_t>(k)];
    mesh.V.row(k) << p.x(), p.y(), bottom_mm;
    mesh.V.row(n + k) << p.x(), p.y(), top_mm;
  }
  mesh.F.resize(2 * static_cast<Eigen::Index>(caps.size()) + 2 * n, 3);
  Eigen::Index f = 0;
  for (const auto& [a, b, c] : caps) {
    mesh.F.row(f++) << a, c, b;
    mesh.F.row(f++) << n + a, n + b, n + c;
  }
  for (int k = 0; k < n; ++k) {
    const int next = (k + 1) % n;
    mesh.F.row(f++) << k, next, n + next;
    mesh.F.row(f++) << k, n + next, n + k;
  }
  return mesh;
}

}  // namespace formwright
