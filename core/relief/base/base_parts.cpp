// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/base/base_parts.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "geometry/planar/plane.h"
#include "relief/base/seen_regions.h"
#include "relief/view/straight_view.h"

namespace formwright {
namespace {

constexpr int max_parts = 200;
constexpr double min_before_viewpoint = 0.1;  // of the viewing distance
constexpr double min_carrying = 0.2;          // cosine between ray and normal: 11.5 degrees between ray and face
constexpr double thinnest = 1e-9;             // of a solid, in depth
constexpr double beside = 1e-7;               // of a ray that misses an outline by a rounding error

/// The faces with one number, without vertices that they do not use.
TriangleMesh faces_of(const TriangleMesh& mesh, const std::vector<int>& part, int number) {
  std::vector<int> vertex_of(static_cast<std::size_t>(mesh.V.rows()), -1), used;
  std::vector<Eigen::Index> faces;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    if (part[static_cast<std::size_t>(f)] == number) faces.push_back(f);
  TriangleMesh own;
  own.F.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t row = 0; row < faces.size(); ++row)
    for (Eigen::Index k = 0; k < 3; ++k) {
      int& vertex = vertex_of[static_cast<std::size_t>(mesh.F(faces[row], k))];
      if (vertex < 0) {
        vertex = static_cast<int>(used.size());
        used.push_back(mesh.F(faces[row], k));
      }
      own.F(static_cast<Eigen::Index>(row), k) = vertex;
    }
  own.V = mesh.V(used, Eigen::all);
  return own;
}

/// The parts, a closed one that lies within another and is turned the other way joined to it.
Components solid_parts(const TriangleMesh& base) {
  Components parts = face_components(Adjacency(base));
  auto& [part, count] = parts;
  if (count == 1 || count > max_parts) return parts;  // too many are refused, hollows or not
  std::vector<double> volume;
  std::vector<BoundingBox> box;
  for (int k = 0; k < count; ++k) {
    const TriangleMesh own = faces_of(base, part, k);
    volume.push_back(Adjacency(own).is_closed() ? signed_volume(own) : 0);
    box.push_back(bounding_box(own));
  }
  std::vector<int> belongs_to(static_cast<std::size_t>(count));
  std::iota(belongs_to.begin(), belongs_to.end(), 0);
  for (std::size_t hollow = 0; hollow < volume.size(); ++hollow)
    for (std::size_t around = 0; around < volume.size(); ++around)
      if (volume[hollow] * volume[around] < 0 && std::abs(volume[hollow]) < std::abs(volume[around]) &&
          box[around].surrounds(box[hollow].lower) && box[around].surrounds(box[hollow].upper))
        belongs_to[hollow] = static_cast<int>(around);
  std::vector<int> number(static_cast<std::size_t>(count), -1);
  int kept = 0;
  for (std::size_t k = 0; k < belongs_to.size(); ++k)
    if (belongs_to[k] == static_cast<int>(k)) number[k] = kept++;
  for (int& own : part) own = number[static_cast<std::size_t>(belongs_to[static_cast<std::size_t>(own)])];
  count = kept;
  return parts;
}

/// Of each face whether the ray through its middle meets it far enough from its edge.
std::vector<char> carrying_faces(const TriangleMesh& mesh, double kappa) {
  std::vector<char> carries;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)).transpose(), b = mesh.V.row(mesh.F(f, 1)).transpose(),
               c = mesh.V.row(mesh.F(f, 2)).transpose(), middle = (a + b + c) / 3;
    const Vec3 normal = (b - a).cross(c - a), ray(kappa * middle.x(), kappa * middle.y(), 1 + kappa * middle.z());
    carries.push_back(std::abs(normal.dot(ray)) > min_carrying * normal.norm() * ray.norm());
  }
  return carries;
}

/// Of each face whether it looks towards the viewer; of an open part all count.
std::vector<char> front_faces(const TriangleMesh& mesh, double kappa, bool closed) {
  std::vector<char> front(static_cast<std::size_t>(mesh.F.rows()), 1);
  if (!closed) return front;
  const double volume = signed_volume(mesh);
  const Positions V = straightened(mesh.V, kappa);
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const auto at = [&](Eigen::Index k) -> Vec2 { return V.row(mesh.F(f, k)).head<2>().transpose(); };
    front[static_cast<std::size_t>(f)] = cross(Vec2(at(1) - at(0)), Vec2(at(2) - at(0))) * volume < 0;
  }
  return front;
}

}  // namespace

int count_base_parts(const TriangleMesh& base) { return solid_parts(base).count; }

BaseParts::BaseParts(const TriangleMesh& base, double kappa, Context& context) : kappa_(kappa) {
  if (1 + kappa * base.V.col(2).minCoeff() < min_before_viewpoint)
    throw Error(
        ErrorCode::invalid_input, "base_mesh",
        "The base reaches to the viewpoint: move it away from the viewer, or choose a larger viewing distance.");
  const auto [part_of_face, count] = solid_parts(base);
  part_of_face_ = part_of_face;
  if (count > max_parts)
    throw Error(ErrorCode::invalid_input, "base_mesh",
                "The base has " + std::to_string(count) + " parts that do not hang together, and " +
                    std::to_string(max_parts) +
                    " at most are possible: leave some out, or take them as one surface (base_mesh_parts).");
  carries_ = carrying_faces(base, kappa);
  parts_.resize(static_cast<std::size_t>(count));
  // What carries and what does not are surfaces of their own, which hide each other.
  std::vector<TriangleMesh> surfaces;
  std::vector<int> part_of_surface;
  for (int k = 0; k < count; ++k) {
    context.check_cancelled();
    Part& part = parts_[static_cast<std::size_t>(k)];
    part.mesh = faces_of(base, part_of_face_, k);
    part.closed = Adjacency(part.mesh).is_closed();
    part.caster = std::make_unique<RayCaster>(TriangleMesh{straightened(part.mesh.V, kappa), part.mesh.F});
    const std::vector<char> front = front_faces(part.mesh, kappa, part.closed);
    std::vector<char> carrying;
    for (std::size_t f = 0; f < part_of_face_.size(); ++f)
      if (part_of_face_[f] == k) carrying.push_back(carries_[f]);
    for (const bool wanted : {true, false}) {
      std::vector<Eigen::Index> faces;
      for (std::size_t f = 0; f < front.size(); ++f)
        if (front[f] && (carrying[f] != 0) == wanted) faces.push_back(static_cast<Eigen::Index>(f));
      surfaces.push_back({straightened(part.mesh.V, kappa), part.mesh.F(faces, Eigen::all)});
      part_of_surface.push_back(k);
    }
  }
  std::vector<Region> seen = seen_regions(surfaces, part_of_surface, context);
  for (std::size_t k = 0; k < parts_.size(); ++k) parts_[k].seen = std::move(seen[2 * k]);
  const TriangleMesh all{straightened(base.V, kappa), base.F};
  caster_ = std::make_unique<RayCaster>(all);
  front_ = std::min(0.0, all.V.col(2).minCoeff()) - 1;
  far_ = 4 * (all.V.rowwise().norm().maxCoeff() + 1) - front_;
}

std::optional<BaseParts::Hit> BaseParts::foremost(const Vec2& on_plate) const {
  const auto hit = caster_->first_hit(Vec3(on_plate.x(), on_plate.y(), front_), Vec3::UnitZ(), 0, far_);
  if (!hit) return std::nullopt;
  const auto face = static_cast<std::size_t>(hit->face);
  return Hit{part_of_face_[face], depth_from_straight(front_ + hit->distance, kappa_), carries_[face] != 0};
}

std::optional<BaseParts::Passage> BaseParts::passage(int part, const Vec2& on_plate) const {
  const Part& own = parts_[static_cast<std::size_t>(part)];
  for (const Vec2& off : {Vec2(0, 0), Vec2(beside, 0), Vec2(-beside, 0), Vec2(0, beside), Vec2(0, -beside)}) {
    const Vec2 at = on_plate + off;
    const Vec3 origin(at.x(), at.y(), front_);
    const auto enters = own.caster->first_hit(origin, Vec3::UnitZ(), 0, far_);
    if (!enters) continue;
    const auto leaves =
        own.closed ? own.caster->first_hit(origin, Vec3::UnitZ(), enters->distance + thinnest, far_) : std::nullopt;
    const double z = depth_from_straight(front_ + enters->distance, kappa_);
    return Passage{z, leaves       ? depth_from_straight(front_ + leaves->distance, kappa_)
                      : own.closed ? z  // it only touches the ray
                                   : INFINITY};
  }
  return std::nullopt;
}

Vec2 BaseParts::limits(const Passage& passage, double above, double below) {
  return {passage.enters - above, std::min(passage.enters + below, 0.5 * (passage.enters + passage.leaves))};
}

}  // namespace formwright
