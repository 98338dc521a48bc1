// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/measures.h"

#include <gtest/gtest.h>

#include <numbers>

#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using namespace test;
using std::numbers::pi;

TEST(Measures, ExactOnTetrahedronAndCube) {
  EXPECT_NEAR(signed_volume(tetrahedron()), 1.0 / 6, 1e-16);
  EXPECT_NEAR(surface_area(tetrahedron()), 1.5 + std::sqrt(3.0) / 2, 1e-15);
  EXPECT_NEAR(signed_volume(cube()), 1, 1e-15);
  EXPECT_NEAR(signed_volume(reversed(cube())), -1, 1e-15);
  EXPECT_NEAR(surface_area(cube()), 6, 1e-15);
  EXPECT_NEAR(mean_edge_length(cube()), (2 + std::sqrt(2.0)) / 3, 1e-15);  // each face has sides 1, 1, sqrt 2
  EXPECT_EQ(bounding_box(cube()).size(), Vec3(1, 1, 1));
  EXPECT_EQ(bounding_box(cube()).centre(), Vec3(0.5, 0.5, 0.5));
}

TEST(Measures, VolumeLosesNothingFarFromTheOrigin) {
  // Moving by 2^20 rounds no coordinate of the unit cube, so the volume must stay exact.
  EXPECT_NEAR(signed_volume(moved(cube(), Vec3(1048576, -1048576, 1048576))), 1, 1e-15);
}

TEST(Measures, SphereVolumeAndAreaConvergeQuadratically) {
  double previous_volume = 0, previous_area = 0;
  for (int level = 2; level <= 5; ++level) {
    const TriangleMesh sphere = icosphere(level);
    const double volume = 4 * pi / 3 - signed_volume(sphere), area = 4 * pi - surface_area(sphere);
    if (level > 2) {
      EXPECT_NEAR(std::log2(previous_volume / volume), 2, 0.05) << level;
      EXPECT_NEAR(std::log2(previous_area / area), 2, 0.05) << level;
    }
    previous_volume = volume;
    previous_area = area;
  }
}

TEST(Measures, RigidMotionAndScale) {
  const TriangleMesh mesh = torus(17, 11);
  const TriangleMesh other = moved(rotated(mesh, Vec3(1, 2, 3), 0.7), Vec3(5, -3, 2), 3);
  EXPECT_NEAR(signed_volume(other), 27 * signed_volume(mesh), 1e-12 * 27 * signed_volume(mesh));
  EXPECT_NEAR(surface_area(other), 9 * surface_area(mesh), 1e-12 * surface_area(other));
  EXPECT_NEAR(mean_edge_length(other), 3 * mean_edge_length(mesh), 1e-12);
  EXPECT_LT((corner_angles(other) - corner_angles(mesh)).cwiseAbs().maxCoeff(), 1e-12);
  const Adjacency adjacency(mesh);
  EXPECT_LT((dihedral_angles(other, adjacency) - dihedral_angles(mesh, adjacency)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Measures, AnglesObeyGaussAndBonnet) {
  // Sum over vertices of (2 pi - angles) = 2 pi chi: an identity, so it holds to round-off.
  for (const auto& [mesh, chi] : {std::pair{icosphere(3), 2}, std::pair{torus(20, 10), 0}, std::pair{cube(), 2}})
    EXPECT_NEAR(2 * pi * mesh.vertex_count() - corner_angles(mesh).sum(), 2 * pi * chi,
                1e-10);  // thousands of angles, each rounded by the library's atan2
}

TEST(Measures, NormalsPointOutwards) {
  const TriangleMesh sphere = icosphere(3);
  const Positions normals = vertex_normals(sphere);
  for (int v = 0; v < sphere.vertex_count(); ++v) {
    EXPECT_NEAR(normals.row(v).norm(), 1, 1e-14);
    EXPECT_GT(normals.row(v).dot(sphere.V.row(v)), 0.999);
  }
  EXPECT_EQ(face_normals(grid(2, 2)).rowwise().sum().minCoeff(), 1);
  // Area weights: beside the corner of a cube the three sides count alike although the faces do not.
  EXPECT_LT((vertex_normals(cube()).row(7).transpose() - Vec3(1, 1, 1).normalized()).norm(), 0.35);
}

TEST(Measures, DihedralAngles) {
  const TriangleMesh mesh = cube();
  const Adjacency adjacency(mesh);
  const Eigen::VectorXd angles = dihedral_angles(mesh, adjacency);
  int right = 0, flat = 0;
  for (int e = 0; e < adjacency.edge_count(); ++e) {
    right += std::abs(angles[e] - pi / 2) < 1e-15 ? 1 : 0;
    flat += std::abs(angles[e]) < 1e-15 ? 1 : 0;
  }
  EXPECT_EQ(right, 12);
  EXPECT_EQ(flat, 6);
  const TriangleMesh inside_out = reversed(mesh);
  EXPECT_NEAR(dihedral_angles(inside_out, Adjacency(inside_out)).minCoeff(), -pi / 2, 1e-15);
  const TriangleMesh flat_grid = grid(3, 3);
  EXPECT_EQ(dihedral_angles(flat_grid, Adjacency(flat_grid)).cwiseAbs().maxCoeff(), 0);
}

TEST(Measures, NothingIsNotANumber) {
  // Repeated points, collinear points, tiny and huge triangles, an unused vertex.
  TriangleMesh mesh = make_mesh({{0, 0, 0},
                                 {0, 0, 0},
                                 {1, 0, 0},
                                 {2, 0, 0},
                                 {0, 1e-200, 0},
                                 {1e-200, 0, 0},
                                 {1e150, 0, 0},
                                 {0, 1e150, 0},
                                 {7, 7, 7}},
                                {{{0, 1, 2}}, {{0, 2, 3}}, {{0, 5, 4}}, {{0, 6, 7}}, {{0, 1, 0}}});
  EXPECT_TRUE(face_normals(mesh).allFinite());
  EXPECT_TRUE(vertex_normals(mesh).allFinite());
  EXPECT_TRUE(corner_angles(mesh).allFinite());
  EXPECT_TRUE(dihedral_angles(mesh, Adjacency(mesh)).allFinite());
  EXPECT_EQ(face_normals(mesh).row(1).norm(), 0);
  EXPECT_EQ(vertex_normals(mesh).row(8).norm(), 0);
  EXPECT_EQ(mean_edge_length(TriangleMesh{}), 0);
  EXPECT_TRUE(bounding_box(TriangleMesh{}).empty());
  EXPECT_EQ(bounding_box(TriangleMesh{}).diagonal(), 0);
}

}  // namespace
}  // namespace formwright
