// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the benchmarks of this module share: a mesh of any size, a clock.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <numbers>

#include "geometry/mesh/measures.h"
#include "geometry/test_meshes.h"

namespace formwright::bench {

/// Of all threads together.
inline double cpu_seconds() {
  timespec now{};
#ifdef __EMSCRIPTEN__
  clock_gettime(CLOCK_MONOTONIC, &now);
#else
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
#endif
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Waves of several lengths on a torus, the finest about ten edges long: curvature everywhere, as in scans.
inline TriangleMesh generated(int vertices) {
  const int across = std::max(3, static_cast<int>(std::sqrt(vertices / 2.5))), around = std::max(3, vertices / across);
  TriangleMesh mesh = test::torus(around, across);
  const Positions normals = vertex_normals(mesh);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const double u = 2 * std::numbers::pi * (v / across) / around, w = 2 * std::numbers::pi * (v % across) / across;
    const double height = 0.05 * std::sin(7 * u + 3 * w) + 0.01 * std::sin(41 * u) * std::sin(17 * w) +
                          1.0 / around * std::sin(0.1 * around * u) * std::sin(0.1 * across * w);
    mesh.V.row(v) += height * normals.row(v);
  }
  mesh.V *= 100;
  return mesh;
}

}  // namespace formwright::bench
