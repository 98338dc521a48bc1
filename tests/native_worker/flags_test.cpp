// SPDX-License-Identifier: GPL-3.0-or-later
#include "flags.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace formwright {
namespace {

using Words = std::vector<std::string>;

FlagValues read(const Words& words) {
  using Value = FlagRule::Value;
  return read_flags(
      words, {{"--out"}, {"--mesh"}, {"--direction"}, {"--depth-order", Value::optional}, {"--quiet", Value::none}},
      [](const std::string& word) { return "unknown " + word; });
}

std::string mistake(const Words& words) {
  try {
    read(words);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_input);
    return error.what();
  }
  return "none";
}

TEST(Flags, TakesTheNextWordOrWhatStandsBehindTheSign) {
  EXPECT_EQ(read({"--out", "a b", "--mesh=c=d"}), (FlagValues{{"--out", {"a b"}}, {"--mesh", {"c=d"}}}));
  EXPECT_EQ(read({"--direction", "-1,0,-.5"}), (FlagValues{{"--direction", {"-1,0,-.5"}}}));
  EXPECT_EQ(read({"--out", "--mesh"}), (FlagValues{{"--out", {"--mesh"}}}));
  EXPECT_EQ(read({"--out=", "--mesh", "[a,b]"}), (FlagValues{{"--out", {""}}, {"--mesh", {"[a,b]"}}}));
  EXPECT_EQ(read({"--mesh", "a", "--mesh", "b"}), (FlagValues{{"--mesh", {"a", "b"}}}));
}

TEST(Flags, ValuesThatMayBeLeftOut) {
  EXPECT_EQ(read({"--depth-order", "--quiet"}), (FlagValues{{"--depth-order", {"on"}}, {"--quiet", {"on"}}}));
  EXPECT_EQ(read({"--depth-order", "off"}), (FlagValues{{"--depth-order", {"off"}}}));
  EXPECT_EQ(read({"--quiet", "--depth-order=off"}), (FlagValues{{"--depth-order", {"off"}}, {"--quiet", {"on"}}}));
  EXPECT_TRUE(read({}).empty());
}

TEST(Flags, MistakesNameTheFlag) {
  EXPECT_EQ(mistake({"--mesh", "a", "--out"}), "--out needs a value.");
  EXPECT_EQ(mistake({"--ou", "x"}), "unknown --ou");
  EXPECT_EQ(mistake({"--ou=x", "--mesh", "a"}), "unknown --ou");
  EXPECT_EQ(mistake({"stray", "--out", "x"}), "unknown stray");
  EXPECT_EQ(mistake({"--quiet", "-x"}), "unknown -x");
}

}  // namespace
}  // namespace formwright
