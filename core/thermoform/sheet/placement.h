// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How a model stands on the forming machine's platform.
//
// Machine coordinates, used by everything that thermoforms: millimetres, z up, the origin in the centre of the clamp
// opening, the base plate at z = 0 once the platform is up.
#include <array>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "base/data/parameters.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct PlacementOptions {
  std::array<double, 3> up{0, 1, 0};
  double turn_deg = 0;
  std::optional<double> size_mm;
  double x_mm = 0;
  double y_mm = 0;
  double sink_mm = 0;

  static constexpr auto parameters = std::tuple{
      parameter(
          "size_mm", &PlacementOptions::size_mm, "Size", unit::mm, 1, 2000,
          "Longest side of the model as it stands on the plate, including any part lowered into the plate. Automatic: the size in the file if that is at least 10 mm and leaves 5 mm to the clamp; otherwise 100 mm, or less where the clamp is narrower.")
          .group("Placement")
          .slider(20, 220),
      parameter(
          "sink_mm", &PlacementOptions::sink_mm, "Lower into the plate", unit::mm, 0, 1000,
          "How deep the model is lowered into the base plate. What lies below the plate is not formed; use it to hide undercuts at the foot.")
          .group("Placement")
          .slider(0, 60),
      parameter("turn_deg", &PlacementOptions::turn_deg, "Turn", unit::degrees, -360, 360,
                "Rotates the model about the vertical axis, counter-clockwise seen from above.")
          .group("Placement")
          .slider(-180, 180),
      parameter(
          "x_mm", &PlacementOptions::x_mm, "Shift in x", unit::mm, -1000, 1000,
          "Moves the centre of the model's outline to the right of the clamp's centre; negative moves it to the left.")
          .group("Placement")
          .slider(-80, 80)
          .advanced(),
      parameter(
          "y_mm", &PlacementOptions::y_mm, "Shift in y", unit::mm, -1000, 1000,
          "Moves the centre of the model's outline to the back of the clamp's centre; negative moves it to the front.")
          .group("Placement")
          .slider(-80, 80)
          .advanced(),
      parameter("up", &PlacementOptions::up, "Up",
                "The direction that points up on the machine, as x, y, z in the model's axes.")
          .group("Placement")
          .advanced()};
};

/// x_machine = linear * x_model + translation; linear is a rotation times a positive scale.
struct Placement {
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  Vec3 translation = Vec3::Zero();
  double scale = 1;                // mm per unit of the file
  std::vector<std::string> notes;  // what was decided for the maker, one sentence each

  Vec3 operator()(const Vec3& p) const { return linear * p + translation; }
  TriangleMesh operator()(const TriangleMesh& mesh) const;
};

/// Stands `mesh` (any unit, at least one triangle) on the platform. `opening_mm`: the clamp opening's sides.
/// Throws Error{invalid_input}: "up" of length 0, a model without extent, a sink that leaves nothing above the plate.
Placement place(const TriangleMesh& mesh, const PlacementOptions& options, const Vec2& opening_mm);

}  // namespace formwright
