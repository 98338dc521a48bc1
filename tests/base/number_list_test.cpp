// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/number_list.h"

#include <gtest/gtest.h>

namespace formwright {
namespace {

TEST(NumberList, TakesBlanksCommasAndSemicolons) {
  EXPECT_EQ(read_number_list("120,80 1900.5, -95;3e2"), (std::vector<double>{120, 80, 1900.5, -95, 300}));
  EXPECT_EQ(read_number_list(""), std::vector<double>{});
  EXPECT_EQ(read_number_list(" ;, "), std::vector<double>{});
}

TEST(NumberList, RefusesWhatIsNoFiniteNumber) {
  for (const char* text : {"a", "1 x", "1..2", "nan", "inf 3", "1e999", "1-", "--2"})
    EXPECT_FALSE(read_number_list(text)) << text;
}

}  // namespace
}  // namespace formwright
