// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/print/sheet_projection.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/parallel.h"
#include "geometry/mesh/measures.h"
#include "geometry/queries/point_distance.h"
#include "geometry/queries/ray_caster.h"
#include "geometry/queries/triangle_bvh.h"

namespace formwright {
namespace {

constexpr double min_agreement = 0.1;    // cosine between the model's normal and the sheet's
constexpr double off_surface_mm = 1e-3;  // where rays that look for the model itself begin
// Two corners of a triangle belong together when their places on the flat sheet are at most this many times as far
// apart as the triangle is long (and the sheet thick), had it shrunk there as much as the sheet did anywhere near.
constexpr double torn_factor = 2.5;

TriangleMesh inner_surface(const FormedSheet& sheet, double& thickest_mm) {
  const Eigen::Index n = sheet.mesh.V.rows();
  if (sheet.mesh.F.rows() == 0 || sheet.sheet_mm.rows() != n || sheet.thickness_mm.size() != n ||
      sheet.stretch.size() != n)
    throw Error(ErrorCode::invalid_input, "sheet",
                "The formed sheet is incomplete: use the sheet.ply that the simulation wrote.");
  if (!sheet.sheet_mm.allFinite() || !sheet.thickness_mm.allFinite() || !sheet.stretch.allFinite() ||
      sheet.thickness_mm.minCoeff() < 0)
    throw Error(ErrorCode::invalid_input, "sheet",
                "The formed sheet contains impossible numbers: use the sheet.ply that the simulation wrote.");
  TriangleMesh inner = sheet.mesh;
  inner.V -= (sheet.thickness_mm / 2).asDiagonal() * vertex_normals(sheet.mesh);
  thickest_mm = sheet.thickness_mm.maxCoeff();
  return inner;
}

/// Per face: the most by which the sheet has shrunk in any direction, flat length over length now; at least 1.
std::vector<double> shrinkage(const FormedSheet& sheet) {
  std::vector<double> result(static_cast<std::size_t>(sheet.mesh.F.rows()), 1);
  for (Eigen::Index f = 0; f < sheet.mesh.F.rows(); ++f) {
    const int i = sheet.mesh.F(f, 0), j = sheet.mesh.F(f, 1), k = sheet.mesh.F(f, 2);
    const Vec3 a = sheet.mesh.V.row(j) - sheet.mesh.V.row(i), b = sheet.mesh.V.row(k) - sheet.mesh.V.row(i);
    const double length = a.norm(), along = length > 0 ? a.dot(b) / length : 0,
                 height = length > 0 ? a.cross(b).norm() / length : 0;
    if (!(height > 1e-9)) continue;
    Eigen::Matrix2d now, flat;
    now << length, along, 0, height;
    flat.col(0) = (sheet.sheet_mm.row(j) - sheet.sheet_mm.row(i)).transpose();
    flat.col(1) = (sheet.sheet_mm.row(k) - sheet.sheet_mm.row(i)).transpose();
    const Eigen::Matrix2d map = flat * now.inverse();
    const double half = 0.5 * map.squaredNorm(), determinant = map.determinant();
    const double largest = std::sqrt(half + std::sqrt(std::max(0.0, half * half - determinant * determinant)));
    if (std::isfinite(largest)) result[static_cast<std::size_t>(f)] = std::clamp(largest, 1.0, 10.0);
  }
  return result;
}

class Projector {
 public:
  Projector(const FormedSheet& sheet, const ThermoformPrintOptions& options)
      : options_(options),
        inner_(inner_surface(sheet, thickest_mm_)),
        normals_(face_normals(sheet.mesh)),
        bvh_(inner_) {
    if (options.projection == SheetProjectionMethod::along_normal) rays_.emplace(inner_);
  }

  double thickest_mm() const { return thickest_mm_; }

  /// Nothing if no face of similar normal is near enough.
  std::optional<NearestPoint> operator()(const Vec3& p, const Vec3& normal) const {
    return rays_ ? along_normal(p, normal) : nearest(p, normal);
  }

 private:
  bool agrees(int face, const Vec3& normal) const { return normals_.row(face).dot(normal.transpose()) > min_agreement; }

  std::optional<NearestPoint> nearest(const Vec3& p, const Vec3& normal) const {
    NearestPoint best;
    double squared = options_.gap_mm * options_.gap_mm * (1 + 1e-12);
    bvh_.near_point(p, squared, [&](const TriangleBvh::Block& block) {
      for (std::size_t lane = 0; lane < TriangleBvh::width && block.face[lane] >= 0; ++lane) {
        if (!agrees(block.face[lane], normal)) continue;
        NearestPoint candidate =
            nearest_on_triangle(p, block.position(0, lane), block.position(1, lane), block.position(2, lane));
        candidate.face = block.face[lane];
        const bool better = best.face < 0 ? candidate.distance <= options_.gap_mm
                                          : candidate.distance < best.distance ||
                                                (candidate.distance == best.distance && candidate.face < best.face);
        if (!better) continue;
        best = candidate;
        squared = best.distance * best.distance * (1 + 1e-14);
      }
    });
    return best.face >= 0 ? std::optional(best) : std::nullopt;
  }

  std::optional<NearestPoint> along_normal(const Vec3& p, const Vec3& normal) const {
    std::optional<NearestPoint> best;
    const double reach = options_.gap_mm;
    for (const RayHit& hit : rays_->all_hits(p - reach * normal, normal, -1e-9, 2 * reach)) {
      const double distance = std::abs(hit.distance - reach);
      if (!agrees(hit.face, normal) || (best && distance >= best->distance)) continue;
      best = NearestPoint{hit.face, distance, p + (hit.distance - reach) * normal, hit.barycentric};
    }
    return best;
  }

  const ThermoformPrintOptions& options_;
  double thickest_mm_ = 0;
  TriangleMesh inner_;
  Positions normals_;  // of the middle surface: inner faces may vanish where the sheet turns sharply
  TriangleBvh bvh_;
  std::optional<RayCaster> rays_;
};

/// Of the vertices, by their faces above the plate: along its foot a model's underside has no say.
Positions normals_above(const RefinedSurface& surface) {
  TriangleMesh above{surface.mesh.V, surface.mesh.F};
  Eigen::Index count = 0;
  for (Eigen::Index f = 0; f < surface.mesh.F.rows(); ++f)
    if (!surface.below_plate[static_cast<std::size_t>(f)]) above.F.row(count++) = surface.mesh.F.row(f);
  above.F.conservativeResize(count, 3);
  return vertex_normals(above);
}

Coverage worst(Coverage a, Coverage b) { return a == Coverage::coloured ? b : a; }

}  // namespace

ProjectedSurface project_onto_sheet(const RefinedSurface& surface, const FormedSheet& sheet,
                                    const ThermoformPrintOptions& options, Context& context) {
  context.progress(0, "Projecting the surface onto the sheet");
  const Projector projector(sheet, options);
  const std::vector<double> shrunk_by = shrinkage(sheet);
  const RayCaster model(surface.undivided);
  const Positions normals = normals_above(surface);
  const Eigen::Index n = surface.mesh.V.rows(), m = surface.mesh.F.rows();
  const Vec2 opening_lower = sheet.sheet_mm.colwise().minCoeff().transpose(),
             opening_upper = sheet.sheet_mm.colwise().maxCoeff().transpose();
  ProjectedSurface result;
  result.vertex.assign(static_cast<std::size_t>(n), Coverage::below_plate);
  result.sheet_mm = TextureCoordinates::Zero(n, 2);
  result.gap_mm = result.stretch = Eigen::VectorXd::Zero(n);
  std::vector<char> above(static_cast<std::size_t>(n), 0);
  for (Eigen::Index f = 0; f < m; ++f)
    for (int k = 0; k < 3 && !surface.below_plate[static_cast<std::size_t>(f)]; ++k)
      above[static_cast<std::size_t>(surface.mesh.F(f, k))] = 1;

  std::vector<int> landed(static_cast<std::size_t>(n), -1);
  constexpr std::size_t grain = 1024;
  parallel_for(static_cast<std::size_t>(n), grain, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (std::size_t i = begin; i < end; ++i) {
      if (!above[i]) continue;
      const auto row = static_cast<Eigen::Index>(i);
      const Vec3 p = surface.mesh.V.row(row), normal = normals.row(row);
      if (const auto found = projector(p, normal)) {
        result.vertex[i] = Coverage::coloured;
        landed[i] = found->face;
        result.gap_mm[row] = found->distance;
        for (int k = 0; k < 3; ++k) {
          const int corner = sheet.mesh.F(found->face, k);
          result.sheet_mm.row(row) += found->barycentric[k] * sheet.sheet_mm.row(corner);
          result.stretch[row] += found->barycentric[k] * sheet.stretch[corner];
        }
        continue;
      }
      const bool within =
          (p.head<2>().array() >= opening_lower.array()).all() && (p.head<2>().array() <= opening_upper.array()).all();
      if (!within) result.vertex[i] = Coverage::outside;
      else if (normal.z() < 0 || model.first_hit(p + off_surface_mm * normal, Vec3::UnitZ(), off_surface_mm, 1e6))
        result.vertex[i] = Coverage::hidden;
      else result.vertex[i] = Coverage::not_touched;
    }
  });
  context.progress(0.9);

  result.face.assign(static_cast<std::size_t>(m), Coverage::below_plate);
  for (Eigen::Index f = 0; f < m; ++f) {
    if (surface.below_plate[static_cast<std::size_t>(f)]) continue;
    Coverage coverage = Coverage::coloured;
    bool torn = false;
    for (int k = 0; k < 3; ++k) {
      const int i = surface.mesh.F(f, k), j = surface.mesh.F(f, (k + 1) % 3);
      coverage = worst(coverage, result.vertex[static_cast<std::size_t>(i)]);
      const int at_i = landed[static_cast<std::size_t>(i)], at_j = landed[static_cast<std::size_t>(j)];
      if (at_i < 0 || at_j < 0) continue;
      const double length = (surface.mesh.V.row(i) - surface.mesh.V.row(j)).norm() + projector.thickest_mm();
      const double reach =
          torn_factor * std::max(shrunk_by[static_cast<std::size_t>(at_i)], shrunk_by[static_cast<std::size_t>(at_j)]) *
          length;
      torn = torn || (result.sheet_mm.row(i) - result.sheet_mm.row(j)).norm() > reach;
    }
    result.face[static_cast<std::size_t>(f)] =
        coverage == Coverage::coloured && torn ? Coverage::not_touched : coverage;
  }
  return result;
}

}  // namespace formwright
