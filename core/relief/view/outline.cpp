// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/view/outline.h"

#include "base/parallel.h"
#include "relief/view/sight.h"
#include "relief/view/visibility.h"

namespace formwright {
namespace {

constexpr std::size_t contour_vertices_a_chunk = 256;

/// Vertices of edges between a face that is turned to the viewer and one that is not, or nothing.
std::vector<int> contour_vertices(const ViewFrame& frame, const Triangles& F, const Adjacency& adjacency) {
  std::vector<char> towards(static_cast<std::size_t>(F.rows())), marked(static_cast<std::size_t>(frame.P.rows()), 0);
  for (Eigen::Index f = 0; f < F.rows(); ++f) towards[static_cast<std::size_t>(f)] = faces_viewer(frame, frame.P, F, f);
  for (int h = 0; h < 3 * adjacency.face_count(); ++h) {
    const int other = adjacency.opposite(h);
    if (other >= 0 && towards[static_cast<std::size_t>(h / 3)] == towards[static_cast<std::size_t>(other / 3)])
      continue;
    marked[static_cast<std::size_t>(adjacency.from(h))] = marked[static_cast<std::size_t>(adjacency.to(h))] = 1;
  }
  std::vector<int> vertices;
  for (std::size_t i = 0; i < marked.size(); ++i)
    if (marked[i]) vertices.push_back(static_cast<int>(i));
  return vertices;
}

}  // namespace

std::vector<char> find_outline(const ViewFrame& frame, const Triangles& F, const Adjacency& adjacency,
                               const std::vector<int>& component, const RayCaster& caster, Context& context) {
  const std::vector<int> contour = contour_vertices(frame, F, adjacency);
  const Sight sight(frame);
  std::vector<char> outline(static_cast<std::size_t>(frame.P.rows()), 0);
  parallel_for(contour.size(), contour_vertices_a_chunk, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (std::size_t k = begin; k < end; ++k) {
      const int vertex = contour[k];
      const SightRay ray = sight.at(vertex);
      bool covered = false;
      for (const RayHit& hit : caster.all_hits(ray.origin, ray.direction, 0, sight.reach())) {
        covered = covered || (!has_corner(F, hit.face, vertex) && component[static_cast<std::size_t>(F(hit.face, 0))] ==
                                                                      component[static_cast<std::size_t>(vertex)]);
      }
      outline[static_cast<std::size_t>(vertex)] = !covered;
    }
  });
  return outline;
}

}  // namespace formwright
