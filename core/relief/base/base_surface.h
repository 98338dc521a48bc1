// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where rays and the plate's points meet the base of a relief.
#include <memory>
#include <optional>
#include <utility>

#include "geometry/queries/ray_caster.h"
#include "relief/base/base_bands.h"
#include "relief/base/base_parts.h"
#include "relief/view/view_frame.h"

namespace formwright {

/// A base in view coordinates; without a mesh, the plane z = 0.
class BaseSurface {
 public:
  BaseSurface() = default;
  /// `mesh`: at least one triangle, open or closed; of what lies behind each other the foremost counts.
  /// `bands`: of a base in steps or strips, whose planes and the walls between them the mesh has. `parts`: of a base
  /// in several parts, the same mesh.
  explicit BaseSurface(const TriangleMesh& mesh, std::optional<BaseBands> bands = std::nullopt,
                       std::shared_ptr<const BaseParts> parts = nullptr);

  bool is_flat() const { return caster_ == nullptr; }
  /// Null where it has neither steps nor strips.
  const BaseBands* bands() const { return bands_ ? &*bands_ : nullptr; }

  /// Null where it is one.
  const BaseParts* parts() const { return parts_.get(); }

  /// The largest length along z of one unit of length along the base's normal where thickness is counted along it: on
  /// strips. Else 1.
  double max_along_z() const;

  /// Depth z at which the ray from the viewpoint through a vertex of the model first meets the base, moved by `shift`
  /// along z. On bands, that of the band whose group the ray belongs to, moved along the band's normal: relief on the
  /// walls between steps cannot be made. Nothing where it misses. For a base without overhangs as seen along z, a
  /// larger shift is met later.
  std::optional<double> depth_on_ray(const ViewFrame& frame, Eigen::Index vertex, double shift) const;

  /// Depth z of the base at a point of the plate, seen straight on. Nothing beyond its edge.
  std::optional<double> depth_at(double x, double y) const;

  /// Least and largest depth over the rectangle |x| <= half_x, |y| <= half_y, all sheets of the mesh included. Nothing
  /// where the base does not reach into it.
  std::optional<std::pair<double, double>> depth_range(double half_x, double half_y) const;

 private:
  TriangleMesh mesh_;
  std::optional<BaseBands> bands_;
  std::shared_ptr<const BaseParts> parts_;
  std::shared_ptr<const RayCaster> caster_;
  double front_ = 0, far_ = 0;  // before everything, and a distance beyond everything from there
};

}  // namespace formwright
