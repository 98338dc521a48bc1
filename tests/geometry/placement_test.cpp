// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/placement.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <array>

#include "base/error.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

/// A brick of 1 x 2 x 4 with its lowest corner at (7, 8, 9).
TriangleMesh brick() {
  TriangleMesh mesh = test::cube();
  const Eigen::RowVector3d low = mesh.V.colwise().minCoeff(), size = mesh.V.colwise().maxCoeff() - low;
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
    mesh.V.row(i) = Eigen::RowVector3d(7, 8, 9) +
                    Eigen::RowVector3d(1, 2, 4).cwiseProduct((mesh.V.row(i) - low).cwiseQuotient(size));
  return mesh;
}

TEST_CASE("Placement.ScalesToItsLongestSideTurnsAndPuts") {
  const Positions V = placed(brick().V, {100, {0, 0, 90}, {5, -3, 2}});
  const Vec3 low = V.colwise().minCoeff(), high = V.colwise().maxCoeff();
  // About z: what was 2 along y lies along x now.
  CHECK((high - low - Vec3(50, 25, 100)).norm() < 1e-12);
  CHECK((0.5 * (high + low) - Vec3(5, -3, 2)).norm() < 1e-12);
}

TEST_CASE("Placement.TurnsAboutXFirstThenYThenZ") {
  const Positions V = placed(brick().V, {4, {90, 90, 0}, {0, 0, 0}});
  // About x: (x, y, z) -> (x, -z, y), a size of 1, 4, 2; about y: (x, y, z) -> (z, y, -x), of 2, 4, 1.
  const Vec3 size = V.colwise().maxCoeff() - V.colwise().minCoeff();
  CHECK((size - Vec3(2, 4, 1)).norm() < 1e-12);
  // Counter-clockwise seen from the axis' end: the middle of the face at x = 8 goes to +y.
  const Positions turned = placed(brick().V, {4, {0, 0, 90}, {0, 0, 0}});
  for (Eigen::Index i = 0; i < turned.rows(); ++i) CHECK((turned(i, 1) > 0) == (brick().V(i, 0) > 7.5));
}

TEST_CASE("Placement.KeepsTheShape") {
  const TriangleMesh mesh = test::icosphere(3);
  const Positions V = placed(mesh.V, {50, {17, -230, 71}, {1e3, -2e3, 3e3}});
  const double scale = 50 / bounding_box(mesh).size().maxCoeff();
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.F(f, k), b = mesh.F(f, (k + 1) % 3);
      CHECK_THAT((V.row(a) - V.row(b)).norm(), WithinRel(scale * (mesh.V.row(a) - mesh.V.row(b)).norm(), 1e-9));
    }
  // Outwards stays outwards.
  CHECK_THAT(signed_volume(TriangleMesh{V, mesh.F}), WithinRel(scale * scale * scale * signed_volume(mesh), 1e-9));
}

TEST_CASE("Placement.RefusesWhatHasNoSize") {
  CHECK_THROWS_AS(placed(Positions(0, 3), {}), Error);
  CHECK_THROWS_AS(placed(Positions::Ones(3, 3), {}), Error);
}

TEST_CASE("Placement.JoinedModelsKeepWhatTheyAreMadeOf") {
  Model plain, painted;
  plain.mesh = test::cube();
  painted.mesh = test::tetrahedron();
  painted.vertex_colours = Positions::Constant(painted.mesh.V.rows(), 3, 0.25);
  painted.UV.resize(2, 2);
  painted.UV << 0.1, 0.2, 0.3, 0.4;
  painted.FT = Triangles::Ones(painted.mesh.F.rows(), 3);
  painted.materials = {{"skin", {1, 0, 0}, 0}};
  painted.face_material.assign(static_cast<std::size_t>(painted.mesh.F.rows()), 0);
  painted.textures = {{"skin.png", "image/png", {}}};
  const std::array models{painted, plain, painted};
  const std::array<std::string, 3> names{"first", "cube", "second"};
  const Model all = joined(models, names);

  CHECK(all.mesh.vertex_count() == 2 * painted.mesh.vertex_count() + plain.mesh.vertex_count());
  CHECK(Adjacency(all.mesh).is_closed());
  CHECK(vertex_components(Adjacency(all.mesh)).count == 3);
  CHECK_THAT(signed_volume(all.mesh), WithinRel(2 * signed_volume(painted.mesh) + signed_volume(plain.mesh), 1e-12));
  CHECK(all.group_names == std::vector<std::string>(names.begin(), names.end()));
  CHECK(all.vertex_colours.row(0).isConstant(0.25));
  CHECK(all.vertex_colours.row(painted.mesh.V.rows()).isConstant(1));
  CHECK(all.FT.maxCoeff() < all.UV.rows());
  const Eigen::Index last = all.mesh.F.rows() - 1;
  CHECK(all.UV.row(all.FT(last, 0)).isApprox(painted.UV.row(1)));
  CHECK(all.textures.size() == 2u);
  CHECK(all.face_material[0] == 0);
  CHECK(all.face_material[static_cast<std::size_t>(painted.mesh.F.rows())] == -1);
  CHECK(all.face_material.back() == 1);
  CHECK(all.materials[1].diffuse_texture == 1);
}

}  // namespace
}  // namespace formwright
