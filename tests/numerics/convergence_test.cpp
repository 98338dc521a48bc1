// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/convergence.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <limits>

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

TEST_CASE("Convergence.EqualFactorsAreEqualShares") {
  Convergence convergence(1e-8);
  for (int step = 0; step <= 10; ++step)
    CHECK_THAT(convergence.passed(100 * std::pow(0.1, step)), WithinAbs(0.1 * step, 1e-12));
  CHECK(convergence.passed(0) == 1);
}

TEST_CASE("Convergence.NeverFalls") {
  Convergence convergence(1e-4);
  CHECK(convergence.passed(1) == 0);
  // An error that grows at first is the one to count from.
  CHECK(convergence.passed(100) == 0);
  CHECK_THAT(convergence.passed(0.1), WithinAbs(0.5, 1e-12));
  CHECK_THAT(convergence.passed(10), WithinAbs(0.5, 1e-12));
  CHECK_THAT(convergence.passed(std::numeric_limits<double>::quiet_NaN()), WithinAbs(0.5, 1e-12));
  CHECK_THAT(convergence.passed(std::numeric_limits<double>::infinity()), WithinAbs(0.5, 1e-12));
  CHECK_THAT(convergence.passed(-1), WithinAbs(0.5, 1e-12));
  CHECK(convergence.passed(1e-5) == 1);
  CHECK(convergence.passed(1) == 1);
}

TEST_CASE("Convergence.WhatBeginsWithinTheToleranceIsDone") {
  Convergence convergence(1e-4);
  CHECK(convergence.passed(1e-6) == 1);
  CHECK(convergence.passed(3) == 1);
}

}  // namespace
}  // namespace formwright
