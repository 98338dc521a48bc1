// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/relief/photographed_relief.h"

#include <algorithm>
#include <cmath>

#include "base/data/json_text.h"
#include "base/data/number_table.h"
#include "base/error.h"

namespace formwright {

std::vector<ShadedPoint> read_shaded_points(ByteView csv) {
  std::vector<ShadedPoint> points;
  for (const std::vector<double>& row :
       read_number_table(csv, "shading.csv", "object", {{"x_mm"}, {"y_mm"}, {"brightness"}, {"sigma", false}})) {
    if (row[2] < 0 || row[3] < 0)
      throw Error(
          ErrorCode::invalid_input, "object",
          "shading.csv, point " + std::to_string(points.size() + 1) + ": brightness and sigma must not be negative.");
    points.push_back({Vec2(row[0], row[1]), row[2], row[3]});
  }
  return points;
}

ShadingSetup read_shading_setup(ByteView bytes) {
  const auto refuse = [](const std::string& sentence) {
    throw Error(ErrorCode::invalid_input, "object", "setup.json: " + sentence);
  };
  const Json json = parse_json_text(as_text(bytes));
  if (!json.is_object()) refuse("this is not a JSON object; see docs/evidence.md for one.");
  ShadingSetup setup;
  const auto length = [&](const char* key, double& value) {
    if (!json.contains(key)) return;
    if (!json[key].is_number() || !(json[key].get<double>() >= 0))
      refuse("“" + std::string(key) + "” must be a number of millimetres, 0 or more.");
    value = json[key].get<double>();
  };
  length("light_distance_mm", setup.light_distance_mm);
  length("camera_height_mm", setup.camera_height_mm);
  if (json.contains("straightened_at_mm")) {
    if (!json["straightened_at_mm"].is_number() || !std::isfinite(json["straightened_at_mm"].get<double>()))
      refuse(
          "“straightened_at_mm” must be a number of millimetres, the height of the plane that the picture shows true.");
    setup.straightened_at_mm = json["straightened_at_mm"].get<double>();
  }
  if (!json.contains("light_direction"))
    refuse("“light_direction” is missing: three numbers, from the relief towards the light, z towards the viewer.");
  const Json& direction = json["light_direction"];
  if (!direction.is_array() || direction.size() != 3 ||
      !std::all_of(direction.begin(), direction.end(), [](const Json& v) { return v.is_number(); }))
    refuse("“light_direction” must be three numbers, such as [-1, 1, 1].");
  for (int k = 0; k < 3; ++k) setup.light_direction[k] = direction[static_cast<std::size_t>(k)].get<double>();
  if (!(setup.light_direction.z() > 0) || !setup.light_direction.allFinite())
    refuse("“light_direction” must point towards the viewer's side: its third number above 0.");
  return setup;
}

}  // namespace formwright
