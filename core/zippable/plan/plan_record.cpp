// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/plan_record.h"

#include <cmath>
#include <numbers>

#include "base/data/json_text.h"
#include "base/error.h"

namespace formwright {
namespace {

constexpr const char* record_format = "formwright zippable plan";
constexpr double degrees_per_radian = 180 / std::numbers::pi;

}  // namespace

std::string write_plan_record(const PlanRecord& record) {
  Json json = Json::object();
  json["format"] = record_format;
  json["version"] = 1;
  json["marker_spacing_mm"] = record.marker_spacing_mm;
  Json turns = Json::array();
  for (const double turn : record.turn_of_triangle_rad) turns.push_back(degrees_per_radian * turn);
  json["turn_of_triangle_deg"] = turns;
  return json.dump() + "\n";
}

PlanRecord read_plan_record(ByteView bytes, std::size_t triangles, const std::string& where) {
  const auto refuse = [&](const std::string& sentence) {
    throw Error(ErrorCode::invalid_input, where, "plan.json: " + sentence);
  };
  const Json json = parse_json_text(as_text(bytes));
  if (!json.is_object() || json.value("format", Json()) != record_format || json.value("version", Json()) != 1)
    refuse("this is not what zippable-plan wrote: export plan.json again.");
  const Json spacing = json.value("marker_spacing_mm", Json()), turns = json.value("turn_of_triangle_deg", Json());
  PlanRecord record;
  if (!spacing.is_number() || !(spacing.get<double>() >= 1 && spacing.get<double>() <= 10000))
    refuse("“marker_spacing_mm” must be a number of millimetres from 1 to 10000.");
  record.marker_spacing_mm = spacing.get<double>();
  if (!turns.is_array() || turns.size() != triangles)
    refuse("it belongs to another design: give the plan.json of this design.json.");
  for (const Json& turn : turns) {
    if (!turn.is_number() || !std::isfinite(turn.get<double>()))
      refuse("a turn is not a number: export plan.json again.");
    record.turn_of_triangle_rad.push_back(turn.get<double>() / degrees_per_radian);
  }
  return record;
}

}  // namespace formwright
