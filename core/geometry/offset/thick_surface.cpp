// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/offset/thick_surface.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "base/error.h"

namespace formwright {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Wrap = CGAL::Surface_mesh<Kernel::Point_3>;

constexpr double wrap_precision = 0.01;  // of the offset: Alpha_wrap_3/internal/Oracle_base.h, first_intersection
constexpr int points_a_check = 64;

/// CGAL's hooks, for cancel and a limit of memory.
struct Watcher : CGAL::Alpha_wraps_3::internal::Wrapping_default_visitor {
  Watcher(Context& watched, int limit) : context(&watched), max_points(limit) {}
  template <class Wrapper, class Point>
  void before_Steiner_point_insertion(const Wrapper&, const Point&) {
    if (++points % points_a_check == 0) context->check_cancelled();
    if (points > max_points)
      throw Error(ErrorCode::invalid_input, "wall_mm",
                  "The wall is too fine for a surface of this size: raise wall_mm, or make the relief narrower.");
  }
  Context* context;
  int max_points;
  int points = 0;
};

}  // namespace

ThickSurface thick_surface(const TriangleMesh& surface, const ThickSurfaceOptions& options, Context& context) {
  if (!(options.wall_mm > 0) || !(options.opening_mm > 0))
    throw Error(ErrorCode::invalid_input, "wall_mm", "The wall needs a thickness above 0 mm.");
  if (!surface.V.allFinite())
    throw Error(ErrorCode::invalid_input, "mesh", "The surface has places that are not finite numbers.");
  std::vector<Kernel::Point_3> points;
  points.reserve(static_cast<std::size_t>(surface.V.rows()));
  for (Eigen::Index i = 0; i < surface.V.rows(); ++i)
    points.emplace_back(surface.V(i, 0), surface.V(i, 1), surface.V(i, 2));
  std::vector<std::array<std::size_t, 3>> faces;
  for (Eigen::Index f = 0; f < surface.F.rows(); ++f) {
    const auto corner = [&](int k) { return static_cast<std::size_t>(surface.F(f, k)); };
    const std::array<std::size_t, 3> face{corner(0), corner(1), corner(2)};
    // CGAL drops triangles without an area itself, but says so on the error stream.
    if (!CGAL::collinear(points[face[0]], points[face[1]], points[face[2]])) faces.push_back(face);
  }
  if (faces.empty()) throw Error(ErrorCode::invalid_input, "mesh", "The surface has no triangle with an area.");

  ThickSurface result;
  result.reach_mm = std::hypot(options.wall_mm, options.opening_mm) / (1 - wrap_precision);
  Watcher watcher(context, options.max_vertices);
  Wrap wrap;
  CGAL::alpha_wrap_3(points, faces, options.opening_mm, result.reach_mm, wrap,
                     CGAL::parameters::visitor(std::ref(watcher)));
  context.check_cancelled();

  std::vector<int> index(wrap.num_vertices() + wrap.number_of_removed_vertices(), -1);
  result.mesh.V.resize(static_cast<Eigen::Index>(wrap.number_of_vertices()), 3);
  Eigen::Index count = 0;
  for (const auto v : wrap.vertices()) {
    index[v.idx()] = static_cast<int>(count);
    const auto& p = wrap.point(v);
    result.mesh.V.row(count++) << p.x(), p.y(), p.z();
  }
  result.mesh.F.resize(static_cast<Eigen::Index>(wrap.number_of_faces()), 3);
  count = 0;
  for (const auto f : wrap.faces()) {
    int k = 0;
    for (const auto v : wrap.vertices_around_face(wrap.halfedge(f))) result.mesh.F(count, k++) = index[v.idx()];
    ++count;
  }
  return result;
}

}  // namespace formwright
