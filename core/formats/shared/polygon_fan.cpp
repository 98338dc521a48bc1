// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/shared/polygon_fan.h"

#include <vector>

#include "formats/shared/polygon_triangulation.h"

namespace formwright {

void triangulate_fans(std::span<const PolygonFan> fans, Model& model, const Context& context) {
  PolygonTriangulator triangulator;
  std::vector<Vec3> corners;
  std::vector<int> vertex, texture;
  const bool with_texture = model.FT.rows() > 0;
  int since_check = 0;
  for (const PolygonFan& fan : fans) {
    if ((since_check += fan.corners) > 10'000) {
      context.check_cancelled();
      since_check = 0;
    }
    const auto first = static_cast<Eigen::Index>(fan.first_triangle);
    const auto collect = [&](const Triangles& F, std::vector<int>& numbers) {
      numbers.assign({F(first, 0), F(first, 1)});
      for (int k = 0; k < fan.corners - 2; ++k) numbers.push_back(F(first + k, 2));
    };
    collect(model.mesh.F, vertex);
    if (with_texture) collect(model.FT, texture);
    corners.clear();
    for (const int v : vertex) corners.push_back(model.mesh.V.row(v).transpose());
    Eigen::Index row = first;
    for (const auto& triangle : triangulator.triangulate(corners)) {
      for (int k = 0; k < 3; ++k) {
        const auto corner = static_cast<std::size_t>(triangle[static_cast<std::size_t>(k)]);
        model.mesh.F(row, k) = vertex[corner];
        if (with_texture) model.FT(row, k) = texture[corner];
      }
      ++row;
    }
  }
}

}  // namespace formwright
