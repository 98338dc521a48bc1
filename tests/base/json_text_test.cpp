// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/data/json_text.h"

#include <catch2/catch_test_macros.hpp>

#include <string>

namespace formwright {
namespace {

std::string nested(int depth) {
  return std::string(static_cast<std::size_t>(depth), '[') + std::string(static_cast<std::size_t>(depth), ']');
}

TEST_CASE("JsonText.ReadsWhatIsJson") {
  CHECK(parse_json_text(R"({"a": [1, {"b": "]}\"[{"}], "c": null})").dump() == R"({"a":[1,{"b":"]}\"[{"}],"c":null})");
  CHECK(parse_json_text("3").get<int>() == 3);
  CHECK(parse_json_text<nlohmann::json>("{}").is_object());
}

TEST_CASE("JsonText.DiscardsWhatIsNot") {
  for (const char* const text : {"", "{", "]", "[1,]", "\"", "{\"a\":1}}", "nul", "\"\\"}) {
    const Json value = parse_json_text(text);
    INFO(text);
    CHECK(value.is_discarded());
    CHECK_FALSE(value.is_object());
  }
}

TEST_CASE("JsonText.NestingEndsAtTheLimit") {
  CHECK(parse_json_text(nested(64)).is_array());
  CHECK(parse_json_text(nested(65)).is_discarded());
  CHECK(parse_json_text(nested(65), {.max_depth = 65}).is_array());
  CHECK(parse_json_text(std::string(200'000, '[')).is_discarded());
  CHECK(parse_json_text(nested(1'000'000)).is_discarded());
  // Beside one another, or inside a string, they do not nest.
  std::string flat = "[";
  for (int i = 0; i < 1000; ++i) flat += "[],";
  CHECK(parse_json_text(flat + "\"" + std::string(1000, '[') + "\"]").size() == 1001u);
}

TEST_CASE("JsonText.ObjectsHaveSoManyMembers") {
  const auto object = [](int members) {
    std::string text = "{";
    for (int i = 0; i < members; ++i) text += (i ? ",\"k" : "\"k") + std::to_string(i) + "\":0";
    return text + "}";
  };
  CHECK(parse_json_text(object(4096)).size() == 4096u);
  CHECK(parse_json_text(object(4097)).is_discarded());
  CHECK(parse_json_text("[" + object(4000) + "," + object(4000) + "]").is_array());
}

}  // namespace
}  // namespace formwright
