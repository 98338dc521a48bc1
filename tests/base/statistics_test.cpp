// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/statistics.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>

#include "base/random.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinULP;

TEST_CASE("Statistics.RanksAreThoseOfTheSortedValues") {
  Random random(3);
  for (std::size_t n = 1; n < 40; ++n) {
    std::vector<double> values(n);
    for (double& v : values) v = std::floor(random.uniform(-5, 5));  // many equal ones
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t rank = 0; rank < n; ++rank) CHECK(value_of_rank(values, rank) == sorted[rank]);
    CHECK(median(values) == sorted[n / 2]);
    for (const double share : {0.0, 0.05, 0.5, 0.9, 0.95, 1.0}) {
      const double at = share * static_cast<double>(n - 1);
      const auto low = static_cast<std::size_t>(at), high = std::min(low + 1, n - 1);
      CHECK(quantile(values, share) == sorted[low] + (at - static_cast<double>(low)) * (sorted[high] - sorted[low]));
    }
  }
}

TEST_CASE("Statistics.KnownValues") {
  CHECK(median(std::vector<float>{3, 1, 2}) == 2.0f);
  CHECK(median(std::vector<double>{4, 1, 3, 2}) == 3.0);
  CHECK(median(std::vector<double>{}) == 0.0);
  CHECK(quantile({10, 20, 30, 40, 50}, 0.25) == 20.0);
  CHECK_THAT(quantile({10, 20}, 0.3), WithinULP(13.0, 4));
  CHECK(quantile({7}, 0.95) == 7.0);
}

}  // namespace
}  // namespace formwright
