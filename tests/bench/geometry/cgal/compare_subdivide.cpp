// SPDX-License-Identifier: GPL-3.0-or-later
// compare_subdivide [vertices]: Loop subdivision by CGAL and by us, on meshes with and without boundary and on a bust
// of that many vertices (50,000). The same points? How long? Rows of the table of docs/geometry.md.
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "bench/geometry/bench_tools.h"
#include "bench/geometry/cgal/cgal_subdivide.h"
#include "geometry/mesh/subdivide.h"
#include "geometry/queries/point_distance.h"
#include "geometry/samples/samples.h"

namespace {
using namespace formwright;

/// Largest distance from a vertex of one mesh to the nearest of the other, both ways, as a share of the box's diagonal.
double farthest_vertex(const TriangleMesh& a, const TriangleMesh& b) {
  const auto points = [](const TriangleMesh& mesh) {
    TriangleMesh result{mesh.V, Triangles(mesh.V.rows(), 3)};
    for (int v = 0; v < mesh.vertex_count(); ++v) result.F.row(v).setConstant(v);
    return PointDistance(result);
  };
  double largest = 0;
  const auto measure = [&](const TriangleMesh& from, const PointDistance& to) {
    for (const auto& row : from.V.rowwise()) largest = std::max(largest, to.nearest(row)->distance);
  };
  measure(a, points(b));
  measure(b, points(a));
  return largest / bounding_box(a).diagonal();
}

void row(const char* name, const TriangleMesh& mesh, int levels) {
  Context context;
  double ours = 1e30, cgal = 1e30, cgal_alone = 1e30;
  TriangleMesh first, second;
  for (int round = 0; round < 3; ++round) {
    double before = bench::cpu_seconds(), alone = 0;
    first = subdivide(mesh, SubdivisionScheme::loop, levels, context);
    ours = std::min(ours, bench::cpu_seconds() - before);
    before = bench::cpu_seconds();
    second = bench::cgal_loop(mesh, levels, alone);
    cgal = std::min(cgal, bench::cpu_seconds() - before);
    cgal_alone = std::min(cgal_alone, alone);
  }
  std::printf("| %s | %d | %d | %s | %.0e | %.2g | %.2g | %.2g |\n", name, levels, first.face_count(),
              first.vertex_count() == second.vertex_count() && first.face_count() == second.face_count() ? "yes" : "no",
              farthest_vertex(first, second), ours, cgal_alone, cgal);
}

}  // namespace

int main(int argc, char** argv) {
  const int vertices = argc > 1 ? std::atoi(argv[1]) : 50'000;
  std::puts(
      "| mesh | levels | triangles | same counts | farthest vertex / diagonal | ours s | CGAL s | CGAL with conversion s |");
  std::puts("|---|---:|---:|---|---:|---:|---:|---:|");
  row("cube", test::cube(), 4);
  row("tetrahedron", test::tetrahedron(), 4);
  row("torus", test::torus(9, 6), 4);
  row("tube, two boundaries", test::tube(8, 3), 4);
  row("square, corners on the boundary", test::grid(6, 4), 4);
  Context context;
  row("bust", make_sample("bust", vertices, context).mesh, 2);
}
