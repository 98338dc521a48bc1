// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/samples/remeshing/remesh.h"

#include <algorithm>
#include <utility>

#include "base/index.h"
#include "geometry/samples/remeshing/remesher.h"

namespace formwright::samples {

Surface remesh(const Surface& surface, std::vector<int>& patch, const TargetShape& target, int vertex_count,
               Context& context) {
  return Remesher(surface, patch, target, vertex_count, -1, context).run(patch);
}

Surface remesh_open(const Surface& surface, const std::function<int(const Point&, const Point&)>& side,
                    const TargetShape& target, int vertex_count, Context& context) {
  Surface closed = surface;
  const int ghost = static_cast<int>(surface.points.size());
  closed.points.push_back({0, 0, 0});
  std::vector<int> patch(surface.triangles.size(), 0);
  // Boundary edges are the directed edges without a reverse.
  std::vector<std::pair<std::pair<int, int>, int>> edges;  // (low, high), direction
  for (const Corners& t : surface.triangles)
    for (std::size_t c = 0; c < 3; ++c) {
      const int a = t[c], b = t[(c + 1) % 3];
      edges.push_back({{std::min(a, b), std::max(a, b)}, a < b ? 1 : 0});
    }
  std::sort(edges.begin(), edges.end());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (e + 1 < edges.size() && edges[e].first == edges[e + 1].first) {
      ++e;
      continue;
    }
    const auto [low, high] = edges[e].first;
    const int a = edges[e].second == 1 ? low : high, b = edges[e].second == 1 ? high : low;
    closed.triangles.push_back({b, a, ghost});
    patch.push_back(first_rim_patch + side(surface.points[index(a)], surface.points[index(b)]));
  }
  Surface result = Remesher(closed, patch, target, vertex_count, ghost, context).run(patch);
  // The ghost keeps its place among the vertices that came before it: find it by its triangles.
  int last = -1;
  Surface open;
  for (std::size_t f = 0; f < result.triangles.size(); ++f) {
    if (patch[f] < first_rim_patch) {
      open.triangles.push_back(result.triangles[f]);
    } else if (last < 0) {
      const Corners& t = result.triangles[f];
      for (const int v : t)
        if (result.points[index(v)] == Point{0, 0, 0}) last = v;
    }
  }
  for (int v = 0; v < static_cast<int>(result.points.size()); ++v)
    if (v != last) open.points.push_back(result.points[index(v)]);
  for (Corners& t : open.triangles)
    for (int& v : t) v -= v > last ? 1 : 0;
  return open;
}

}  // namespace formwright::samples
