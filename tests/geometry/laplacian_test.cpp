// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/operators/laplacian.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <limits>
#include <numbers>

#include "base/error.h"
#include "geometry/mesh/measures.h"
#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using namespace test;
using std::numbers::pi;

constexpr LaplacianOptions unlimited{1e12};

std::vector<TriangleMesh> zoo() {
  return {tetrahedron(),
          cube(),
          icosphere(2),
          torus(15, 8),
          grid(6, 5, 0.3),
          tube(9, 4),
          joined(tetrahedron(), moved(icosphere(1), Vec3(3, 0, 0)))};
}

TEST_CASE("CotangentLaplacian.KnownTriangle") {
  // Right isosceles triangle: cotangents 0, 1, 1 at corners 0, 1, 2.
  const TriangleMesh mesh = make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{{0, 1, 2}}});
  const Eigen::MatrixXd L = cotangent_laplacian(mesh);
  Eigen::Matrix3d expected;
  expected << 1, -0.5, -0.5, -0.5, 0.5, 0, -0.5, 0, 0.5;
  CHECK((L - expected).cwiseAbs().maxCoeff() < 1e-15);
}

TEST_CASE("CotangentLaplacian.SymmetricSemidefiniteConstantsInTheKernel") {
  for (const TriangleMesh& mesh : zoo()) {
    const SparseMatrix L = cotangent_laplacian(mesh);
    const Eigen::MatrixXd dense = L;
    CHECK((dense - dense.transpose()).cwiseAbs().maxCoeff() == 0);
    CHECK((L * Eigen::VectorXd::Ones(L.cols())).cwiseAbs().maxCoeff() < 1e-13);
    Random random(7);
    for (int trial = 0; trial < 20; ++trial) {
      Eigen::VectorXd u(L.cols());
      for (double& x : u) x = random.uniform(-1, 1);
      CHECK(u.dot(L * u) >= -1e-12);
    }
    // Compressed, ascending, each diagonal entry stored.
    CHECK(L.isCompressed());
    for (int j = 0; j < L.cols(); ++j) {
      int previous = -1;
      bool diagonal = false;
      for (SparseMatrix::InnerIterator it(L, j); it; ++it) {
        CHECK(it.row() > previous);
        previous = static_cast<int>(it.row());
        diagonal = diagonal || it.row() == j;
      }
      CHECK(diagonal);
    }
  }
}

TEST_CASE("CotangentLaplacian.EnergyIsTheIntegralOfTheGradient") {
  // Built a second way: face by face from |grad u|^2 area, Pinkall & Polthier eq. (7).
  const TriangleMesh mesh = torus(13, 9);
  Random random(3);
  Eigen::VectorXd u(mesh.vertex_count());
  for (double& x : u) x = random.uniform(-1, 1);
  double energy = 0;
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)), c = mesh.V.row(mesh.F(f, 2));
    const Vec3 area = 0.5 * (b - a).cross(c - a);
    const Vec3 gradient = (u[mesh.F(f, 0)] * area.cross(c - b) + u[mesh.F(f, 1)] * area.cross(a - c) +
                           u[mesh.F(f, 2)] * area.cross(b - a)) /
                          (2 * area.squaredNorm());
    energy += gradient.squaredNorm() * area.norm();
  }
  CHECK_THAT(u.dot(cotangent_laplacian(mesh) * u), WithinAbs(energy, 1e-12 * energy));
}

TEST_CASE("CotangentLaplacian.LinearPrecisionInThePlane") {
  const TriangleMesh mesh = grid(12, 10, 0.35);
  const Adjacency adjacency(mesh);
  Context context;
  for (const SparseMatrix& L : {cotangent_laplacian(mesh, adjacency, unlimited),
                                cotangent_laplacian(intrinsic_delaunay(mesh, context), unlimited)}) {
    const Eigen::VectorXd u = 3 * mesh.V.col(0) - 2 * mesh.V.col(1) + Eigen::VectorXd::Constant(mesh.vertex_count(), 5);
    const Eigen::VectorXd Lu = L * u;
    for (int v = 0; v < mesh.vertex_count(); ++v)
      if (!adjacency.is_boundary_vertex(v)) {
        CHECK_THAT(Lu[v], WithinAbs(0, 1e-12));
      }
  }
}

TEST_CASE("CotangentLaplacian.ScaleAndRigidMotionChangeNothing") {
  const TriangleMesh mesh = torus(15, 9);
  const TriangleMesh other = moved(rotated(mesh, Vec3(3, 1, 2), 1.1), Vec3(10, 20, 30), 7);
  const SparseMatrix difference = cotangent_laplacian(mesh) - cotangent_laplacian(other);
  CHECK(difference.coeffs().abs().maxCoeff() < 1e-11);
}

double rayleigh_quotient(const TriangleMesh& mesh, const Eigen::VectorXd& u) {
  return u.dot(cotangent_laplacian(mesh) * u) / u.dot(vertex_areas(mesh).cwiseProduct(u));
}

TEST_CASE("CotangentLaplacian.CoordinatesOnAnInscribedSphere") {
  // sum over x, y, z of x^T L x is twice the area of any mesh; on a sphere sum x^T A x is the area too, and
  // the icosahedron's symmetry makes the three alike: the quotient is l (l + 1) = 2 at every resolution.
  for (int level = 0; level <= 4; ++level)
    CHECK_THAT(rayleigh_quotient(icosphere(level), icosphere(level).V.col(2)), WithinAbs(2, 1e-12));
}

TEST_CASE("CotangentLaplacian.ConvergesToTheSphericalHarmonics") {
  // x y has the eigenvalue 6 and 5 z^3 - 3 z has 12; the Rayleigh quotient converges with order 2.
  for (const double eigenvalue : {6.0, 12.0}) {
    double previous = 0;
    for (int level = 2; level <= 5; ++level) {
      const TriangleMesh sphere = icosphere(level);
      const Eigen::ArrayXd x = sphere.V.col(0).array(), y = sphere.V.col(1).array(), z = sphere.V.col(2).array();
      Eigen::VectorXd u = x * y;
      if (eigenvalue == 12) u = 5 * z.cube() - 3 * z;
      const double error = std::abs(rayleigh_quotient(sphere, u) - eigenvalue);
      if (level > 2) {
        INFO("eigenvalue " << eigenvalue << ", level " << level);
        CHECK_THAT(std::log2(previous / error), WithinAbs(2, 0.1));
      }
      previous = error;
    }
    CHECK(previous < 1e-3 * eigenvalue);
  }
}

TEST_CASE("CotangentLaplacian.PointwiseOnTheSphere") {
  // A^-1 L z against 2 z in the mean square. Pointwise values converge more slowly than energies: with
  // Voronoi areas on this family of meshes the measured orders are 1.38 and 1.45.
  double previous = 0;
  for (int level = 3; level <= 5; ++level) {
    const TriangleMesh sphere = icosphere(level);
    const Eigen::VectorXd areas = vertex_areas(sphere), u = sphere.V.col(2);
    const Eigen::VectorXd error = (cotangent_laplacian(sphere) * u).cwiseQuotient(areas) - 2 * u;
    const double rms = std::sqrt(error.dot(areas.cwiseProduct(error)) / areas.sum());
    if (level > 3) {
      INFO(level);
      CHECK(std::log2(previous / rms) > 1.3);
    }
    previous = rms;
  }
}

TEST_CASE("CotangentLaplacian.CotangentsAreHeld") {
  const double thin = 1e-3;
  const TriangleMesh mesh = make_mesh({{0, 0, 0}, {1, 0, 0}, {0.5, thin, 0}, {0.5, -1, 0}}, {{{0, 1, 2}}, {{0, 3, 1}}});
  for (const double limit : {20.0, 5.0}) {
    const Eigen::MatrixXd L = cotangent_laplacian(mesh, LaplacianOptions{limit});
    CHECK_THAT(L(0, 2), WithinAbs(-limit / 2, 1e-12));
  }
  // Without area at all, still finite.
  const TriangleMesh flat = make_mesh({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 0, 0}}, {{{0, 1, 2}}, {{0, 3, 1}}});
  CHECK(Eigen::MatrixXd(cotangent_laplacian(flat)).allFinite());
  CHECK(Eigen::MatrixXd(cotangent_laplacian(flat, unlimited)).allFinite());
  CHECK(cotangent_laplacian(TriangleMesh{}).rows() == 0);
}

TEST_CASE("VertexAreas.SumToTheSurface") {
  for (const TriangleMesh& mesh : zoo())
    for (const VertexArea kind : {VertexArea::barycentric, VertexArea::mixed_voronoi}) {
      const Eigen::VectorXd areas = vertex_areas(mesh, kind, 0);
      CHECK_THAT(areas.sum(), WithinAbs(surface_area(mesh), 1e-12 * surface_area(mesh)));
      CHECK(areas.minCoeff() > 0);
    }
}

TEST_CASE("VertexAreas.KnownTriangles") {
  const TriangleMesh equilateral = make_mesh({{0, 0, 0}, {2, 0, 0}, {1, std::sqrt(3.0), 0}}, {{{0, 1, 2}}});
  CHECK_THAT(vertex_areas(equilateral)[1], WithinAbs(std::sqrt(3.0) / 3, 1e-15));
  const TriangleMesh right = make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{{0, 1, 2}}});
  CHECK_THAT(vertex_areas(right)[0], WithinAbs(0.25, 1e-15));  // the circumcentre is on the hypotenuse
  CHECK_THAT(vertex_areas(right)[1], WithinAbs(0.125, 1e-15));
  const TriangleMesh obtuse = make_mesh({{0, 0, 0}, {4, 0, 0}, {1, 0.5, 0}}, {{{0, 1, 2}}});
  CHECK_THAT(vertex_areas(obtuse)[2], WithinAbs(0.5, 1e-15));
  CHECK_THAT(vertex_areas(obtuse)[0], WithinAbs(0.25, 1e-15));
}

TEST_CASE("VertexAreas.Floor") {
  // A needle-thin triangle far from a large one, and an unused vertex.
  const TriangleMesh mesh = make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 0}, {5, 1e-9, 0}, {9, 9, 9}},
                                      {{{0, 1, 2}}, {{3, 4, 5}}});
  const Eigen::VectorXd areas = vertex_areas(mesh);
  const double mean = surface_area(mesh) / 6;
  CHECK_THAT(areas.minCoeff(), WithinAbs(1e-3 * mean, 1e-12 * mean));
  CHECK_THAT(areas[6], WithinAbs(1e-3 * mean, 1e-12 * mean));
  CHECK(vertex_areas(TriangleMesh{}).size() == 0);
}

// ---- intrinsic Delaunay ----

TEST_CASE("IntrinsicDelaunay.WeightsAreNeverNegative") {
  Context context;
  std::vector<TriangleMesh> meshes = zoo();
  meshes.push_back(grid(20, 20, 0.95));  // jitter folds some faces over: still a surface
  TriangleMesh spikes = icosphere(3);
  Random random(11);
  for (int v = 0; v < spikes.vertex_count(); ++v) spikes.V.row(v) *= random.uniform(0.4, 1.6);
  meshes.push_back(spikes);
  TriangleMesh stretched = torus(40, 12);
  stretched.V.col(2) *= 40;
  meshes.push_back(stretched);
  bool some_negative_before = false;
  for (const TriangleMesh& mesh : meshes) {
    const IntrinsicTriangulation t = intrinsic_delaunay(mesh, context);
    const SparseMatrix L = cotangent_laplacian(t, unlimited);
    const Adjacency adjacency(mesh);
    for (int j = 0; j < L.cols(); ++j)
      for (SparseMatrix::InnerIterator it(L, j); it; ++it)
        if (const int e = adjacency.find_edge(j, static_cast<int>(it.row()));
            it.row() != j && !(e >= 0 && adjacency.is_boundary_edge(e))) {
          CHECK(it.value() <= 0);  // no flip can mend a boundary edge
        }
    CHECK((L * Eigen::VectorXd::Ones(L.cols())).cwiseAbs().maxCoeff() < 1e-9);
    const Eigen::MatrixXd before = cotangent_laplacian(mesh, unlimited);
    some_negative_before =
        some_negative_before || (before - Eigen::MatrixXd(before.diagonal().asDiagonal())).maxCoeff() > 1e-6;
    // The metric is the same: areas and total angle at each vertex survive the flips.
    CHECK(t.lengthened_by == 0);
    CHECK_THAT(vertex_areas(t, VertexArea::mixed_voronoi, 0).sum(),
               WithinAbs(surface_area(mesh), 1e-9 * surface_area(mesh)));
    Eigen::VectorXd angle_before = Eigen::VectorXd::Zero(mesh.vertex_count()), angle_after = angle_before;
    const Positions corners = corner_angles(mesh);
    for (int f = 0; f < mesh.face_count(); ++f)
      for (int k = 0; k < 3; ++k) {
        angle_before[mesh.F(f, k)] += corners(f, k);
        const auto side = [&](int i) { return t.length[static_cast<std::size_t>(3 * f + (k + i) % 3)]; };
        angle_after[t.from[static_cast<std::size_t>(3 * f + k)]] += std::acos(std::clamp(
            (side(0) * side(0) + side(2) * side(2) - side(1) * side(1)) / (2 * side(0) * side(2)), -1.0, 1.0));
      }
    CHECK((angle_before - angle_after).cwiseAbs().maxCoeff() < 1e-6);
  }
  CHECK(some_negative_before);  // otherwise nothing was tested
}

TEST_CASE("IntrinsicDelaunay.GluingStaysConsistent") {
  Context context;
  TriangleMesh mesh = torus(30, 5);
  mesh.V.col(0) *= 30;
  const IntrinsicTriangulation t = intrinsic_delaunay(mesh, context);
  CHECK(t.flips > 10);
  for (int h = 0; h < 3 * t.face_count(); ++h) {
    const int g = t.opposite[static_cast<std::size_t>(h)];
    REQUIRE(g >= 0);
    CHECK(t.opposite[static_cast<std::size_t>(g)] == h);
    CHECK(t.from[static_cast<std::size_t>(g)] == t.from[static_cast<std::size_t>(next_halfedge(h))]);
    CHECK(t.length[static_cast<std::size_t>(g)] == t.length[static_cast<std::size_t>(h)]);
  }
}

TEST_CASE("IntrinsicDelaunay.NothingToDoOnDelaunayMeshes") {
  Context context;
  for (const TriangleMesh& mesh : {icosphere(3), grid(5, 5), tetrahedron()}) {
    const IntrinsicTriangulation t = intrinsic_delaunay(mesh, context);
    CHECK(t.flips == 0);
    const SparseMatrix difference = cotangent_laplacian(t, unlimited) - cotangent_laplacian(mesh, unlimited);
    CHECK(difference.coeffs().abs().maxCoeff() < 1e-12);
  }
}

TEST_CASE("IntrinsicDelaunay.FlipsTheLongDiagonal") {
  // A rhombus split along its long diagonal; the other diagonal has length 2 in the plane.
  const TriangleMesh mesh = make_mesh({{-5, 0, 0}, {0, -1, 0}, {5, 0, 0}, {0, 1, 0}}, {{{0, 1, 2}}, {{0, 2, 3}}});
  Context context;
  const IntrinsicTriangulation t = intrinsic_delaunay(mesh, context);
  CHECK(t.flips == 1);
  CHECK_THAT(*std::min_element(t.length.begin(), t.length.end()), WithinAbs(2, 1e-14));
}

TEST_CASE("IntrinsicDelaunay.FlatTrianglesAreMollified") {
  Context context;
  const TriangleMesh mesh = make_mesh({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}}, {{{0, 1, 2}}, {{0, 2, 3}}});
  const IntrinsicTriangulation t = intrinsic_delaunay(mesh, context);
  CHECK(t.lengthened_by > 0);
  CHECK(t.lengthened_by < 1e-6);
  CHECK(Eigen::MatrixXd(cotangent_laplacian(t)).allFinite());
}

TEST_CASE("IntrinsicDelaunay.RefusesWhatIsNotManifold") {
  Context context;
  CHECK_THROWS_AS(intrinsic_delaunay(moebius_band(8), context), Error);
  CHECK(intrinsic_delaunay(TriangleMesh{}, context).face_count() == 0);
  Host host;
  host.cancel_requested = [] { return true; };
  Context cancelled(host);
  TriangleMesh large = torus(400, 200);
  CHECK_THROWS_AS(intrinsic_delaunay(large, cancelled), Error);
}

}  // namespace
}  // namespace formwright
