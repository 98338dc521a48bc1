// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Geometry>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/data/json.h"
#include "geometry/mesh/measures.h"
#include "zippable/design_files.h"
#include "zippable/flat_design.h"
#include "zippable/zippable_shapes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

struct ClosedDesign {
  ParameterisedModel model;
  ZippableDesign design;
};

ClosedDesign closed_design(const TriangleMesh& mesh, double width_mm) {
  Context context;
  ZippableOptions options;
  options.width_mm = width_mm;
  options.measure_distances = false;
  ClosedDesign d{parameterise_model(mesh, {}, options, context), {}};
  d.design = design_zippable(d.model, options, context);
  return d;
}

TriangleMesh sample(std::string_view name) {
  Context context;
  return make_sample(name, 2500, context).mesh;
}

/// The largest distance between places that meet, over the cut's length; all that theory says of both sides on the way.
double expect_sides_meet(const Ribbon& ribbon, const HandleClosure& closure) {
  const int count = static_cast<int>(ribbon.boundary.size());
  std::array<std::map<double, std::array<int, 2>>, 2> edges;  // by where they begin, in the direction of the cut
  double apart = 0;
  for (std::size_t side = 0; side < 2; ++side) {
    double covered = 0;
    for (const ClosureRun& run : closure.sides[side])
      for (int k = 0; k < run.edge_count(); ++k) {
        const int v = (run.first_vertex + k) % count, w = (v + 1) % count;
        const double from = run.along_mm[k], to = run.along_mm[k + 1];
        CHECK((side == 0 ? to > from : to < from));
        // An edge of an opening, no longer than the cut between its ends.
        const RibbonVertex &a = ribbon.boundary[v], &b = ribbon.boundary[w];
        CHECK((a.piece < 0 || b.piece < 0 || a.left != b.left || a.piece != b.piece));
        CHECK((a.position_mm - b.position_mm).norm() <= std::abs(to - from) * (1 + 1e-9));
        covered += std::abs(to - from);
        edges[side][std::min(from, to)] = side == 0 ? std::array{v, w} : std::array{w, v};
      }
    CHECK_THAT(covered, WithinAbs(closure.length_mm, 1e-6 * closure.length_mm));
  }
  CHECK(edges[0].size() == edges[1].size());
  for (const auto& [from, left] : edges[0]) {
    const auto right = edges[1].find(from);
    if (right == edges[1].end()) {
      FAIL_CHECK("nothing meets what begins at " << from);
      continue;
    }
    for (std::size_t end = 0; end < 2; ++end)
      apart = std::max(
          apart, (ribbon.boundary[left[end]].position_mm - ribbon.boundary[right->second[end]].position_mm).norm());
    const auto flat = [&](const std::array<int, 2>& edge) {
      return (ribbon.flat_mm[edge[0]] - ribbon.flat_mm[edge[1]]).norm();
    };
    CHECK_THAT(flat(left), WithinAbs(flat(right->second), 1e-9 * closure.length_mm));
  }
  return apart / closure.length_mm;
}

TEST_CASE("HandleClosure.BothSidesOfATorusMeetPlaceByPlace") {
  for (const double width : {8.0, 15.0, 30.0}) {
    const ClosedDesign d = closed_design(sample("torus"), width);
    const auto& closures = d.design.ribbon.closures;
    REQUIRE(closures.size() == 1u);
    CHECK(closures[0].closed);
    CHECK_THAT(closures[0].length_mm,
               WithinAbs(walk_length_mm(d.model.mesh, d.model.proposal.handle_cuts.at(0), true), 1e-9));
    CHECK(expect_sides_meet(d.design.ribbon, closures[0]) < 1e-9);
    // It begins where the zipper ends on the left side, which is one run.
    CHECK(closures[0].sides[0].size() == 1u);
    CHECK(closures[0].sides[0][0].along_mm.front() == 0);
    CHECK(closures[0].sides[0][0].along_mm.back() == closures[0].length_mm);
  }
}

TEST_CASE("HandleClosure.OfLimbsAndAHandle") {
  // The cat's tail touches its body: two of several openings, with Fermat spirals between.
  const ClosedDesign d = closed_design(sample("cat"), 12);
  REQUIRE(d.design.ribbon.closures.size() == 1u);
  CHECK(expect_sides_meet(d.design.ribbon, d.design.ribbon.closures[0]) < 1e-9);
}

TEST_CASE("HandleClosure.IsNotThereWithoutAHandle") {
  const ClosedDesign d = closed_design(sample("star"), 15);
  CHECK(d.design.ribbon.closures.empty());
  CHECK(std::string(as_text(write_design_json(d.model, d.design))).find("handle_cuts") == std::string::npos);
}

TEST_CASE("HandleClosure.MovesAndGrowsWithTheModel") {
  const TriangleMesh torus = sample("torus");
  TriangleMesh other = torus;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  other.V = (2 * torus.V * turn.transpose()).rowwise() + Eigen::RowVector3d(5, -3, 11);
  const HandleClosure a = closed_design(torus, 15).design.ribbon.closures.at(0),
                      b = closed_design(other, 30).design.ribbon.closures.at(0);
  CHECK_THAT(b.length_mm, WithinAbs(2 * a.length_mm, 1e-8 * a.length_mm));
  for (std::size_t side = 0; side < 2; ++side) {
    REQUIRE(a.sides[side].size() == b.sides[side].size());
    for (std::size_t r = 0; r < a.sides[side].size(); ++r) {
      REQUIRE(a.sides[side][r].along_mm.size() == b.sides[side][r].along_mm.size());
      CHECK(a.sides[side][r].first_vertex == b.sides[side][r].first_vertex);
      // As far as the parameterisation is the same, which stops at a millionth of the energy.
      for (std::size_t k = 0; k < a.sides[side][r].along_mm.size(); ++k)
        CHECK_THAT(b.sides[side][r].along_mm[k], WithinAbs(2 * a.sides[side][r].along_mm[k], 1e-4 * a.length_mm));
    }
  }
}

TEST_CASE("HandleClosure.IsReadAgainOrRefused") {
  const ClosedDesign d = closed_design(sample("torus"), 15);
  const Bytes written = write_design_json(d.model, d.design);
  const HandleClosure& made = d.design.ribbon.closures.at(0);
  const FlatDesign flat = read_flat_design(written);
  REQUIRE(flat.closures.size() == 1u);
  CHECK(flat.closures[0].length_mm == made.length_mm);
  for (std::size_t side = 0; side < 2; ++side) {
    REQUIRE(flat.closures[0].sides[side].size() == made.sides[side].size());
    for (std::size_t r = 0; r < made.sides[side].size(); ++r)
      CHECK(flat.closures[0].sides[side][r].along_mm == made.sides[side][r].along_mm);
  }
  // Files from before there were any.
  Json json = Json::parse(as_text(written));
  Json old = json;
  old.erase("handle_cuts");
  CHECK(read_flat_design(to_bytes(old.dump())).closures.empty());
  const auto refused = [&](const auto& change) {
    Json wrong = json;
    change(wrong["handle_cuts"][0]);
    try {
      read_flat_design(to_bytes(wrong.dump()));
      return false;
    } catch (const Error& error) {
      return error.where() == "design";
    }
  };
  CHECK(refused([](Json& cut) { cut.erase("sides"); }));
  CHECK(refused([](Json& cut) { cut["length_mm"] = -1; }));
  CHECK(refused([](Json& cut) { cut["sides"][1] = Json::array(); }));
  CHECK(refused([](Json& cut) { cut["sides"][0][0]["first_vertex"] = 1 << 20; }));
  CHECK(refused([](Json& cut) { cut["sides"][0][0]["first_vertex"] = 0; }));  // along the zipper
  CHECK(refused([](Json& cut) { std::swap(cut["sides"][0][0]["along_mm"][1], cut["sides"][0][0]["along_mm"][2]); }));
}

}  // namespace
}  // namespace formwright
