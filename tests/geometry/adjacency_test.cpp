// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/adjacency.h"

#include <catch2/catch_test_macros.hpp>

#include <algorithm>

#include "base/error.h"
#include "geometry/test_meshes.h"

namespace formwright {
namespace {
using namespace test;

TEST_CASE("Adjacency.CountsOfKnownSurfaces") {
  struct Case {
    const char* name;
    TriangleMesh mesh;
    int edges, chi, loops, genus, parts;
    bool manifold, closed;
  };
  const std::vector<Case> cases{
      {"tetrahedron", tetrahedron(), 6, 2, 0, 0, 1, true, true},
      {"cube", cube(), 18, 2, 0, 0, 1, true, true},
      {"icosphere", icosphere(2), 480, 2, 0, 0, 1, true, true},
      {"torus", torus(12, 8), 288, 0, 0, 1, 1, true, true},
      {"two tori", joined(torus(5, 4), torus(6, 4)), 132, 0, 0, 2, 2, true, true},
      {"disc", grid(3, 2), 23, 1, 1, 0, 1, true, false},
      {"annulus", tube(7, 3), 70, 0, 2, 0, 1, true, false},
  };
  for (const Case& c : cases) {
    INFO(c.name);
    const Adjacency adjacency(c.mesh);
    CHECK(adjacency.edge_count() == c.edges);
    CHECK(euler_characteristic(adjacency) == c.chi);
    CHECK(boundary_loops(adjacency).size() == static_cast<std::size_t>(c.loops));
    CHECK(genus(adjacency) == c.genus);
    CHECK(vertex_components(adjacency).count == c.parts);
    CHECK(face_components(adjacency).count == c.parts);
    CHECK(adjacency.is_manifold() == c.manifold);
    CHECK(adjacency.is_closed() == c.closed);
  }
}

TEST_CASE("Adjacency.TablesAgreeWithTheFaces") {
  const TriangleMesh mesh = joined(torus(9, 7), grid(4, 5));
  const Adjacency adjacency(mesh);
  for (int h = 0; h < 3 * mesh.face_count(); ++h) {
    const int a = mesh.F(h / 3, h % 3), b = mesh.F(h / 3, (h + 1) % 3);
    CHECK(adjacency.from(h) == a);
    CHECK(adjacency.to(h) == b);
    const Edge edge = adjacency.edges()[static_cast<std::size_t>(adjacency.edge_of(h))];
    CHECK(std::minmax(a, b) == std::minmax(edge.lower, edge.higher));
    CHECK(adjacency.find_edge(b, a) == adjacency.edge_of(h));
    if (const int g = adjacency.opposite(h); g >= 0) {
      CHECK(adjacency.opposite(g) == h);
      CHECK(adjacency.from(g) == b);
      CHECK(adjacency.to(g) == a);
    } else {
      CHECK(adjacency.is_boundary_edge(adjacency.edge_of(h)));
    }
  }
  std::size_t ends = 0;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const auto ring = adjacency.neighbours(v);
    CHECK(std::is_sorted(ring.begin(), ring.end()));
    for (const int u : ring) CHECK(adjacency.find_edge(u, v) >= 0);
    for (const int h : adjacency.outgoing(v)) CHECK(adjacency.from(h) == v);
    ends += ring.size();
  }
  CHECK(ends == 2 * adjacency.edges().size());
  CHECK(adjacency.find_edge(0, mesh.vertex_count() - 1) == -1);
}

TEST_CASE("Adjacency.BoundaryRunsWithTheFaces") {
  const auto loops = boundary_loops(Adjacency(grid(2, 1)));
  REQUIRE(loops.size() == 1u);
  CHECK(loops[0] == std::vector<int>{0, 1, 2, 5, 4, 3});
}

TEST_CASE("Adjacency.BoundaryStaysInOneFanAtATouchingVertex") {
  // Two triangles that share vertex 0 only: two loops of three, not one of six.
  const TriangleMesh bow =
      make_mesh({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}}, {{{0, 1, 2}}, {{0, 3, 4}}});
  const Adjacency adjacency(bow);
  CHECK(adjacency.nonmanifold_vertices() == std::vector<int>{0});
  CHECK_FALSE(adjacency.is_manifold());
  CHECK(boundary_loops(adjacency) == std::vector<std::vector<int>>{{0, 1, 2}, {0, 3, 4}});
  CHECK(vertex_components(adjacency).count == 1);
  CHECK(face_components(adjacency).count == 2);
}

TEST_CASE("Adjacency.CountsWhatIsNotManifold") {
  // Three pages of a book.
  const TriangleMesh book =
      make_mesh({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}}, {{{0, 1, 2}}, {{0, 1, 3}}, {{0, 1, 4}}});
  const Adjacency pages(book);
  CHECK(pages.nonmanifold_edge_count() == 1);
  CHECK(pages.boundary_edge_count() == 6);
  CHECK(pages.opposite(0) == -1);
  CHECK_THROWS_AS(boundary_loops(pages), Error);

  const Adjacency clash(make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}}, {{{0, 1, 2}}, {{0, 1, 3}}}));
  CHECK(clash.inconsistent_edge_count() == 1);
  CHECK_FALSE(clash.is_manifold());

  CHECK(Adjacency(moebius_band(9)).inconsistent_edge_count() == 1);
}

TEST_CASE("Adjacency.HubOfALargeFan") {
  // Enough faces at one vertex that its bucket is sorted by the general method.
  const int spokes = 1000;
  std::vector<Vec3> points{{0, 0, 0}};
  std::vector<std::array<int, 3>> faces;
  for (int i = 0; i < spokes; ++i) {
    const double angle = 2 * std::numbers::pi * i / spokes;
    points.emplace_back(std::cos(angle), std::sin(angle), 0);
    faces.push_back({0, 1 + i, 1 + (i + 1) % spokes});
  }
  const Adjacency adjacency(make_mesh(points, faces));
  CHECK(adjacency.is_manifold());
  CHECK(adjacency.neighbours(0).size() == static_cast<std::size_t>(spokes));
  CHECK(boundary_loops(adjacency).front().size() == static_cast<std::size_t>(spokes));
}

TEST_CASE("Adjacency.UnusedVerticesAreParts") {
  TriangleMesh mesh = joined(tetrahedron(), tetrahedron());
  mesh.V.conservativeResize(9, 3);
  mesh.V.row(8).setZero();
  const Adjacency adjacency(mesh);
  CHECK(vertex_components(adjacency).of == std::vector<int>{0, 0, 0, 0, 1, 1, 1, 1, 2});
  CHECK(euler_characteristic(adjacency) == 4);
}

TEST_CASE("Adjacency.EmptyAndBadInput") {
  const Adjacency nothing{TriangleMesh{}};
  CHECK(nothing.edge_count() == 0);
  CHECK(boundary_loops(nothing).empty());
  TriangleMesh bad = tetrahedron();
  bad.F(2, 1) = 4;
  CHECK_THROWS_AS(Adjacency{bad}, Error);
  bad.F(2, 1) = -1;
  CHECK_THROWS_AS(Adjacency{bad}, Error);
}

}  // namespace
}  // namespace formwright
