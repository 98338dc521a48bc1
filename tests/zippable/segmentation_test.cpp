// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/parts/segmentation.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <set>

#include "base/error.h"
#include "geometry/paths/geodesic_distance.h"
#include "zippable/parts/handles.h"
#include "zippable/parts/surface_split.h"
#include "zippable/zippable_shapes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using std::numbers::pi;

TEST_CASE("GeodesicDistance.IsThatOfTheSphereToFirstOrder") {
  double error = 1;
  for (const int levels : {3, 4, 5}) {
    const TriangleMesh mesh = test::icosphere(levels);
    const Eigen::VectorXd d = geodesic_distance_mm(mesh, Adjacency(mesh), {0});
    double worst = 0;
    for (int v = 0; v < mesh.vertex_count(); ++v)
      worst = std::max(worst, std::abs(d[v] - std::acos(std::clamp(mesh.V.row(v).dot(mesh.V.row(0)), -1.0, 1.0))));
    {
      INFO(levels);
      CHECK(worst < 0.75 * error);
    }
    error = worst;
  }
  CHECK(error < 0.05);
}

TEST_CASE("SurfaceSplit.CutsWhereTheFieldsAreEqual") {
  // Three linear fields over a square: borders are straight lines and meet in one point.
  const TriangleMesh mesh = test::grid(20, 20, 0.2);
  Eigen::MatrixXd field(mesh.vertex_count(), 3);
  field.col(0) = mesh.V.col(0);
  field.col(1) = mesh.V.col(1).array() + 0.1;
  field.col(2) = 0.9 - mesh.V.col(0).array();
  std::vector<int> label(mesh.vertex_count());
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    Eigen::Index minimum = 0;
    field.row(v).minCoeff(&minimum);
    label[v] = static_cast<int>(minimum);
  }
  const LabelledSurface split = split_by_smallest_field(mesh, label, field);
  CHECK(Adjacency(split.mesh).is_manifold());
  double area = 0, wrong = 0;
  for (int f = 0; f < split.mesh.face_count(); ++f) {
    const Vec3 a = split.mesh.V.row(split.mesh.F(f, 0)).transpose(),
               b = split.mesh.V.row(split.mesh.F(f, 1)).transpose(),
               c = split.mesh.V.row(split.mesh.F(f, 2)).transpose();
    const double size = 0.5 * (b - a).cross(c - a).z();
    CHECK(size > 0);
    area += size;
    const Vec3 m = (a + b + c) / 3;
    const double fields[3] = {m.x(), m.y() + 0.1, 0.9 - m.x()};
    if (fields[split.face_label[f]] > std::min({fields[0], fields[1], fields[2]}) + 0.01) wrong += size;
  }
  CHECK_THAT(area, WithinAbs(1, 1e-12));
  CHECK(wrong < 1e-3);  // only by the distance that new vertices keep from old ones
}

TEST_CASE("Puncture.IsARoundHoleOfItsRadius") {
  LabelledSurface surface{test::icosphere(5), {}};
  surface.face_label.assign(surface.mesh.face_count(), 0);
  const Vec3 centre = surface.mesh.V.row(7).transpose();
  CHECK(puncture(surface, {7}, 0.3) == std::vector<double>{0.3});
  const auto loops = boundary_loops(Adjacency(surface.mesh));
  REQUIRE(loops.size() == 1u);
  for (const int v : loops[0]) CHECK_THAT((surface.mesh.V.row(v).transpose() - centre).norm(), WithinAbs(0.3, 0.01));
}

TEST_CASE("Puncture.ShrinksUntilItFits") {
  LabelledSurface surface{test::icosphere(4), {}};
  surface.face_label.assign(surface.mesh.face_count(), 0);
  const std::vector<double> radii =
      puncture(surface, {3, 0}, 5);  // larger than the whole sphere; the second must keep off the first
  CHECK(radii[0] < 2);
  CHECK(radii[1] < 2);
  const Adjacency adjacency(surface.mesh);
  CHECK(adjacency.is_manifold());
  CHECK(boundary_loops(adjacency).size() == 2u);
  CHECK(euler_characteristic(adjacency) == 0);
}

TEST_CASE("Handles.AreCutAlongTheShortWay") {
  Context context;
  const TriangleMesh mesh = test::torus(60, 24);
  const OpenedSurface opened = cut_handles(mesh, context);
  REQUIRE(opened.cuts.size() == 1u);
  CHECK_THAT(walk_length_mm(mesh, opened.cuts[0], true), WithinAbs(2 * pi * 0.4, 0.05));
  const Adjacency adjacency(opened.mesh);
  CHECK(genus(adjacency) == 0);
  CHECK(boundary_loops(adjacency).size() == 2u);
  CHECK(opened.mesh.face_count() == mesh.face_count());
  for (int v = 0; v < opened.mesh.vertex_count(); ++v) CHECK(opened.mesh.V.row(v) == mesh.V.row(opened.source_of[v]));
}

TEST_CASE("Openings.AreJoinedBySlits") {
  Context context;
  LabelledSurface surface{test::icosphere(4), {}};
  surface.face_label.assign(surface.mesh.face_count(), 0);
  puncture(surface, {0, 7, 90, 200, 300}, 0.1);
  OpenedSurface opened;
  opened.mesh = surface.mesh;
  for (int v = 0; v < surface.mesh.vertex_count(); ++v) opened.source_of.push_back(v);
  for (std::size_t openings = 5; openings > 1; --openings) {
    const Adjacency before(opened.mesh);
    REQUIRE(boundary_loops(before).size() == openings);
    CHECK(euler_characteristic(before) == 2 - static_cast<int>(openings));
    REQUIRE(join_nearest_openings(opened, context));
  }
  CHECK_FALSE(join_nearest_openings(opened, context));
  CHECK(opened.slits.size() == 4u);
  CHECK(opened.mesh.face_count() == surface.mesh.face_count());
  for (int v = 0; v < opened.mesh.vertex_count(); ++v)
    CHECK(opened.mesh.V.row(v) == surface.mesh.V.row(opened.source_of[v]));
}

TEST_CASE("Proposal.JoinsOpeningsThatAreTooMany") {
  // Four openings, and the model is to be one cylinder.
  Context context;
  ProposalOptions options;
  options.parts_max = 1, options.puncture_radius_mm = 0.05;
  LabelledSurface surface{test::icosphere(4), {}};
  surface.face_label.assign(surface.mesh.face_count(), 0);
  puncture(surface, {0, 7, 90, 200}, 0.1);
  const Proposal proposal = propose_segmentation(surface.mesh, options, context);
  CHECK(proposal.segmentation.part_count() == 1);
  REQUIRE(proposal.notes.size() == 1u);
  CHECK(proposal.notes[0].find("2 slits were cut") != std::string::npos);
  CHECK(parameterise(proposal.segmentation, {}, context).distortion_mean > 1);
}

TEST_CASE("Segmentation.FindsTheLinesOfACylinder") {
  const Segmentation s = test::alone(test::cylinder_side(10, 30, 24, 12));
  REQUIRE(s.valid());
  CHECK(s.segments[0].bottom.vertices.size() == 24u);
  CHECK(s.segments[0].top.vertices.size() == 24u);
  CHECK(s.segments[0].bottom.is_open());
}

TEST_CASE("Segmentation.SaysWhyAPartIsNoCylinder") {
  const auto problem = [](const TriangleMesh& mesh, std::vector<int> parts, int part) {
    return make_segmentation(mesh, parts).problems[part];
  };
  const TriangleMesh tube = test::cylinder_side(10, 30, 24, 12);
  // The lower half as a part, and the upper half in two separate columns.
  std::vector<int> halves(tube.face_count(), 0), pieces(tube.face_count(), 0);
  for (int f = 0; f < tube.face_count(); ++f) {
    const double z = tube.V(tube.F(f, 0), 2);
    halves[f] = z > 14 ? 1 : 0;
    pieces[f] = z > 14 && z < 19 ? 1 : 0;
  }
  CHECK(make_segmentation(tube, halves).valid());
  CHECK(problem(tube, pieces, 0).find("in 2 pieces") != std::string::npos);
  CHECK(problem(tube, pieces, 1).find("It has no opening") != std::string::npos);
  CHECK(problem(test::grid(4, 4), std::vector<int>(32, 0), 0)
            .find("1 openings instead of two: put another hole into it") != std::string::npos);
}

TEST_CASE("Segmentation.BothSidesOfAnInterfaceAgree") {
  for (const char* sample : {"t_shape", "star", "octopus"}) {
    const Segmentation s = test::proposed(sample, 3000).segmentation;
    REQUIRE(s.valid());
    REQUIRE(s.part_count() >= 3);
    std::vector<int> used(s.interfaces.size(), 0);
    for (int part = 0; part < s.part_count(); ++part) {
      const BoundaryLine& line = s.segments[part].bottom;
      std::size_t place = 0;
      for (const InterfaceUse& use : line.uses) {
        const Interface& interface = s.interfaces[use.interface];
        CHECK((use.forward ? interface.left : interface.right) == part);
        ++used[use.interface];
        const std::size_t count = interface.vertices.size();
        for (std::size_t k = 0; k + 1 < count; ++k)
          CHECK(line.vertices[place++] == interface.vertices[use.forward ? k : count - 1 - k]);
      }
      CHECK(place == line.vertices.size());
    }
    for (const int count : used) CHECK(count == 2);
  }
}

TEST_CASE("Segmentation.NoTriangleCanBeCrushedOntoALine") {
  // Two rows of triangles between the lines, then chords: a fan that leans on the lower line.
  const Segmentation s = test::proposed("t_shape", 500).segmentation;
  const Adjacency adjacency(s.mesh);
  for (int part = 0; part < s.part_count(); ++part)
    for (const BoundaryLine* line : {&s.segments[part].bottom, &s.segments[part].top}) {
      std::set<int> on(line->vertices.begin(), line->vertices.end());
      for (int h = 0; h < 3 * s.mesh.face_count(); ++h) {
        const int o = adjacency.opposite(h);
        if (s.face_segment[h / 3] != part || o < 0 || s.face_segment[o / 3] != part) continue;
        CHECK_FALSE((on.contains(adjacency.from(h)) && on.contains(adjacency.to(h))));
      }
    }
}

TEST_CASE("Proposal.FindsTheLimbs") {
  CHECK(test::proposed("t_shape", 3000).segmentation.part_count() == 3);
  CHECK(test::proposed("star", 3000).segmentation.part_count() == 5);
  CHECK(test::proposed("octopus", 6000).segmentation.part_count() == 9);
  CHECK(test::proposed("octopus", 3000, 5, 1).segmentation.part_count() == 1);
  const Proposal torus = test::proposed("torus", 3000);
  CHECK(torus.segmentation.part_count() == 1);
  CHECK(torus.handles_cut == 1);
  CHECK(torus.punctures.empty());
}

TEST_CASE("Proposal.TakesGivenPunctures") {
  Context context;
  ProposalOptions options;
  options.puncture_radius_mm = 0.2;
  options.tips_mm = {{0, 0, 1}, {1, 0, 0}, {-0.5, 0.8, -0.2}};
  const Proposal proposal = propose_segmentation(test::icosphere(4), options, context);
  CHECK(proposal.segmentation.part_count() == 3);
  for (std::size_t i = 0; i < 3; ++i) CHECK((proposal.punctures[i] - options.tips_mm[i].normalized()).norm() < 0.1);
  options.tips_mm.resize(1);
  CHECK_THROWS_AS(propose_segmentation(test::icosphere(3), options, context), Error);
}

}  // namespace
}  // namespace formwright
