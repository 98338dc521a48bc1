// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/mould/vents.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>

#include "base/error.h"
#include "geometry/test_meshes.h"
#include "thermoform/mould/solid_shapes.h"
#include "thermoform/sheet/sheet_effects.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

const TriangleMesh block = box_mesh({-30, -30, 0}, {30, 30, 10});

/// A flat sheet of 80 x 80 mm, 1 mm nodes, half its thickness above the block's top where it lies on it.
template <class Contact>
FormedSheet flat_sheet(Contact contact_s, double gap_mm = 0) {
  FormedSheet sheet;
  sheet.mesh = test::grid(80, 80);
  const Eigen::Index n = sheet.mesh.V.rows();
  sheet.thickness_mm = Eigen::VectorXd::Constant(n, 0.5);
  sheet.stretch = Eigen::VectorXd::Ones(n);
  sheet.contact_s.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    sheet.mesh.V.row(i) << 80 * sheet.mesh.V(i, 0) - 40, 80 * sheet.mesh.V(i, 1) - 40, 10.25;
    sheet.contact_s[i] = contact_s(sheet.mesh.V(i, 0), sheet.mesh.V(i, 1));
    if (sheet.contact_s[i] < 0) sheet.mesh.V(i, 2) += gap_mm;
  }
  sheet.sheet_mm = sheet.mesh.V.leftCols<2>();
  return sheet;
}

double hill(double x, double y, double cx, double cy) {
  return std::exp(-(std::pow(x - cx, 2) + std::pow(y - cy, 2)) / 50);
}

TEST_CASE("Vents.LieAtTheLastPlacesToForm") {
  Context context;
  const FormedSheet sheet = flat_sheet(
      [](double x, double y) { return 1 + 2 * hill(x, y, 10, 5) + hill(x, y, -12, -7) + 3 * hill(x, y, 38, 0); });
  const auto vents = find_vents(block, sheet, 10, 1, 5, context);
  REQUIRE(vents.size() == 2u);  // the third and latest hill lies beside the model, where the plate sucks
  CHECK_THAT((vents[0].position_mm - Vec3(10, 5, 10)).norm(), WithinAbs(0, 1e-9));
  CHECK_THAT((vents[1].position_mm - Vec3(-12, -7, 10)).norm(), WithinAbs(0, 1e-9));
  CHECK_THAT(vents[0].contact_s, WithinAbs(3, 1e-3));
  CHECK_THAT(vents[0].gap_mm, WithinAbs(0, 1e-9));
  CHECK(find_vents(block, sheet, 1, 1, 5, context).size() == 1u);
  CHECK(find_vents(block, sheet, 10, 1, 30, context).size() == 1u);  // 25 mm apart
  CHECK(find_vents(block, sheet, 10, 13, 5, context).size() == 1u);  // wide ones keep twice their diameter
  CHECK(find_vents(block, sheet, 0, 1, 5, context).empty());
}

TEST_CASE("Vents.WhereItNeverArrivesComesFirst") {
  Context context;
  const FormedSheet sheet = flat_sheet(
      [](double x, double y) { return std::hypot(x + 12, y + 7) < 3.5 ? -1.0 : 1 + 2 * hill(x, y, 10, 5); }, 4);
  const auto vents = find_vents(block, sheet, 10, 1, 10, context);
  REQUIRE(vents.size() == 2u);
  CHECK((vents[0].position_mm - Vec3(-12, -7, 10)).norm() < 3.6);
  CHECK(vents[0].contact_s == -1);
  CHECK_THAT(vents[0].gap_mm, WithinAbs(4, 1e-9));
  CHECK_THAT((vents[1].position_mm - Vec3(10, 5, 10)).norm(), WithinAbs(0, 1e-9));
}

TEST_CASE("Vents.HollowsBeforePlains") {
  Context context;
  FormedSheet sheet = flat_sheet([](double, double) { return 1.0; });  // everything at once
  for (Eigen::Index i = 0; i < sheet.mesh.V.rows(); ++i)
    sheet.mesh.V(i, 2) += 1 - hill(sheet.mesh.V(i, 0), sheet.mesh.V(i, 1), 6, -4);
  const auto vents = find_vents(block, sheet, 1, 1, 5, context);
  REQUIRE(vents.size() == 1u);
  CHECK_THAT((vents[0].position_mm - Vec3(6, -4, 10)).norm(), WithinAbs(0, 1e-9));
}

TEST_CASE("Vents.OfAMouldThatTheMachineDisplacesLieInTheMouldItself") {
  Context context;
  const FormedSheet sheet =
      flat_sheet([](double x, double y) { return 1 + 2 * hill(x, y, 10, 5) + hill(x, y, -12, -7); });
  Placement nominal;
  nominal.linear = 0.5 * Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  nominal.translation = {4, -2, 7};
  SheetEffects machine;
  machine.mould_shift_x_mm = 6;
  machine.mould_shift_y_mm = -3;
  machine.mould_rotation_deg = 5;
  machine.mould_scale = 0.04;
  const Placement real = displaced(nominal, machine);
  FormedSheet formed = sheet;  // all of it moved as the mould is, as in an opening without end
  for (Eigen::Index i = 0; i < formed.mesh.V.rows(); ++i) {
    const Vec3 p = sheet.mesh.V.row(i), in_file = nominal.linear.inverse() * (p - nominal.translation);
    formed.mesh.V.row(i) = real(in_file);
  }
  const auto vents = find_vents(block, about_the_model(formed, nominal, real), 10, 1, 5, context);
  REQUIRE(vents.size() == 2u);
  CHECK_THAT((vents[0].position_mm - Vec3(10, 5, 10)).norm(), WithinAbs(0, 1e-9));
  CHECK_THAT((vents[1].position_mm - Vec3(-12, -7, 10)).norm(), WithinAbs(0, 1e-9));
  // The places on the plate itself are others.
  const auto beside = find_vents(block, formed, 10, 1, 5, context);
  REQUIRE_FALSE(beside.empty());
  CHECK((beside[0].position_mm - vents[0].position_mm).head<2>().norm() > 4);
}

TEST_CASE("Vents.NotThroughASide") {
  Context context;
  const FormedSheet sheet = flat_sheet([](double x, double y) { return 1 + hill(x, y, 29, 0); });
  CHECK(find_vents(block, sheet, 10, 2, 5, context).empty());
  CHECK(find_vents(block, sheet, 10, 0.5, 5, context).size() == 1u);
}

}  // namespace
}  // namespace formwright
