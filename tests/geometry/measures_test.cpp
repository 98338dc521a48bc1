// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/measures.h"

#include <gtest/gtest.h>

namespace formwright {
namespace {

TriangleMesh unit_tetrahedron() {
  TriangleMesh mesh;
  mesh.V.resize(4, 3);
  mesh.V << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  mesh.F.resize(4, 3);
  mesh.F << 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3;
  return mesh;
}

TEST(Measures, TetrahedronVolumeAndArea) {
  const TriangleMesh mesh = unit_tetrahedron();
  EXPECT_NEAR(signed_volume(mesh), 1.0 / 6, 1e-16);
  EXPECT_NEAR(surface_area(mesh), 1.5 + std::sqrt(3.0) / 2, 1e-15);
}

}  // namespace
}  // namespace formwright
