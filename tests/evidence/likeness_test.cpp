// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/explanations/likeness.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>

#include "evidence/fit/hypotheses.h"
#include "evidence/toy_model.h"

namespace formwright {
namespace {

using Catch::Matchers::WithinAbs;

/// The residual and what each parameter of the toy does, as vectors of which the first two directions are those of the
/// base parameters.
GramByStructure gram_of(const Eigen::Matrix<double, 8, 1>& residual) {
  Eigen::Matrix<double, 8, 8> columns = Eigen::Matrix<double, 8, 8>::Zero();
  columns.col(0) = residual;
  columns(0, 1) = 3;                     // height
  columns(1, 2) = 0.5;                   // tilt
  columns(2, 3) = 2, columns(0, 3) = 7;  // bump
  columns(3, 4) = 1, columns(1, 4) = 4;  // ripple
  columns(4, 5) = 0.1;                   // drift_x
  columns(5, 6) = 10;                    // drift_y
  columns.col(7) = residual;             // something that is no parameter
  return {{columns.transpose() * columns}, {0}};
}

TEST_CASE("Likeness.IsTheCosineBesideWhatTheBaseParametersCanDo") {
  const evidence_test::ToyModel model(10);
  Eigen::Matrix<double, 8, 1> residual;
  residual << 5, -2, 3, 0, 4, 0, 0, 0;
  const std::vector<double> found = likenesses(model, gram_of(residual));
  REQUIRE(found.size() == 3);
  CHECK_THAT(found[0], WithinAbs(0.6, 1e-9));  // bump
  CHECK_THAT(found[1], WithinAbs(0, 1e-9));    // ripple
  CHECK_THAT(found[2], WithinAbs(0.8, 1e-9));  // drift, along the nearest of its directions
}

TEST_CASE("Likeness.OfNothingIsNone") {
  const evidence_test::ToyModel model(10);
  for (const double found : likenesses(model, gram_of(Eigen::Matrix<double, 8, 1>::Zero()))) CHECK(found == 0);
}

TEST_CASE("VisibleStrength.WhereTheMaterialWasMeasuredItIsThatOfItsOwnPlace") {
  // What the parameters do at two places, one set after the other: the bump does something else at each.
  Eigen::Matrix<double, 5, 13> columns = Eigen::Matrix<double, 5, 13>::Zero();
  columns(0, 1) = columns(0, 7) = 3;    // height
  columns(1, 2) = columns(1, 8) = 0.5;  // tilt
  columns(2, 3) = 2;                    // bump at the first place
  columns(3, 9) = 2;                    // at the second
  const GramByStructure gram{{columns.transpose() * columns}, {0}};
  evidence_test::ToyModel model(10);
  constexpr int bump = 0;
  const auto visible = [&] { return min_visible_strength(model, gram, 0, {0, 1, 2, 3, 4, 5}, bump); };
  CHECK(std::isinf(visible()));
  model.set_measured_height(0.05);
  CHECK_THAT(visible(), WithinAbs(4 / 2.0, 1e-9));  // four standard deviations
}

}  // namespace
}  // namespace formwright
