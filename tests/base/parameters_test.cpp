// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parameters.h"

#include <gtest/gtest.h>

namespace formwright {

enum class Colour { red, deep_blue };
template <>
struct EnumNames<Colour> {
  static constexpr std::array<std::string_view, 2> names{"red", "deep_blue"};
  static constexpr std::array<std::string_view, 2> labels{"Red", "Deep blue"};
};

namespace {

struct PaintOptions {
  double layer_mm = 0.5;
  int coats = 2;
  bool gloss = false;
  std::optional<double> drying_s;
  Colour colour = Colour::deep_blue;
  std::array<double, 3> from{0, 0, 1};
  static constexpr auto parameters = std::tuple{
      parameter("layer_mm", &PaintOptions::layer_mm, "Layer", unit::mm, 0.1, 3, "Thickness of a coat.").slider(0.2, 1),
      parameter("coats", &PaintOptions::coats, "Coats", unit::none, 1, 9, "How many."),
      parameter("gloss", &PaintOptions::gloss, "Gloss", "Shiny."),
      parameter("drying_s", &PaintOptions::drying_s, "Drying", unit::seconds, 0, 100, "Time between coats.").advanced(),
      parameter("colour", &PaintOptions::colour, "Colour", "Which."),
      parameter("from", &PaintOptions::from, "From", "Where the brush comes from.").group("Brush")};
};

void expect_rejected(const Json& object, const std::string& where, const std::string& part) {
  try {
    read_parameters<PaintOptions>(object);
    FAIL() << object << " was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_input);
    EXPECT_EQ(error.where(), where);
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(Parameters, AbsentNamesKeepTheMemberInitialisers) {
  const auto options = read_parameters<PaintOptions>(Json::object());
  EXPECT_EQ(options.layer_mm, 0.5);
  EXPECT_EQ(options.coats, 2);
  EXPECT_FALSE(options.drying_s);
  EXPECT_EQ(options.colour, Colour::deep_blue);
}

TEST(Parameters, ReadsWhatItWrites) {
  PaintOptions options;
  options.layer_mm = 1.25;
  options.coats = 7;
  options.gloss = true;
  options.drying_s = 12.5;
  options.colour = Colour::red;
  options.from = {1, 2, 3};
  const Json written = write_parameters(options);
  EXPECT_EQ(write_parameters(read_parameters<PaintOptions>(Json::parse(written.dump()))), written);
}

TEST(Parameters, RejectsWithNameRangeAndMend) {
  expect_rejected({{"layer_mm", 5}}, "layer_mm", "from 0.1 to 3 mm");
  expect_rejected({{"layer_mm", "thick"}}, "layer_mm", "must be a number");
  expect_rejected({{"coats", 2.5}}, "coats", "whole number");
  expect_rejected({{"gloss", 1}}, "gloss", "true or false");
  expect_rejected({{"colour", "green"}}, "colour", "red, deep_blue");
  expect_rejected({{"from", {1, 2}}}, "from", "three numbers");
  expect_rejected({{"layer_m", 1}}, "layer_m", "did you mean layer_mm?");
  expect_rejected({{"zzz", 1}}, "zzz", "no parameter called zzz.");
  expect_rejected(Json::array(), "parameters", "JSON object");
}

TEST(Parameters, SchemaCarriesUnitRangeDefaultAndHelp) {
  const auto infos = describe_parameters<PaintOptions>();
  const Json layer = parameter_schema(infos[0]);
  EXPECT_EQ(layer["type"], "number");
  EXPECT_EQ(layer["minimum"], 0.1);
  EXPECT_EQ(layer["maximum"], 3.0);
  EXPECT_EQ(layer["default"], 0.5);
  EXPECT_EQ(layer["x-unit"], "mm");
  EXPECT_EQ(layer["x-slider"], (Json{0.2, 1.0}));
  EXPECT_TRUE(parameter_schema(infos[3])["x-advanced"]);
  EXPECT_EQ(parameter_schema(infos[3])["default"], nullptr);
  EXPECT_EQ(parameter_schema(infos[4])["enum"], (Json{"red", "deep_blue"}));
  EXPECT_EQ(parameter_schema(infos[5])["x-group"], "Brush");
}

TEST(Parameters, FlagsParseToTheSameValues) {
  const auto infos = describe_parameters<PaintOptions>();
  EXPECT_EQ(flag_name(infos[0]), "--layer-mm");
  EXPECT_EQ(parse_flag(infos[0], "0.75"), 0.75);
  EXPECT_EQ(parse_flag(infos[2], "on"), true);
  EXPECT_EQ(parse_flag(infos[3], "auto"), nullptr);
  EXPECT_EQ(parse_flag(infos[5], "0,-1,0.5"), (Json{0.0, -1.0, 0.5}));
  EXPECT_THROW(parse_flag(infos[0], "5mm"), Error);
  EXPECT_THROW(parse_flag(infos[5], "1,,2"), Error);
  EXPECT_THROW(parse_flag(infos[2], "maybe"), Error);
}

}  // namespace
}  // namespace formwright
