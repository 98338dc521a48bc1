// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/AABB_traits_3.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <cmath>

#include "geometry/ray_oracles.h"

namespace formwright::test {
namespace {
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Iterator = std::vector<Kernel::Triangle_3>::const_iterator;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits_3<Kernel, CGAL::AABB_triangle_primitive_3<Kernel, Iterator>>>;

/// CGAL keeps two points of a ray; the second is put far away (by a power of two, which rounds nothing)
/// so that its own rounding turns the ray by no more than round-off.
Kernel::Ray_3 ray(const Vec3& o, const Vec3& d, double size) {
  const Vec3 far = d * std::exp2(std::ceil(std::log2(o.norm() + size)));
  return {Kernel::Point_3(o[0], o[1], o[2]), Kernel::Vector_3(far[0], far[1], far[2])};
}
}  // namespace

struct CgalRays::Implementation {
  std::vector<Kernel::Triangle_3> triangles;
  Tree tree;
  double size = 0;
};

CgalRays::CgalRays(const TriangleMesh& mesh) : implementation_(std::make_unique<Implementation>()) {
  auto& triangles = implementation_->triangles;
  implementation_->size = mesh.V.cwiseAbs().maxCoeff();
  for (int f = 0; f < mesh.face_count(); ++f) {
    std::array<Kernel::Point_3, 3> p;
    for (int k = 0; k < 3; ++k) {
      const Vec3 v = mesh.V.row(mesh.F(f, k));
      p[static_cast<std::size_t>(k)] = {v[0], v[1], v[2]};
    }
    triangles.emplace_back(p[0], p[1], p[2]);
  }
  implementation_->tree.insert(triangles.cbegin(), triangles.cend());
  implementation_->tree.build();
}
CgalRays::~CgalRays() = default;

std::vector<int> CgalRays::all_faces(const Vec3& origin, const Vec3& direction) const {
  std::vector<Iterator> primitives;
  implementation_->tree.all_intersected_primitives(ray(origin, direction, implementation_->size),
                                                   std::back_inserter(primitives));
  std::vector<int> faces;
  for (const Iterator it : primitives) faces.push_back(static_cast<int>(it - implementation_->triangles.cbegin()));
  std::sort(faces.begin(), faces.end());
  return faces;
}

std::optional<double> CgalRays::first_distance(const Vec3& origin, const Vec3& direction) const {
  const Kernel::Point_3 o(origin[0], origin[1], origin[2]);
  const auto found = implementation_->tree.first_intersection(ray(origin, direction, implementation_->size));
  if (!found) return std::nullopt;
  if (const auto* point = std::get_if<Kernel::Point_3>(&found->first))
    return std::sqrt(CGAL::squared_distance(o, *point));
  const auto* segment = std::get_if<Kernel::Segment_3>(&found->first);
  return std::sqrt(CGAL::squared_distance(o, *segment));
}

}  // namespace formwright::test
