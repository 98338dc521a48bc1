// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/forest/forest_check.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace formwright {
namespace {

constexpr double on_surface_mm = 0.01, depth_tolerance_mm = 0.03, beyond_mm = 1e7;
constexpr std::size_t lines_a_chunk = 4;

enum class Met : char { outside, seen, bare, nothing, intruding };

/// Whether a viewpoint's ray ends on the relief as its piece has it there or within a pixel.
bool is_on_piece(const CheckedView& of, int pillar, const Vec3& point) {
  const RayPoint p = of.view.ray_point(point);
  for (const PieceGrid& grid : of.grids) {
    if (grid.pillar != pillar) continue;
    const auto after = std::ranges::upper_bound(grid.aside, p.aside);
    const int column = std::clamp(static_cast<int>(after - grid.aside.begin()) - 1, 0, grid.columns() - 2);
    const double pixel =
        grid.aside[static_cast<std::size_t>(column) + 1] - grid.aside[static_cast<std::size_t>(column)];
    if (p.aside < grid.aside.front() - pixel || p.aside > grid.aside.back() + pixel) continue;
    const double z = of.view.eye().z() + p.above * grid.reach[static_cast<std::size_t>(column)].surface;
    const int row = static_cast<int>(std::floor((z - grid.z_mm.front()) / (grid.z_mm[1] - grid.z_mm[0])));
    double nearest = INFINITY, farthest = -INFINITY;
    for (int r = std::max(0, row - 1); r <= std::min(grid.rows() - 2, row + 1); ++r)
      for (int c = std::max(0, column - 1); c <= std::min(grid.columns() - 2, column + 1); ++c) {
        if (!grid.covered[grid.cell(c, r)]) continue;
        for (const std::size_t node :
             {grid.node(c, r), grid.node(c + 1, r), grid.node(c, r + 1), grid.node(c + 1, r + 1)}) {
          nearest = std::min(nearest, grid.front[node]);
          farthest = std::max(farthest, grid.front[node]);
        }
      }
    if (p.ahead >= nearest - depth_tolerance_mm && p.ahead <= farthest + depth_tolerance_mm) return true;
  }
  return false;
}

/// Whether a point belongs to one of a viewpoint's pieces on this pillar, up to `margin_mm`.
bool belongs_to(const CheckedView& of, int pillar, const Vec3& point, double margin_mm) {
  const RayPoint p = of.view.ray_point(point);
  if (p.ahead <= 0) return false;
  const double eye_z = of.view.eye().z();
  for (const PieceGrid& grid : of.grids) {
    if (grid.pillar != pillar) continue;
    const double margin = margin_mm / p.ahead;
    if (p.aside < grid.aside.front() - margin || p.aside > grid.aside.back() + margin) continue;
    const auto after = std::ranges::upper_bound(grid.aside, p.aside);
    const int column = std::clamp(static_cast<int>(after - grid.aside.begin()) - 1, 0, grid.columns() - 2);
    const WallReach& reach = grid.reach[static_cast<std::size_t>(column)];
    if (p.ahead < reach.near - 2 * margin_mm || p.ahead > reach.exit + margin_mm) continue;
    const double z = eye_z + p.above * reach.surface, pitch = grid.z_mm[1] - grid.z_mm[0];
    const int row = static_cast<int>(std::floor((z - grid.z_mm.front()) / pitch));
    // Back walls do not follow the rays, so that their rows may differ by one.
    for (int r = std::max(0, row - 1); r <= std::min(grid.rows() - 2, row + 1); ++r)
      for (int c = std::max(0, column - 1); c <= std::min(grid.columns() - 2, column + 1); ++c)
        if (grid.covered[grid.cell(c, r)]) return true;
  }
  return false;
}

}  // namespace

StandingForest standing_forest(std::span<const TriangleMesh> pillars) {
  StandingForest forest;
  Eigen::Index vertices = 0, faces = 0;
  for (const TriangleMesh& pillar : pillars) {
    vertices += pillar.V.rows();
    faces += pillar.F.rows();
  }
  forest.mesh.V.resize(vertices, 3);
  forest.mesh.F.resize(faces, 3);
  vertices = faces = 0;
  for (std::size_t p = 0; p < pillars.size(); ++p) {
    forest.mesh.V.middleRows(vertices, pillars[p].V.rows()) = pillars[p].V;
    forest.mesh.F.middleRows(faces, pillars[p].F.rows()) = pillars[p].F.array() + static_cast<int>(vertices);
    forest.face_pillar.insert(forest.face_pillar.end(), static_cast<std::size_t>(pillars[p].F.rows()),
                              static_cast<int>(p));
    vertices += pillars[p].V.rows();
    faces += pillars[p].F.rows();
  }
  return forest;
}

int ViewCheck::worst_pillar() const {
  const auto worst = std::ranges::max_element(intruding_rays_of_pillar);
  return worst == intruding_rays_of_pillar.end() || *worst == 0
             ? -1
             : static_cast<int>(worst - intruding_rays_of_pillar.begin());
}

ViewCheck check_view(std::span<const CheckedView> views, std::size_t own, std::span<const Pillar> pillars,
                     const StandingForest& forest, const RayCaster& caster, int across, double pixel_mm,
                     Context& context) {
  const CheckedView& of = views[own];
  const RayCaster model({of.frame.P, of.model_F});
  const Vec3 model_eye(0, 0, -1 / of.frame.kappa);
  const double model_far = 4 * (of.frame.P.rowwise().norm().maxCoeff() + 1 / of.frame.kappa);
  const auto lines = static_cast<std::size_t>(std::max(1.0, std::round(across * of.frame.image_height)));
  const auto columns = static_cast<std::size_t>(across);
  struct One {
    Met met = Met::outside;
    int pillar = -1;
  };
  std::vector<One> rays(lines * columns);
  parallel_for(lines, lines_a_chunk, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (std::size_t line = begin; line < end; ++line)
      for (std::size_t column = 0; column < columns; ++column) {
        const double x = (static_cast<double>(column) + 0.5) / static_cast<double>(columns) - 0.5;
        const double y = of.frame.image_height * ((static_cast<double>(line) + 0.5) / static_cast<double>(lines) - 0.5);
        const Vec3 in_model = (Vec3(x, y, 0) - model_eye).normalized();
        if (!model.first_hit(model_eye, in_model, 0, model_far)) continue;
        One& one = rays[line * columns + column];
        const Vec3 direction = of.view.picture_ray(x, y);
        const auto hit = caster.first_hit(of.view.eye(), direction, 0, beyond_mm);
        one.met = Met::nothing;
        if (!hit) continue;
        one.pillar = forest.face_pillar[static_cast<std::size_t>(hit->face)];
        const Vec3 point = of.view.eye() + hit->distance * direction;
        const Pillar& pillar = pillars[static_cast<std::size_t>(one.pillar)];
        one.met = Met::seen;
        if (is_on_piece(of, one.pillar, point)) continue;
        one.met = Met::bare;
        if (point.z() >= pillar.height_mm - on_surface_mm || point.z() <= on_surface_mm ||
            distance_to_outline(pillar.outline_mm, point.head<2>()) <= on_surface_mm)
          continue;
        // Walls beside its own relief are its own, too.
        for (std::size_t v = 0; v < views.size(); ++v)
          if (v != own && belongs_to(views[v], one.pillar, point, pixel_mm) &&
              !belongs_to(of, one.pillar, point, pixel_mm))
            one.met = Met::intruding;
      }
  });
  ViewCheck check;
  check.intruding_rays_of_pillar.assign(pillars.size(), 0);
  for (const One& one : rays) {
    if (one.met == Met::outside) continue;
    ++check.rays;
    check.seen += one.met == Met::seen;
    check.bare += one.met == Met::bare;
    check.nothing += one.met == Met::nothing;
    check.intruding += one.met == Met::intruding;
    if (one.met == Met::intruding) ++check.intruding_rays_of_pillar[static_cast<std::size_t>(one.pillar)];
  }
  return check;
}

}  // namespace formwright
