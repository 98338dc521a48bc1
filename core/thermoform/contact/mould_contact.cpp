// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/contact/mould_contact.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"

namespace formwright {
namespace {

constexpr double farthest_mm =
    25;  // distances beyond this are not looked for: what moves 1 mm a step asks again in time

/// Keeps points at least `spacing` apart, first come, first kept.
class SparsePoints {
 public:
  explicit SparsePoints(double spacing) : spacing_(spacing) {}
  void add(const Vec3& p) {
    const Eigen::Array3i cell = (p.array() / spacing_).floor().cast<int>();
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dz = -1; dz <= 1; ++dz) {
          const auto found = cells_.find(key(cell + Eigen::Array3i(dx, dy, dz)));
          if (found == cells_.end()) continue;
          for (const int i : found->second)
            if ((points[static_cast<std::size_t>(i)] - p).squaredNorm() < spacing_ * spacing_) return;
        }
    cells_[key(cell)].push_back(static_cast<int>(points.size()));
    points.push_back(p);
  }
  std::vector<Vec3> points;

 private:
  static std::uint64_t key(const Eigen::Array3i& c) {
    const auto part = [](int value) { return static_cast<std::uint64_t>(value + (1 << 20)) & 0x1fffffu; };
    return part(c[0]) | part(c[1]) << 21 | part(c[2]) << 42;
  }
  double spacing_;
  std::unordered_map<std::uint64_t, std::vector<int>> cells_;
};

}  // namespace

MouldContact::MouldContact(std::shared_ptr<const MouldShape> shape, const Placement& placement, const Vec2& opening_mm,
                           double tolerance_mm)
    : shape_(std::move(shape)),
      placement_(placement),
      to_model_(placement.linear.inverse()),
      wall_mm_(0.5 * opening_mm),
      tolerance_mm_(tolerance_mm) {
  for (Eigen::Index i = 0; i < shape_->mesh.V.rows(); ++i)
    top_mm_ = std::max(top_mm_, placement_(shape_->mesh.V.row(i).transpose()).z());
}

std::optional<double> MouldContact::distance_mm(const Vec3& p, double limit_mm) const {
  if (!shape_) return std::nullopt;
  const auto nearest = shape_->distance.nearest(to_model_ * (p - placement_.translation), limit_mm / placement_.scale);
  if (!nearest) return std::nullopt;
  return nearest->distance * placement_.scale;
}

MouldContact::Known MouldContact::survey(const Vec3& p) const {
  return {p, distance_mm(p, farthest_mm).value_or(farthest_mm)};
}

std::optional<double> MouldContact::first_touch(const Vec3& from, const Vec3& to, double radius_mm,
                                                Known& known) const {
  // The plate: an exact moment.
  std::optional<double> plate;
  if (to.z() < radius_mm + tolerance_mm_)
    plate = from.z() <= radius_mm + tolerance_mm_ ? 0.0 : (from.z() - radius_mm - tolerance_mm_) / (from.z() - to.z());
  // The box's walls, which keep a sheet that finds no balance from blowing up for ever. Without half a thickness of
  // distance: the sheet's own rim begins there.
  for (int k = 0; k < 2; ++k)
    if (std::abs(to[k]) > wall_mm_[k]) {
      const double wall = std::copysign(wall_mm_[k], to[k]);
      const double t = std::abs(from[k]) >= wall_mm_[k] ? 0.0 : (wall - from[k]) / (to[k] - from[k]);
      plate = std::min(plate.value_or(1.0), t);
    }
  if (!shape_) return plate;
  const Vec3 path = to - from;
  const double length = path.norm(), until = plate.value_or(1.0);
  double t = 0;
  // Enough may be known already: the path lies within two balls around its ends' distances.
  if (known.at(from) + known.at(to) - 2 * (radius_mm + tolerance_mm_) > length &&
      known.at(from) > radius_mm + tolerance_mm_)
    return plate;
  for (;;) {
    const Vec3 here = from + t * path;
    double clear = known.at(here) - radius_mm;
    if (clear <= std::max(tolerance_mm_, 0.25 * (known.distance_mm - radius_mm))) {
      known = survey(here);
      clear = known.distance_mm - radius_mm;
      if (clear <= tolerance_mm_) return t;
    }
    if (t >= until) return plate;
    t = length > 0 ? std::min(until, t + 0.999 * clear / length) : until;
  }
}

Vec3 MouldContact::normal(const Vec3& p, double radius_mm) const {
  double clear = p.z() - radius_mm;
  Vec3 away = Vec3::UnitZ();
  for (int k = 0; k < 2; ++k)
    if (const double to_wall = wall_mm_[k] - std::abs(p[k]); to_wall < clear) {
      clear = to_wall;
      away = -std::copysign(1.0, p[k]) * Vec3::Unit(k);
    }
  if (!shape_) return away;
  const auto nearest = shape_->distance.nearest(to_model_ * (p - placement_.translation),
                                                (std::max(clear, 0.0) + radius_mm) / placement_.scale);
  if (!nearest || nearest->distance * placement_.scale - radius_mm > clear) return away;
  const Vec3 from_mould = p - placement_(nearest->point);
  return from_mould.norm() > 1e-9 ? from_mould.normalized() : away;
}

std::optional<Vec3> MouldContact::slide(const Vec3& from, Vec3& to, const Vec3& normal, double radius_mm) const {
  const Vec3 shift = to - from - normal.dot(to - from) * normal;
  const double length = shift.norm();
  to = from;
  if (length < 1e-9) return from;
  // A little off the surface, along it, and down again.
  const double lift = std::max(0.25 * length, 4 * tolerance_mm_);
  const Vec3 above = from + lift * normal;
  // What it touches beside, as in a corner, it may hardly come nearer to.
  Known known{above, distance_mm(above, farthest_mm).value_or(farthest_mm)};
  const double radius = std::min({radius_mm, known.distance_mm - 2 * tolerance_mm_, above.z() - 2 * tolerance_mm_});
  if (radius < 0.9 * radius_mm - 2 * tolerance_mm_) return from;
  const Vec3 along = above + first_touch(above, above + shift, radius, known).value_or(1.0) * shift;
  const Vec3 down = -(lift + 0.5 * length + 2 * tolerance_mm_) * normal;
  const auto landing = first_touch(along, along + down, radius, known);
  if (!landing) {
    to = along;
    return std::nullopt;
  }
  return to = along + *landing * down;
}

std::vector<Vec3> MouldContact::sharp_points(double edge_mm, double allowed_mm, double spacing_mm) const {
  if (!shape_) return {};
  const TriangleMesh mesh = placement_(shape_->mesh);
  const Adjacency adjacency(mesh);
  const Eigen::VectorXd angles = dihedral_angles(mesh, adjacency);
  const Eigen::VectorXd areas = face_areas(mesh);
  std::vector<double> area_beside(static_cast<std::size_t>(adjacency.edge_count()));
  for (int h = 0; h < 3 * adjacency.face_count(); ++h)
    area_beside[static_cast<std::size_t>(adjacency.edge_of(h))] += areas[h / 3];
  // The turn of the surface over one sheet edge, from that over the two triangles beside a mould edge: a sheet edge
  // of length e that rests on an edge of turn a stands off by e/2 tan(a/2) on each side.
  const double allowed_turn = 4 * std::atan(2 * allowed_mm / edge_mm);
  // Sharpest first, so that the tips survive the thinning.
  struct Candidate {
    double turn;
    int edge;
  };
  std::vector<Candidate> candidates;
  const auto& edges = adjacency.edges();
  for (int e = 0; e < adjacency.edge_count(); ++e) {
    if (!(angles[e] > 0)) continue;
    const Edge& edge = edges[static_cast<std::size_t>(e)];
    const double length = (mesh.V.row(edge.lower) - mesh.V.row(edge.higher)).norm();
    // Of the strip over which this edge turns the surface; a smooth surface turns on in the neighbouring strips.
    const double width = std::max(2 * area_beside[static_cast<std::size_t>(e)] / std::max(length, 1e-9) / 3, 1e-9);
    const double turn = angles[e] * std::clamp(edge_mm / width, 1.0, 16.0);
    if (turn > allowed_turn) candidates.push_back({turn, e});
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.turn != b.turn ? a.turn > b.turn : a.edge < b.edge;
  });
  SparsePoints points(spacing_mm);
  const auto add = [&](const Vec3& p) {
    if (p.z() > 0) points.add(p);
  };
  for (const Candidate& candidate : candidates) {  // ends first: corners and tips
    add(mesh.V.row(edges[static_cast<std::size_t>(candidate.edge)].lower));
    add(mesh.V.row(edges[static_cast<std::size_t>(candidate.edge)].higher));
  }
  for (const Candidate& candidate : candidates) {
    const Edge& edge = edges[static_cast<std::size_t>(candidate.edge)];
    const Vec3 a = mesh.V.row(edge.lower), b = mesh.V.row(edge.higher);
    const int parts = std::min(2000, static_cast<int>(std::ceil((b - a).norm() / spacing_mm)));
    for (int i = 1; i < parts; ++i) add(a + (b - a) * (static_cast<double>(i) / parts));
  }
  return std::move(points.points);
}

}  // namespace formwright
