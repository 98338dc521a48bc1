// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/json_text.h"

#include <gtest/gtest.h>

#include <string>

namespace formwright {
namespace {

std::string nested(int depth) {
  return std::string(static_cast<std::size_t>(depth), '[') + std::string(static_cast<std::size_t>(depth), ']');
}

TEST(JsonText, ReadsWhatIsJson) {
  EXPECT_EQ(parse_json_text(R"({"a": [1, {"b": "]}\"[{"}], "c": null})").dump(),
            R"({"a":[1,{"b":"]}\"[{"}],"c":null})");
  EXPECT_EQ(parse_json_text("3").get<int>(), 3);
  EXPECT_TRUE(parse_json_text<nlohmann::json>("{}").is_object());
}

TEST(JsonText, DiscardsWhatIsNot) {
  for (const char* const text : {"", "{", "]", "[1,]", "\"", "{\"a\":1}}", "nul", "\"\\"}) {
    const Json value = parse_json_text(text);
    EXPECT_TRUE(value.is_discarded()) << text;
    EXPECT_FALSE(value.is_object()) << text;
  }
}

TEST(JsonText, NestingEndsAtTheLimit) {
  EXPECT_TRUE(parse_json_text(nested(64)).is_array());
  EXPECT_TRUE(parse_json_text(nested(65)).is_discarded());
  EXPECT_TRUE(parse_json_text(nested(65), {.max_depth = 65}).is_array());
  EXPECT_TRUE(parse_json_text(std::string(200'000, '[')).is_discarded());
  EXPECT_TRUE(parse_json_text(nested(1'000'000)).is_discarded());
  // Beside one another, or inside a string, they do not nest.
  std::string flat = "[";
  for (int i = 0; i < 1000; ++i) flat += "[],";
  EXPECT_EQ(parse_json_text(flat + "\"" + std::string(1000, '[') + "\"]").size(), 1001u);
}

TEST(JsonText, ObjectsHaveSoManyMembers) {
  const auto object = [](int members) {
    std::string text = "{";
    for (int i = 0; i < members; ++i) text += (i ? ",\"k" : "\"k") + std::to_string(i) + "\":0";
    return text + "}";
  };
  EXPECT_EQ(parse_json_text(object(4096)).size(), 4096u);
  EXPECT_TRUE(parse_json_text(object(4097)).is_discarded());
  EXPECT_TRUE(parse_json_text("[" + object(4000) + "," + object(4000) + "]").is_array());
}

}  // namespace
}  // namespace formwright
