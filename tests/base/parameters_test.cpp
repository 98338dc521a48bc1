// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/data/parameters.h"

#include <catch2/catch_test_macros.hpp>

namespace formwright {

enum class Colour { red, deep_blue };
template <>
struct EnumNames<Colour> {
  static constexpr std::array<std::string_view, 2> names{"red", "deep_blue"};
  static constexpr std::array<std::string_view, 2> labels{"Red", "Deep blue"};
  static constexpr std::array<std::pair<std::string_view, Colour>, 1> old_names{{{"navy", Colour::deep_blue}}};
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
      parameter("coats", &PaintOptions::coats, "Coats", unit::none, 1, 9, "How many.").formerly("layers"),
      parameter("gloss", &PaintOptions::gloss, "Gloss", "Shiny.").only_with("colour", "red"),
      parameter("drying_s", &PaintOptions::drying_s, "Drying", unit::seconds, 0, 100, "Time between coats.").advanced(),
      parameter("colour", &PaintOptions::colour, "Colour", "Which."),
      parameter("from", &PaintOptions::from, "From", "Where the brush comes from.").group("Brush")};
};

void expect_rejected(const Json& object, const std::string& where, const std::string& part) {
  try {
    read_parameters<PaintOptions>(object);
    FAIL(object << " was accepted");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::invalid_input);
    CHECK(error.where() == where);
    INFO(error.what());
    CHECK(std::string(error.what()).find(part) != std::string::npos);
  }
}

TEST_CASE("Parameters.AbsentNamesKeepTheMemberInitialisers") {
  const auto options = read_parameters<PaintOptions>(Json::object());
  CHECK(options.layer_mm == 0.5);
  CHECK(options.coats == 2);
  CHECK_FALSE(options.drying_s);
  CHECK(options.colour == Colour::deep_blue);
}

TEST_CASE("Parameters.ReadsWhatItWrites") {
  PaintOptions options;
  options.layer_mm = 1.25;
  options.coats = 7;
  options.gloss = true;
  options.drying_s = 12.5;
  options.colour = Colour::red;
  options.from = {1, 2, 3};
  const Json written = write_parameters(options);
  CHECK(write_parameters(read_parameters<PaintOptions>(Json::parse(written.dump()))) == written);
}

TEST_CASE("Parameters.RejectsWithNameRangeAndFix") {
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

TEST_CASE("Parameters.NamesOfTheReleaseBeforeAreUnderstood") {
  const PaintOptions options = read_parameters<PaintOptions>({{"layers", 7}, {"colour", "navy"}});
  CHECK(options.coats == 7);
  CHECK(options.colour == Colour::deep_blue);
  expect_rejected({{"layers", 10}}, "coats", "from 1 to 9");
  CHECK(write_parameters(options).contains("coats"));
  CHECK_FALSE(write_parameters(options).contains("layers"));
  CHECK(describe_parameters<PaintOptions>()[1].old_name == "layers");
  CHECK(describe_parameters<PaintOptions>()[0].old_name.empty());
}

TEST_CASE("Parameters.SchemaCarriesUnitRangeDefaultAndHelp") {
  const auto infos = describe_parameters<PaintOptions>();
  const Json layer = parameter_schema(infos[0]);
  CHECK(layer["type"] == "number");
  CHECK(layer["minimum"] == 0.1);
  CHECK(layer["maximum"] == 3.0);
  CHECK(layer["default"] == 0.5);
  CHECK(layer["x-unit"] == "mm");
  CHECK(layer["x-slider"] == Json{0.2, 1.0});
  CHECK(parameter_schema(infos[3])["x-advanced"]);
  CHECK(parameter_schema(infos[3])["default"] == nullptr);
  CHECK(parameter_schema(infos[4])["enum"] == Json{"red", "deep_blue"});
  CHECK(parameter_schema(infos[5])["x-group"] == "Brush");
  CHECK(parameter_schema(infos[2])["x-only-with"] == Json{{"parameter", "colour"}, {"values", {"red"}}});
  CHECK_FALSE(parameter_schema(infos[1]).contains("x-only-with"));
}

TEST_CASE("Parameters.FlagsParseToTheSameValues") {
  const auto infos = describe_parameters<PaintOptions>();
  CHECK(flag_name(infos[0]) == "--layer-mm");
  CHECK(parse_flag(infos[0], "0.75") == 0.75);
  CHECK(parse_flag(infos[2], "on") == true);
  CHECK(parse_flag(infos[3], "auto") == nullptr);
  CHECK(parse_flag(infos[5], "0,-1,0.5") == Json{0.0, -1.0, 0.5});
  CHECK_THROWS_AS(parse_flag(infos[0], "5mm"), Error);
  CHECK_THROWS_AS(parse_flag(infos[5], "1,,2"), Error);
  CHECK_THROWS_AS(parse_flag(infos[2], "maybe"), Error);
}

}  // namespace
}  // namespace formwright
