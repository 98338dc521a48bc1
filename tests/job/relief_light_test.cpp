// SPDX-License-Identifier: GPL-3.0-or-later
// Jobs of relief-light: what is kept between them, what is said, what is in the files.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>

#include "formats/container/zip.h"
#include "formats/mesh_io.h"
#include "formats/png/png16.h"
#include "job/run.h"

namespace formwright::relief_light_tests {
namespace {
using Catch::Matchers::WithinAbs;

JobResult light(Session& session, Json parameters, const std::vector<std::string>& outputs = {}) {
  parameters["light_pixel_mm"] = 3;
  parameters["light_samples"] = 8;
  parameters["pixel_mm"] = 1;
  const Json job = {{"operation", "relief-light"},
                    {"parameters", parameters},
                    {"inputs", {{"mesh", {{"sample", "cat"}, {"vertices", 700}}}}},
                    {"outputs", outputs}};
  JobResult result = run_job(job, [](const std::string&) { return nullptr; }, session, {});
  INFO((result.error ? result.error->message : ""));
  REQUIRE_FALSE(result.error.has_value());
  return result;
}

const Bytes& output(const JobResult& result, const std::string& name) {
  for (const OutputBlob& blob : result.outputs)
    if (blob.name == name) return *blob.bytes;
  FAIL(name << " is missing");
  return *result.outputs.front().bytes;
}

}  // namespace

TEST_CASE("ReliefLight.WhatIsKeptGivesTheSameFigures") {
  Session session;
  const Json noon = {{"hour", 12}}, morning = {{"hour", 10}};
  const Json first = light(session, noon).report;
  CHECK(first["seconds_scene"].get<double>() > 0);
  const Json other = light(session, morning).report;
  CHECK(other["light_similarity"] != first["light_similarity"]);
  CHECK(other["day"] == first["day"]);
  for (const char* name : {"light_similarity", "relief_in_shadow_percent", "day", "best_hour", "best_sun_hour"}) {
    INFO(name);
    Session fresh;
    CHECK(light(session, noon).report[name] == first[name]);
    CHECK(light(fresh, morning).report[name] == other[name]);
  }
  // What the table says of the hour is near what the light at full detail says.
  const Json row = first["day"][24];
  CHECK(row["hour"] == 12.0);
  CHECK_THAT(row["similarity"].get<double>(), WithinAbs(first["light_similarity"].get<double>(), 0.1));
  // Another thickness is another scene.
  CHECK(light(session, {{"hour", 12}, {"thickness_mm", 12}}).report["light_similarity"] != first["light_similarity"]);
}

TEST_CASE("ReliefLight.NightAndTheBackOfTheWallAreNotes") {
  Session session;
  const Json night = light(session, {{"hour", 1}}, {"light.png", "light.ply"}).report;
  CHECK(night["light_similarity"].is_null());
  CHECK(night["notes"] == Json::array({"The sun is below the horizon, so there is no daylight."}));
  const JobResult behind = light(session, {{"hour", 12}, {"wall_facing_deg", 0}, {"day_table", false}});
  CHECK(behind.report["sun_on_wall"] == false);
  CHECK(behind.report["light_similarity"].is_number());
  CHECK(behind.report["notes"].size() == 1);
  CHECK_FALSE(behind.report.contains("day"));
  const Json strobe = light(session, {{"light", "strobe"}}).report;
  CHECK(strobe["notes"].empty());
  CHECK_FALSE(strobe.contains("sun_height_deg"));
}

TEST_CASE("ReliefLight.TheFrontHasTheLightOfThePicture") {
  Session session;
  const JobResult result = light(session, {{"light", "sun_angles"}, {"projection", "orthographic"}}, {"light.ply"});
  Context context;
  const ModelFile front = read_model_file(output(result, "light.ply"), "light.ply", {}, context);
  REQUIRE(front.columns.size() == 1);
  CHECK(front.columns[0].name == "brightness");
  CHECK(front.columns[0].values.minCoeff() >= 0);
  CHECK(front.columns[0].values.maxCoeff() <= 1);
  CHECK(front.columns[0].values.maxCoeff() > 0.5);
  // As wide as the plate, and no thicker than the relief.
  const Vec3 size = front.model.mesh.V.colwise().maxCoeff() - front.model.mesh.V.colwise().minCoeff();
  CHECK_THAT(size.x(), WithinAbs(result.report["size_mm"][0].get<double>(), 1e-3));
  CHECK(size.minCoeff() <= 5 + 1e-6);
}

TEST_CASE("ReliefLight.TheLithophaneLetsThePictureThrough") {
  Session session;
  const Json parameters = {{"light", "overcast"},
                           {"lithophane_min_mm", 1},
                           {"lithophane_max_mm", 4},
                           {"lithophane_transmission_percent", 30}};
  const JobResult result = light(session, parameters, {"lithophane.png", "light_model.png"});
  const Grey16Image plate = read_png16(output(result, "lithophane.png"), "lithophane.png");
  const Grey16Image picture = read_png16(output(result, "light_model.png"), "light_model.png");
  REQUIRE(plate.levels.size() == picture.levels.size());
  const double min_mm = result.report["lithophane_min_mm"], step_mm = result.report["lithophane_mm_per_level"];
  const double mu = -std::log(0.3), dark = std::exp(-4 * mu), bright = std::exp(-1 * mu);
  int seen = 0;
  for (std::size_t i = 0; i < plate.levels.size(); ++i) {
    const double shown = picture.levels[i] / 65535.0;  // sRGB
    if (shown == 0) continue;                          // beyond the model
    ++seen;
    const double linear = shown <= 0.04045 ? shown / 12.92 : std::pow((shown + 0.055) / 1.055, 2.4);
    const double through = std::exp(-mu * (min_mm + step_mm * plate.levels[i]));
    CHECK_THAT((through - dark) / (bright - dark), WithinAbs(linear, 0.006));  // a step of 8 bits
  }
  CHECK(seen > 100);
}

TEST_CASE("ReliefLight.WalkingPastHasAPictureEveryFiveDegrees") {
  Session session;
  const JobResult result = light(session, {{"light", "window"}}, {"walk_past.zip"});
  Context context;
  const Bytes& bytes = output(result, "walk_past.zip");
  const ReadOptions options;
  const MeshSource source(bytes, "walk_past.zip", options, context);
  CHECK(ZipArchive(source).entries().size() == 25);
}

}  // namespace formwright::relief_light_tests
