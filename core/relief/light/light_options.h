// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a maker chooses of the light on a relief.
#include <optional>
#include <string>
#include <tuple>

#include "relief/view/relief_options.h"

namespace formwright {

enum class LightKind { sun, sun_angles, overcast, bright_sky, window, strobe };
template <>
struct EnumNames<LightKind> {
  static constexpr std::array<std::string_view, 6> names{"sun",        "sun_angles", "overcast",
                                                         "bright_sky", "window",     "strobe"};
  static constexpr std::array<std::string_view, 6> labels{"Sun",        "Sun by angles", "Overcast sky",
                                                          "Bright sky", "Window",        "Strobe"};
};

struct ReliefLightOptions : ReliefOptions {
  LightKind light = LightKind::sun;
  double wall_facing_deg = 180;
  double latitude_deg = 47.4;
  double longitude_deg = 8.5;
  std::string date = "2026-06-21";
  double hour = 12;
  double utc_offset_h = 2;
  double sun_azimuth_deg = 225;
  double sun_height_deg = 35;
  double sky_percent = 12;
  double ground_percent = 20;
  double light_distance_mm = 1500;
  double light_aside_deg = -70;
  double light_height_deg = 20;
  double window_width_mm = 1000;
  double window_height_mm = 1400;
  double viewer_aside_deg = 40;
  bool day_table = true;
  double lithophane_min_mm = 0.8;
  double lithophane_max_mm = 3;
  double lithophane_transmission_percent = 40;
  std::optional<double> light_pixel_mm;
  int light_samples = 128;

  static constexpr auto parameters = std::tuple_cat(
      inherit_parameters<ReliefLightOptions>(ReliefOptions::parameters),
      std::tuple{
          parameter(
              "light", &ReliefLightOptions::light, "Light",
              "What shines on the relief: the sun at a place and time or from given angles, an overcast or an evenly bright sky, a window, or a bare strobe.")
              .group("Light"),
          parameter("hour", &ReliefLightOptions::hour, "Hour", Unit{"h"}, 0, 24,
                    "Time of the day on the clock of the place. 13.5 is half past one in the afternoon.")
              .group("Light")
              .only_with("light", "sun"),
          parameter("wall_facing_deg", &ReliefLightOptions::wall_facing_deg, "Wall faces", unit::degrees, 0, 360,
                    "Compass direction into which the wall looks. 0 is north, 90 east, 180 south, 270 west.")
              .group("Light")
              .only_with("light", "sun", "sun_angles"),
          parameter("latitude_deg", &ReliefLightOptions::latitude_deg, "Latitude", unit::degrees, -90, 90,
                    "Latitude of the place; north of the equator is positive.")
              .group("Light")
              .only_with("light", "sun"),
          parameter("longitude_deg", &ReliefLightOptions::longitude_deg, "Longitude", unit::degrees, -180, 180,
                    "Longitude of the place; east of Greenwich is positive.")
              .group("Light")
              .only_with("light", "sun"),
          parameter("date", &ReliefLightOptions::date, "Date",
                    "Day of the year as year-month-day, such as 2026-06-21, from 1901 to 2099.")
              .group("Light")
              .only_with("light", "sun"),
          parameter(
              "utc_offset_h", &ReliefLightOptions::utc_offset_h, "Ahead of UTC", Unit{"h"}, -12, 14,
              "Hours by which the clock of the place is ahead of Universal Time. Central Europe: 1 in winter, 2 in summer.")
              .group("Light")
              .only_with("light", "sun"),
          parameter("sun_azimuth_deg", &ReliefLightOptions::sun_azimuth_deg, "Direction of the sun", unit::degrees, 0,
                    360, "Compass direction in which the sun stands. 0 is north, 90 east, 180 south, 270 west.")
              .group("Light")
              .only_with("light", "sun_angles"),
          parameter("sun_height_deg", &ReliefLightOptions::sun_height_deg, "Height of the sun", unit::degrees, -90, 90,
                    "Angle of the sun over the horizon. 90° is straight above; below 0° it has set.")
              .group("Light")
              .only_with("light", "sun_angles"),
          parameter(
              "sky_percent", &ReliefLightOptions::sky_percent, "Light of the clear sky", unit::percent, 0, 100,
              "Light of the whole sky on level ground, as a share of what the sun gives to a surface that faces it. About 12 % on a clear day; more where thin clouds soften the shadows.")
              .group("Light")
              .only_with("light", "sun", "sun_angles"),
          parameter(
              "ground_percent", &ReliefLightOptions::ground_percent, "Light from the ground", unit::percent, 0, 100,
              "Share of the light that the ground before the wall sends up again. Grass 20 %, concrete 30 %, snow 80 %.")
              .group("Light")
              .only_with("light", "sun", "sun_angles", "overcast", "bright_sky"),
          parameter("light_distance_mm", &ReliefLightOptions::light_distance_mm, "Distance of the light", unit::mm, 10,
                    100000, "Distance from the middle of the relief to the strobe or to the middle of the window.")
              .group("Light")
              .slider(200, 5000)
              .only_with("light", "window", "strobe"),
          parameter(
              "light_aside_deg", &ReliefLightOptions::light_aside_deg, "Light from the side", unit::degrees, -89, 89,
              "Angle to the side at which the strobe or the window stands. 0° is straight in front; negative angles are on the left.")
              .group("Light")
              .only_with("light", "window", "strobe"),
          parameter("light_height_deg", &ReliefLightOptions::light_height_deg, "Light from above", unit::degrees, -80,
                    80, "Angle above the middle of the relief at which the strobe or the window stands.")
              .group("Light")
              .only_with("light", "window", "strobe"),
          parameter("window_width_mm", &ReliefLightOptions::window_width_mm, "Window width", unit::mm, 1, 100000,
                    "Width of the window. A wider one makes softer shadows.")
              .group("Light")
              .slider(200, 4000)
              .only_with("light", "window"),
          parameter("window_height_mm", &ReliefLightOptions::window_height_mm, "Window height", unit::mm, 1, 100000,
                    "Height of the window. A higher one makes softer shadows.")
              .group("Light")
              .slider(200, 3000)
              .only_with("light", "window"),
          parameter(
              "viewer_aside_deg", &ReliefLightOptions::viewer_aside_deg, "Walk aside", unit::degrees, -80, 80,
              "Angle by which the second picture is seen from the side, as when one walks past. Negative angles are on the left.")
              .group("Pictures"),
          parameter(
              "day_table", &ReliefLightOptions::day_table, "Compare the hours of the day",
              "Measures every half hour of the day how like the model the relief looks. Only for the sun at a place and time.")
              .group("Pictures"),
          parameter("lithophane_min_mm", &ReliefLightOptions::lithophane_min_mm, "Thinnest place", unit::mm, 0.01, 100,
                    "Thickness of the lithophane where it is brightest. Two to four layers or lines are usual: 0.8 mm.")
              .group("Lithophane")
              .slider(0.2, 5)
              .advanced(),
          parameter("lithophane_max_mm", &ReliefLightOptions::lithophane_max_mm, "Thickest place", unit::mm, 0.01, 100,
                    "Thickness of the lithophane where it is darkest. Thicker gives deeper shadows: 3 mm is usual.")
              .group("Lithophane")
              .slider(1, 10)
              .advanced(),
          parameter(
              "lithophane_transmission_percent", &ReliefLightOptions::lithophane_transmission_percent,
              "Light through 1 mm", unit::percent, 0.1, 99.9,
              "Share of the light that passes through 1 mm of the material. Print a plate of 1 mm and measure it with a light meter before and after.")
              .group("Lithophane")
              .slider(5, 95)
              .advanced(),
          parameter(
              "light_pixel_mm", &ReliefLightOptions::light_pixel_mm, "Detail of the light", unit::mm, 0.02, 100,
              "Spacing of the points at which the light is computed, and of the pictures' pixels. Automatic: 1/320 of the plate's longer side.")
              .group("Pictures")
              .advanced(),
          parameter(
              "light_samples", &ReliefLightOptions::light_samples, "Directions of light", unit::none, 1, 1024,
              "Number of directions or points by which a sky or a window is computed. More makes soft shadows smoother and takes longer.")
              .group("Pictures")
              .advanced()});
};

}  // namespace formwright
