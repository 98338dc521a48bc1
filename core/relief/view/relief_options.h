// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a maker chooses for a relief: thesis chapter 3.
#include <array>
#include <optional>
#include <tuple>

#include "base/data/parameters.h"
#include "numerics/qp/bounded_qp.h"

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
  static constexpr std::array<std::string_view, 2> labels{"Flat", "May sink"};
};

enum class BaseShape { flat, cylinder, wave, groove, stairs, strips };
template <>
struct EnumNames<BaseShape> {
  static constexpr std::array<std::string_view, 6> names{"flat", "cylinder", "wave", "groove", "stairs", "strips"};
  static constexpr std::array<std::string_view, 6> labels{"Flat", "Cylinder", "Waves", "V groove", "Stairs", "Strips"};
};

/// How strips follow each other.
enum class BaseBend { bay, zigzag };
template <>
struct EnumNames<BaseBend> {
  static constexpr std::array<std::string_view, 2> names{"bay", "zigzag"};
  static constexpr std::array<std::string_view, 2> labels{"Bay", "Zigzag"};
};

enum class BaseMisses { refused, free };
template <>
struct EnumNames<BaseMisses> {
  static constexpr std::array<std::string_view, 2> names{"refused", "free"};
  static constexpr std::array<std::string_view, 2> labels{"Refuse", "Leave free"};
};

/// How parts of a base from a file that do not hang together are taken.
enum class PartsOfBase { apart, together };
template <>
struct EnumNames<PartsOfBase> {
  static constexpr std::array<std::string_view, 2> names{"apart", "together"};
  static constexpr std::array<std::string_view, 2> labels{"Each by itself", "As one surface"};
};

/// What a relief is made of between its surface and its plate.
enum class SolidKind { filled, thick };
template <>
struct EnumNames<SolidKind> {
  static constexpr std::array<std::string_view, 2> names{"filled", "thick"};
  static constexpr std::array<std::string_view, 2> labels{"Filled", "Thick surface"};
};

enum class Appearance { detail, balanced, squashed };
template <>
struct EnumNames<Appearance> {
  static constexpr std::array<std::string_view, 3> names{"detail", "balanced", "squashed"};
  static constexpr std::array<std::string_view, 3> labels{"Crisp detail", "Detail and broad forms", "Simply squashed"};
};

/// Of whatever solves reliefs and has such a member.
template <class Options>
constexpr auto bounded_vertices_parameter(BoundedVertices Options::*member) {
  return parameter(
             "bounded_vertices", member, "Back of the relief",
             "Flat keeps the whole model within the thickness. May sink lets the hidden back go deeper than the plate's face, which distorts the visible side less.")
      .group("Shape");
}
template <class Options>
constexpr auto hidden_weight_parameter(double Options::*member) {
  return parameter(
             "hidden_weight", member, "How much the back matters", unit::none, 0.001, 1,
             "How much the shape of parts hidden from the viewer matters. 1: as much as the visible parts; smaller values let hidden parts distort more so that visible ones distort less.")
      .group("Shape")
      .slider(0.01, 1)
      .advanced();
}
template <class Options>
constexpr auto depth_order_parameter(bool Options::*member) {
  return parameter(
             "depth_order", member, "Keep the depth order",
             "Keeps what is in front in front, so that parts do not pass through each other. Off: parts may cross.")
      .group("Shape");
}

struct ReliefOptions {
  double thickness_mm = 5;
  double width_mm = 120;
  double plate_mm = 3;
  double margin_mm = 0;
  BaseShape base = BaseShape::flat;
  double base_depth_mm = 10;
  std::optional<double> base_pitch_mm;
  int base_steps = 5;
  double base_fold_deg = 22.5;
  BaseBend base_bend = BaseBend::bay;
  double base_turn_deg = 0;
  double base_shift_mm = 0;
  double carve_depth_mm = 0;
  double base_mesh_x_mm = 0;
  double base_mesh_y_mm = 0;
  double base_mesh_z_mm = 0;
  double base_mesh_turn_deg = 0;
  PartsOfBase base_mesh_parts = PartsOfBase::apart;
  BaseMisses base_misses = BaseMisses::refused;
  Projection projection = Projection::perspective;
  std::array<double, 3> direction{0, 0, -1};
  std::array<double, 3> up{0, 1, 0};
  double field_of_view_deg = 20;
  std::optional<double> distance_mm;
  BoundedVertices bounded_vertices = BoundedVertices::all;
  std::optional<double> outline_mm;
  bool only_outline = false;
  Appearance appearance = Appearance::detail;
  double hidden_weight = 1;
  bool depth_order = true;
  SolidKind solid = SolidKind::filled;
  double wall_mm = 2;
  double pixel_mm = 0.2;
  QpMethod method = QpMethod::automatic;
  bool compare_pictures = false;

  static constexpr auto parameters = std::tuple{
      parameter(
          "thickness_mm", &ReliefOptions::thickness_mm, "Thickness", unit::mm, 0.01, 1000,
          "How far the relief stands out from its plate; the result keeps exactly to it. More looks deeper from the side; 5 mm is usual for a width of 120 mm.")
          .group("Relief")
          .slider(0.5, 20),
      parameter("width_mm", &ReliefOptions::width_mm, "Width", unit::mm, 1, 10000,
                "Width of the model on the plate, as seen from the viewpoint.")
          .group("Relief")
          .slider(20, 400),
      parameter("plate_mm", &ReliefOptions::plate_mm, "Plate", unit::mm, 0.01, 1000,
                "Thickness of the flat plate behind the relief. Thicker is stiffer and takes more material.")
          .group("Base")
          .slider(0.5, 20),
      parameter("margin_mm", &ReliefOptions::margin_mm, "Margin", unit::mm, 0, 1000,
                "How far the plate extends beyond the model on every side. 0 ends the plate at the model's edge.")
          .group("Base")
          .slider(0, 40),
      parameter("base", &ReliefOptions::base, "Shape of the base",
                "The surface that the relief is worked into. It keeps to this surface as it keeps to a flat plate.")
          .group("Base"),
      parameter(
          "carve_depth_mm", &ReliefOptions::carve_depth_mm, "Carve into the base", unit::mm, 0, 1000,
          "How far the relief may go behind the surface of its base. 0 stands out only; 1 to 6 mm are usual for carving.")
          .group("Base")
          .slider(0, 20),
      parameter("base_depth_mm", &ReliefOptions::base_depth_mm, "Depth of the base", unit::mm, 0.01, 1000,
                "How far the deepest places of the base lie behind its foremost ones, over the width of the plate.")
          .group("Base")
          .only_with("base", "cylinder", "wave", "groove", "stairs")
          .slider(1, 60),
      parameter(
          "base_pitch_mm", &ReliefOptions::base_pitch_mm, "Width of waves or groove", unit::mm, 0.1, 10000,
          "From one crest of the waves to the next, or from edge to edge of the V groove. Automatic: the width of the plate.")
          .group("Base")
          .only_with("base", "wave", "groove")
          .slider(10, 400),
      parameter("base_steps", &ReliefOptions::base_steps, "Steps or strips", unit::none, 2, 40,
                "Number of steps, all of the same width and height, or of strips, all of the same width. Each carries "
                "a part of the picture.")
          .group("Base")
          .only_with("base", "stairs", "strips")
          .slider(2, 12),
      parameter("base_fold_deg", &ReliefOptions::base_fold_deg, "Angle between strips", unit::degrees, -90, 90,
                "How far each strip is turned against the one before. Positive: the fold stands out towards the "
                "viewer. Negative: it goes back.")
          .group("Base")
          .only_with("base", "strips")
          .slider(-45, 45),
      parameter("base_bend", &ReliefOptions::base_bend, "Bend of the strips",
                "Bay: all strips turn the same way, as in a bay window. Zigzag: they turn left and right by turns, as "
                "a folding screen.")
          .group("Base")
          .only_with("base", "strips"),
      parameter(
          "base_turn_deg", &ReliefOptions::base_turn_deg, "Turn of the base", unit::degrees, -180, 180,
          "Turns the base on the plate, counter-clockwise. At 0° waves, groove, cylinder and strips run upwards, and stairs rise upwards, away from the viewer.")
          .group("Base")
          .only_with("base", "cylinder", "wave", "groove", "stairs", "strips")
          .slider(-90, 90),
      parameter(
          "base_shift_mm", &ReliefOptions::base_shift_mm, "Shift of the base", unit::mm, -10000, 10000,
          "Moves waves, groove and cylinder to the right on the plate, and stairs upwards, before they are turned; negative values the other way. So a crest or a fold comes to lie behind the part of the model that needs it.")
          .group("Base")
          .only_with("base", "cylinder", "wave", "groove", "stairs")
          .slider(-60, 60),
      parameter(
          "base_mesh_x_mm", &ReliefOptions::base_mesh_x_mm, "Base to the right", unit::mm, -10000, 10000,
          "Moves a base from a file to the right on the plate, as seen from the viewpoint; negative values to the "
          "left.")
          .group("Base")
          .slider(-100, 100),
      parameter("base_mesh_y_mm", &ReliefOptions::base_mesh_y_mm, "Base upwards", unit::mm, -10000, 10000,
                "Moves a base from a file upwards on the plate, as seen from the viewpoint; negative values downwards.")
          .group("Base")
          .slider(-100, 100),
      parameter("base_mesh_z_mm", &ReliefOptions::base_mesh_z_mm, "Base forwards", unit::mm, -10000, 10000,
                "Moves a base from a file towards the viewer; negative values push it back into the plate.")
          .group("Base")
          .slider(-50, 50),
      parameter("base_mesh_turn_deg", &ReliefOptions::base_mesh_turn_deg, "Turn of the base file", unit::degrees, -180,
                180, "Turns a base from a file about its own origin, counter-clockwise as seen from the viewpoint.")
          .group("Base")
          .slider(-180, 180),
      parameter(
          "base_mesh_parts", &ReliefOptions::base_mesh_parts, "Parts of the base",
          "For a base from a file in parts that do not hang together: each part carries what is seen before it, in the full thickness and as a piece of its own, or all carry one surface.")
          .group("Base"),
      parameter(
          "base_misses", &ReliefOptions::base_misses, "Where the base ends",
          "For a base from a file that is smaller than the model: refuse it, or leave the parts without a base behind them free in depth.")
          .group("Base")
          .advanced(),
      parameter(
          "projection", &ReliefOptions::projection, "Distance",
          "Near shows the model in perspective from the viewing distance, as a camera would. Far shows it without perspective, as from very far away.")
          .group("Viewpoint"),
      parameter("direction", &ReliefOptions::direction, "Looking direction",
                "The direction in which the viewer looks, as x, y, z in the model's axes.")
          .group("Viewpoint")
          .advanced(),
      parameter("up", &ReliefOptions::up, "Up",
                "The direction that points up in the picture, as x, y, z in the model's axes.")
          .group("Viewpoint")
          .advanced(),
      parameter(
          "field_of_view_deg", &ReliefOptions::field_of_view_deg, "Field of view", unit::degrees, 0.1, 120,
          "Angle that the width of the model fills in the viewer's eye, for near views only. A smaller angle looks from farther away; 20° is usual.")
          .group("Viewpoint")
          .only_with("projection", "perspective")
          .slider(2, 60)
          .advanced(),
      parameter(
          "distance_mm", &ReliefOptions::distance_mm, "Viewing distance", unit::mm, 0.1, 1e7,
          "Distance from the viewpoint to the plate, for near views only. Automatic: computed from the field of view.")
          .group("Viewpoint")
          .only_with("projection", "perspective")
          .slider(50, 2000)
          .advanced(),
      bounded_vertices_parameter(&ReliefOptions::bounded_vertices),
      parameter(
          "outline_mm", &ReliefOptions::outline_mm, "Height of the outline", unit::mm, 0.01, 1000,
          "How far the outline of every separate part of the model may be from the base. 0.1 mm lets several models, or a figure, lie on the base with their edges. Automatic: as far as the thickness.")
          .group("Shape")
          .slider(0.05, 5),
      parameter(
          "only_outline", &ReliefOptions::only_outline, "Hold the outline only",
          "Puts the outline of every separate part on the base and leaves what is inside it as deep as it looks best, up to half-way to the viewpoint. The thickness then does not count; painted places keep their own limits.")
          .group("Shape")
          .advanced(),
      parameter(
          "appearance", &ReliefOptions::appearance, "Appearance",
          "Crisp detail keeps fine detail best and flattens broad forms. Detail and broad forms keeps soft, large forms too, so that the relief looks more like the model; it takes about twice as long. Simply squashed scales depth evenly and optimises nothing: to compare with.")
          .group("Shape"),
      hidden_weight_parameter(&ReliefOptions::hidden_weight),
      depth_order_parameter(&ReliefOptions::depth_order),
      parameter(
          "solid", &ReliefOptions::solid, "Solid",
          "Filled is solid from the relief down to its plate. Thick surface gives the relief a wall instead: what stands free of the plate stays open behind, as seen from the side. It needs a flat base.")
          .group("Output"),
      parameter(
          "wall_mm", &ReliefOptions::wall_mm, "Wall thickness", unit::mm, 0.1, 100,
          "Thickness of the wall behind the surface, measured along the line of sight. Thicker is stronger and closes narrow gaps; 2 mm is usual for printing.")
          .group("Output")
          .only_with("solid", "thick")
          .slider(0.5, 10),
      parameter(
          "pixel_mm", &ReliefOptions::pixel_mm, "Detail of the STL", unit::mm, 0.01, 10,
          "Spacing of the points in the height map and in the exported solid. Smaller shows finer detail and makes larger files; half the width of the nozzle or tool is fine enough.")
          .group("Output")
          .slider(0.05, 1)
          .advanced(),
      parameter(
          "method", &ReliefOptions::method, "Solver",
          "Numerical method; all give the same relief. Exchange is faster when the relief touches its limits at few points, interior point when at many; automatic chooses.")
          .group("Output")
          .advanced(),
      parameter(
          "compare_pictures", &ReliefOptions::compare_pictures, "Compare the pictures",
          "Measures how alike relief and model look from the viewpoint under 32 lights, and reports it beside the shading difference. Takes about two seconds more.")
          .group("Output")
          .advanced()};
};

}  // namespace formwright
