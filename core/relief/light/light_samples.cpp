// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/light/light_samples.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "relief/seen/picture_similarity.h"

namespace formwright {
namespace {

constexpr double tan_sun_radius = 4.6542e-3;  // 0.26667 degrees, the mean over a year (Meeus 1998, chapter 55)
// From one point of a spiral to the next it turns by the golden angle; as numbers, so that every machine has the same.
constexpr double golden_cosine = -0.7373688780783197, golden_sine = 0.6754902942615238;
constexpr double golden_ratio_less_one = 0.6180339887498949;

}  // namespace

LightSamples sun_disc(const Vec3& towards, double irradiance, int count) {
  const Vec3 other = std::abs(towards.y()) < 0.9 ? Vec3(0, 1, 0) : Vec3(1, 0, 0);
  const Vec3 a = towards.cross(other).normalized(), b = towards.cross(a);
  LightSamples samples;
  double x = 1, y = 0;
  for (int k = 0; k < count; ++k) {
    const double r = tan_sun_radius * std::sqrt((k + 0.5) / count);
    samples.far.push_back({(towards + r * (x * a + y * b)).normalized(), irradiance / count});
    const double turned = golden_cosine * x - golden_sine * y;
    y = golden_sine * x + golden_cosine * y;
    x = turned;
  }
  return samples;
}

LightSamples sky_light(SkyKind kind, double level_irradiance, int count) {
  LightSamples samples;
  for (const Vec3& direction : light_directions(count)) {
    const double sine = direction.y();  // of the height over the horizon
    double radiance = 0;
    if (sine > 0)
      radiance = level_irradiance / std::numbers::pi * (kind == SkyKind::uniform ? 1 : 3.0 / 7 * (1 + 2 * sine));
    samples.far.push_back({direction, radiance * 2 * std::numbers::pi / count});
  }
  return samples;
}

LightSamples ground_light(double sent_back, int count) {
  LightSamples samples;
  for (const Vec3& direction : light_directions(count))
    samples.far.push_back({direction, direction.y() <= 0 ? sent_back * 2 / count : 0});
  return samples;
}

LightSamples window_light(const Vec3& centre, double width_mm, double height_mm, int count) {
  const Vec3 facing = -centre.normalized(), across = Vec3(0, 1, 0).cross(facing).normalized(),
             upwards = facing.cross(across);
  const double part = width_mm * height_mm / count;
  LightSamples samples;
  for (int k = 0; k < count; ++k) {
    const double s = (k + 0.5) / count, turns = golden_ratio_less_one * (k + 0.5), t = turns - std::floor(turns);
    const Vec3 place = centre + (s - 0.5) * width_mm * across + (t - 0.5) * height_mm * upwards;
    if (place.z() > 0) samples.near.push_back({place, facing, part});
  }
  return samples;
}

LightSamples strobe_light(const Vec3& place) { return {{}, {{place, Vec3(0, 0, 0), place.squaredNorm()}}}; }

LightSamples joined(LightSamples a, const LightSamples& b) {
  a.far.insert(a.far.end(), b.far.begin(), b.far.end());
  a.near.insert(a.near.end(), b.near.begin(), b.near.end());
  return a;
}

}  // namespace formwright
