// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The solid and its model ready for light, kept in the session: another hour or lamp then casts new rays only.
#include <memory>
#include <optional>

#include "job/operations/relief/solved_relief.h"
#include "relief/light/light_day.h"
#include "relief/light/light_options.h"

namespace formwright {

struct KeptLight {
  std::string key;
  ViewFrame frame;  // axes and scale, without the model
  PlateSize plate{};
  double distance_mm = 0;  // of the viewer; 0: far
  double size_depth_mm = 0;
  std::shared_ptr<const LitScene> scene;
  std::shared_ptr<const LitScene> day_scene;  // of pixels twice as large, for one day's many hours
  std::shared_ptr<const FillLight> fill;      // of the last number of samples
  int fill_samples = 0;
  std::string day_key;  // of what the table was made for
  std::vector<HourOfLight> day;
  double memory_mb = 0;
};

/// From the session, or made of the inputs and kept there. Throws Error: see solve_relief, make_height_map, LitScene.
std::shared_ptr<KeptLight> light_scene(const OperationCall& call, const ReliefLightOptions& options);

/// What falls on a scene.
struct ChosenLight {
  SceneLight main, all;            // what casts shadows; and that with what fills them
  std::optional<SunPosition> sun;  // for the sun by date
  Vec3 sun_towards{0, 0, 0};       // 0 for other lights
  std::vector<std::string> notes;  // sentences
};

/// Throws Error: cancelled.
ChosenLight chosen_light(KeptLight& kept, const ReliefLightOptions& options, Context& context);

/// Table of the day, from what was kept or computed anew. Throws Error: cancelled.
const std::vector<HourOfLight>& day_of_light(KeptLight& kept, const ReliefLightOptions& options, Context& context);

}  // namespace formwright
