// SPDX-License-Identifier: GPL-3.0-or-later
// compare_repair: broken meshes repaired by us and by CGAL. A trial: prints the table of docs/geometry.md.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <functional>
#include <string>

#include "bench/geometry/bench_tools.h"
#include "bench/geometry/cgal/cgal_repair.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/repair/repair.h"
#include "geometry/samples/samples.h"

namespace {
using namespace formwright;
using namespace formwright::test;

struct Case {
  const char* name;
  TriangleMesh mesh;
  /// The right answer: parts, holes, and volume where it is closed (else area); 0 where there are several.
  int parts, holes;
  double measure;
};

TriangleMesh pinched_torus() {
  TriangleMesh mesh = torus(12, 6, 0.4);
  mesh.V.row(3) = mesh.V.row(6 * 6 + 3);
  mesh.V.row(6 + 3) = mesh.V.row(7 * 6 + 3);
  return mesh;
}

TriangleMesh every_third_turned(TriangleMesh mesh) {
  for (int f = 0; f < mesh.face_count(); f += 3) std::swap(mesh.F(f, 1), mesh.F(f, 2));
  return mesh;
}

TriangleMesh with_faces(const TriangleMesh& mesh, const std::vector<std::array<int, 3>>& more) {
  TriangleMesh result = make_mesh({}, more);
  return {mesh.V, (Triangles(mesh.F.rows() + result.F.rows(), 3) << mesh.F, result.F).finished()};
}

TriangleMesh without_second_wall(const TriangleMesh& cubes) {
  std::vector<std::array<int, 3>> faces;
  for (int f = 0; f < cubes.face_count(); ++f) {
    bool wall = f >= 12;
    for (int k = 0; k < 3; ++k) wall = wall && cubes.V(cubes.F(f, k), 0) == 1;
    if (!wall) faces.push_back({cubes.F(f, 0), cubes.F(f, 1), cubes.F(f, 2)});
  }
  TriangleMesh result = make_mesh({}, faces);
  result.V = cubes.V;
  return result;
}

std::vector<Case> cases() {
  const double ball = signed_volume(icosphere(2)), small_ball = signed_volume(icosphere(1));
  const TriangleMesh book =
      make_mesh({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, -1, 0}}, {{{0, 1, 2}}, {{1, 0, 3}}, {{0, 1, 4}}});
  const TriangleMesh bow =
      make_mesh({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}}, {{{0, 1, 2}}, {{0, 3, 4}}});
  const TriangleMesh crack = make_mesh({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 0}},
                                       {{{0, 1, 2}}, {{0, 2, 4}}, {{4, 2, 3}}, {{0, 4, 3}}});
  const auto cubes = [](const Vec3& shift) { return joined(cube(), moved(cube(), shift)); };
  const TriangleMesh hollow = joined(icosphere(2), reversed(moved(icosphere(1), Vec3(0, 0, 0), 0.5)));
  return {{"sound sphere", icosphere(2), 1, 0, ball},
          {"soup of triangles (STL)", unwelded(icosphere(2)), 1, 0, ball},
          {"triangles without area", with_faces(cube(), {{0, 1, 1}, {2, 2, 2}, {0, 7, 0}}), 1, 0, 1},
          {"vertex on the edge of a neighbour", crack, 1, 1, 4},
          {"duplicate triangles", with_faces(cube(), {{cube().F(0, 0), cube().F(0, 1), cube().F(0, 2)}}), 1, 0, 1},
          {"sheet given from both sides", joined(grid(3, 3), reversed(grid(3, 3))), 1, 1, 1},
          {"cubes that share an edge", cubes(Vec3(1, 1, 0)), 2, 0, 2},
          {"cubes that share a corner", cubes(Vec3(1, 1, 1)), 2, 0, 2},
          {"cubes with their wall given twice", cubes(Vec3(1, 0, 0)), 2, 0, 2},
          {"cubes with their wall given once", without_second_wall(cubes(Vec3(1, 0, 0))), 0, 0, 0},
          {"three triangles at an edge", book, 0, 0, 0},
          {"sheets that touch at a vertex", bow, 2, 2, surface_area(bow)},
          {"torus pinched at an edge", pinched_torus(), 1, 0, signed_volume(pinched_torus())},
          {"every third triangle turned", every_third_turned(icosphere(2)), 1, 0, ball},
          {"inside out", reversed(icosphere(2)), 1, 0, ball},
          {"ball with a cavity", hollow, 2, 0, ball - small_ball / 8},
          {"Möbius band", moebius_band(12), 1, 1, surface_area(moebius_band(12))},
          {"balls that cross", joined(icosphere(2), moved(icosphere(2), Vec3(1, 0, 0))), 0, 0, 0}};
}

void row(const Case& c, const char* method, const std::function<TriangleMesh()>& repair_it) {
  try {
    const double before = bench::cpu_seconds();
    const TriangleMesh mesh = repair_it();
    const double seconds = bench::cpu_seconds() - before;
    const Adjacency adjacency(mesh);
    const int parts = face_components(adjacency).count;
    const bool manifold = adjacency.is_manifold();
    const int holes = manifold ? static_cast<int>(boundary_loops(adjacency).size()) : -1;
    const double measure = holes == 0 ? signed_volume(mesh) : surface_area(mesh);
    const bool right =
        manifold && parts == c.parts && holes == c.holes && std::abs(measure - c.measure) <= 1e-9 * c.measure;
    std::printf("| %s | %s | %s | %s | %d | %s | %.4g | %d of %d | %.2g |\n", c.name, method,
                c.parts == 0 ? ""
                : right      ? "yes"
                             : "no",
                manifold ? "yes" : "no", parts, manifold ? std::to_string(holes).c_str() : "", measure,
                mesh.face_count(), c.mesh.face_count(), 1e3 * seconds);
  } catch (const std::exception& error) {
    std::printf("| %s | %s | no: %s |\n", c.name, method, error.what());
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int vertices = argc > 1 ? std::atoi(argv[1]) : 100'000;
  std::puts("| broken mesh | method | right | manifold | parts | holes | volume or area | triangles kept | ms |");
  std::puts("|---|---|---|---|---:|---:|---:|---:|---:|");
  Context context;
  std::vector<Case> all = cases();
  const TriangleMesh bust = make_sample("bust", vertices, context).mesh;
  all.push_back({"bust as a soup of triangles", unwelded(bust), 1, 0, signed_volume(bust)});
  for (const Case& c : all) {
    row(c, "ours", [&] { return repair(c.mesh, {}, context).mesh; });
    row(c, "CGAL", [&] { return bench::cgal_repair(c.mesh, false); });
    row(c, "CGAL, crossings split", [&] { return bench::cgal_repair(c.mesh, true); });
  }
}
