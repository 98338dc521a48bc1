// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Meshes from places and faces that were listed one by one.
#include <vector>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// `faces`: indices of `places`.
inline TriangleMesh mesh_of(const std::vector<Vec3>& places, const std::vector<Eigen::Vector3i>& faces) {
  TriangleMesh mesh;
  mesh.V.resize(static_cast<Eigen::Index>(places.size()), 3);
  for (std::size_t i = 0; i < places.size(); ++i) mesh.V.row(static_cast<Eigen::Index>(i)) = places[i].transpose();
  mesh.F.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) mesh.F.row(static_cast<Eigen::Index>(f)) = faces[f].transpose();
  return mesh;
}

}  // namespace formwright
