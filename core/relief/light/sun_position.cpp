// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/light/sun_position.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

namespace formwright {
namespace {

constexpr double radians_a_degree = std::numbers::pi / 180;
constexpr double julian_day_of_2000 = 2451545, days_a_century = 36525;
constexpr int first_year = 1901, last_year = 2099;

double whole_turns_off(double angle_deg) { return angle_deg - 360 * std::floor(angle_deg / 360); }

int days_in(int year, int month) {
  constexpr int days[]{31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  const bool leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
  return days[month - 1] + (month == 2 && leap ? 1 : 0);
}

}  // namespace

std::optional<CalendarDate> read_date(std::string_view text) {
  const auto number = [&](std::size_t begin, std::size_t length) -> int {
    int value = 0;
    const char* end = text.data() + begin + length;
    const auto [stop, error] = std::from_chars(text.data() + begin, end, value);
    return error == std::errc() && stop == end ? value : -1;
  };
  if (text.size() != 10 || text[4] != '-' || text[7] != '-') return std::nullopt;
  const CalendarDate date{number(0, 4), number(5, 2), number(8, 2)};
  if (date.year < first_year || date.year > last_year || date.month < 1 || date.month > 12 || date.day < 1 ||
      date.day > days_in(date.year, date.month))
    return std::nullopt;
  return date;
}

double julian_day(CalendarDate date, double hour) {
  int year = date.year, month = date.month;
  if (month <= 2) {
    --year;
    month += 12;
  }
  const int century = year / 100;
  return std::floor(365.25 * (year + 4716)) + std::floor(30.6001 * (month + 1)) + date.day +
         (2 - century + century / 4) - 1524.5 + hour / 24;
}

SunCoordinates sun_coordinates(double julian_day) {
  const double t = (julian_day - julian_day_of_2000) / days_a_century;
  const double mean_longitude =
      radians_a_degree * whole_turns_off(280.46646 + t * (36000.76983 + 0.0003032 * t));      // (25.2)
  const double anomaly = radians_a_degree * (357.52911 + t * (35999.05029 - 0.0001537 * t));  // (25.3)
  const double eccentricity = 0.016708634 - t * (0.000042037 + 0.0000001267 * t);             // (25.4)
  const double centre = (1.914602 - t * (0.004817 + 0.000014 * t)) * std::sin(anomaly) +
                        (0.019993 - 0.000101 * t) * std::sin(2 * anomaly) + 0.000289 * std::sin(3 * anomaly);
  const double node = radians_a_degree * (125.04 - 1934.136 * t);
  const double longitude = mean_longitude + radians_a_degree * (centre - 0.00569 - 0.00478 * std::sin(node));
  const double obliquity =  // (22.2) and (25.8)
      radians_a_degree *
      (23 + (26 + (21.448 - t * (46.8150 + t * (0.00059 - 0.001813 * t))) / 60) / 60 + 0.00256 * std::cos(node));
  const double half = std::tan(obliquity / 2), y = half * half;
  const double equation =  // (28.3)
      y * std::sin(2 * mean_longitude) - 2 * eccentricity * std::sin(anomaly) +
      4 * eccentricity * y * std::sin(anomaly) * std::cos(2 * mean_longitude) -
      0.5 * y * y * std::sin(4 * mean_longitude) - 1.25 * eccentricity * eccentricity * std::sin(2 * anomaly);
  constexpr double minutes_a_degree = 4;
  return {std::asin(std::sin(obliquity) * std::sin(longitude)) / radians_a_degree,
          minutes_a_degree * equation / radians_a_degree};
}

double refraction_deg(double height_no_air_deg) {
  const double h = height_no_air_deg;
  double arc_seconds = 0;
  if (h <= 85) {
    const double t = std::tan(radians_a_degree * h);
    if (h > 5) arc_seconds = 58.1 / t - 0.07 / (t * t * t) + 0.000086 / (t * t * t * t * t);
    else if (h > -0.575) arc_seconds = 1735 + h * (-518.2 + h * (103.4 + h * (-12.79 + h * 0.711)));
    else arc_seconds = -20.774 / t;
  }
  return h <= -89.9 ? 0 : arc_seconds / 3600;
}

SunPosition sun_position(Place place, CalendarDate date, double hour, double utc_offset_h) {
  const SunCoordinates sun = sun_coordinates(julian_day(date, hour - utc_offset_h));
  const double solar_minutes = 60 * (hour - utc_offset_h) + sun.equation_of_time_min + 4 * place.longitude_deg;
  const double hour_angle = radians_a_degree * (solar_minutes / 4 - 180);
  const double latitude = radians_a_degree * place.latitude_deg, declination = radians_a_degree * sun.declination_deg;
  const double east = -std::cos(declination) * std::sin(hour_angle);
  const double north =
      std::cos(latitude) * std::sin(declination) - std::sin(latitude) * std::cos(declination) * std::cos(hour_angle);
  const double up =
      std::sin(latitude) * std::sin(declination) + std::cos(latitude) * std::cos(declination) * std::cos(hour_angle);
  const double height = std::atan2(up, std::hypot(east, north)) / radians_a_degree;
  return {whole_turns_off(std::atan2(east, north) / radians_a_degree), height + refraction_deg(height), height};
}

Vec3 sun_direction(double azimuth_deg, double height_deg, double wall_facing_deg) {
  const double turn = radians_a_degree * (azimuth_deg - wall_facing_deg), height = radians_a_degree * height_deg;
  const Vec3 direction(-std::cos(height) * std::sin(turn), std::sin(height), std::cos(height) * std::cos(turn));
  constexpr double steps = 1 << 30;
  return (direction * steps).array().round().matrix() / steps;
}

}  // namespace formwright
