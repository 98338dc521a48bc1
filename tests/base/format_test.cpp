// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/format.h"

#include <catch2/catch_test_macros.hpp>

#include <cmath>
#include <cstdio>
#include <limits>

#include "base/random.h"

namespace formwright {
namespace {

std::string printed(const char* format, int precision, double value) {
  char text[512];
  std::snprintf(text, sizeof text, format, precision, value);
  return text;
}

TEST_CASE("Format.AgreesWithPrintf") {
  Random random(7);
  for (int k = 0; k < 3000; ++k) {
    const double value = random.uniform(-1, 1) * std::pow(10, random.uniform(-12, 12));
    for (const int precision : {0, 1, 2, 3, 6, 17}) {
      CHECK(with_decimals(value, precision) == printed("%.*f", precision, value));
      if (precision > 0 && std::abs(value) < 0.99 * std::pow(10, precision))
        CHECK(with_digits(value, precision) == printed("%.*g", precision, value));
    }
  }
  const double largest = std::numeric_limits<double>::max();
  CHECK(with_decimals(-largest, 17) == printed("%.*f", 17, -largest));
}

TEST_CASE("Format.KnownNumbers") {
  CHECK(with_digits(1234567, 3) == "1230000");
  CHECK(with_digits(-289.6, 2) == "-290");
  CHECK(with_digits(99.96, 3) == "100");
  CHECK(with_digits(1e6, 6) == "1000000");
  CHECK(with_digits(1e-5, 2) == "1e-05");
  CHECK(with_digits(2.5, 3) == "2.5");
  CHECK(with_decimals(0.125, 2) == "0.12");  // halves to the even digit
  CHECK(with_max_decimals(12.5, 3) == "12.5");
  CHECK(with_max_decimals(100, 3) == "100");
  CHECK(with_max_decimals(100, 0) == "100");
  CHECK(with_max_decimals(-0.0001, 3) == "0");
  CHECK(with_max_decimals(-0.0, 0) == "0");
  CHECK(with_max_decimals(1e15, 2) == "1000000000000000");
}

}  // namespace
}  // namespace formwright
