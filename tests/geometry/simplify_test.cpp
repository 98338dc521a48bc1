// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/simplify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "base/error.h"
#include "geometry/adjacency.h"
#include "geometry/measures.h"
#include "geometry/point_distance.h"
#include "geometry/test_meshes.h"

namespace formwright {
namespace {
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

TEST(Simplify, KeepsTheTopology) {
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
    SCOPED_TRACE(c.name);
    const TriangleMesh result = simplified(c.mesh, c.target);
    const Adjacency before(c.mesh), after(result);
    EXPECT_TRUE(after.is_manifold());
    EXPECT_TRUE(result.V.allFinite());
    EXPECT_EQ(euler_characteristic(after), euler_characteristic(before));
    EXPECT_EQ(boundary_loops(after).size(), boundary_loops(before).size());
    EXPECT_EQ(face_components(after).count, face_components(before).count);
    if (c.target > 4) {
      EXPECT_EQ(result.vertex_count(), c.target);
    }
    EXPECT_EQ(vertex_components(after).count, face_components(after).count);  // no unused vertices
  }
  EXPECT_EQ(simplified(icosphere(3), 4).vertex_count(), 4);
}

TEST(Simplify, SmallEnoughIsLeftAlone) {
  const TriangleMesh mesh = torus(10, 8);
  EXPECT_EQ(simplified(mesh, 80).V, mesh.V);
  EXPECT_EQ(simplified(mesh, 80).F, mesh.F);
}

TEST(Simplify, PlanesStayExact) {
  // Everything stays in the plane, the square keeps its corners and its area.
  const TriangleMesh result = simplified(grid(30, 30, 0.3), 60);
  EXPECT_LT(result.V.col(2).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_NEAR(surface_area(result), 1, 2e-3);
  const BoundingBox box = bounding_box(result);
  EXPECT_NEAR(box.size().x(), 1, 1e-3);
  EXPECT_NEAR(box.size().y(), 1, 1e-3);
}

TEST(Simplify, SharpEdgesStay) {
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
  EXPECT_LT(hausdorff_distance(fine, result, 0.02, context), 0.02);
  EXPECT_NEAR(signed_volume(result), 1, 0.01);
}

TEST(Simplify, DistanceFallsQuadratically) {
  // A smooth surface with n vertices can be met to within O(1 / n); four times the vertices, a quarter of
  // the mean distance.
  Context context;
  const TriangleMesh mesh = icosphere(6);
  double previous = 0;
  for (const int target : {150, 600, 2400}) {
    const TriangleMesh result = simplified(mesh, target);
    const SurfaceDistance distance = surface_distance(mesh, PointDistance(result), 0.05, context);
    if (previous > 0) {
      EXPECT_NEAR(std::log2(previous / distance.mean), 2, 0.35) << target;
    }
    previous = distance.mean;
    // An inscribed or best-fitting polyhedron with equilateral triangles of edge h errs by h^2 / 6 at worst.
    const double edge_squared = 4 / std::sqrt(3.0) * 4 * std::numbers::pi / (2.0 * target);
    EXPECT_LT(distance.maximum, edge_squared / 2) << target;
  }
}

TEST(Simplify, TrianglesAreWellShaped) {
  struct Case {
    const char* name;
    TriangleMesh mesh;
    double least, hundredth, median;  // degrees: of the worst triangle, the worst hundredth, the usual one
  };
  // Measured 33.8, 35.4, 49.6; 11.4, 14.9, 36.6 (the waves of the torus stretch its triangles); 16.5, 21.0, 46.1.
  // The bunny to 5000 vertices has 12, 21, 44; without the improvement at the end it had 11, 16, 39.
  for (const Case& c : std::vector<Case>{{"sphere", icosphere(5), 30, 33, 48},
                                         {"torus", bumpy_torus(120, 60), 10, 14, 35.5},
                                         {"grid", grid(80, 80, 0.3), 15, 19.5, 45}}) {
    SCOPED_TRACE(c.name);
    const TriangleMesh result = simplified(c.mesh, c.mesh.vertex_count() / 10);
    const Eigen::VectorXd least = corner_angles(result).rowwise().minCoeff() * (180 / std::numbers::pi);
    std::vector<double> sorted(least.begin(), least.end());
    std::sort(sorted.begin(), sorted.end());
    EXPECT_GT(sorted[0], c.least);
    EXPECT_GT(sorted[sorted.size() / 100], c.hundredth);
    EXPECT_GT(sorted[sorted.size() / 2], c.median);
  }
}

TEST(Simplify, NoFaceTurnsOver) {
  const TriangleMesh mesh = icosphere(5), result = simplified(mesh, 150);
  const Positions normals = face_normals(result);
  for (int f = 0; f < result.face_count(); ++f) {
    const Vec3 centre =
        (result.V.row(result.F(f, 0)) + result.V.row(result.F(f, 1)) + result.V.row(result.F(f, 2))) / 3;
    EXPECT_GT(centre.normalized().dot(Vec3(normals.row(f))), 0.8);
  }
}

TEST(Simplify, WhereVerticesWent) {
  Context context;
  const TriangleMesh mesh = bumpy_torus(60, 30);
  std::vector<int> new_vertex_of;
  const TriangleMesh result = simplify(mesh, {400, false}, context, &new_vertex_of);
  ASSERT_EQ(new_vertex_of.size(), static_cast<std::size_t>(mesh.vertex_count()));
  std::vector<int> received(400, 0);
  const double edge = mean_edge_length(result);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const int w = new_vertex_of[static_cast<std::size_t>(v)];
    ASSERT_GE(w, 0);
    ++received[static_cast<std::size_t>(w)];
    EXPECT_LT((mesh.V.row(v) - result.V.row(w)).norm(), 3 * edge);
  }
  EXPECT_GT(*std::min_element(received.begin(), received.end()), 0);
}

TEST(Simplify, SmallPartsVanishOnlyWhenAsked) {
  const TriangleMesh mesh = joined(icosphere(4), moved(icosphere(1), Vec3(2, 0, 0), 0.01));
  EXPECT_EQ(face_components(Adjacency(simplified(mesh, 200))).count, 2);
  EXPECT_EQ(face_components(Adjacency(simplified(mesh, 200, true))).count, 1);
}

TEST(Simplify, DeterministicAndIndependentOfPlaceAndScale) {
  const TriangleMesh mesh = bumpy_torus(50, 30), result = simplified(mesh, 300);
  EXPECT_EQ(simplified(mesh, 300).V, result.V);
  EXPECT_EQ(simplified(mesh, 300).F, result.F);
  // Powers of two round nothing.
  const TriangleMesh scaled = simplified(moved(mesh, Vec3(0, 0, 0), 1024), 300);
  EXPECT_EQ(scaled.F, result.F);
  EXPECT_EQ(scaled.V, 1024 * result.V);
  Context context;
  const TriangleMesh far = simplified(moved(mesh, Vec3(1e6, -1e6, 1e6)), 300);
  EXPECT_LT(hausdorff_distance(far, moved(result, Vec3(1e6, -1e6, 1e6)), 0.05, context), 0.05);
}

TEST(Simplify, BadInputAndCancel) {
  EXPECT_THROW(simplified(moebius_band(30), 10), Error);
  EXPECT_THROW(simplified(cube(), 3), Error);
  Host host;
  host.cancel_requested = [] { return true; };
  Context cancelled(host);
  EXPECT_THROW(simplify(icosphere(3), {50, false}, cancelled), Error);
}

}  // namespace
}  // namespace formwright
