// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How a relief on a wall looks in the course of one day.
#include <optional>
#include <vector>

#include "relief/light/lit_scene.h"
#include "relief/light/sun_position.h"

namespace formwright {

struct WallPlace {
  Place place;
  CalendarDate date;
  double utc_offset_h;
  double wall_facing_deg;
};

/// Sun, sky and ground over one wall.
struct OpenAir {
  double sky_share;     // light of the sky on level ground, of the sun's on what faces it
  double ground_share;  // of the light on level ground, sent up again
  int samples;          // directions of sky and ground
};

/// How high its middle stands when it is half set: refraction, 34 minutes, is in the height already.
inline constexpr double sun_sets_at_deg = 0;

/// Light of sky and ground on a scene, for shares and heights of the sun that change.
class FillLight {
 public:
  /// Throws Error: cancelled.
  FillLight(const LitScene& scene, int samples, Context& context);
  /// `sun_height_sine`: 0 where it does not shine on the ground.
  SceneLight of(const OpenAir& air, double sun_height_sine) const;

 private:
  SceneLight sky_, ground_;  // for a level irradiance of 1
};

struct HourOfLight {
  double hour;
  SunPosition sun;
  bool sun_is_up, sun_on_wall;
  std::optional<LightComparison> looks;  // nothing while the sun is down
};

inline constexpr int hours_steps = 48;  // of a day, half an hour each

/// Each half hour from 0 to 23.5. While the sun stands behind the wall there is light of sky and ground only. The sky
/// is evenly bright, and as bright from sunrise to sunset.
/// Throws Error: cancelled.
std::vector<HourOfLight> light_day(const LitScene& scene, const WallPlace& wall, const OpenAir& air, Context& context);

/// Place in the table of the hour with the largest similarity, the first of equal ones; of those with the sun on the
/// wall where `sun_on_wall`. Nothing where there is none.
std::optional<std::size_t> best_hour(const std::vector<HourOfLight>& day, bool sun_on_wall);

}  // namespace formwright
