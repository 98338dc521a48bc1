// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/zipping/made_pattern.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "zippable/zipping/ribbons.h"
#include "zippable/zipping/zipper_hinges.h"
#include "zippable/zipping/zipping.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

constexpr double turn_mm = 100, height_mm = 60;

RibbonPattern helix(int around) {
  Context context;
  return pattern_of(test::cylinder_ribbon({turn_mm, height_mm, 2, around, 0}), 0, context);
}

ZippingOptions inextensible() {
  ZippingOptions options;
  options.stretch_n_per_mm = 10;
  options.bending_n_mm = 0.002;
  return options;
}

/// Once around the cylinder that the ribbon comes to rest as, from its middle part: the axis is across all normals, the
/// circle fits by least squares.
double circumference_mm(const RibbonPattern& pattern, const ZippingOptions& options) {
  Context context;
  const ZippedAtRest rest = zipped_at_rest(pattern, options, pattern.predicted_mm, context);
  CHECK(rest.settled);
  const auto inner = [&](int v) { return std::abs(pattern.predicted_mm(v, 2) - 0.5 * height_mm) < 12; };
  Eigen::Matrix3d normals = Eigen::Matrix3d::Zero();
  for (Eigen::Index f = 0; f < pattern.flat.F.rows(); ++f) {
    const auto v = pattern.flat.F.row(f);
    const Vec3 a = rest.x.row(v[1]) - rest.x.row(v[0]), b = rest.x.row(v[2]) - rest.x.row(v[0]),
               n = a.cross(b).normalized();
    normals += n * n.transpose();
  }
  const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(normals).eigenvectors();
  std::vector<Vec2> points;
  for (int v = 0; v < pattern.flat.vertex_count(); ++v)
    if (inner(v)) points.emplace_back(axes.rightCols<2>().transpose() * rest.x.row(v).transpose());
  Eigen::MatrixX3d rows(static_cast<Eigen::Index>(points.size()), 3);
  Eigen::VectorXd squares(rows.rows());
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const Vec2& p = points[static_cast<std::size_t>(i)];
    rows.row(i) << 2 * p.x(), 2 * p.y(), 1;
    squares[i] = p.squaredNorm();
  }
  const Vec3 circle = rows.colPivHouseholderQr().solve(squares);
  return 2 * std::numbers::pi * std::sqrt(circle[2] + circle.head<2>().squaredNorm());
}

/// From a place of the right edge to the one of the left edge that it is sewn to, in the flat ribbon: once around.
Vec2 once_around(const MakingErrors& errors) {
  const Vec2 along = Vec2(turn_mm, height_mm / 2).normalized(), across(-along.y(), along.x());
  const Vec2 designed(turn_mm, 0);
  return errors.cloth_change() *
         (designed.dot(along) * along + (designed.dot(across) - 2 * errors.edge_shift_mm()) * across);
}

TEST_CASE("MadePattern.IsTheCylinderThatItsPeriodMakes") {
  for (const auto& [name, errors] : std::vector<std::pair<const char*, MakingErrors>>{
           {"as designed", {}},
           {"zipper wider", {.more_gap_mm = 2}},
           {"cloth lost", {.seam_take_up_mm = 0.6}},
           {"kerf", {.more_kerf_mm = 1}},
           {"larger", {.plan_scale = 0.03}},
           {"longer", {.cloth_stretch_along = 0.04, .cloth_stretch_across = -0.05}},
           {"askew", {.cloth_bias = 0.06}}}) {
    CAPTURE(name);
    std::vector<double> off;
    for (const int around : {12, 24}) {
      ZippingOptions options = inextensible();
      static_cast<MakingErrors&>(options) = errors;
      const double expected = once_around(errors).norm(), found = circumference_mm(helix(around), options);
      off.push_back(std::abs(found - expected));
    }
    CAPTURE(off[0], off[1]);
    CHECK(off[1] < 0.5);
    CHECK(off[1] < 0.6 * off[0]);
  }
}

TEST_CASE("MadePattern.WithoutErrorsIsThePattern") {
  const RibbonPattern pattern = helix(12), made = made_pattern(pattern, {});
  CHECK(made.flat.V == pattern.flat.V);
  CHECK(made.cloth_change.empty());
}
TEST_CASE("MadePattern.ANarrowRibbonKeepsItsTriangles") {
  MakingErrors errors;
  errors.seam_take_up_mm = 10;
  const RibbonPattern pattern = helix(12), made = made_pattern(pattern, errors);
  for (const ClothTriangle& t : cloth_triangles(made.flat)) CHECK(t.area_mm2 > 0);
}

TEST_CASE("MadePattern.ClothThatIsTurnedOnItsSheetStretchesInItsOwnDirections") {
  MakingErrors errors;
  errors.cloth_stretch_along = 0.1;
  RibbonPattern pattern = helix(12);
  pattern.turn_of_triangle_rad.assign(static_cast<std::size_t>(pattern.flat.face_count()), std::numbers::pi / 2);
  const Eigen::Matrix2d change = made_pattern(pattern, errors).cloth_change.front();
  CHECK_THAT(change(0, 0), WithinAbs(1, 1e-12));
  CHECK_THAT(change(1, 1), WithinAbs(1.1, 1e-12));
}

TEST_CASE("ZipperHinges.HaveTheEnergyOfARodOnAHelix") {
  // A helix on a cylinder of radius r that rises by `rise` a turn has curvature r / (r^2 + (rise / 2 pi)^2).
  constexpr double bending = 7, rise = height_mm / 2;
  const double radius = turn_mm / (2 * std::numbers::pi), climb = rise / (2 * std::numbers::pi),
               curvature = radius / (radius * radius + climb * climb);
  std::vector<double> off;
  for (const int around : {12, 24, 48}) {
    const RibbonPattern pattern = helix(around);
    const double energy = bending_energy_mj(zipper_hinges(pattern, bending), pattern.predicted_mm);
    const double inner_mm = pattern.zipper_mm * (1 - 1.0 / static_cast<double>(pattern.seams.size() - 1));
    off.push_back(std::abs(energy / (0.5 * bending * curvature * curvature * inner_mm) - 1));
  }
  CHECK(off[2] < 0.005);
  CHECK(std::log2(off[0] / off[1]) > 1.8);
  CHECK(std::log2(off[1] / off[2]) > 1.8);
}

TEST_CASE("ZippedAtRest.HangsFromTheHand") {
  const RibbonPattern pattern = helix(12);
  ZippingOptions options = inextensible();
  options.bending_n_mm = 0.05;
  Context context;
  const ZippedAtRest free = zipped_at_rest(pattern, options, pattern.predicted_mm, context);
  options.hung_at_mm = 0.5 * pattern.zipper_mm;
  double last = 0;
  for (const double weight : {10.0, 20.0}) {
    options.weight_g_per_m2 = weight;
    const ZippedAtRest hung = zipped_at_rest(pattern, options, free.x, context);
    CHECK(hung.settled);
    const double moved = compare_shapes(hung.x, free.x, Eigen::VectorXd::Ones(free.x.rows())).mean_mm;
    CHECK(moved > 1.5 * last);  // about twice as heavy, twice as far
    last = moved;
  }
  CHECK(last > 0.01);
}

}  // namespace
}  // namespace formwright
