// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A model's surface in triangles small enough to be carried to the sheet corner by corner.
#include <array>
#include <vector>

#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct RefinedSurface {
  TriangleMesh mesh;                                  // old vertices first
  TriangleMesh undivided;                             // the mesh as it was
  std::vector<int> face_of;                           // per face: the old one it is a part of
  std::vector<std::array<Eigen::Vector2f, 3>> place;  // per face and corner: weights of the old face's corners 1 and 2
  std::vector<char> below_plate;                      // per face: at or under z = 0
  double edge_mm = 0;                                 // the longest edge above the plate
};

/// Cuts every triangle at z = 0 (machine coordinates) and bisects the edges of what lies above until none is longer
/// than `longest_edge_mm`, or until `max_triangles`, in a way that fits together across edges. What lies in or below
/// the plate stays as it is. The order of the result depends on the mesh alone. Throws Error{invalid_input, "mesh"}:
/// indices out of range; Error{cancelled}.
RefinedSurface refine_above_plate(const TriangleMesh& mesh, double longest_edge_mm, int max_triangles,
                                  Context& context);

/// Within this height (mm) of the base plate a face that looks down counts as standing on it.
inline constexpr double plate_contact_mm = 0.01;

}  // namespace formwright
