// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/thermoform/cause_words.h"

#include <catch2/catch_test_macros.hpp>

#include <vector>

#include "evidence/models/thermoform/thermoform_model.h"

namespace formwright {
namespace {

std::string words(const char* cause, std::vector<double> values) { return thermoform_cause_in_words(cause, values); }

TEST_CASE("CauseWords.SayWhereAndHowMuch") {
  // Colder towards the right and the back is hotter at the front left, where both add up.
  CHECK(words("heating_gradient", {0.3, 0.2}) ==
        "The sheet was hotter at the front left: about 50 % softer there than in its middle.");
  CHECK(words("heating_gradient", {-0.3, 0.02}) ==
        "The sheet was hotter on the right: about 30 % softer there than in its middle.");
  CHECK(words("heating_gradient", {0, 0.255}) ==
        "The sheet was hotter at the front: about 26 % softer there than in its middle.");
  CHECK(words("thickness_wedge", {0.1, 0.1}) ==
        "The flat sheet was thicker at the back right: about 20 % more there than in its middle.");
  CHECK(words("heating_centre", {-0.2}) ==
        "The corners of the sheet were hotter than its middle: about 20 % softer than on average.");
  CHECK(words("slip", {2}) ==
        "The sheet slid on the mould instead of sticking, as with a coefficient of friction of about 0.5.");
  CHECK(words("anisotropy", {-0.4}) ==
        "The sheet was about 40 % stiffer from front to back, and as much softer from side to side.");
  CHECK(words("cooling", {1}) ==
        "The mould chilled the sheet: where it touched, the sheet became up to 6 times as stiff.");
  CHECK(words("weak_vacuum", {0.35}) == "About 35 % of the vacuum did not reach the sheet.");
  CHECK(words("clamp_slip", {3.24}) == "The sheet's rim was drawn in from under the clamp by up to about 3.2 mm.");
  CHECK(words("mould_shift", {2.04, -1.5}) ==
        "The mould stood about 2 mm to the right and 1.5 mm to the front of its place.");
  CHECK(words("mould_shift", {0.1, 1.5}) == "The mould stood about 1.5 mm to the back of its place.");
  CHECK(words("mould_rotation", {-4.04}) == "The mould stood turned by about 4°, clockwise seen from above.");
  CHECK(words("mould_scale", {0.018}) == "The mould was about 1.8 % larger than its model.");
  CHECK(words("print_scale", {-0.0121}) == "The pattern was printed about 1.2 % too small.");
  CHECK(words("print_stretch_x", {0.02}) == "The pattern was printed about 2 % too long from side to side.");
  CHECK(words("print_stretch_y", {-0.015}) == "The pattern was printed about 1.5 % too short from front to back.");
  CHECK(words("scan_scale", {0.01}) == "The scan is about 1 % larger than the object.");
  CHECK(words("scan_stretch_x", {0.02}) == "The scan is about 2 % too long from side to side.");
  CHECK(words("scan_stretch_y", {-0.015}) == "The scan is about 1.5 % too short from front to back.");
  CHECK(words("scan_stretch_z", {0.01}) == "The scan is about 1 % too high.");
  // About x the back goes up, about y the left.
  CHECK(words("scan_rotation", {0.7, 0, 0.05}) == "The scan leans by 0.7°, too high at the back.");
  CHECK(words("scan_rotation", {0, 0.7, 0}) == "The scan leans by 0.7°, too high on the left.");
  CHECK(words("scan_rotation", {0, -0.1, -1}) == "The scan is turned by 1°, clockwise seen from above.");
  CHECK(words("scan_rotation", {0.3, -0.4, 1}) ==
        "The scan leans by 0.5°, too high at the back right, and is turned by 1°, counter-clockwise seen from above.");
  CHECK(words("scan_shift", {1.5, -0.4, 0.8}) ==
        "The scan lies about 1.5 mm to the right, 0.4 mm to the front and 0.8 mm up from where the object was.");
  CHECK(words("sorcery", {1}).empty());
  CHECK(words("slip", {}).empty());
}

TEST_CASE("CauseWords.EveryCauseOfTheModelHasThem") {
  std::vector<ModelParameter> parameters;
  std::vector<Cause> causes;
  declare_thermoform_parameters(Json::object(), {}, parameters, causes);
  REQUIRE_FALSE(causes.empty());
  for (const Cause& cause : causes)
    for (const double value : {-0.2, 0.0, 0.2}) {
      INFO(cause.name);
      const std::string said = words(cause.name.c_str(), std::vector<double>(cause.parameters.size(), value));
      CHECK(said.size() > 20);
      CHECK(said.back() == '.');
    }
}

}  // namespace
}  // namespace formwright
