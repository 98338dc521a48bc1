// SPDX-License-Identifier: GPL-3.0-or-later
#include "command_line/flags.h"

#include <catch2/catch_test_macros.hpp>

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
    CHECK(error.code() == ErrorCode::invalid_input);
    return error.what();
  }
  return "none";
}

TEST_CASE("Flags.TakesTheNextWordOrWhatStandsBehindTheSign") {
  CHECK(read({"--out", "a b", "--mesh=c=d"}) == FlagValues{{"--out", {"a b"}}, {"--mesh", {"c=d"}}});
  CHECK(read({"--direction", "-1,0,-.5"}) == FlagValues{{"--direction", {"-1,0,-.5"}}});
  CHECK(read({"--out", "--mesh"}) == FlagValues{{"--out", {"--mesh"}}});
  CHECK(read({"--out=", "--mesh", "[a,b]"}) == FlagValues{{"--out", {""}}, {"--mesh", {"[a,b]"}}});
  CHECK(read({"--mesh", "a", "--mesh", "b"}) == FlagValues{{"--mesh", {"a", "b"}}});
}

TEST_CASE("Flags.ValuesThatMayBeLeftOut") {
  CHECK(read({"--depth-order", "--quiet"}) == FlagValues{{"--depth-order", {"on"}}, {"--quiet", {"on"}}});
  CHECK(read({"--depth-order", "off"}) == FlagValues{{"--depth-order", {"off"}}});
  CHECK(read({"--quiet", "--depth-order=off"}) == FlagValues{{"--depth-order", {"off"}}, {"--quiet", {"on"}}});
  CHECK(read({}).empty());
}

TEST_CASE("Flags.MistakesNameTheFlag") {
  CHECK(mistake({"--mesh", "a", "--out"}) == "--out needs a value.");
  CHECK(mistake({"--ou", "x"}) == "unknown --ou");
  CHECK(mistake({"--ou=x", "--mesh", "a"}) == "unknown --ou");
  CHECK(mistake({"stray", "--out", "x"}) == "unknown stray");
  CHECK(mistake({"--quiet", "-x"}) == "unknown -x");
}

}  // namespace
}  // namespace formwright
