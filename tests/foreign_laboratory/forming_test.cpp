// SPDX-License-Identifier: GPL-3.0-or-later
#include "foreign_laboratory/forming.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/generators/catch_generators.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Dense>
#include <cmath>

namespace formwright::foreign_laboratory {
namespace {

using Catch::Matchers::WithinAbs, Catch::Matchers::WithinRel;
using Eigen::Vector3d;

/// Shorter than usual, for tests.
Machine quick_machine() {
  Machine machine;
  machine.sag_s = 0.3;
  machine.plate_start_z_mm = -90;
  return machine;
}

FormedSheet formed(Mould mould, int cells, const Faults& faults = {}) {
  return form_sheet(mould, quick_machine(), World{}, faults, {.cells = cells, .mass_scale = 30});
}

/// Largest distance between the sheet and its mirror image about the plane across `axis`.
double asymmetry_mm(const FormedSheet& sheet, Eigen::Index axis) {
  const Grid& grid = sheet.grid;
  double worst = 0;
  for (int j = 0; j <= grid.cells_y; ++j)
    for (int i = 0; i <= grid.cells_x; ++i) {
      const int opposite = axis == 0 ? grid.node(grid.cells_x - i, j) : grid.node(i, grid.cells_y - j);
      Vector3d mirrored = sheet.place_mm.col(opposite);
      mirrored[axis] = -mirrored[axis];
      worst = std::max(worst, (sheet.place_mm.col(grid.node(i, j)) - mirrored).norm());
    }
  return worst;
}

}  // namespace

TEST_CASE("Forming.ASymmetricMouldMakesASymmetricSheetOutsideOfItself") {
  const Mould mould = GENERATE(Mould::dome, Mould::cross);
  const FormedSheet sheet = formed(mould, 20);
  CHECK(asymmetry_mm(sheet, 0) < 1e-6);
  CHECK(asymmetry_mm(sheet, 1) < 1e-6);
  CHECK(sheet.inside_node_mm < 0.02);
  CHECK(sheet.inside_cell_mm < (mould == Mould::dome ? 0.6 : 3));  // cells of 11 mm; the cross is rounded by 7 mm
  // The highest point of the sheet's middle is half its thickness above the mould, and what nodes are held off there.
  const int middle = sheet.grid.node(10, 10);
  CHECK_THAT(sheet.place_mm(2, middle), WithinAbs(mould_height_mm(mould) + 0.5 * sheet.thickness_mm[middle], 0.4));
  CHECK(sheet.spring_back_strain > 0);
  CHECK(sheet.spring_back_strain < 3e-3);
}

TEST_CASE("Forming.AreaTimesThicknessIsKept") {
  // Areas of the quadrilaterals' four triangles about their middle, which the membrane does not compute.
  const FormedSheet sheet = formed(Mould::pyramid, 24);
  double volume = 0, area_mm2 = 0;
  for (int cell = 0; cell < sheet.grid.cell_count(); ++cell) {
    const std::array<int, 4> k = sheet.grid.corners(cell);
    Vector3d middle = Vector3d::Zero();
    double thickness = 0, area = 0;
    for (const int node : k) middle += sheet.place_mm.col(node) / 4, thickness += sheet.thickness_mm[node] / 4;
    for (std::size_t e = 0; e < 4; ++e) {
      const Vector3d a = sheet.place_mm.col(k[e]), b = sheet.place_mm.col(k[(e + 1) % 4]);
      area += 0.5 * (a - middle).cross(b - middle).norm();
    }
    volume += area * thickness;
    area_mm2 += area;
  }
  CHECK_THAT(volume, WithinRel(220 * 240 * 1.0, 0.03));
  CHECK(area_mm2 > 1.07 * 220 * 240);
}

TEST_CASE("Forming.ADomeConvergesWithTheGrid") {
  const FormedSheet coarse = formed(Mould::dome, 10), middle = formed(Mould::dome, 20), fine = formed(Mould::dome, 40);
  const auto difference = [](const FormedSheet& a, const FormedSheet& b) {
    const int times = b.grid.cells_x / a.grid.cells_x;
    double sum = 0;
    for (int j = 0; j <= a.grid.cells_y; ++j)
      for (int i = 0; i <= a.grid.cells_x; ++i)
        sum += (a.place_mm.col(a.grid.node(i, j)) - b.place_mm.col(b.grid.node(times * i, times * j))).norm();
    return sum / a.grid.node_count();
  };
  const double first = difference(coarse, middle), second = difference(middle, fine);
  INFO("mean differences " << first << " and " << second << " mm, order " << std::log2(first / second));
  CHECK(std::log2(first / second) > 1.5);
  CHECK(second < 0.4);
}

TEST_CASE("Forming.AMouldThatIsShiftedTakesTheSheetAlong") {
  Faults faults;
  faults.mould_shift_x_mm = 3;
  const FormedSheet clean = formed(Mould::dome, 20), shifted = formed(Mould::dome, 20, faults);
  CHECK(asymmetry_mm(shifted, 0) > 1);
  CHECK(asymmetry_mm(shifted, 1) < 1e-6);
  const int middle = clean.grid.node(10, 10);
  // The middle of the flat sheet comes down beside the top of the mould: lower, and little to the side.
  CHECK(shifted.place_mm(2, middle) < clean.place_mm(2, middle));
}

TEST_CASE("Forming.FaultsChangeWhatTheyAreNamedAfter") {
  const FormedSheet clean = formed(Mould::dome, 16);
  Faults clamp, wedge, heat;
  clamp.clamp_mm2_per_n_s = 25;
  const FormedSheet loose = formed(Mould::dome, 16, clamp);
  CHECK(clean.clamp_feed_mm == 0);
  CHECK(loose.clamp_feed_mm > 0.3);
  CHECK(loose.clamp_feed_mm < 10);
  wedge.thicker_right = 0.3;
  const FormedSheet uneven = formed(Mould::dome, 16, wedge);
  const auto of_sides = [](const FormedSheet& sheet) {
    double right = 0, left = 0;
    for (int node = 0; node < sheet.grid.node_count(); ++node)
      if (const double x = sheet.grid.flat_mm(node).x(); x != 0) (x > 0 ? right : left) += sheet.thickness_mm[node];
    return right / left;
  };
  CHECK_THAT(of_sides(clean), WithinRel(1, 1e-6));
  CHECK(of_sides(uneven) > 1.2);
  // The colder side stretches less, so that it stays thicker.
  heat.colder_right_k = 13;
  CHECK(of_sides(formed(Mould::dome, 16, heat)) > 1.01);
}

TEST_CASE("Forming.WhatCannotBeFormedIsRefused") {
  Machine shallow;
  shallow.plate_start_z_mm = -50;
  CHECK_THROWS_AS(form_sheet(Mould::cone, shallow, World{}, Faults{}, {}), std::invalid_argument);
  CHECK_THROWS_AS(form_sheet(Mould::cone, Machine{}, World{}, Faults{}, {.cells = 1}), std::invalid_argument);
  CHECK_THROWS_AS(mould_of("teapot"), std::invalid_argument);
  std::mt19937_64 random(1);
  CHECK_THROWS_AS(draw_faults("gremlin", 1, random), std::invalid_argument);
  CHECK_THROWS_AS(draw_faults("slip", std::nan(""), random), std::invalid_argument);
}

}  // namespace formwright::foreign_laboratory
