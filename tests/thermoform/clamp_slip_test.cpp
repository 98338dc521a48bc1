// SPDX-License-Identifier: GPL-3.0-or-later
// A loose clamp: pulls that are known, other meshes, and a formed sheet.
#include "thermoform/sheet/clamp_slip.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "thermoform/sheet_fixture.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using namespace thermoform_test;

const Vec2 oblong_mm(120, 80);

/// Forces on the rim that pull inwards by `pull` newtons for each mm of it, at a place along the side in [-1, 1].
Positions pulled(const SheetMesh& sheet, const std::function<double(bool on_x_side, double along)>& pull) {
  Positions force = Positions::Zero(sheet.flat_mm.rows(), 3);
  const Vec2 cell(oblong_mm.x() / (sheet.columns - 1), oblong_mm.y() / (sheet.rows - 1));
  for (Eigen::Index v = 0; v < force.rows(); ++v) {
    const Vec2 share = 2 * Vec2(sheet.flat_mm.row(v)).cwiseQuotient(oblong_mm);
    for (const int axis : {0, 1}) {
      if (std::abs(share[axis]) < 1 - 1e-9) continue;
      const double along = share[1 - axis], length = (std::abs(along) > 1 - 1e-9 ? 0.5 : 1.0) * cell[1 - axis];
      force(v, axis) -= (share[axis] > 0 ? 1 : -1) * length * pull(axis == 0, along);
    }
  }
  return force;
}

int vertex_at(const SheetMesh& sheet, double xi, double eta) {
  const auto index = [](double t, int count) { return static_cast<int>(std::lround(0.5 * (t + 1) * (count - 1))); };
  return index(eta, sheet.rows) * sheet.columns + index(xi, sheet.columns);
}

Vec2 movement_at(const SheetMesh& sheet, const ClampSlip& slip, double xi, double eta) {
  return slip.movement(vertex_at(sheet, xi, eta));
}

TEST_CASE("ClampSlip.where_all_of_the_rim_is_pulled_alike_it_comes_in_evenly") {
  const SheetMesh sheet = make_sheet_mesh(oblong_mm, 3072);
  ClampSlip slip(sheet, oblong_mm);
  const auto check = [&] {
    CHECK((movement_at(sheet, slip, 1, 0) - Vec2(-1, 0)).norm() < 1e-9);
    CHECK((movement_at(sheet, slip, 0, -1) - Vec2(0, 1)).norm() < 1e-9);
    CHECK((movement_at(sheet, slip, -1, 0.5) - Vec2(1, -0.125)).norm() < 1e-9);
    CHECK(movement_at(sheet, slip, 0, 0).norm() == 0);
  };
  check();  // before anything pulls
  slip.feel(pulled(sheet, [](bool, double) { return 0.02; }));
  check();
  slip.feel(Positions::Zero(sheet.flat_mm.rows(), 3));
  check();
}

TEST_CASE("ClampSlip.half_the_pull_moves_a_quarter_and_a_push_nothing") {
  const SheetMesh sheet = make_sheet_mesh(oblong_mm, 3072);
  ClampSlip slip(sheet, oblong_mm);
  slip.feel(pulled(sheet, [](bool on_x_side, double) { return on_x_side ? 0.04 : 0.02; }));
  CHECK((movement_at(sheet, slip, 1, 0) - Vec2(-1, 0)).norm() < 1e-9);
  CHECK((movement_at(sheet, slip, 0, 1) - Vec2(0, -0.25)).norm() < 1e-9);
  slip.feel(pulled(sheet, [](bool on_x_side, double) { return on_x_side ? 0.04 : -0.02; }));
  CHECK(movement_at(sheet, slip, 0, 1).norm() == 0);
}

/// Mean of cos(a t) over [-1, 1] with the weights (1 - t^2)^2.
double averaged_cosine(double a) {
  const double a2 = a * a;
  return 15 / (a2 * a2 * a) * ((3 - a2) * std::sin(a) - 3 * a * std::cos(a));
}

TEST_CASE("ClampSlip.converges_to_the_closed_form_of_a_pull_that_falls_as_a_cosine") {
  // An average of cosines is a cosine; on the short side the average takes more off the peak.
  const double reach_mm = 0.15 * oblong_mm.y(), wave = 0.5 * std::numbers::pi;
  const double short_side = averaged_cosine(wave * reach_mm / (0.5 * oblong_mm.y())),
               long_side = averaged_cosine(wave * reach_mm / (0.5 * oblong_mm.x()));
  const double exact = -0.5 * std::pow(short_side / long_side, 2);
  std::vector<double> errors;
  for (const int triangles : {192, 768, 3072, 12288}) {
    const SheetMesh sheet = make_sheet_mesh(oblong_mm, triangles);
    ClampSlip slip(sheet, oblong_mm);
    slip.feel(pulled(sheet, [&](bool, double along) { return std::cos(wave * along); }));
    errors.push_back(std::abs(movement_at(sheet, slip, 1, 0.5).x() - exact));
  }
  INFO(exact << ": " << errors[0] << " " << errors[1] << " " << errors[2] << " " << errors[3]);
  CHECK(errors.back() < 1e-5);
  CHECK(std::log2(errors.front() / errors.back()) / 3 > 1.7);
}

TEST_CASE("ClampSlip.a_formed_sheet_comes_in_farthest_in_the_middle_of_its_sides") {
  ThermoformOptions o = fine_stepping_machine(1500);
  o.clamp_slip_mm = 3;
  const FormedResult formed = form(pyramid(60, 40), o);
  const SheetMesh sheet = make_sheet_mesh(Vec2(120, 120), o.triangles);
  const auto drawn_in = [&](double xi, double eta) {
    const int v = vertex_at(sheet, xi, eta);
    return Vec2(sheet.flat_mm.row(v) - formed.sheet.mesh.V.row(v).head<2>()).cwiseAbs().eval();
  };
  const double middle = drawn_in(1, 0).x(), near_corner = drawn_in(1, 0.75).x(), corner = drawn_in(1, 1).x();
  CAPTURE(middle, near_corner, corner);
  CHECK(middle <= o.clamp_slip_mm);
  CHECK(middle > 0.5 * o.clamp_slip_mm);
  CHECK(near_corner < 0.8 * middle);
  CHECK(corner < near_corner);
  // As symmetric as sheet and model are, but for what touches a step sooner or later (0.14 mm).
  for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    std::vector<double> alike;
    for (const double side : {-1.0, 1.0})
      for (const double along : {-t, t}) {
        alike.push_back(drawn_in(side, along).x());
        alike.push_back(drawn_in(along, side).y());
      }
    const auto [least, most] = std::minmax_element(alike.begin(), alike.end());
    CAPTURE(t);
    CHECK(*most - *least < 0.15);
  }
}

}  // namespace
}  // namespace formwright
