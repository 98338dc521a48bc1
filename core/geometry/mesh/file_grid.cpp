// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/file_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "geometry/mesh/adjacency.h"

namespace formwright {

TriangleMesh on_file_grid(const TriangleMesh& mesh) {
  const double reach = mesh.V.cwiseAbs().maxCoeff();
  for (const int bits : {22, 24, 27, 32}) {
    const double step = std::exp2(std::ceil(std::log2(reach)) - bits);
    std::map<std::array<double, 3>, int> vertex_of;
    std::vector<int> moved(static_cast<std::size_t>(mesh.V.rows()));
    std::vector<std::array<double, 3>> places;
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
      std::array<double, 3> place{};
      for (int k = 0; k < 3; ++k) place[static_cast<std::size_t>(k)] = std::round(mesh.V(i, k) / step) * step + 0.0;
      const auto [found, is_new] = vertex_of.try_emplace(place, static_cast<int>(places.size()));
      if (is_new) places.push_back(place);
      moved[static_cast<std::size_t>(i)] = found->second;
    }
    std::map<std::array<int, 3>, int> faces;  // by their corners in order, turned so that the smallest is first
    std::vector<std::array<int, 3>> order;
    for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
      std::array<int, 3> face{};
      for (int k = 0; k < 3; ++k) face[static_cast<std::size_t>(k)] = moved[static_cast<std::size_t>(mesh.F(f, k))];
      if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) continue;
      std::ranges::rotate(face, std::ranges::min_element(face));
      // Two sides of one sheet without thickness.
      if (const auto other = faces.find({face[0], face[2], face[1]}); other != faces.end() && other->second > 0) {
        --other->second;
        continue;
      }
      ++faces[face];
      order.push_back(face);
    }
    TriangleMesh result;
    result.V.resize(static_cast<Eigen::Index>(places.size()), 3);
    for (std::size_t i = 0; i < places.size(); ++i)
      result.V.row(static_cast<Eigen::Index>(i)) << places[i][0], places[i][1], places[i][2];
    std::vector<std::array<int, 3>> left;
    for (const auto& face : order)
      if (int& count = faces[face]; count > 0) {
        --count;
        left.push_back(face);
      }
    result.F.resize(static_cast<Eigen::Index>(left.size()), 3);
    for (std::size_t f = 0; f < left.size(); ++f)
      result.F.row(static_cast<Eigen::Index>(f)) << left[f][0], left[f][1], left[f][2];
    if (Adjacency(result).is_closed()) return result;
  }
  return mesh;
}

}  // namespace formwright
