// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/view/visibility.h"

#include <Eigen/Geometry>
#include <cmath>

#include "base/parallel.h"
#include "relief/view/sight.h"

namespace formwright {
namespace {

constexpr std::size_t grain = 2048;
// Of the picture's width: nearer than this two surfaces count as touching, and their order as undecided.
constexpr double touching = 1e-7;

}  // namespace

bool faces_viewer(const ViewFrame& frame, const Positions& P, const Triangles& F, Eigen::Index face) {
  const Vec3 a = P.row(F(face, 0)).transpose(), b = P.row(F(face, 1)).transpose(), c = P.row(F(face, 2)).transpose();
  // View axes (right, up, away) are left-handed: this normal points inwards.
  const Vec3 inward = (b - a).cross(c - a);
  const Vec3 middle = (a + b + c) / 3;
  return inward.dot(Vec3(frame.kappa * middle.x(), frame.kappa * middle.y(), 1 + frame.kappa * middle.z())) > 0;
}

Visibility find_visibility(const ViewFrame& frame, const Triangles& F, const RayCaster& caster, Context& context) {
  const auto n = static_cast<std::size_t>(frame.P.rows());
  const Sight sight(frame);
  Visibility result;
  result.vertex.assign(n, 0);
  parallel_for(n, grain, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (std::size_t i = begin; i < end; ++i) {
      const auto vertex = static_cast<Eigen::Index>(i);
      const SightRay ray = sight.at(vertex);
      // Up to the vertex only; what touches it does not hide it.
      const auto hit = caster.first_hit(ray.origin, ray.direction, 0, ray.vertex_distance - touching);
      result.vertex[i] = !hit || has_corner(F, hit->face, vertex);
    }
  });
  for (const char visible : result.vertex) result.visible_vertices += visible;
  result.face.assign(static_cast<std::size_t>(F.rows()), 0);
  for (Eigen::Index f = 0; f < F.rows(); ++f)
    result.face[static_cast<std::size_t>(f)] =
        result.vertex[static_cast<std::size_t>(F(f, 0))] && result.vertex[static_cast<std::size_t>(F(f, 1))] &&
        result.vertex[static_cast<std::size_t>(F(f, 2))] && faces_viewer(frame, frame.P, F, f);
  return result;
}

std::vector<InequalityRow> depth_order_rows(const ViewFrame& frame, const Triangles& F, const RayCaster& caster,
                                            Context& context) {
  const auto n = static_cast<std::size_t>(frame.P.rows());
  const Sight sight(frame);
  std::vector<std::vector<InequalityRow>> chunks((n + grain - 1) / grain);

  // z_near + q_near u_near <= z_far + q_far u_far, with q = 1 + kappa z.
  const auto add_row = [&](std::vector<InequalityRow>& rows, int vertex, const RayHit& hit, const SightRay& ray,
                           bool hit_is_behind) {
    const double z_vertex = frame.P(vertex, 2), z_hit = (ray.origin + hit.distance * ray.direction).z();
    const double sign = hit_is_behind ? 1 : -1;
    const double q_vertex = 1 + frame.kappa * z_vertex, q_hit = 1 + frame.kappa * z_hit;
    InequalityRow row;
    row.index = {vertex, F(hit.face, 0), F(hit.face, 1), F(hit.face, 2)};
    row.coefficient = {-sign * q_vertex, sign * q_hit * hit.barycentric[0], sign * q_hit * hit.barycentric[1],
                       sign * q_hit * hit.barycentric[2]};
    row.bound = sign * (z_vertex - z_hit);
    rows.push_back(std::move(row));
  };

  parallel_for(n, grain, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    std::vector<InequalityRow>& rows = chunks[begin / grain];
    for (std::size_t i = begin; i < end; ++i) {
      const int vertex = static_cast<int>(i);
      const SightRay ray = sight.at(vertex);
      const RayHit* before = nullptr;
      const std::vector<RayHit> hits = caster.all_hits(ray.origin, ray.direction, 0, sight.reach());
      for (const RayHit& hit : hits) {
        if (has_corner(F, hit.face, vertex) || std::abs(hit.distance - ray.vertex_distance) < touching) continue;
        if (hit.distance < ray.vertex_distance) {
          before = &hit;
        } else {
          add_row(rows, vertex, hit, ray, true);
          break;
        }
      }
      if (before) add_row(rows, vertex, *before, ray, false);
    }
  });

  std::vector<InequalityRow> all;
  std::size_t count = 0;
  for (const auto& chunk : chunks) count += chunk.size();
  all.reserve(count);
  for (auto& chunk : chunks) {
    std::move(chunk.begin(), chunk.end(), std::back_inserter(all));
    chunk = {};
  }
  return all;
}

}  // namespace formwright
