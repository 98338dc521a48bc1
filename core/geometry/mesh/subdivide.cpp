// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/subdivide.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/index.h"
#include "geometry/mesh/adjacency.h"

namespace formwright {
namespace {

/// Weight of each of n neighbours (Loop 1987).
double loop_weight(int n) {
  const double c = 3.0 / 8 + std::cos(2 * std::numbers::pi / n) / 4;
  return (5.0 / 8 - c * c) / n;
}

/// The two neighbours along the boundary; sums their positions.
Vec3 boundary_neighbours(const Positions& V, const Adjacency& adjacency, int v) {
  Vec3 sum = Vec3::Zero();
  for (const int u : adjacency.neighbours(v))
    if (adjacency.is_boundary_edge(adjacency.find_edge(u, v))) sum += V.row(u);
  return sum;
}

Vec3 neighbour_sum(const Positions& V, const Adjacency& adjacency, int v) {
  Vec3 sum = Vec3::Zero();
  for (const int u : adjacency.neighbours(v)) sum += V.row(u);
  return sum;
}

Adjacency checked_adjacency(const TriangleMesh& mesh) {
  Adjacency adjacency(mesh);
  if (adjacency.nonmanifold_edge_count() > 0 || adjacency.inconsistent_edge_count() > 0)
    throw Error(ErrorCode::invalid_input, "mesh",
                "An edge joins more than two triangles or two that face opposite ways; repair the mesh first.");
  return adjacency;
}

void check_levels(const Triangles& F, int levels) {
  if (levels < 0 || levels > 12 || std::ldexp(static_cast<double>(F.rows()), 2 * levels) > std::ldexp(1.0, 28))
    throw Error(ErrorCode::invalid_input, "levels",
                std::to_string(levels) + " levels make too many triangles; choose fewer, or simplify the mesh first.");
}

/// Faces of the next level, given the number of the new vertex on each half-edge.
template <class MiddleOf>
Triangles split_faces(const Triangles& F, const MiddleOf& middle_of) {
  Triangles finer(4 * F.rows(), 3);
  for (int f = 0; f < static_cast<int>(F.rows()); ++f) {
    const int ab = middle_of(3 * f), bc = middle_of(3 * f + 1), ca = middle_of(3 * f + 2);
    finer.row(4 * f) << F(f, 0), ab, ca;
    finer.row(4 * f + 1) << ab, F(f, 1), bc;
    finer.row(4 * f + 2) << ca, bc, F(f, 2);
    finer.row(4 * f + 3) << ab, bc, ca;
  }
  return finer;
}

/// One level of values that are interpolated along edges.
template <class Values>
void append_midpoints(Values& values, const Adjacency& adjacency) {
  const Eigen::Index n = values.rows();
  values.conservativeResize(n + adjacency.edge_count(), values.cols());
  for (int e = 0; e < adjacency.edge_count(); ++e) {
    const Edge edge = adjacency.edges()[index(e)];
    values.row(n + e) = 0.5 * (values.row(edge.lower) + values.row(edge.higher));
  }
}

Positions loop_positions(const Positions& V, const Adjacency& adjacency) {
  const int n = adjacency.vertex_count();
  Positions finer(n + adjacency.edge_count(), 3);
  for (int v = 0; v < n; ++v) {
    const Vec3 old = V.row(v);
    const int degree = static_cast<int>(adjacency.neighbours(v).size());
    if (degree == 0) {
      finer.row(v) = old;
    } else if (adjacency.is_boundary_vertex(v)) {
      finer.row(v) = 0.75 * old + 0.125 * boundary_neighbours(V, adjacency, v);
    } else {
      const double weight = loop_weight(degree);
      finer.row(v) = (1 - degree * weight) * old + weight * neighbour_sum(V, adjacency, v);
    }
  }
  for (int e = 0; e < adjacency.edge_count(); ++e) {
    const Edge edge = adjacency.edges()[index(e)];
    const Vec3 ends = V.row(edge.lower) + V.row(edge.higher);
    const auto along = adjacency.halfedges_of_edge(e);
    if (along.size() == 2) {
      const Vec3 apexes =
          V.row(adjacency.from(previous_halfedge(along[0]))) + V.row(adjacency.from(previous_halfedge(along[1])));
      finer.row(n + e) = 0.375 * ends + 0.125 * apexes;
    } else {
      finer.row(n + e) = 0.5 * ends;
    }
  }
  return finer;
}

void refine(TriangleMesh& mesh, const Adjacency& adjacency, SubdivisionScheme scheme) {
  const int n = mesh.vertex_count();
  if (scheme == SubdivisionScheme::loop) {
    mesh.V = loop_positions(mesh.V, adjacency);
  } else {
    append_midpoints(mesh.V, adjacency);
  }
  mesh.F = split_faces(mesh.F, [&](int h) { return n + adjacency.edge_of(h); });
}

}  // namespace

TriangleMesh subdivide(const TriangleMesh& mesh, SubdivisionScheme scheme, int levels, Context& context) {
  check_levels(mesh.F, levels);
  TriangleMesh result = mesh;
  for (int level = 0; level < levels; ++level) {
    context.progress(std::ldexp(1.0, 2 * (level - levels)), "Subdividing");
    refine(result, checked_adjacency(result), scheme);
  }
  return result;
}

Model subdivide(const Model& model, SubdivisionScheme scheme, int levels, Context& context) {
  check_levels(model.mesh.F, levels);
  Model result = model;
  const bool colours = model.vertex_colours.rows() == model.mesh.V.rows() && model.mesh.V.rows() > 0;
  const bool textured = model.FT.rows() == model.mesh.F.rows() && model.FT.rows() > 0;
  for (int level = 0; level < levels; ++level) {
    context.progress(std::ldexp(1.0, 2 * (level - levels)), "Subdividing");
    const Adjacency adjacency = checked_adjacency(result.mesh);
    if (colours) append_midpoints(result.vertex_colours, adjacency);
    if (textured) {
      // The texture has edges of its own: seams are where they outnumber those of the surface.
      TriangleMesh texture;
      texture.V = Positions::Zero(result.UV.rows(), 3);
      texture.F = result.FT;
      const Adjacency seams(texture);
      const int n = static_cast<int>(result.UV.rows());
      append_midpoints(result.UV, seams);
      result.FT = split_faces(result.FT, [&](int h) { return n + seams.edge_of(h); });
    }
    refine(result.mesh, adjacency, scheme);
  }
  const auto inherited = [&](const std::vector<int>& of_old) {
    std::vector<int> of_new(of_old.empty() ? 0 : index(result.mesh.face_count()));
    for (std::size_t f = 0; f < of_new.size(); ++f) of_new[f] = of_old[f >> (2 * levels)];
    return of_new;
  };
  result.face_group = inherited(model.face_group);
  result.face_material = inherited(model.face_material);
  return result;
}

Positions loop_limit(const TriangleMesh& mesh) {
  const Adjacency adjacency = checked_adjacency(mesh);
  Positions limit = mesh.V;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3 old = mesh.V.row(v);
    const int degree = static_cast<int>(adjacency.neighbours(v).size());
    if (degree == 0) continue;
    if (adjacency.is_boundary_vertex(v)) {
      limit.row(v) = (4 * old + boundary_neighbours(mesh.V, adjacency, v)) / 6;  // the cubic spline along the boundary
    } else {
      const double chi = 1 / (3 / (8 * loop_weight(degree)) + degree);
      limit.row(v) = (1 - degree * chi) * old + chi * neighbour_sum(mesh.V, adjacency, v);
    }
  }
  return limit;
}

}  // namespace formwright
