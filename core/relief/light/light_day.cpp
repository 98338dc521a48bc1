// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/light/light_day.h"

#include <algorithm>

namespace formwright {
namespace {

constexpr int sun_samples_of_day = 1;  // its half shadows are narrower than a pixel

}  // namespace

FillLight::FillLight(const LitScene& scene, int samples, Context& context) {
  {
    const auto span = context.span(0, 0.5, "Casting light of the sky");
    sky_ = scene.lit_by(sky_light(SkyKind::uniform, 1, samples), context);
  }
  const auto span = context.span(0.5, 1, "Casting light from the ground");
  ground_ = scene.lit_by(ground_light(1, samples), context);
}

SceneLight FillLight::of(const OpenAir& air, double sun_height_sine) const {
  SceneLight fill = scaled(sky_, air.sky_share);
  add(fill, scaled(ground_, air.ground_share * (air.sky_share + std::max(0.0, sun_height_sine))));
  return fill;
}

std::vector<HourOfLight> light_day(const LitScene& scene, const WallPlace& wall, const OpenAir& air, Context& context) {
  const FillLight fill = [&] {
    const auto span = context.span(0, 0.3, "Casting light of the sky");
    return FillLight(scene, air.samples, context);
  }();
  std::vector<HourOfLight> day;
  for (int step = 0; step < hours_steps; ++step) {
    const auto span = context.span(0.3 + 0.7 * step / hours_steps, 0.3 + 0.7 * (step + 1) / hours_steps,
                                   "Comparing the hours of the day");
    HourOfLight one{};
    one.hour = 24.0 * step / hours_steps;
    one.sun = sun_position(wall.place, wall.date, one.hour, wall.utc_offset_h);
    one.sun_is_up = one.sun.height_deg > sun_sets_at_deg;
    const Vec3 towards = sun_direction(one.sun.azimuth_deg, one.sun.height_deg, wall.wall_facing_deg);
    one.sun_on_wall = one.sun_is_up && towards.z() > 0;
    if (one.sun_is_up) {
      SceneLight all = fill.of(air, towards.y());
      if (one.sun_on_wall) {
        const SceneLight sun = scene.lit_by(sun_disc(towards, 1, sun_samples_of_day), context);
        add(all, sun);
        one.looks = compare(scene, sun, all, context);
      } else {
        one.looks = compare(scene, all, all, context);
      }
    }
    day.push_back(one);
  }
  return day;
}

std::optional<std::size_t> best_hour(const std::vector<HourOfLight>& day, bool sun_on_wall) {
  std::optional<std::size_t> best;
  for (std::size_t k = 0; k < day.size(); ++k) {
    if (!day[k].looks || (sun_on_wall && !day[k].sun_on_wall)) continue;
    if (!best || day[k].looks->similarity > day[*best].looks->similarity) best = k;
  }
  return best;
}

}  // namespace formwright
