// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a maker chooses for a relief: thesis chapter 3.
#include <array>
#include <optional>
#include <tuple>

#include "base/parameters.h"
#include "numerics/bounded_qp.h"

namespace formwright {

enum class Projection { perspective, orthographic };
template <>
struct EnumNames<Projection> {
  static constexpr std::array<std::string_view, 2> names{"perspective", "orthographic"};
  static constexpr std::array<std::string_view, 2> labels{"Near", "Far"};
};

enum class BoundedVertices { all, visible };
template <>
struct EnumNames<BoundedVertices> {
  static constexpr std::array<std::string_view, 2> names{"all", "visible"};
  static constexpr std::array<std::string_view, 2> labels{"All", "Visible only"};
};

struct ReliefOptions {
  double thickness_mm = 5;
  double width_mm = 120;
  double plate_mm = 3;
  double margin_mm = 0;
  Projection projection = Projection::perspective;
  std::array<double, 3> direction{0, 0, -1};
  std::array<double, 3> up{0, 1, 0};
  double field_of_view_deg = 20;
  std::optional<double> distance_mm;
  BoundedVertices bounded_vertices = BoundedVertices::all;
  double hidden_weight = 1;
  bool depth_order = true;
  double pixel_mm = 0.2;
  QpMethod method = QpMethod::automatic;

  static constexpr auto parameters = std::tuple{
      parameter("thickness_mm", &ReliefOptions::thickness_mm, "Thickness", unit::mm, 0.01, 1000,
                "How far the relief stands out from its plate. Kept exactly.")
          .group("Relief")
          .slider(0.5, 20),
      parameter("width_mm", &ReliefOptions::width_mm, "Width", unit::mm, 1, 10000,
                "Width of the model on the plate, as seen from the viewpoint.")
          .group("Relief")
          .slider(20, 400),
      parameter("plate_mm", &ReliefOptions::plate_mm, "Plate", unit::mm, 0.01, 1000,
                "Thickness of the flat plate behind the relief.")
          .group("Base")
          .slider(0.5, 20),
      parameter("margin_mm", &ReliefOptions::margin_mm, "Margin", unit::mm, 0, 1000,
                "How far the plate reaches beyond the model on every side.")
          .group("Base")
          .slider(0, 40),
      parameter("projection", &ReliefOptions::projection, "Distance",
                "Near: seen in perspective from the distance of the view. Far: seen straight on, without perspective.")
          .group("Viewpoint"),
      parameter("direction", &ReliefOptions::direction, "Looking direction",
                "The direction in which the viewer looks, in the model's axes.")
          .group("Viewpoint")
          .advanced(),
      parameter("up", &ReliefOptions::up, "Up", "The direction that is up in the picture, in the model's axes.")
          .group("Viewpoint")
          .advanced(),
      parameter("field_of_view_deg", &ReliefOptions::field_of_view_deg, "Field of view", unit::degrees, 0.1, 120,
                "Angle under which the width of the model is seen (near views only). Smaller is further away.")
          .group("Viewpoint")
          .slider(2, 60)
          .advanced(),
      parameter("distance_mm", &ReliefOptions::distance_mm, "Viewing distance", unit::mm, 0.1, 1e7,
                "Distance of the viewpoint from the plate (near views only). Automatic: from the field of view.")
          .group("Viewpoint")
          .slider(50, 2000)
          .advanced(),
      parameter(
          "bounded_vertices", &ReliefOptions::bounded_vertices, "Keep within the thickness",
          "Visible only leaves the hidden side free to sink behind the plate, which is gentler on the visible side.")
          .group("Shape"),
      parameter("hidden_weight", &ReliefOptions::hidden_weight, "Weight of the hidden side", unit::none, 0.001, 1,
                "How much the shape of hidden parts counts (w in eq. 3.13).")
          .group("Shape")
          .slider(0.01, 1)
          .advanced(),
      parameter("depth_order", &ReliefOptions::depth_order, "Keep the order in depth",
                "What is in front stays in front (eq. 3.12), so that parts do not pass through each other.")
          .group("Shape"),
      parameter("pixel_mm", &ReliefOptions::pixel_mm, "Grid of the solid", unit::mm, 0.01, 10,
                "Spacing of the height map and of the solid made from it. Half a nozzle or tool width is fine enough.")
          .group("Output")
          .slider(0.05, 1)
          .advanced(),
      parameter("method", &ReliefOptions::method, "Solver",
                "Exchange is fastest where the relief touches its bounds at few points, interior point where at many.")
          .group("Output")
          .advanced()};
};

}  // namespace formwright
