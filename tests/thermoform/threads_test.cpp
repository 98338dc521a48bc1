// SPDX-License-Identifier: GPL-3.0-or-later
// The simulation on several threads: nobody writes where another does, and their number changes nothing.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <set>

#include "base/parallel.h"
#include "thermoform/solver/face_strips.h"
#include "thermoform/forming.h"
#include "thermoform/sheet_fixture.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using namespace thermoform_test;

/// The strips in the order in which one thread works on them: those of even number, then the others.
std::vector<std::pair<int, int>> strips_in_order(const FaceStrips& strips) {
  const ThreadLimit one(1);
  std::vector<std::pair<int, int>> result;
  strips.for_each([&](int first, int end) { result.emplace_back(first, end); });
  return result;
}

void expect_apart(const FaceStrips& strips, const Triangles& F) {
  const auto ranges = strips_in_order(strips);
  REQUIRE(static_cast<int>(ranges.size()) == strips.count());
  std::vector<int> visits(static_cast<std::size_t>(F.rows()));
  const std::size_t even = (ranges.size() + 1) / 2;
  for (std::size_t part = 0; part < 2; ++part) {
    std::set<int> taken;
    for (std::size_t s = part == 0 ? 0 : even; s < (part == 0 ? even : ranges.size()); ++s) {
      CHECK(ranges[s].first % 4 == 0);
      std::set<int> own;
      for (int f = ranges[s].first; f < ranges[s].second; ++f) {
        ++visits[static_cast<std::size_t>(f)];
        for (int k = 0; k < 3; ++k) own.insert(F(f, k));
      }
      for (const int v : own) {
        INFO("strips " << s << " and another share vertex " << v);
        CHECK(taken.insert(v).second);
      }
    }
  }
  CHECK(std::count(visits.begin(), visits.end(), 1) == F.rows());
}

TEST_CASE("FaceStrips.those_worked_on_at_a_time_share_no_vertex") {
  for (const int triangles : {8, 50, 700, 2500, 10000})
    for (const int minimum : {4, 64, 512}) {
      const SheetMesh sheet = make_sheet_mesh(Vec2(220, 240), triangles);
      expect_apart(FaceStrips(sheet.F, minimum), sheet.F);
    }
  const SheetMesh sheet = make_sheet_mesh(Vec2(220, 240), 10000);
  CHECK(FaceStrips(sheet.F, 512).count() > 12);
}

TEST_CASE("FaceStrips.faces_in_no_order_stay_all_but_together") {
  SheetMesh sheet = make_sheet_mesh(Vec2(100, 100), 2000);
  const Triangles ordered = sheet.F;
  for (Eigen::Index f = 0; f < ordered.rows(); ++f) sheet.F.row(f) = ordered.row((f * 977) % ordered.rows());
  const FaceStrips strips(sheet.F, 64);
  expect_apart(strips, sheet.F);
  CHECK(strips.count() <= 2);
}

TEST_CASE("Membrane.strips_add_up_to_the_whole") {
  const SheetMesh sheet = make_sheet_mesh(Vec2(100, 120), 1500);
  const int n = static_cast<int>(sheet.flat_mm.rows());
  Membrane membrane(sheet.flat_mm, sheet.F, 1, {});
  BlockMatrix whole_matrix(n, std::span(sheet.F.data(), static_cast<std::size_t>(sheet.F.size())), 3),
      matrix = whole_matrix;
  membrane.use_matrix(matrix);
  membrane.begin_step(shaken(sheet, 0.1, 1), HeldVertices(static_cast<std::size_t>(n), 0));
  const Positions x = shaken(sheet, 0.3, 2);
  Positions whole = Positions::Zero(n, 3), force = whole;
  membrane.add_forces(x, 1e-3, 0, n, whole, &whole_matrix);
  FaceStrips(sheet.F, 64).for_each([&](int first, int end) {
    membrane.add_forces_of(first, end, x, 1e-3, force, &matrix);
  });
  CHECK((force - whole).cwiseAbs().maxCoeff() < 1e-13 * whole.cwiseAbs().maxCoeff());
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 3; ++k) {
      const float expected = whole_matrix.block(whole_matrix.diagonal_slot(i))[static_cast<std::size_t>(k)][k];
      CHECK_THAT(matrix.block(matrix.diagonal_slot(i))[static_cast<std::size_t>(k)][k],
                 WithinAbs(expected, 1e-5f * expected));
    }
}

TEST_CASE("Forming.any_number_of_threads_gives_the_same_bits") {
  ThermoformOptions o;
  o.sheet_x_mm = o.sheet_y_mm = 140;
  o.clamp_opening_x_mm = o.clamp_opening_y_mm = 120;
  o.platform_travel_mm = 80;
  o.triangles = 4000;
  const TriangleMesh mould = pyramid(60, 36);
  const FormedResult all = form(mould, o);
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    const FormedResult few = form(mould, o);
    CHECK(few.statistics.newton_iterations == all.statistics.newton_iterations);
    CHECK(few.statistics.cg_iterations == all.statistics.cg_iterations);
    INFO(threads << " threads");
    CHECK(few.sheet.mesh.V == all.sheet.mesh.V);
    CHECK(few.sheet.contact_s == all.sheet.contact_s);
  }
}

}  // namespace
}  // namespace formwright
