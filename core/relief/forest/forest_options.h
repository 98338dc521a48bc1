// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a maker chooses for a forest of pillars: thesis, section 3.3, "3D camouflage".
#include <tuple>

#include "geometry/samples/sample_parameters.h"
#include "relief/forest/plan/forest_layout.h"
#include "relief/forest/plan/wall_pieces.h"
#include "relief/view/relief_options.h"

namespace formwright {

/// Where the pillars come from.
enum class PillarLayout { scene, screens, grid, random };
template <>
struct EnumNames<PillarLayout> {
  static constexpr std::array<std::string_view, 4> names{"scene", "screens", "grid", "random"};
  static constexpr std::array<std::string_view, 4> labels{"As in the scene", "A screen for each viewpoint", "Grid",
                                                          "At random"};
};

enum class Intrusion { refused, allowed };
template <>
struct EnumNames<Intrusion> {
  static constexpr std::array<std::string_view, 2> names{"refused", "allowed"};
  static constexpr std::array<std::string_view, 2> labels{"Refuse", "Allow"};
};

struct ForestOptions {
  double thickness_mm = 1.5;
  double carve_depth_mm = 0;
  PillarLayout layout = PillarLayout::scene;
  PillarShape pillar_shape = PillarShape::mixed;
  double pillar_width_mm = 12;
  double pillar_height_mm = 120;
  int pillar_count = 40;
  int grid_columns = 6;
  int grid_rows = 6;
  double grid_turn_deg = 20;
  double area_width_mm = 240;
  double area_depth_mm = 240;
  double screen_outer_mm = 160;
  double screen_inner_mm = 60;
  int seed = 1;
  SharedWalls shared_walls = SharedWalls::bare;
  Intrusion intrusion = Intrusion::refused;
  double pin_diameter_mm = 4;
  double pin_depth_mm = 8;
  double pin_clearance_mm = 0.2;
  BoundedVertices bounded_vertices = BoundedVertices::all;
  double hidden_weight = 1;
  bool depth_order = true;
  double pixel_mm = 0.3;
  int check_rays = 240;
  int picture_pixels = 720;
  int scene_vertices = 20000;

  static constexpr auto parameters = std::tuple{
      parameter(
          "thickness_mm", &ForestOptions::thickness_mm, "Thickness", unit::mm, 0.1, 1000,
          "How far the pieces stand out from their pillars, at most. More looks deeper and shows more from the side; 1 to 3 mm are usual for pillars of 12 mm.")
          .group("Relief")
          .slider(0.5, 6),
      parameter(
          "carve_depth_mm", &ForestOptions::carve_depth_mm, "Carve into the pillars", unit::mm, 0, 1000,
          "How far the pieces may go behind the surface of their pillars. 0 stands out only; keep it below a quarter of the pillars' width.")
          .group("Relief")
          .slider(0, 6),
      parameter(
          "layout", &ForestOptions::layout, "Pillars",
          "Takes the pillars of the scene, or makes new ones: for each viewpoint a staggered screen that stops all its lines of sight, an even grid, or random places. Without a scene file, screens are made for the sample.")
          .group("Pillars"),
      parameter("pillar_shape", &ForestOptions::pillar_shape, "Shape", "Outline of the pillars that are made.")
          .group("Pillars")
          .only_with("layout", "screens", "grid", "random"),
      parameter(
          "pillar_width_mm", &ForestOptions::pillar_width_mm, "Width", unit::mm, 1, 10000,
          "Diameter or side of the pillars that are made; in screens about so, because each fills its lines of sight. Wider pillars show the models in fewer pieces.")
          .group("Pillars")
          .only_with("layout", "screens", "grid", "random")
          .slider(6, 40),
      parameter("pillar_height_mm", &ForestOptions::pillar_height_mm, "Height", unit::mm, 1, 100000,
                "Height of the pillars that are made. What of a model would lie above is not shown.")
          .group("Pillars")
          .only_with("layout", "screens", "grid", "random")
          .slider(40, 300),
      parameter("pillar_count", &ForestOptions::pillar_count, "Number of pillars", unit::none, 1, max_pillars,
                "How many pillars are set at random places.")
          .group("Pillars")
          .only_with("layout", "random")
          .slider(10, 120),
      parameter("grid_columns", &ForestOptions::grid_columns, "Columns", unit::none, 1, 100,
                "Number of pillars of the grid from left to right.")
          .group("Pillars")
          .only_with("layout", "grid")
          .slider(2, 12),
      parameter("grid_rows", &ForestOptions::grid_rows, "Rows", unit::none, 1, 100,
                "Number of pillars of the grid from front to back.")
          .group("Pillars")
          .only_with("layout", "grid")
          .slider(2, 12),
      parameter("grid_turn_deg", &ForestOptions::grid_turn_deg, "Turn of the grid", unit::degrees, -180, 180,
                "Turns the grid, counter-clockwise. At 0° lines of sight along its rows pass between all pillars.")
          .group("Pillars")
          .only_with("layout", "grid")
          .slider(0, 45),
      parameter("area_width_mm", &ForestOptions::area_width_mm, "Width of the area", unit::mm, 1, 100000,
                "From the leftmost to the rightmost middle of a pillar, about what the viewpoints look at.")
          .group("Pillars")
          .only_with("layout", "grid", "random")
          .slider(100, 600),
      parameter("area_depth_mm", &ForestOptions::area_depth_mm, "Depth of the area", unit::mm, 1, 100000,
                "From the foremost to the hindmost middle of a pillar, about what the viewpoints look at.")
          .group("Pillars")
          .only_with("layout", "grid", "random")
          .slider(100, 600),
      parameter("screen_outer_mm", &ForestOptions::screen_outer_mm, "Screens begin", unit::mm, 0, 100000,
                "How far before what its viewpoint looks at the foremost pillar of a screen may stand.")
          .group("Pillars")
          .only_with("layout", "screens")
          .slider(60, 400),
      parameter(
          "screen_inner_mm", &ForestOptions::screen_inner_mm, "Screens end", unit::mm, 0, 100000,
          "How far before what its viewpoint looks at the hindmost pillar of a screen must stand. Screens of viewpoints on different sides need room between them.")
          .group("Pillars")
          .only_with("layout", "screens")
          .slider(10, 200),
      parameter("seed", &ForestOptions::seed, "Seed", unit::none, 0, 1000000,
                "Another number sets the pillars at other random places; the same number gives the same places.")
          .group("Pillars")
          .only_with("layout", "screens", "random")
          .slider(1, 100),
      parameter(
          "shared_walls", &ForestOptions::shared_walls, "Surfaces seen from two sides",
          "What becomes of a surface that two viewpoints see within their pictures: it stays bare and both miss it, the one that sees it most squarely gets it and shows it to the other as well, or the scene is refused.")
          .group("Check"),
      parameter(
          "intrusion", &ForestOptions::intrusion, "Pieces of other models",
          "What to do when a piece of another model shows within the picture of a viewpoint, as rays at the finished solids find it: refuse, with the pillar that is in the way, or allow it.")
          .group("Check"),
      parameter("pin_diameter_mm", &ForestOptions::pin_diameter_mm, "Pin", unit::mm, 0.5, 1000,
                "Diameter of the round pin below each pillar.")
          .group("Floor")
          .slider(2, 20),
      parameter("pin_depth_mm", &ForestOptions::pin_depth_mm, "Length of the pin", unit::mm, 0.5, 1000,
                "How far the pin goes into the floor: a little less than the floor is thick.")
          .group("Floor")
          .slider(2, 40),
      parameter("pin_clearance_mm", &ForestOptions::pin_clearance_mm, "Clearance of the holes", unit::mm, 0, 10,
                "How much wider the holes of the floor plan are than the pins. 0.2 mm fits most printed pins.")
          .group("Floor")
          .slider(0, 1),
      bounded_vertices_parameter(&ForestOptions::bounded_vertices).advanced(),
      hidden_weight_parameter(&ForestOptions::hidden_weight),
      depth_order_parameter(&ForestOptions::depth_order).advanced(),
      parameter(
          "pixel_mm", &ForestOptions::pixel_mm, "Detail of the solids", unit::mm, 0.05, 10,
          "Spacing of the points on the pillars' surfaces at which the relief is taken. Smaller shows finer detail and takes longer.")
          .group("Output")
          .slider(0.1, 1)
          .advanced(),
      parameter("check_rays", &ForestOptions::check_rays, "Rays of the check", unit::none, 20, 2000,
                "Number of rays across the width of each model with which the finished solids are checked.")
          .group("Output")
          .slider(100, 800)
          .advanced(),
      parameter("picture_pixels", &ForestOptions::picture_pixels, "Width of the pictures", unit::none, 100, 4000,
                "Number of pixels across each picture of the forest.")
          .group("Output")
          .slider(400, 1600)
          .advanced(),
      scene_vertices_parameter(&ForestOptions::scene_vertices).group("Output")};
};

}  // namespace formwright
