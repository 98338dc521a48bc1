// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/data/number_list.h"

#include <catch2/catch_test_macros.hpp>

namespace formwright {
namespace {

TEST_CASE("NumberList.TakesBlanksCommasAndSemicolons") {
  CHECK(read_number_list("120,80 1900.5, -95;3e2") == std::vector<double>{120, 80, 1900.5, -95, 300});
  CHECK(read_number_list("") == std::vector<double>{});
  CHECK(read_number_list(" ;, ") == std::vector<double>{});
}

TEST_CASE("NumberList.RefusesWhatIsNoFiniteNumber") {
  for (const char* text : {"a", "1 x", "1..2", "nan", "inf 3", "1e999", "1-", "--2"}) {
    INFO(text);
    CHECK_FALSE(read_number_list(text));
  }
}

}  // namespace
}  // namespace formwright
