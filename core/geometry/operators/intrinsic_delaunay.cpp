// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/operators/intrinsic_delaunay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>

#include "base/error.h"
#include "base/index.h"
#include "geometry/mesh/adjacency.h"

namespace formwright {
namespace {

/// Fraction of the mean edge length by which two sides of a triangle exceed the third, at least.
constexpr double min_slack = 1e-8;
/// An edge counts as Delaunay while cot a + cot b >= -tolerance: four points on one circle (every
/// square of a grid) must not flip to and fro.
constexpr double cotangent_tolerance = 1e-10;

void mollify(IntrinsicTriangulation& t) {
  double sum = 0;
  for (const double l : t.length) sum += l;
  const double slack = min_slack * sum / static_cast<double>(t.length.size());
  double missing = 0;
  for (int f = 0; f < t.face_count(); ++f) {
    const double a = t.length[index(3 * f)], b = t.length[index(3 * f + 1)], c = t.length[index(3 * f + 2)];
    missing = std::max({missing, slack + a - b - c, slack + b - c - a, slack + c - a - b});
  }
  if (missing <= 0) return;
  t.lengthened_by = missing;
  for (double& l : t.length) l += missing;
}

double opposite_cotangent(const IntrinsicTriangulation& t, int h) {
  return cotangent_from_lengths(t.length[index(h)], t.length[index(next_halfedge(h))],
                                t.length[index(previous_halfedge(h))]);
}

/// Length of the other diagonal of the two triangles beside h, unfolded into the plane.
double flipped_length(const IntrinsicTriangulation& t, int h, int g) {
  const double base = t.length[index(h)];
  const auto apex = [&](double from_start, double from_end) {
    const double x = (base * base + (from_start - from_end) * (from_start + from_end)) / (2 * base);
    return std::array{x, 2 * area_from_lengths(base, from_start, from_end) / base};
  };
  // h runs i -> j and g runs j -> i; k lies left of h and l left of g.
  const auto [kx, ky] = apex(t.length[index(previous_halfedge(h))], t.length[index(next_halfedge(h))]);
  const auto [lx, ly] = apex(t.length[index(next_halfedge(g))], t.length[index(previous_halfedge(g))]);
  return std::hypot(kx - lx, ky + ly);
}

/// Replaces the edge i-j of faces (i, j, k) and (j, i, l) by k-l. The four outer sides move to other
/// slots of the same two faces; they may be glued to one another, so gluing is mapped as well.
void flip(IntrinsicTriangulation& t, int h, int g, double new_length) {
  const int h1 = next_halfedge(h), h2 = previous_halfedge(h), g1 = next_halfedge(g), g2 = previous_halfedge(g);
  // Face of h becomes (l, k, i) = [l->k, k->i, i->l], face of g becomes (k, l, j) = [k->l, l->j, j->k].
  const std::array<int, 4> old_slot{h2, g1, g2, h1}, new_slot{h1, h2, g1, g2};
  std::array<int, 4> vertex{}, across{};
  std::array<double, 4> side{};
  for (std::size_t i = 0; i < 4; ++i) {
    vertex[i] = t.from[index(old_slot[i])];
    across[i] = t.opposite[index(old_slot[i])];
    side[i] = t.length[index(old_slot[i])];
    for (std::size_t j = 0; j < 4; ++j)
      if (across[i] == old_slot[j]) {
        across[i] = new_slot[j];
        break;
      }
  }
  const int k = t.from[index(h2)], l = t.from[index(g2)];
  for (std::size_t i = 0; i < 4; ++i) {
    t.from[index(new_slot[i])] = vertex[i];
    t.opposite[index(new_slot[i])] = across[i];
    t.length[index(new_slot[i])] = side[i];
    if (across[i] >= 0) t.opposite[index(across[i])] = new_slot[i];
  }
  t.from[index(h)] = l;
  t.from[index(g)] = k;
  t.length[index(h)] = t.length[index(g)] = new_length;
  ++t.flips;
}

}  // namespace

double area_from_lengths(double a, double b, double c) {
  if (a < b) std::swap(a, b);
  if (b < c) std::swap(b, c);
  if (a < b) std::swap(a, b);
  const double product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
  return product > 0 ? 0.25 * std::sqrt(product) : 0;
}

double cotangent_from_lengths(double a, double b, double c) {
  return (b * b + (c - a) * (c + a)) / (4 * area_from_lengths(a, b, c));
}

IntrinsicTriangulation intrinsic_triangulation(const TriangleMesh& mesh) {
  const Adjacency adjacency(mesh);
  if (adjacency.nonmanifold_edge_count() > 0 || adjacency.inconsistent_edge_count() > 0)
    throw Error(ErrorCode::invalid_input, "mesh",
                "An edge joins more than two triangles or two that face opposite ways; repair the mesh first.");
  IntrinsicTriangulation t;
  t.vertex_count = mesh.vertex_count();
  const int halfedges = 3 * mesh.face_count();
  t.from.resize(index(halfedges));
  t.opposite.resize(index(halfedges));
  t.length.resize(index(halfedges));
  for (int h = 0; h < halfedges; ++h) {
    t.from[index(h)] = adjacency.from(h);
    t.opposite[index(h)] = adjacency.opposite(h);
    const Edge edge = adjacency.edges()[index(adjacency.edge_of(h))];  // the same order on both sides
    t.length[index(h)] = (mesh.V.row(edge.higher) - mesh.V.row(edge.lower)).norm();
  }
  if (halfedges > 0) mollify(t);
  return t;
}

IntrinsicTriangulation intrinsic_delaunay(const TriangleMesh& mesh, Context& context) {
  IntrinsicTriangulation t = intrinsic_triangulation(mesh);
  const int halfedges = static_cast<int>(t.from.size());
  std::deque<int> queue;
  std::vector<char> queued(t.from.size(), 0);
  const auto enqueue = [&](int h) {
    const int g = t.opposite[index(h)];
    if (g < 0 || queued[index(std::min(h, g))]) return;
    queued[index(std::min(h, g))] = 1;
    queue.push_back(std::min(h, g));
  };
  for (int h = 0; h < halfedges; ++h) enqueue(h);

  // Flipping ends, but no bound linear in the size is known; real meshes need fewer flips than edges.
  const long long limit = 1000LL * halfedges;
  long long steps = 0;
  while (!queue.empty()) {
    if ((++steps & 0xffff) == 0) context.check_cancelled();
    if (t.flips > limit)
      throw Error(ErrorCode::could_not_solve, "mesh",
                  "The triangles are too distorted to be improved; repair or remesh the mesh.");
    const int h = queue.front();
    queue.pop_front();
    queued[index(h)] = 0;
    const int g = t.opposite[index(h)];
    if (g < 0 || h / 3 == g / 3) continue;  // an edge inside a vertex of degree one is always Delaunay
    if (!(opposite_cotangent(t, h) + opposite_cotangent(t, g) < -cotangent_tolerance)) continue;
    flip(t, h, g, flipped_length(t, h, g));
    for (const int side : {next_halfedge(h), previous_halfedge(h), next_halfedge(g), previous_halfedge(g)})
      enqueue(side);
  }
  return t;
}

}  // namespace formwright
