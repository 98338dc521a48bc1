// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Moulds by formulas: the exact distance outside, positive there, and its gradient. Every convex edge is rounded.
// Standing on z = 0, about 100 mm wide and 40 to 60 mm high.
#include <Eigen/Core>
#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace formwright::foreign_laboratory {

enum class Mould { dome, cone, box, pyramid, bumps, cross };
inline constexpr std::array<std::string_view, 6> mould_names = {"dome", "cone", "box", "pyramid", "bumps", "cross"};

/// Throws std::invalid_argument, which lists the names.
Mould mould_of(std::string_view name);

struct Distance {
  double mm;
  Eigen::Vector3d outward;  // unit vector
};

/// Inside, the sign is right, and the value is right up to the mould's medial surface.
Distance distance_to(Mould mould, const Eigen::Vector3d& place);

/// Height of the highest point above z = 0.
double mould_height_mm(Mould mould);

struct Triangulation {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;  // counter-clockwise from outside
};

/// Closed by a flat bottom at z = 0. No point that is checked (five of an edge, the middle of a triangle) is farther
/// than `chord_error_mm` from the mould. Edges are divided where they are farthest from it.
Triangulation triangulate(Mould mould, double chord_error_mm = 0.02);

/// Vertices in mm with seven digits.
std::string write_obj(const Triangulation& mesh);

}  // namespace formwright::foreign_laboratory
