// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Repairs a mesh and checks what holds for every result.
#include <catch2/catch_test_macros.hpp>

#include <algorithm>
#include <array>
#include <set>
#include <string>

#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "geometry/repair/repair.h"

namespace formwright::test {

using namespace test;

inline RepairedMesh repaired(const TriangleMesh& mesh, const RepairOptions& options = {}) {
  Context context;
  return repair(mesh, options, context);
}

inline std::string said(const RepairedMesh& result) {
  std::string all;
  for (const std::string& sentence : result.sentences) all += sentence + "\n";
  return all;
}

/// What holds for every result: manifold, oriented, no flat or unused pieces, maps that point at the same place.
inline void expect_sound(const TriangleMesh& before, const RepairedMesh& after) {
  const Adjacency adjacency(after.mesh);
  REQUIRE(adjacency.nonmanifold_edge_count() == 0);
  REQUIRE(adjacency.inconsistent_edge_count() == 0);
  REQUIRE(adjacency.nonmanifold_vertices().empty());
  REQUIRE(after.mesh.V.allFinite());
  REQUIRE(after.vertex_of.size() == static_cast<std::size_t>(after.mesh.vertex_count()));
  REQUIRE(after.face_of.size() == static_cast<std::size_t>(after.mesh.face_count()));
  REQUIRE(after.corner_of.size() == static_cast<std::size_t>(3 * after.mesh.face_count()));
  for (int v = 0; v < after.mesh.vertex_count(); ++v) REQUIRE_FALSE(adjacency.outgoing(v).empty());
  std::set<std::array<int, 3>> faces;
  for (int f = 0; f < after.mesh.face_count(); ++f) {
    std::array<int, 3> corners{after.mesh.F(f, 0), after.mesh.F(f, 1), after.mesh.F(f, 2)};
    std::sort(corners.begin(), corners.end());
    REQUIRE(corners[0] < corners[1]);
    REQUIRE(corners[1] < corners[2]);
    faces.insert(corners);
    REQUIRE(after.face_of[static_cast<std::size_t>(f)] < before.face_count());
    for (int k = 0; k < 3; ++k) {
      const int old = after.corner_of[static_cast<std::size_t>(3 * f + k)];
      REQUIRE(old >= 0);
      REQUIRE(old < 3 * before.face_count());
    }
  }
  REQUIRE(after.part_count == face_components(adjacency).count);
  REQUIRE(after.hole_count == static_cast<int>(boundary_loops(adjacency).size()));
  REQUIRE(2 * after.part_count - 2 * after.genus - after.hole_count == euler_characteristic(adjacency));
}

}  // namespace formwright::test
