// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/simplify.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <numbers>

#include "base/error.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "geometry/queries/point_distance.h"
#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using namespace test;

TriangleMesh simplified(const TriangleMesh& mesh, int target, bool drop = false) {
  Context context;
  return simplify(mesh, {target, drop}, context);
}

/// A closed surface with bumps of several sizes, genus 1.
TriangleMesh bumpy_torus(int around, int across) {
  TriangleMesh mesh = torus(around, across, 0.4);
  const Positions normals = vertex_normals(mesh);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const double u = std::atan2(mesh.V(v, 1), mesh.V(v, 0));
    mesh.V.row(v) += (0.05 * std::sin(7 * u) + 0.02 * std::sin(30 * mesh.V(v, 2))) * normals.row(v);
  }
  return mesh;
}

TEST_CASE("Simplify.KeepsTheTopology") {
  struct Case {
    const char* name;
    TriangleMesh mesh;
    int target;
  };
  for (const Case& c : std::vector<Case>{{"sphere", icosphere(4), 200},
                                         {"torus", bumpy_torus(80, 40), 300},
                                         {"grid", grid(40, 40, 0.3), 200},
                                         {"tube", tube(60, 40), 150},
                                         {"two parts", joined(icosphere(3), moved(torus(40, 20), Vec3(4, 0, 0))), 200},
                                         {"to the limit", torus(30, 20), 4},
                                         {"sphere to the limit", icosphere(3), 4},
                                         {"tube to the limit", tube(20, 10), 4}}) {
    INFO(c.name);
    const TriangleMesh result = simplified(c.mesh, c.target);
    const Adjacency before(c.mesh), after(result);
    CHECK(after.is_manifold());
    CHECK(result.V.allFinite());
    CHECK(euler_characteristic(after) == euler_characteristic(before));
    CHECK(boundary_loops(after).size() == boundary_loops(before).size());
    CHECK(face_components(after).count == face_components(before).count);
    if (c.target > 4) {
      CHECK(result.vertex_count() == c.target);
    }
    CHECK(vertex_components(after).count == face_components(after).count);  // no unused vertices
  }
  CHECK(simplified(icosphere(3), 4).vertex_count() == 4);
}

TEST_CASE("Simplify.SmallEnoughIsLeftAlone") {
  const TriangleMesh mesh = torus(10, 8);
  CHECK(simplified(mesh, 80).V == mesh.V);
  CHECK(simplified(mesh, 80).F == mesh.F);
}

TEST_CASE("Simplify.PlanesStayExact") {
  // Everything stays in the plane, the square keeps its corners and its area.
  const TriangleMesh result = simplified(grid(30, 30, 0.3), 60);
  CHECK(result.V.col(2).cwiseAbs().maxCoeff() < 1e-12);
  CHECK_THAT(surface_area(result), WithinAbs(1, 2e-3));
  const BoundingBox box = bounding_box(result);
  CHECK_THAT(box.size().x(), WithinAbs(1, 1e-3));
  CHECK_THAT(box.size().y(), WithinAbs(1, 1e-3));
}

TEST_CASE("Simplify.SharpEdgesStay") {
  // A finely split cube: the Hausdorff distance stays far below the edge length of the result.
  Context context;
  TriangleMesh fine = cube();
  for (int level = 0; level < 5; ++level) {
    const Adjacency adjacency(fine);
    TriangleMesh finer;
    const int n = fine.vertex_count();
    finer.V.resize(n + adjacency.edge_count(), 3);
    finer.V.topRows(n) = fine.V;
    for (int e = 0; e < adjacency.edge_count(); ++e) {
      const Edge edge = adjacency.edges()[static_cast<std::size_t>(e)];
      finer.V.row(n + e) = 0.5 * (fine.V.row(edge.lower) + fine.V.row(edge.higher));
    }
    finer.F.resize(4 * fine.F.rows(), 3);
    for (int f = 0; f < fine.face_count(); ++f) {
      const int ab = n + adjacency.edge_of(3 * f), bc = n + adjacency.edge_of(3 * f + 1),
                ca = n + adjacency.edge_of(3 * f + 2);
      finer.F.row(4 * f) << fine.F(f, 0), ab, ca;
      finer.F.row(4 * f + 1) << ab, fine.F(f, 1), bc;
      finer.F.row(4 * f + 2) << ca, bc, fine.F(f, 2);
      finer.F.row(4 * f + 3) << ab, bc, ca;
    }
    fine = finer;
  }
  const TriangleMesh result = simplified(fine, 200);
  CHECK(hausdorff_distance(fine, result, 0.02, context) < 0.02);
  CHECK_THAT(signed_volume(result), WithinAbs(1, 0.01));
}

TEST_CASE("Simplify.DistanceFallsQuadratically") {
  // A smooth surface with n vertices can be met to within O(1 / n); four times the vertices, a quarter of
  // the mean distance.
  Context context;
  const TriangleMesh mesh = icosphere(6);
  double previous = 0;
  for (const int target : {150, 600, 2400}) {
    const TriangleMesh result = simplified(mesh, target);
    const SurfaceDistance distance = surface_distance(mesh, PointDistance(result), 0.05, context);
    if (previous > 0) {
      INFO(target);
      CHECK_THAT(std::log2(previous / distance.mean), WithinAbs(2, 0.35));
    }
    previous = distance.mean;
    // An inscribed or best-fitting polyhedron with equilateral triangles of edge h errs by h^2 / 6 at worst.
    const double edge_squared = 4 / std::sqrt(3.0) * 4 * std::numbers::pi / (2.0 * target);
    INFO(target);
    CHECK(distance.maximum < edge_squared / 2);
  }
}

TEST_CASE("Simplify.TrianglesAreWellShaped") {
  struct Case {
    const char* name;
    TriangleMesh mesh;
    double minimum, hundredth, median;  // degrees: of the worst triangle, the worst hundredth, the usual one
  };
  // Measured 33.8, 35.4, 49.6; 11.4, 14.9, 36.6 (the waves of the torus stretch its triangles); 16.5, 21.0, 46.1.
  // The bunny to 5000 vertices has 12, 21, 44; without the improvement at the end it had 11, 16, 39.
  for (const Case& c : std::vector<Case>{{"sphere", icosphere(5), 30, 33, 48},
                                         {"torus", bumpy_torus(120, 60), 10, 14, 35.5},
                                         {"grid", grid(80, 80, 0.3), 15, 19.5, 45}}) {
    INFO(c.name);
    const TriangleMesh result = simplified(c.mesh, c.mesh.vertex_count() / 10);
    const Eigen::VectorXd minimum = corner_angles(result).rowwise().minCoeff() * (180 / std::numbers::pi);
    std::vector<double> sorted(minimum.begin(), minimum.end());
    std::sort(sorted.begin(), sorted.end());
    CHECK(sorted[0] > c.minimum);
    CHECK(sorted[sorted.size() / 100] > c.hundredth);
    CHECK(sorted[sorted.size() / 2] > c.median);
  }
}

TEST_CASE("Simplify.NoFaceTurnsOver") {
  const TriangleMesh mesh = icosphere(5), result = simplified(mesh, 150);
  const Positions normals = face_normals(result);
  for (int f = 0; f < result.face_count(); ++f) {
    const Vec3 centre =
        (result.V.row(result.F(f, 0)) + result.V.row(result.F(f, 1)) + result.V.row(result.F(f, 2))) / 3;
    CHECK(centre.normalized().dot(Vec3(normals.row(f))) > 0.8);
  }
}

TEST_CASE("Simplify.WhereVerticesWent") {
  Context context;
  const TriangleMesh mesh = bumpy_torus(60, 30);
  std::vector<int> new_vertex_of;
  const TriangleMesh result = simplify(mesh, {400, false}, context, &new_vertex_of);
  REQUIRE(new_vertex_of.size() == static_cast<std::size_t>(mesh.vertex_count()));
  std::vector<int> received(400, 0);
  const double edge = mean_edge_length(result);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const int w = new_vertex_of[static_cast<std::size_t>(v)];
    REQUIRE(w >= 0);
    ++received[static_cast<std::size_t>(w)];
    CHECK((mesh.V.row(v) - result.V.row(w)).norm() < 3 * edge);
  }
  CHECK(*std::min_element(received.begin(), received.end()) > 0);
}

TEST_CASE("Simplify.SmallPartsVanishOnlyWhenAsked") {
  const TriangleMesh mesh = joined(icosphere(4), moved(icosphere(1), Vec3(2, 0, 0), 0.01));
  CHECK(face_components(Adjacency(simplified(mesh, 200))).count == 2);
  CHECK(face_components(Adjacency(simplified(mesh, 200, true))).count == 1);
}

TEST_CASE("Simplify.DeterministicAndIndependentOfPlaceAndScale") {
  const TriangleMesh mesh = bumpy_torus(50, 30), result = simplified(mesh, 300);
  CHECK(simplified(mesh, 300).V == result.V);
  CHECK(simplified(mesh, 300).F == result.F);
  // Powers of two round nothing.
  const TriangleMesh scaled = simplified(moved(mesh, Vec3(0, 0, 0), 1024), 300);
  CHECK(scaled.F == result.F);
  CHECK(scaled.V == 1024 * result.V);
  Context context;
  const TriangleMesh far = simplified(moved(mesh, Vec3(1e6, -1e6, 1e6)), 300);
  CHECK(hausdorff_distance(far, moved(result, Vec3(1e6, -1e6, 1e6)), 0.05, context) < 0.05);
}

TEST_CASE("Simplify.BadInputAndCancel") {
  CHECK_THROWS_AS(simplified(moebius_band(30), 10), Error);
  CHECK_THROWS_AS(simplified(cube(), 3), Error);
  Host host;
  host.cancel_requested = [] { return true; };
  Context cancelled(host);
  CHECK_THROWS_AS(simplify(icosphere(3), {50, false}, cancelled), Error);
}

}  // namespace
}  // namespace formwright
