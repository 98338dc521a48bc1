// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/measures.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <numbers>

#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using namespace test;
using std::numbers::pi;

TEST_CASE("Measures.ExactOnTetrahedronAndCube") {
  CHECK_THAT(signed_volume(tetrahedron()), WithinAbs(1.0 / 6, 1e-16));
  CHECK_THAT(surface_area(tetrahedron()), WithinAbs(1.5 + std::sqrt(3.0) / 2, 1e-15));
  CHECK_THAT(signed_volume(cube()), WithinAbs(1, 1e-15));
  CHECK_THAT(signed_volume(reversed(cube())), WithinAbs(-1, 1e-15));
  CHECK_THAT(surface_area(cube()), WithinAbs(6, 1e-15));
  CHECK_THAT(mean_edge_length(cube()), WithinAbs((2 + std::sqrt(2.0)) / 3, 1e-15));  // each face has sides 1, 1, sqrt 2
  CHECK(bounding_box(cube()).size() == Vec3(1, 1, 1));
  CHECK(bounding_box(cube()).centre() == Vec3(0.5, 0.5, 0.5));
}

TEST_CASE("Measures.VolumeLosesNothingFarFromTheOrigin") {
  // Moving by 2^20 rounds no coordinate of the unit cube, so the volume must stay exact.
  CHECK_THAT(signed_volume(moved(cube(), Vec3(1048576, -1048576, 1048576))), WithinAbs(1, 1e-15));
}

TEST_CASE("Measures.SphereVolumeAndAreaConvergeQuadratically") {
  double previous_volume = 0, previous_area = 0;
  for (int level = 2; level <= 5; ++level) {
    const TriangleMesh sphere = icosphere(level);
    const double volume = 4 * pi / 3 - signed_volume(sphere), area = 4 * pi - surface_area(sphere);
    if (level > 2) {
      INFO(level);
      CHECK_THAT(std::log2(previous_volume / volume), WithinAbs(2, 0.05));
      CHECK_THAT(std::log2(previous_area / area), WithinAbs(2, 0.05));
    }
    previous_volume = volume;
    previous_area = area;
  }
}

TEST_CASE("Measures.RigidMotionAndScale") {
  const TriangleMesh mesh = torus(17, 11);
  const TriangleMesh other = moved(rotated(mesh, Vec3(1, 2, 3), 0.7), Vec3(5, -3, 2), 3);
  CHECK_THAT(signed_volume(other), WithinAbs(27 * signed_volume(mesh), 1e-12 * 27 * signed_volume(mesh)));
  CHECK_THAT(surface_area(other), WithinAbs(9 * surface_area(mesh), 1e-12 * surface_area(other)));
  CHECK_THAT(mean_edge_length(other), WithinAbs(3 * mean_edge_length(mesh), 1e-12));
  CHECK((corner_angles(other) - corner_angles(mesh)).cwiseAbs().maxCoeff() < 1e-12);
  const Adjacency adjacency(mesh);
  CHECK((dihedral_angles(other, adjacency) - dihedral_angles(mesh, adjacency)).cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("Measures.AnglesObeyGaussAndBonnet") {
  // Sum over vertices of (2 pi - angles) = 2 pi chi: an identity, so it holds to round-off.
  for (const auto& [mesh, chi] : {std::pair{icosphere(3), 2}, std::pair{torus(20, 10), 0}, std::pair{cube(), 2}})
    CHECK_THAT(2 * pi * mesh.vertex_count() - corner_angles(mesh).sum(),
               WithinAbs(2 * pi * chi, 1e-10));  // thousands of angles, each rounded by the library's atan2
}

TEST_CASE("Measures.NormalsPointOutwards") {
  const TriangleMesh sphere = icosphere(3);
  const Positions normals = vertex_normals(sphere);
  for (int v = 0; v < sphere.vertex_count(); ++v) {
    CHECK_THAT(normals.row(v).norm(), WithinAbs(1, 1e-14));
    CHECK(normals.row(v).dot(sphere.V.row(v)) > 0.999);
  }
  CHECK(face_normals(grid(2, 2)).rowwise().sum().minCoeff() == 1);
  // Area weights: beside the corner of a cube the three sides count alike although the faces do not.
  CHECK((vertex_normals(cube()).row(7).transpose() - Vec3(1, 1, 1).normalized()).norm() < 0.35);
}

TEST_CASE("Measures.DihedralAngles") {
  const TriangleMesh mesh = cube();
  const Adjacency adjacency(mesh);
  const Eigen::VectorXd angles = dihedral_angles(mesh, adjacency);
  int right = 0, flat = 0;
  for (int e = 0; e < adjacency.edge_count(); ++e) {
    right += std::abs(angles[e] - pi / 2) < 1e-15 ? 1 : 0;
    flat += std::abs(angles[e]) < 1e-15 ? 1 : 0;
  }
  CHECK(right == 12);
  CHECK(flat == 6);
  const TriangleMesh inside_out = reversed(mesh);
  CHECK_THAT(dihedral_angles(inside_out, Adjacency(inside_out)).minCoeff(), WithinAbs(-pi / 2, 1e-15));
  const TriangleMesh flat_grid = grid(3, 3);
  CHECK(dihedral_angles(flat_grid, Adjacency(flat_grid)).cwiseAbs().maxCoeff() == 0);
}

TEST_CASE("Measures.NothingIsNotANumber") {
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
  CHECK(face_normals(mesh).allFinite());
  CHECK(vertex_normals(mesh).allFinite());
  CHECK(corner_angles(mesh).allFinite());
  CHECK(dihedral_angles(mesh, Adjacency(mesh)).allFinite());
  CHECK(face_normals(mesh).row(1).norm() == 0);
  CHECK(vertex_normals(mesh).row(8).norm() == 0);
  CHECK(mean_edge_length(TriangleMesh{}) == 0);
  CHECK(bounding_box(TriangleMesh{}).empty());
  CHECK(bounding_box(TriangleMesh{}).diagonal() == 0);
}

}  // namespace
}  // namespace formwright
