// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/relief/rounded_box.h"

#include <array>
#include <map>
#include <vector>

namespace formwright::test {

TriangleMesh rounded_box(int squares_along_edge, double radius) {
  const int n = squares_along_edge;
  std::map<std::array<int, 3>, int> index;
  std::vector<std::array<int, 3>> nodes;
  const auto node = [&](const std::array<int, 3>& at) {
    const auto [found, is_new] = index.try_emplace(at, static_cast<int>(nodes.size()));
    if (is_new) nodes.push_back(at);
    return found->second;
  };
  std::vector<std::array<int, 3>> faces;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int a = 0; a < n; ++a)
        for (int b = 0; b < n; ++b) {
          const auto corner = [&](int da, int db) {
            std::array<int, 3> at{};
            at[axis] = side;
            at[(axis + 1) % 3] = a + da;
            at[(axis + 2) % 3] = b + db;
            return node(at);
          };
          std::array<int, 4> square{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
          if (side == 0) std::swap(square[1], square[3]);
          // Diagonals alternate, so that no direction is preferred.
          const std::size_t first = (a + b) % 2 == 0 ? 0 : 1;
          faces.push_back({square[first], square[first + 1], square[(first + 2) % 4]});
          faces.push_back({square[first], square[(first + 2) % 4], square[(first + 3) % 4]});
        }
  TriangleMesh mesh{Positions(static_cast<Eigen::Index>(nodes.size()), 3),
                    Triangles(static_cast<Eigen::Index>(faces.size()), 3)};
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Vec3 p = Vec3(nodes[i][0], nodes[i][1], nodes[i][2]) / n - Vec3::Constant(0.5);
    const Vec3 core = p.cwiseMax(radius - 0.5).cwiseMin(0.5 - radius);
    const double off = (p - core).norm();
    mesh.V.row(static_cast<Eigen::Index>(i)) = (off > 0 ? Vec3(core + radius / off * (p - core)) : p).transpose();
  }
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (int k = 0; k < 3; ++k) mesh.F(static_cast<Eigen::Index>(f), k) = faces[f][static_cast<std::size_t>(k)];
  return mesh;
}

}  // namespace formwright::test
