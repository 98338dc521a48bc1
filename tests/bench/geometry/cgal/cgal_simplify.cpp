// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/geometry/cgal/cgal_simplify.h"

#include <CGAL/Polygon_mesh_processing/angle_and_area_smoothing.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_probabilistic_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_probabilistic_triangle_policies.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_triangle_policies.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include <algorithm>
#include <optional>

#include "bench/geometry/cgal/cgal_mesh.h"
#include "geometry/mesh/measures.h"

namespace formwright::bench {
namespace {

namespace simplification = CGAL::Surface_mesh_simplification;

/// Every collapse takes one vertex, so the number that is asked for is met exactly.
struct EnoughVertices {
  std::size_t target;
  template <class Cost, class Profile, class Count>
  bool operator()(const Cost&, const Profile& profile, Count, Count) const {
    return profile.surface_mesh().number_of_vertices() <= target;
  }
};

/// Notes into which vertex each has gone, reports progress and stops when the job is cancelled.
struct Watcher : simplification::internal::Dummy_visitor {
  std::vector<int>* merged_into;
  Context* context;
  std::size_t at_first, target;
  std::size_t steps = 0;
  Watcher(std::vector<int>& merged, Context& job, std::size_t vertices, std::size_t wanted)
      : merged_into(&merged), context(&job), at_first(vertices), target(wanted) {}

  template <class Profile, class Cost, class Count>
  void OnSelected(const Profile& profile, const Cost&, Count, Count) {
    if ((steps++ & 0x1fff) == 0)
      context->progress(static_cast<double>(at_first - profile.surface_mesh().number_of_vertices()) /
                        static_cast<double>(std::max<std::size_t>(1, at_first - target)));
  }
  template <class Profile, class Vertex>
  void OnCollapsed(const Profile& profile, Vertex kept) {
    for (const auto v : {profile.v0(), profile.v1()})
      if (v != kept) (*merged_into)[v.idx()] = static_cast<int>(kept.idx());
  }
};

template <class Policies>
void collapse(CgalMesh& mesh, std::size_t target, std::vector<int>& merged_into, Context& context) {
  const Policies policies(mesh);
  simplification::edge_collapse(mesh, EnoughVertices{target},
                                CGAL::parameters::get_cost(policies.get_cost())
                                    .get_placement(policies.get_placement())
                                    .filter(simplification::Bounded_normal_change_filter<>())
                                    .visitor(Watcher(merged_into, context, mesh.number_of_vertices(), target)));
}

}  // namespace

CgalSimplified cgal_simplify(const TriangleMesh& mesh, int target, CgalQuadrics quadrics, bool smooth,
                             Context& context) {
  const BoundingBox box = bounding_box(mesh);
  const double scale = box.diagonal() > 0 ? box.diagonal() : 1;
  TriangleMesh unit = mesh;
  unit.V = (mesh.V.rowwise() - box.centre().transpose()) / scale;
  CgalMesh work = to_cgal(unit);
  std::vector<int> merged_into(static_cast<std::size_t>(mesh.vertex_count()), -1);
  const auto wanted = static_cast<std::size_t>(target);
  switch (quadrics) {
    case CgalQuadrics::plane:
      collapse<simplification::GarlandHeckbert_plane_policies<CgalMesh, CgalKernel>>(work, wanted, merged_into,
                                                                                     context);
      break;
    case CgalQuadrics::triangle:
      collapse<simplification::GarlandHeckbert_triangle_policies<CgalMesh, CgalKernel>>(work, wanted, merged_into,
                                                                                        context);
      break;
    case CgalQuadrics::probabilistic_plane:
      collapse<simplification::GarlandHeckbert_probabilistic_plane_policies<CgalMesh, CgalKernel>>(
          work, wanted, merged_into, context);
      break;
    case CgalQuadrics::probabilistic_triangle:
      collapse<simplification::GarlandHeckbert_probabilistic_triangle_policies<CgalMesh, CgalKernel>>(
          work, wanted, merged_into, context);
      break;
  }
  if (smooth)
    CGAL::Polygon_mesh_processing::angle_and_area_smoothing(
        work,
        CGAL::parameters::number_of_iterations(5).use_area_smoothing(false).use_safety_constraints(true).do_project(
            true));
  CgalSimplified result;
  std::vector<int> name;
  result.mesh = from_cgal(work, &name);
  result.mesh.V = ((result.mesh.V * scale).rowwise() + box.centre().transpose()).eval();
  result.new_vertex_of.resize(merged_into.size());
  for (std::size_t v = 0; v < merged_into.size(); ++v) {
    std::size_t kept = v;
    while (merged_into[kept] >= 0) kept = static_cast<std::size_t>(merged_into[kept]);
    result.new_vertex_of[v] = name[kept];
  }
  return result;
}

}  // namespace formwright::bench
