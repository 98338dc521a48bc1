// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Free-standing pillars: upright prisms over outlines in the floor plan.
#include <optional>
#include <string_view>
#include <vector>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// Corners in the floor plan, mm, counter-clockwise, the last joined to the first. Edge k goes from corner k to k + 1.
using Outline = std::vector<Vec2>;

/// A shape with a name: what a maker edits in the place of corners.
struct PillarForm {
  enum class Shape { round, square, hexagon };
  Shape shape = Shape::round;
  Vec2 centre{0, 0};
  double width_mm = 0;  // diameter of the round one and around the hexagon's corners; side of the square
  double turn_deg = 0;  // counter-clockwise; at 0 a square's sides lie along x and y, and a hexagon has a corner on x
};
std::string_view name_of(PillarForm::Shape shape);
std::optional<PillarForm::Shape> shape_called(std::string_view name);
/// A round one has 48 corners, which do not turn.
Outline outline_of(const PillarForm& form);

struct Pillar {
  Outline outline_mm;
  double height_mm = 0;                           // from the floor, z = 0
  std::optional<PillarForm> form = std::nullopt;  // what the outline was made of
};
/// Of a shape with a name.
Pillar pillar_of(const PillarForm& form, double height_mm);

/// A polygon with `corners` corners on a circle, the first `turn_deg` from x towards y.
Outline round_outline(const Vec2& centre, double diameter_mm, int corners, double turn_deg = 0);
/// `turn_deg`: counter-clockwise; at 0 the sides lie along x and y.
Outline square_outline(const Vec2& centre, double side_mm, double turn_deg);

const Vec2& corner(const Outline& outline, int k);  // of any k from 0 to twice the number of corners

double outline_area_mm2(const Outline& outline);  // positive if counter-clockwise
Vec2 outline_centroid(const Outline& outline);
bool is_inside(const Outline& outline, const Vec2& p);
double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b);
double distance_to_outline(const Outline& outline, const Vec2& p);  // of the line, also from inside
/// 0 where they cross or one holds the other. Of outlines whose boxes are `enough` apart or more, the distance of
/// these.
double distance_between(const Outline& a, const Outline& b, double enough = 1e300);
/// Whether two of its edges cross or touch, neighbours apart at their common corner.
bool crosses_itself(const Outline& outline);
/// A place far from the outline within it: the centroid, or of a grid of points the one that is farthest where that is
/// much better.
Vec2 place_of_pin(const Outline& outline);

/// The prism as a closed mesh, faces outwards.
TriangleMesh prism(const Outline& outline, double bottom_mm, double top_mm);

}  // namespace formwright
