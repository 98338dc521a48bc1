// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/test_grid.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <map>
#include <set>

#include "base/random.h"
#include "fabrication/laser/laser_materials.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

LaserPlan run(const TestGrid& grid, const TestGridOptions& options) {
  Context context;
  return run_strokes({grid.labels, grid.strokes}, options, 0, true, context);
}

TEST_CASE("TestGrid.EverySquareHasItsOwnPowerAndSpeed") {
  for (const GridWork work : {GridWork::cut, GridWork::engrave}) {
    TestGridOptions options;
    options.work = work;
    options.columns = 4;
    options.rows = 3;
    options.passes = 2;
    const TestGrid grid = make_test_grid(options, Context());
    REQUIRE(grid.cells.size() == 12u);
    const LaserPlan plan = run(grid, options);
    CHECK(plan.misfits.empty());
    std::map<std::string, double> length;
    for (const ToolMove& move : plan.path.moves) {
      if (!move.work || move.part == "numbers") continue;
      const auto cell =
          std::find_if(grid.cells.begin(), grid.cells.end(), [&](const TestCell& c) { return c.name == move.part; });
      REQUIRE(cell != grid.cells.end());
      CHECK(move.power_percent == cell->power_percent);
      CHECK(move.speed_mm_per_s == cell->speed_mm_per_s);
      for (std::size_t i = 0; i < move.points_mm.size(); ++i) {
        CHECK(move.points_mm[i].x() >= cell->x_mm - 1e-9);
        CHECK(move.points_mm[i].y() <= cell->y_mm + options.cell_mm + 1e-9);
        if (i > 0) length[move.part] += (move.points_mm[i] - move.points_mm[i - 1]).norm();
      }
    }
    CHECK(length.size() == 12u);
    for (const auto& [name, mm] : length) {
      INFO(name);
      CHECK_THAT(mm, WithinAbs(2 * (work == GridWork::cut ? 32 : 8 * 53), 1e-6));
    }  // 8 mm of lines 0.15 mm apart
    CHECK(grid.cells.front().power_percent == 20);
    CHECK(grid.cells.back().power_percent == 100);
    CHECK(grid.cells.front().speed_mm_per_s == 5);
    CHECK(grid.cells.back().speed_mm_per_s == 25);
  }
}

TEST_CASE("TestGrid.NumbersKeepOutOfEachOtherAndOfTheSquares") {
  Random random(7);
  for (int round = 0; round < 30; ++round) {
    TestGridOptions options;
    options.columns = 1 + static_cast<int>(random.below(12));
    options.rows = 1 + static_cast<int>(random.below(12));
    options.cell_mm = random.uniform(4, 12);
    options.gap_mm = random.uniform(1, 6);
    options.label_mm = random.uniform(1.5, 3);
    options.speed_to_mm_per_s = random.uniform(6, 1500);
    const TestGrid grid = make_test_grid(options, Context());
    double left = 1e9;
    for (const LaserStroke& label : grid.labels)
      for (const Vec2& p : label.points_mm) {
        left = std::min(left, p.x());
        for (const TestCell& cell : grid.cells)
          CHECK_FALSE((p.x() > cell.x_mm && p.x() < cell.x_mm + options.cell_mm && p.y() > cell.y_mm &&
                       p.y() < cell.y_mm + options.cell_mm));
      }
    CHECK(left >= options.x_mm - 1e-9);
  }
}

TEST_CASE("TestGrid.TheKerfTestShowsTheKerf") {
  TestGridOptions options;
  options.kind = GridKind::kerf;
  const TestGrid grid = make_test_grid(options, Context());
  REQUIRE(grid.strokes.size() == 10u);
  // Burn away a kerf on every line, push the pieces to the left: the last edge stands at the kerf's tick.
  const double kerf = 0.2;
  const auto& slot = grid.strokes.back().points_mm;
  const double left = slot[0].x(), right = slot[1].x();
  double pieces = 0, before = left;
  for (int i = 0; i <= 9; ++i) {
    const double next = i < 9 ? grid.strokes[static_cast<std::size_t>(i)].points_mm[0].x() : right;
    pieces += next - before - kerf;
    before = next;
  }
  const double edge = left - kerf / 2 + pieces;
  std::vector<double> ticks;
  for (const LaserStroke& label : grid.labels)
    if (label.points_mm.size() == 2 && label.points_mm[0].x() == label.points_mm[1].x() &&
        label.points_mm[0].y() == options.y_mm + 2 * options.cell_mm + 1)
      ticks.push_back(label.points_mm[0].x());
  REQUIRE(ticks.size() == 11u);
  CHECK_THAT(ticks[4], WithinAbs(edge, 1e-9));  // 0.05 mm a tick
  // The slot comes last.
  const LaserPlan plan = run(grid, options);
  CHECK(std::find_if(plan.path.moves.rbegin(), plan.path.moves.rend(), [](const ToolMove& m) {
          return m.work;
        })->part == "slot");
}

TEST_CASE("TestGrid.FocusLinesAreAtTheirHeights") {
  TestGridOptions options;
  options.kind = GridKind::focus;
  options.focus_range_mm = 2;
  const TestGrid grid = make_test_grid(options, Context());
  std::set<double> heights;
  for (const ToolMove& move : run(grid, options).path.moves) {
    if (move.work && move.part != "numbers") heights.insert(move.points_mm[0].z());
    if (move.part == "numbers") {
      CHECK(move.points_mm[0].z() == 0);
    }
  }
  CHECK(heights == std::set<double>{-2, -1, 0, 1, 2});
}

TEST_CASE("LaserMaterials.AreParametersOfTheJob") {
  std::set<std::string> names;
  for (const LaserMaterial& material : laser_materials()) {
    {
      INFO(material.name);
      CHECK(names.insert(material.name).second);
    }
    const auto options =
        read_parameters<LaserOptions>(material.parameters);  // throws for a name or a value that is none
    CHECK(options.cut_enabled == (material.thickness_mm > 0));
    CHECK(options.mark_power_percent / options.mark_speed_mm_per_s <= 1);
  }
  CHECK(names.size() >= 12u);
}

}  // namespace
}  // namespace formwright
