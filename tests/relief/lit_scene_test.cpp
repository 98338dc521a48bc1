// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/light/lit_scene.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "relief/light/light_day.h"
#include "relief/light/lithophane.h"

namespace formwright::lit_scene_tests {
namespace {
using Catch::Matchers::WithinAbs;
constexpr double width_mm = 40, depth_mm = 30;

double hill(double x, double y) {
  return 6 * std::exp(-(x * x + 1.7 * y * y) / 60) + 0.6 * std::sin(0.7 * x + 0.3 * y);
}

/// A solid whose front is a hill times `scale`, its middle at 0.
TriangleMesh hill_solid(double scale, double pitch_mm = 0.25) {
  HeightMap map;
  map.columns = static_cast<int>(std::lround(width_mm / pitch_mm)) + 1;
  map.rows = static_cast<int>(std::lround(depth_mm / pitch_mm)) + 1;
  map.pitch_x_mm = map.pitch_y_mm = pitch_mm;
  map.height_mm.resize(static_cast<std::size_t>(map.columns) * static_cast<std::size_t>(map.rows));
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column)
      map.at(row, column) =
          static_cast<float>(scale * hill(column * pitch_mm - width_mm / 2, row * pitch_mm - depth_mm / 2));
  map.floor_mm = -scale;
  map.top_mm = 8 * scale;
  Context context;
  TriangleMesh solid = make_solid(map, 2, 0, context);
  solid.V.rowwise() -= Eigen::RowVector3d(width_mm / 2, depth_mm / 2, 2 - map.floor_mm);
  return solid;
}

/// The front alone, so that its normals are those of the hill up to its edges.
TriangleMesh hill_front() {
  Context context;
  return front_mesh(make_lit_relief(LitObject(hill_solid(1)), {width_mm, depth_mm}, 0.25, 1e-3, context));
}

LitScene scene_of(double scale, double pixel_mm, double distance_mm = 0) {
  Context context;
  const TriangleMesh model = hill_front();
  return LitScene(LitObject(hill_solid(scale)), LitObject(model), model,
                  {{width_mm, depth_mm}, pixel_mm, distance_mm, 1e-3, 1e-3}, context);
}

LightComparison compared(const LitScene& scene, const LightSamples& light) {
  Context context;
  const SceneLight all = scene.lit_by(light, context);
  return compare(scene, all, all, context).value();
}

}  // namespace

TEST_CASE("LitScene.NodesLieOnTheSolidAndNormalsConverge") {
  Context context;
  const LitObject solid(hill_solid(1, 0.0625));
  std::vector<double> errors;
  for (const double pitch : {1.0, 0.5, 0.25}) {
    const LitRelief relief = make_lit_relief(solid, {width_mm, depth_mm}, pitch, 1e-3, context);
    double sum = 0;
    int inside = 0;
    for (Eigen::Index i = 0; i < relief.nodes.place.rows(); ++i) {
      const double x = relief.nodes.place(i, 0), y = relief.nodes.place(i, 1), step = 1e-5;
      CHECK_THAT(relief.nodes.place(i, 2), WithinAbs(hill(x, y), 2e-3));
      if (std::abs(x) > width_mm / 2 - 1.1 || std::abs(y) > depth_mm / 2 - 1.1) continue;
      const Vec3 exact = Vec3(-(hill(x + step, y) - hill(x - step, y)) / (2 * step),
                              -(hill(x, y + step) - hill(x, y - step)) / (2 * step), 1)
                             .normalized();
      sum += (exact - relief.nodes.normal.row(i).transpose()).norm();
      ++inside;
    }
    errors.push_back(sum / inside);
  }
  // Second order, but where the limiter sees a peak.
  CHECK(std::log2(errors[0] / errors[2]) / 2 > 1.6);
}

TEST_CASE("LitScene.ASurfaceThatJumpsKeepsItsFlatNormals") {
  HeightMap map;
  map.columns = map.rows = 41;
  map.pitch_x_mm = map.pitch_y_mm = 0.5;
  for (int row = 0; row < 41; ++row)
    for (int column = 0; column < 41; ++column) map.height_mm.push_back(column < 20 ? 0.0f : 5.0f);
  map.top_mm = 5;
  Context context;
  TriangleMesh solid = make_solid(map, 1, 0, context);
  solid.V.rowwise() -= Eigen::RowVector3d(10, 10, 1);
  const LitRelief relief = make_lit_relief(LitObject(solid), {20, 20}, 0.5, 1e-3, context);
  for (Eigen::Index i = 0; i < relief.nodes.normal.rows(); ++i) CHECK(relief.nodes.normal(i, 2) == 1);
}

TEST_CASE("LitScene.AReliefAsDeepAsItsModelLooksTheSame") {
  const LightSamples low_sun = sun_disc(Vec3(-0.9, 0.3, 0.25).normalized(), 1, 4);
  std::vector<double> missing, shadow_differences;
  for (const double pixel : {1.0, 0.5, 0.25}) {
    const LightComparison same = compared(scene_of(1, pixel, 300), low_sun);
    missing.push_back(1 - same.similarity);
    shadow_differences.push_back(std::abs(same.relief_in_shadow_percent - same.model_in_shadow_percent));
    CHECK(same.similarity_no_shadows > same.similarity - 1e-3);
  }
  CHECK(missing.back() < 0.03);
  CHECK(missing.front() > 2 * missing.back());
  CHECK(shadow_differences.back() < 1.5);
  CHECK(shadow_differences.back() < shadow_differences.front());
}

TEST_CASE("LitScene.AThinReliefLooksWorseTheLowerTheSun") {
  const LitScene flat = scene_of(0.1, 0.5);
  double before = 1;
  for (const double angle_deg : {20.0, 50.0, 80.0}) {
    const double angle = angle_deg * std::numbers::pi / 180;
    const LightComparison looks = compared(flat, sun_disc(Vec3(-std::sin(angle), 0, std::cos(angle)), 1, 4));
    CHECK(looks.similarity < before);
    before = looks.similarity;
    CHECK(looks.similarity > -1);
  }
  // The model throws shadows under the low sun, the relief a tenth as deep next to none.
  const LightComparison low = compared(flat, sun_disc(Vec3(-0.94, 0, 0.34).normalized(), 1, 1));
  CHECK(low.model_in_shadow_percent > 5);
  CHECK(low.relief_in_shadow_percent < 0.5);
  // Straight from in front nothing throws a shadow that the viewer sees.
  const LightComparison front = compared(flat, sun_disc(Vec3(0, 0, 1), 1, 1));
  CHECK(front.model_in_shadow_percent == 0);
  CHECK(front.similarity == front.similarity_no_shadows);
}

TEST_CASE("LitScene.LightAddsUpAndScales") {
  const LitScene scene = scene_of(0.5, 1);
  Context context;
  const LightSamples a = sky_light(SkyKind::overcast, 1, 16), b = sun_disc(Vec3(0.6, 0, 0.8), 1, 2);
  SceneLight sum = scaled(scene.lit_by(a, context), 2);
  add(sum, scene.lit_by(b, context));
  LightSamples twice = a;
  for (FarLight& part : twice.far) part.irradiance *= 2;
  const SceneLight together = scene.lit_by(joined(twice, b), context);
  for (std::size_t i = 0; i < sum.relief.lit.size(); ++i)
    CHECK_THAT(sum.relief.lit[i], WithinAbs(together.relief.lit[i], 1e-12));
  // The exposure follows the light, so that a brighter one gives the same picture.
  const SceneLight brighter = scaled(together, 4);
  const auto plain = compare(scene, together, together, context), bright = compare(scene, brighter, brighter, context);
  CHECK(plain->similarity == bright->similarity);
  CHECK(plain->exposure == 4 * bright->exposure);
}

TEST_CASE("LitScene.WithoutLightThereIsNoFigure") {
  const LitScene scene = scene_of(1, 1);
  Context context;
  const SceneLight dark = scene.lit_by(sun_disc(Vec3(0, 0, -1), 1, 1), context);
  CHECK_FALSE(compare(scene, dark, dark, context).has_value());
}

TEST_CASE("LitScene.PicturesFromAsideShowTheSamePlaces") {
  Context context;
  const TriangleMesh solid = hill_solid(1);
  const LitObject object(solid);
  for (const double distance : {0.0, 250.0})
    for (const double aside : {-50.0, 0.0, 30.0}) {
      const PictureView view = picture_around(object, 1, distance, aside);
      const SeenRelief seen = see_relief(view, object, context);
      const std::size_t middle = static_cast<std::size_t>(view.rows / 2) * static_cast<std::size_t>(view.columns) +
                                 static_cast<std::size_t>(view.columns / 2);
      REQUIRE(seen.covered[middle]);
      // What is seen in the middle lies on the line of sight through it.
      const Vec2 p = seen.point[middle];
      const double angle = aside * std::numbers::pi / 180, z = hill(p.x(), p.y());
      const double across = std::cos(angle) * p.x() - std::sin(angle) * z,
                   towards = std::sin(angle) * p.x() + std::cos(angle) * z;
      const double shrink = distance > 0 ? distance / (distance - towards) : 1;
      CHECK_THAT(across * shrink, WithinAbs(0.5 * (view.columns % 2 == 0), 2e-2));
      CHECK_THAT(p.y() * shrink, WithinAbs(0.5 * (view.rows % 2 == 0), 2e-2));
      // Nothing is cut off: each vertex lies in the picture, which is rounded to whole pixels of 1 mm.
      for (Eigen::Index i = 0; i < solid.V.rows(); ++i) {
        const Vec3 q = solid.V.row(i).transpose();
        const double nearer = std::sin(angle) * q.x() + std::cos(angle) * q.z();
        const double grows = distance > 0 ? distance / (distance - nearer) : 1;
        CHECK(std::abs((std::cos(angle) * q.x() - std::sin(angle) * q.z()) * grows) <= 0.5 * view.columns + 0.5);
        CHECK(std::abs(q.y() * grows) <= 0.5 * view.rows + 0.5);
      }
    }
}

TEST_CASE("LightDay.TheSunGoesRoundAWall") {
  const LitScene scene = scene_of(0.3, 2);
  Context context;
  const OpenAir air{0.12, 0.2, 32};
  const std::vector<HourOfLight> south = light_day(scene, {{47.4, 8.5}, {2026, 3, 20}, 1, 180}, air, context);
  REQUIRE(south.size() == hours_steps);
  CHECK(south[24].sun_on_wall);             // noon
  CHECK_FALSE(south[4].looks.has_value());  // two in the morning
  int on_wall = 0;
  for (const HourOfLight& one : south) {
    CHECK(one.looks.has_value() == one.sun_is_up);
    on_wall += one.sun_on_wall;
    if (one.looks) {
      CHECK(one.looks->similarity <= 1);
      CHECK(one.looks->similarity > -1);
    }
  }
  CHECK(on_wall >= 22);  // twelve hours, on the day of the equinox
  CHECK(on_wall <= 25);
  const std::size_t best = best_hour(south, true).value();
  for (const HourOfLight& one : south)
    if (one.sun_on_wall) CHECK(one.looks->similarity <= south[best].looks->similarity);
  // The wall on the other side has the sky only, all day the same but for the light from the ground.
  const std::vector<HourOfLight> north = light_day(scene, {{47.4, 8.5}, {2026, 12, 21}, 1, 0}, air, context);
  CHECK_FALSE(best_hour(north, true).has_value());
  CHECK(best_hour(north, false).has_value());
  const std::vector<HourOfLight> polar = light_day(scene, {{80, 8.5}, {2026, 12, 21}, 1, 180}, air, context);
  CHECK_FALSE(best_hour(polar, false).has_value());
}

TEST_CASE("Lithophane.ThicknessIsTheInverseOfBrightness") {
  for (const double share : {0.05, 0.4, 0.95})
    for (const auto& [thin, thick] : {std::pair{0.8, 3.0}, std::pair{0.2, 100.0}, std::pair{1.0, 1.001}}) {
      const Lithophane plate{thin, thick, absorption_per_mm(share)};
      CHECK_THAT(lithophane_thickness_mm(plate, 1), WithinAbs(thin, 1e-12));
      CHECK_THAT(lithophane_thickness_mm(plate, 0), WithinAbs(thick, 1e-6 * thick));
      CHECK(lithophane_thickness_mm(plate, -1) <= thick);
      CHECK(lithophane_thickness_mm(plate, 2) == thin);
      double before = lithophane_thickness_mm(plate, 0);
      for (double brightness = 0.01; brightness <= 1; brightness += 0.01) {
        const double thickness = lithophane_thickness_mm(plate, brightness);
        CHECK(thickness <= before);
        before = thickness;
        CHECK_THAT(lithophane_brightness(plate, thickness), WithinAbs(brightness, 1e-9));
        // By the law itself: what comes through goes evenly from that of the thickest to that of the thinnest place.
        const double mu = -std::log(share), through = std::exp(-mu * thickness);
        const double dark = std::exp(-mu * thick), bright = std::exp(-mu * thin);
        CHECK_THAT((through - dark) / (bright - dark), WithinAbs(brightness, 1e-9));
      }
    }
}

}  // namespace formwright::lit_scene_tests
