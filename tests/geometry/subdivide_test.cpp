// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/subdivide.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "base/error.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using namespace test;

TEST_CASE("Subdivide.Counts") {
  Context context;
  for (const SubdivisionScheme scheme : {SubdivisionScheme::midpoint, SubdivisionScheme::loop})
    for (const TriangleMesh& mesh : {cube(), torus(9, 6), grid(3, 2), tube(7, 2)}) {
      const Adjacency before(mesh);
      const TriangleMesh finer = subdivide(mesh, scheme, 1, context);
      CHECK(finer.vertex_count() == mesh.vertex_count() + before.edge_count());
      CHECK(finer.face_count() == 4 * mesh.face_count());
      const Adjacency after(finer);
      CHECK(after.is_manifold());
      CHECK(euler_characteristic(after) == euler_characteristic(before));
      CHECK(boundary_loops(after).size() == boundary_loops(before).size());
      CHECK(subdivide(mesh, scheme, 3, context).face_count() == 64 * mesh.face_count());
    }
  CHECK(subdivide(cube(), SubdivisionScheme::loop, 0, context).V == cube().V);
}

TEST_CASE("Subdivide.MidpointKeepsTheSurface") {
  Context context;
  const TriangleMesh mesh = torus(9, 6), finer = subdivide(mesh, SubdivisionScheme::midpoint, 3, context);
  CHECK_THAT(surface_area(finer), WithinAbs(surface_area(mesh), 1e-12));
  CHECK_THAT(signed_volume(finer), WithinAbs(signed_volume(mesh), 1e-12));
  CHECK(finer.V.topRows(mesh.vertex_count()) == mesh.V);
  // Each group of four faces covers its parent.
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Vec3 parent = face_normals(mesh).row(f), child = face_normals(finer).row(64 * f + 17);
    CHECK((parent - child).norm() < 1e-12);
  }
}

TEST_CASE("Subdivide.LoopLeavesRegularPlanesInPlace") {
  // Affine invariance with linear precision: on a regular planar grid inner vertices stay.
  Context context;
  const TriangleMesh mesh = grid(6, 6), finer = subdivide(mesh, SubdivisionScheme::loop, 1, context);
  const Adjacency adjacency(mesh);
  for (int v = 0; v < mesh.vertex_count(); ++v)
    if (!adjacency.is_boundary_vertex(v)) {
      CHECK((finer.V.row(v) - mesh.V.row(v)).norm() < 1e-15);
    }
  CHECK(finer.V.col(2).cwiseAbs().maxCoeff() == 0);
}

TEST_CASE("Subdivide.LoopIsAffinelyInvariant") {
  Context context;
  Eigen::Matrix3d A;
  A << 2, 1, 0, -1, 3, 0.5, 0, 0.2, 1;
  const TriangleMesh mesh = torus(9, 6);
  TriangleMesh bent = mesh;
  bent.V = ((mesh.V * A.transpose()).rowwise() + Eigen::RowVector3d(1, 2, 3)).eval();
  const Positions direct = subdivide(bent, SubdivisionScheme::loop, 2, context).V;
  const Positions mapped = ((subdivide(mesh, SubdivisionScheme::loop, 2, context).V * A.transpose()).rowwise() +
                            Eigen::RowVector3d(1, 2, 3));
  CHECK((direct - mapped).cwiseAbs().maxCoeff() < 1e-13);
}

TEST_CASE("Subdivide.LoopConvergesToItsLimit") {
  // Old vertices approach the limit points, by a factor of at least the scheme's subdominant eigenvalue
  // squared; 5/8 bounds it for every valence here. The limit is kept by subdivision.
  Context context;
  for (const TriangleMesh& mesh : {cube(), icosphere(1), torus(9, 6), tube(8, 3), tetrahedron()}) {
    const Positions limit = loop_limit(mesh);
    double previous = 0;
    for (int level = 0; level <= 4; ++level) {
      const TriangleMesh finer = subdivide(mesh, SubdivisionScheme::loop, level, context);
      const double distance = (finer.V.topRows(mesh.vertex_count()) - limit).cwiseAbs().maxCoeff();
      if (level > 0) {
        CHECK(distance < 0.65 * previous);
      }
      previous = distance;
      CHECK((loop_limit(finer).topRows(mesh.vertex_count()) - limit).cwiseAbs().maxCoeff() < 1e-13);
    }
  }
}

TEST_CASE("Subdivide.LoopBoundaryIsACubicSpline") {
  // The boundary depends on the boundary alone: points 1/8, 3/4, 1/8 and midpoints.
  Context context;
  const TriangleMesh mesh = tube(8, 2), finer = subdivide(mesh, SubdivisionScheme::loop, 1, context);
  const Vec3 expected = 0.125 * mesh.V.row(7) + 0.75 * mesh.V.row(0) + 0.125 * mesh.V.row(1);
  CHECK((Vec3(finer.V.row(0)) - expected).norm() < 1e-15);
  const Adjacency adjacency(mesh);
  const Vec3 middle = finer.V.row(mesh.vertex_count() + adjacency.find_edge(0, 1));
  CHECK((middle - 0.5 * Vec3(mesh.V.row(0) + mesh.V.row(1))).norm() < 1e-15);
}

TEST_CASE("Subdivide.LoopVolumeConverges") {
  Context context;
  double previous_change = 0, volume = signed_volume(subdivide(cube(), SubdivisionScheme::loop, 1, context));
  for (int level = 2; level <= 5; ++level) {
    const double finer = signed_volume(subdivide(cube(), SubdivisionScheme::loop, level, context)),
                 change = std::abs(finer - volume);
    if (level > 2) {
      CHECK_THAT(std::log2(previous_change / change), WithinAbs(2, 0.3));
    }
    previous_change = change;
    volume = finer;
  }
}

TEST_CASE("Subdivide.ModelsCarryTheirAttributes") {
  Context context;
  Model model;
  model.mesh = cube();
  model.vertex_colours = model.mesh.V;
  model.UV.resize(36, 2);  // every face an island of its own
  model.FT.resize(12, 3);
  for (int f = 0; f < 12; ++f) {
    model.UV.row(3 * f) << f, 0;
    model.UV.row(3 * f + 1) << f + 1, 0;
    model.UV.row(3 * f + 2) << f, 1;
    model.FT.row(f) << 3 * f, 3 * f + 1, 3 * f + 2;
    model.face_group.push_back(f % 3);
  }
  model.group_names = {"a", "b", "c"};
  const Model finer = subdivide(model, SubdivisionScheme::midpoint, 2, context);
  CHECK((finer.vertex_colours - finer.mesh.V).cwiseAbs().maxCoeff() < 1e-15);  // both linear
  REQUIRE(finer.FT.rows() == finer.mesh.F.rows());
  for (int f = 0; f < finer.mesh.face_count(); ++f) {
    CHECK(finer.face_group[static_cast<std::size_t>(f)] == model.face_group[static_cast<std::size_t>(f / 16)]);
    const Vec2 a = finer.UV.row(finer.FT(f, 0)), b = finer.UV.row(finer.FT(f, 1)), c = finer.UV.row(finer.FT(f, 2));
    CHECK_THAT((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x(),
               WithinAbs(1.0 / 16, 1e-15));  // no island is crossed
  }
}

TEST_CASE("Subdivide.BadInput") {
  Context context;
  CHECK_THROWS_AS(subdivide(moebius_band(6), SubdivisionScheme::loop, 1, context), Error);
  CHECK_THROWS_AS(subdivide(cube(), SubdivisionScheme::loop, -1, context), Error);
  CHECK_THROWS_AS(subdivide(cube(), SubdivisionScheme::loop, 13, context), Error);
  CHECK(subdivide(TriangleMesh{}, SubdivisionScheme::loop, 2, context).face_count() == 0);
}

}  // namespace
}  // namespace formwright
