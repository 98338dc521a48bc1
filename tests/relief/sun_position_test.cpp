// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/light/sun_position.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <cmath>

namespace formwright::sun_position_tests {
namespace {
using Catch::Matchers::WithinAbs;

// The example of Reda and Andreas 2008, "Solar Position Algorithm for Solar Radiation Applications", NREL/TP-560-34302,
// appendix A.5: Golden, Colorado, 17 October 2003.
constexpr Place golden{39.742476, -105.1786};
constexpr CalendarDate example_day{2003, 10, 17};
constexpr double mountain_time = -7;

/// The clock's hour between two where the sun's middle passes a height, which it does once.
double hour_of_height(Place place, CalendarDate date, double offset, double from, double to, double height_deg) {
  const bool rising = sun_position(place, date, to, offset).height_no_air_deg > height_deg;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (from + to);
    const bool above = sun_position(place, date, middle, offset).height_no_air_deg > height_deg;
    (above == rising ? to : from) = middle;
  }
  return from;
}

/// The hour at which the sun crosses the meridian.
double solar_noon(Place place, CalendarDate date, double offset) {
  double hour = 12;
  for (int i = 0; i < 3; ++i) {
    const SunCoordinates sun = sun_coordinates(julian_day(date, hour - offset));
    hour = 12 + offset - place.longitude_deg / 15 - sun.equation_of_time_min / 60;
  }
  return hour;
}

}  // namespace

TEST_CASE("SunPosition.DatesThatExist") {
  CHECK(read_date("2026-06-21")->day == 21);
  CHECK(read_date("2024-02-29")->month == 2);
  for (const char* wrong : {"2026-02-29", "2026-13-01", "2026-00-10", "2026-06-31", "1900-01-01", "2100-01-01",
                            "2026-6-21", "21.06.2026", "", "2026-06-21T", "2026-0x-21", "2026--1-21"})
    CHECK_FALSE(read_date(wrong).has_value());
}

TEST_CASE("SunPosition.JulianDaysOfMeeus") {
  // Meeus 1998, chapter 7: 1957 October 4.81, and the table there.
  CHECK_THAT(julian_day({1957, 10, 4}, 0.81 * 24), WithinAbs(2436116.31, 1e-8));
  CHECK(julian_day({2000, 1, 1}, 12) == 2451545.0);
  CHECK(julian_day({1987, 6, 19}, 12) == 2446966.0);
}

TEST_CASE("SunPosition.CoordinatesOfMeeus") {
  // Example 25.a: declination -7.78507 degrees on 1992 October 13 at 0 h; example 28.a: the equation of time that day
  // is 13 min 42.7 s.
  const SunCoordinates sun = sun_coordinates(2448908.5);
  CHECK_THAT(sun.declination_deg, WithinAbs(-7.78507, 1e-5));
  CHECK_THAT(sun.equation_of_time_min, WithinAbs(13 + 42.7 / 60, 0.03));
}

TEST_CASE("SunPosition.ExampleOfTheSolarPositionAlgorithm") {
  const double hour = 12 + 30.0 / 60 + 30.0 / 3600;
  const SunPosition sun = sun_position(golden, example_day, hour, mountain_time);
  // Topocentric azimuth 194.34024, zenith angle 50.11162 with the refraction of 820 hPa; ours has 1010 hPa and no
  // parallax, together 0.006 degrees at this height.
  CHECK_THAT(sun.azimuth_deg, WithinAbs(194.34024, 0.01));
  CHECK_THAT(sun.height_deg, WithinAbs(90 - 50.11162, 0.01));
  // Sunrise 6:12:43.46 and sunset 17:20:19.19, for a height of -0.8333 degrees without air; transit 11:46:04.97.
  CHECK_THAT(hour_of_height(golden, example_day, mountain_time, 3, 11, -0.8333), WithinAbs(6.212067, 0.003));
  // Of that day in Universal Time, so that the sunset is that of the evening before in Colorado.
  CHECK_THAT(hour_of_height(golden, {2003, 10, 16}, mountain_time, 13, 22, -0.8333), WithinAbs(17.338664, 0.003));
  CHECK_THAT(solar_noon(golden, example_day, mountain_time), WithinAbs(11.768047, 0.001));
}

TEST_CASE("SunPosition.NoonHeightIsThatOfTheEquatorPlusTheDeclination") {
  for (const double latitude : {-67.0, -23.4, 0.0, 35.0, 51.48, 66.0})
    for (const CalendarDate date : {CalendarDate{2026, 3, 20}, CalendarDate{2026, 6, 21}, CalendarDate{2026, 12, 21}}) {
      const Place place{latitude, 13.0};
      const double noon = solar_noon(place, date, 1);
      const double declination = sun_coordinates(julian_day(date, noon - 1)).declination_deg;
      const double overhead = 90 - std::abs(latitude - declination);
      CHECK_THAT(sun_position(place, date, noon, 1).height_no_air_deg, WithinAbs(overhead, 1e-5));
    }
  // On the day of the equinox the declination is 0 within what it changes in half a day.
  CHECK_THAT(sun_position({50, 0}, {2026, 3, 20}, 12.12, 0).height_no_air_deg, WithinAbs(40, 0.25));
}

TEST_CASE("SunPosition.MorningAndAfternoonAreMirrorImages") {
  const Place place{47.4, 8.5};
  const CalendarDate date{2026, 6, 21};  // the declination stands still
  const double noon = solar_noon(place, date, 2);
  for (const double hours : {1.0, 3.5, 6.0, 8.0, 11.0}) {
    const SunPosition before = sun_position(place, date, noon - hours, 2),
                      after = sun_position(place, date, noon + hours, 2);
    CHECK_THAT(before.height_deg, WithinAbs(after.height_deg, 0.02));
    CHECK_THAT(before.azimuth_deg, WithinAbs(360 - after.azimuth_deg, 0.02));
  }
}

TEST_CASE("SunPosition.NearThePoles") {
  const CalendarDate june{2026, 6, 21}, december{2026, 12, 21};
  for (const double latitude : {90.0, 89.9999, -90.0})
    for (double hour = 0; hour < 24; hour += 1.5) {
      const SunPosition sun = sun_position({latitude, 30}, june, hour, 0);
      const double declination = sun_coordinates(julian_day(june, hour)).declination_deg;
      CHECK_THAT(sun.height_no_air_deg, WithinAbs(latitude > 0 ? declination : -declination, 2e-4));
      CHECK(sun.azimuth_deg >= 0);
      CHECK(sun.azimuth_deg < 360);
    }
  // It goes round by 15 degrees an hour.
  const double turned = sun_position({90, 0}, june, 7, 0).azimuth_deg - sun_position({90, 0}, june, 6, 0).azimuth_deg;
  CHECK_THAT(turned, WithinAbs(15, 0.01));
  for (double hour = 0; hour < 24; ++hour) {
    CHECK(sun_position({75, 20}, june, hour, 1).height_deg > 0);
    CHECK(sun_position({75, 20}, december, hour, 1).height_deg < 0);
  }
}

TEST_CASE("SunPosition.TheAirLiftsTheSun") {
  // Half a degree at the horizon (NOAA: 1735 seconds of arc at 0), a minute at 45 degrees, nothing overhead.
  CHECK_THAT(refraction_deg(0), WithinAbs(1735.0 / 3600, 1e-12));
  CHECK_THAT(refraction_deg(45), WithinAbs(58.03 / 3600, 1e-5));
  CHECK(refraction_deg(90) == 0);
  double before = refraction_deg(-90);
  for (double height = -90; height <= 90; height += 0.01) {
    const double now = refraction_deg(height);
    CHECK(std::isfinite(now));
    CHECK(now >= 0);
    CHECK(std::abs(now - before) < 0.01);  // the three formulas meet
    before = now;
  }
}

TEST_CASE("SunPosition.DirectionsBeforeAWall") {
  // A wall that faces south: the sun in the south stands in front, in the east on the right of who looks at the wall.
  CHECK((sun_direction(180, 0, 180) - Vec3(0, 0, 1)).norm() < 1e-8);
  CHECK((sun_direction(90, 0, 180) - Vec3(1, 0, 0)).norm() < 1e-8);
  CHECK((sun_direction(0, 90, 180) - Vec3(0, 1, 0)).norm() < 1e-8);
  CHECK(sun_direction(0, 30, 180).z() < 0);
  for (const double turn : {10.0, 100.0, 250.0})
    CHECK((sun_direction(200 + turn, 33, 180 + turn) - sun_direction(200, 33, 180)).norm() < 1e-8);
  CHECK_THAT(sun_direction(217, 41, 95).norm(), WithinAbs(1, 1e-8));
}

}  // namespace formwright::sun_position_tests
