// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/fabric_colours.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/mesh/adjacency.h"

namespace formwright {
namespace {

/// Triangles from the first one on, each before those beyond it, and the half-edge of each that leads back.
struct FaceTree {
  std::vector<int> order, edge_back;
};

FaceTree tree_of(const Adjacency& adjacency) {
  FaceTree tree{{0}, std::vector<int>(std::size_t(adjacency.face_count()), -1)};
  for (std::size_t i = 0; i < tree.order.size(); ++i)
    for (int h = 3 * tree.order[i]; h < 3 * tree.order[i] + 3; ++h)
      if (const int o = adjacency.opposite(h); o >= 0 && h != tree.edge_back[tree.order[i]]) {
        tree.edge_back[o / 3] = o;
        tree.order.push_back(o / 3);
      }
  return tree;
}

/// 0: all corners on the zipper's left side; 1: all on its right side; -1: neither.
int band_of(const Ribbon& ribbon, int f) {
  int left = 0, right = 0;
  for (int k = 0; k < 3; ++k)
    if (const RibbonVertex& v = ribbon.boundary[ribbon.F(f, k)]; v.sample >= 0) ++(v.left ? left : right);
  return left == 3 ? 0 : right == 3 ? 1 : -1;
}

void colour_by_bands(const Adjacency& adjacency, const FaceTree& tree, const std::vector<int>& band,
                     const std::vector<double>& area, const std::vector<double>& seam_cost, FabricColours& colours) {
  const std::size_t faces = band.size();
  // The least cost of what hangs on a triangle, by its own colour.
  std::vector<std::array<double, fabric_count>> cost(faces, {0, 0});
  for (std::size_t i = faces; i-- > 0;) {
    const int f = tree.order[i];
    if (band[f] >= 0) cost[f][1 - band[f]] += area[f];
    const int h = tree.edge_back[f];
    if (h < 0) continue;
    auto& parent = cost[adjacency.opposite(h) / 3];
    for (int c = 0; c < fabric_count; ++c) parent[c] += std::min(cost[f][c], cost[f][1 - c] + seam_cost[h]);
  }
  for (const int f : tree.order) {
    const int h = tree.edge_back[f];
    if (h < 0) {
      colours.of_face[f] = cost[f][1] < cost[f][0] ? 1 : 0;
      continue;
    }
    const int before = colours.of_face[adjacency.opposite(h) / 3];
    colours.of_face[f] = cost[f][1 - before] + seam_cost[h] < cost[f][before] ? 1 - before : before;
  }
}

void colour_by_halves(const Adjacency& adjacency, const FaceTree& tree, const std::vector<double>& area,
                      FabricColours& colours) {
  const std::size_t faces = area.size();
  std::vector<double> beyond = area;
  for (std::size_t i = faces; i-- > 1;)
    beyond[adjacency.opposite(tree.edge_back[tree.order[i]]) / 3] += beyond[tree.order[i]];
  const double half = beyond[tree.order[0]] / 2;
  int top = tree.order[1];
  for (std::size_t i = 1; i < faces; ++i)
    if (std::abs(beyond[tree.order[i]] - half) < std::abs(beyond[top] - half)) top = tree.order[i];
  for (std::size_t i = 1; i < faces; ++i) {
    const int f = tree.order[i];
    colours.of_face[f] = f == top ? 1 : colours.of_face[adjacency.opposite(tree.edge_back[f]) / 3];
  }
}

/// Of the zipper's length, where the triangles at its two sides differ in colour.
double interleaved_share(const Ribbon& ribbon, const Adjacency& adjacency, const FabricColours& colours) {
  int samples = 0;
  for (const RibbonVertex& v : ribbon.boundary) samples = std::max(samples, v.sample + 1);
  // Per step of the zipper, named by the sample before it: colours on either side.
  std::vector<std::array<int, 2>> sides(std::size_t(samples), {-1, -1});
  std::vector<double> length(std::size_t(samples), 0.0);
  for (int h = 0; h < 3 * adjacency.face_count(); ++h) {
    const RibbonVertex &a = ribbon.boundary[adjacency.from(h)], &b = ribbon.boundary[adjacency.to(h)];
    if (adjacency.opposite(h) >= 0 || a.sample < 0 || b.sample < 0 || a.piece != b.piece || a.left != b.left) continue;
    const int step = std::min(a.sample, b.sample);
    sides[step][a.left ? 0 : 1] = colours.of_face[h / 3];
    length[step] = (a.position_mm - b.position_mm).norm();
  }
  double all = 0, interleaved = 0;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    all += length[i];
    if (sides[i][0] >= 0 && sides[i][1] >= 0 && sides[i][0] != sides[i][1]) interleaved += length[i];
  }
  return all > 0 ? interleaved / all : 0;
}

}  // namespace

FabricColours two_fabrics(const Ribbon& ribbon, double width_mm) {
  const Adjacency adjacency(ribbon.formed());
  const auto faces = static_cast<std::size_t>(ribbon.F.rows());
  const auto position = [&](int v) -> const Vec3& { return ribbon.boundary[v].position_mm; };
  std::vector<int> band(faces);
  std::vector<double> area(faces), seam_cost(3 * faces);
  FabricColours colours;
  colours.of_face.assign(faces, 0);
  double on_side[fabric_count]{};
  for (std::size_t i = 0; i < faces; ++i) {
    const int f = static_cast<int>(i), a = ribbon.F(f, 0), b = ribbon.F(f, 1), c = ribbon.F(f, 2);
    band[i] = band_of(ribbon, f);
    area[i] = (position(b) - position(a)).cross(position(c) - position(a)).norm() / 2;
    if (band[i] >= 0) on_side[band[i]] += area[i];
  }
  for (int h = 0; h < static_cast<int>(seam_cost.size()); ++h)
    seam_cost[h] = 2 * width_mm * (position(adjacency.from(h)) - position(adjacency.to(h))).norm();
  const FaceTree tree = tree_of(adjacency);
  const double min_band_mm2 = 2 * width_mm * width_mm;
  colours.has_bands = std::min(on_side[0], on_side[1]) > min_band_mm2;
  if (colours.has_bands) colour_by_bands(adjacency, tree, band, area, seam_cost, colours);
  else colour_by_halves(adjacency, tree, area, colours);
  for (std::size_t f = 0; f < faces; ++f) colours.area_mm2[colours.of_face[f]] += area[f];
  for (int h = 0; h < 3 * adjacency.face_count(); ++h)
    if (const int o = adjacency.opposite(h); o > h && colours.of_face[h / 3] != colours.of_face[o / 3]) ++colours.seams;
  colours.interleaved_share = interleaved_share(ribbon, adjacency, colours);
  return colours;
}

}  // namespace formwright
