// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where the sun stands over a place.
#include <optional>
#include <string_view>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct CalendarDate {
  int year, month, day;  // of the Gregorian calendar; months and days count from 1
};

/// "2026-06-21"; nothing for any other text, for a day that does not exist, and for years outside 1901 to 2099.
std::optional<CalendarDate> read_date(std::string_view text);

struct Place {
  double latitude_deg, longitude_deg;  // north and east are positive
};

/// Days since noon of 1 January 4713 BC at Greenwich (Meeus 1998, chapter 7); `hour` of Universal Time, any number.
double julian_day(CalendarDate date, double hour);

/// Seen from the middle of the earth.
struct SunCoordinates {
  double declination_deg;
  double equation_of_time_min;  // by how much a sundial is ahead of a clock that shows mean solar time
};
/// Within 0.01 degrees from 1901 to 2099: Meeus 1998, chapter 25, lower accuracy, and eq. (28.3), as NOAA uses them.
SunCoordinates sun_coordinates(double julian_day);

struct SunPosition {
  double azimuth_deg;        // from north over east, 0 to 360
  double height_deg;         // over the horizon as seen, that is with refraction
  double height_no_air_deg;  // without refraction
};
/// `hour` of the clock, which is `utc_offset_h` ahead of Universal Time. At a pole, north is where the meridian of
/// `longitude_deg` comes from.
SunPosition sun_position(Place place, CalendarDate date, double hour, double utc_offset_h);

/// What the air adds to a height, degrees: NOAA's three formulas, for 1010 hPa and 10 degrees Celsius.
double refraction_deg(double height_no_air_deg);

/// Unit vector towards the sun for somebody who faces a wall: x right, y up, z out of the wall. `wall_facing_deg` is
/// the azimuth into which the wall looks: 180 for a wall that faces south. Rounded to 2^-30, so that the last digit of
/// a machine's sine does not decide what lies in the shadow.
Vec3 sun_direction(double azimuth_deg, double height_deg, double wall_facing_deg);

}  // namespace formwright
