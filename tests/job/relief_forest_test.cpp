// SPDX-License-Identifier: GPL-3.0-or-later
// Jobs of relief-forest: scenes from files, what is refused, what is in the files.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "base/sha256.h"
#include "formats/container/zip.h"
#include "formats/mesh_io.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "geometry/test_meshes.h"
#include "job/run.h"

namespace formwright::relief_forest_tests {
namespace {
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::WithinAbs;

using Files = std::map<std::string, Bytes>;  // by the input's name

Bytes bytes_of(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

JobResult run(const Files& files, Json parameters, const std::vector<std::string>& outputs) {
  parameters.update(Json{{"pixel_mm", 1}, {"check_rays", 80}, {"picture_pixels", 100}, {"scene_vertices", 1500}});
  Json inputs = Json::object();
  std::map<std::string, std::shared_ptr<const Bytes>> blobs;
  for (const auto& [name, bytes] : files) {
    const std::string hash = sha256_hex(bytes);
    blobs[hash] = std::make_shared<const Bytes>(bytes);
    inputs[name] = {{"sha256", hash}, {"file_name", name == "scene" ? "scene.json" : "model.stl"}};
  }
  const Json job = {
      {"operation", "relief-forest"}, {"parameters", parameters}, {"inputs", inputs}, {"outputs", outputs}};
  Session session;
  return run_job(job, [&](const std::string& hash) { return blobs[hash]; }, session, {});
}

Json scene() {
  return Json::parse(R"({
    "viewpoints": [
      {"eye_mm": [0, -400, 40], "look_at_mm": [0, 0, 40], "width_mm": 40, "sample": "heart", "vertices": 1500},
      {"eye_mm": [400, 0, 40], "look_at_mm": [0, 0, 40], "width_mm": 40, "sample": "star", "vertices": 1500}],
    "pillars": [
      {"shape": "square", "x_mm": -12, "y_mm": -60, "width_mm": 18, "height_mm": 80},
      {"shape": "round", "x_mm": 12, "y_mm": -80, "width_mm": 30, "height_mm": 80},
      {"outline_mm": [[80, -24], [92, -22], [90, 4], [78, 2]], "height_mm": 80},
      {"shape": "square", "x_mm": 56, "y_mm": 14, "width_mm": 22, "turn_deg": 30, "height_mm": 70}]})");
}

Files with_scene(const Json& json) { return {{"scene", bytes_of(json.dump())}}; }

const Bytes& output(const JobResult& result, const std::string& name) {
  for (const OutputBlob& blob : result.outputs)
    if (blob.name == name) return *blob.bytes;
  FAIL(name << " is missing");
  return *result.outputs.front().bytes;
}

std::string text_of(const Bytes& bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

std::size_t count(const std::string& text, const std::string& words) {
  std::size_t found = 0;
  for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++found;
  return found;
}

void is_refused(const Json& json, const std::string& words) {
  const JobResult result = run(with_scene(json), Json::object(), {"plan.json"});
  INFO(words);
  REQUIRE(result.error.has_value());
  INFO(result.error->message);
  CHECK(result.error->where == "scene");
  CHECK_THAT(result.error->message, ContainsSubstring(words));
  CHECK(result.error->message.back() == '.');
}

}  // namespace

TEST_CASE("ReliefForest.AllFilesOfAScene") {
  const JobResult result = run(with_scene(scene()), Json::object(),
                               {"pillars.zip", "pillars.3mf", "forest.glb", "floor_plan.svg", "floor_plan.dxf",
                                "pictures.zip", "overview.png", "scene.json", "plan.json"});
  INFO((result.error ? result.error->message : ""));
  REQUIRE_FALSE(result.error.has_value());
  const Json& report = result.report;
  CHECK(report["pillar_count"] == 4);
  CHECK(report["watertight"] == true);
  CHECK(report["intrusion_percent_max"] == 0);
  CHECK(report["seen_percent_min"].get<double>() > 85);
  CHECK(report["hole_diameter_mm"] == 4.2);

  // Every solid as another program would read it, and all of them together.
  Context context;
  const Bytes& zip = output(result, "pillars.zip");
  const ReadOptions options;
  const MeshSource source(zip, "pillars.zip", options, context);
  ZipArchive archive(source);
  REQUIRE(archive.entries().size() == 4);
  double volume_mm3 = 0;
  for (const ZipArchive::Entry& entry : archive.entries()) {
    INFO(entry.name);
    const Model pillar = read_model(archive.read(entry, 100'000'000), entry.name, context);
    CHECK(Adjacency(pillar.mesh).is_closed());
    CHECK_THAT(bounding_box(pillar.mesh).lower.z(), WithinAbs(0, 1e-6));
    volume_mm3 += signed_volume(pillar.mesh);
  }
  CHECK_THAT(volume_mm3 / 1000, WithinAbs(report["volume_ml"].get<double>(), 1e-3));
  const Model all = read_model(output(result, "pillars.3mf"), "pillars.3mf", context);
  CHECK(all.group_names.size() == 4);
  CHECK_THAT(signed_volume(all.mesh) / 1000, WithinAbs(volume_mm3 / 1000, 1e-3));

  const std::string svg = text_of(output(result, "floor_plan.svg")), dxf = text_of(output(result, "floor_plan.dxf"));
  CHECK(count(svg, "id=\"hole-") == 4);
  CHECK(count(svg, "id=\"pillar-") == 4);
  CHECK(count(dxf, "\nPOLYLINE\n") > 8);
}

TEST_CASE("ReliefForest.ModelsAreSeenWithoutSolving") {
  const JobResult result = run(with_scene(scene()), Json::object(), {"models.zip", "plan.json"});
  REQUIRE_FALSE(result.error.has_value());
  CHECK(result.report["seconds_solve"] == 0);
  Context context;
  const ReadOptions options;
  const MeshSource source(output(result, "models.zip"), "models.zip", options, context);
  ZipArchive archive(source);
  REQUIRE(archive.entries().size() == 2);
  CHECK(archive.entries()[0].name == "model_1.png");
  CHECK(archive.entries()[1].name == "model_2.png");
  CHECK(archive.read(archive.entries()[0], 1'000'000) != archive.read(archive.entries()[1], 1'000'000));
}

TEST_CASE("ReliefForest.AWrittenSceneGivesTheSamePillars") {
  const JobResult first = run({}, {{"layout", "screens"}, {"seed", 3}}, {"scene.json", "floor_plan.svg"});
  REQUIRE_FALSE(first.error.has_value());
  const JobResult again =
      run({{"scene", output(first, "scene.json")}}, Json::object(), {"scene.json", "floor_plan.svg"});
  REQUIRE_FALSE(again.error.has_value());
  // Up to what they say of the job that made them.
  const auto drawing = [](const JobResult& result) {
    const std::string svg = text_of(output(result, "floor_plan.svg"));
    return svg.substr(0, svg.find("<metadata"));
  };
  CHECK((drawing(first) == drawing(again)));
  CHECK((output(first, "scene.json") == output(again, "scene.json")));
  const JobResult other = run({}, {{"layout", "screens"}, {"seed", 4}}, {"scene.json"});
  CHECK((output(first, "scene.json") != output(other, "scene.json")));
}

TEST_CASE("ReliefForest.ShapesStayShapesInAWrittenScene") {
  Json json = scene();
  json["pillars"][0] =
      Json::parse(R"({"shape": "hexagon", "x_mm": -12, "y_mm": -60, "width_mm": 18, "turn_deg": 10, "height_mm": 80})");
  const JobResult result = run(with_scene(json), Json::object(), {"scene.json", "plan.json"});
  INFO((result.error ? result.error->message : ""));
  REQUIRE_FALSE(result.error.has_value());
  const Json written = Json::parse(text_of(output(result, "scene.json")));
  CHECK(written["pillars"] == json["pillars"]);
  CHECK(Json::parse(text_of(output(result, "plan.json")))["pillars_mm"][0].size() == 6);
  json["pillars"][0]["shape"] = "octagon";
  is_refused(json, "Pillar 1 of the scene has shape that is not round, square or hexagon");
}

TEST_CASE("ReliefForest.ThePlanNamesWhatTwoViewpointsSee") {
  Json json = scene();
  // Both look past the others at the right front of a pillar behind them.
  json["pillars"].erase(3);
  json["pillars"][1] = {{"shape", "square"}, {"x_mm", 15},     {"y_mm", 10},
                        {"width_mm", 12},    {"turn_deg", 45}, {"height_mm", 80}};
  const JobResult result = run(with_scene(json), Json::object(), {"plan.json"});
  INFO((result.error ? result.error->message : ""));
  REQUIRE_FALSE(result.error.has_value());
  CHECK(result.report["seconds_solve"] == 0);
  const Json plan = Json::parse(text_of(output(result, "plan.json")));
  REQUIRE(plan["shared"].size() == 1);
  CHECK(plan["shared"][0]["pillar"] == 2);
  CHECK(plan["shared"][0]["viewpoints"] == Json{1, 2});
}

TEST_CASE("ReliefForest.ModelsFromFiles") {
  Context context;
  Model model;
  model.mesh = test::icosphere(3);
  Json json = scene();
  for (const char* key : {"sample", "vertices"}) json["viewpoints"][1].erase(key);
  json["viewpoints"][1]["model"] = 2;
  is_refused(json, "Viewpoint 2 of the scene asks for model 2, which was not given");
  Files files = with_scene(json);
  files["model_2"] = write_model(model, MeshFormat::stl, context);
  const JobResult result = run(files, Json::object(), {"plan.json"});
  INFO((result.error ? result.error->message : ""));
  REQUIRE_FALSE(result.error.has_value());
  CHECK(result.report["in_plan"][1]["model"] == "model 2");
}

TEST_CASE("ReliefForest.BadScenesAreRefusedBySentence") {
  Json json = scene();
  is_refused("words", "not a JSON object");
  json["trees"] = 3;
  is_refused(json, "\"trees\", which is not known");
  json = scene();
  json["viewpoints"] = Json::array();
  is_refused(json, "no viewpoint");
  json = scene();
  json["pillars"] = 5;
  is_refused(json, "pillars must be a list");
  json = scene();
  json["viewpoints"][1].erase("eye_mm");
  is_refused(json, "Viewpoint 2 of the scene has no eye_mm");
  json = scene();
  json["viewpoints"][1]["eye_mm"] = {1, 2};
  is_refused(json, "Viewpoint 2 of the scene has eye_mm that is not a list of 3 numbers");
  json = scene();
  json["viewpoints"][1]["eye_mm"] = {0, 0, 400};
  is_refused(json, "Viewpoint 2 looks straight up or down, or nowhere");
  json = scene();
  json["viewpoints"][0]["width_mm"] = -4;
  is_refused(json, "Viewpoint 1 has a model of -4 mm");
  json = scene();
  json["viewpoints"][0]["sample"] = "tiger";
  is_refused(json, "Viewpoint 1 of the scene asks for a sample \"tiger\"");
  json = scene();
  json["viewpoints"][0]["vertices"] = 3;
  is_refused(json, "sample of 3 vertices");
  json = scene();
  json["viewpoints"][0]["model"] = 1;
  is_refused(json, "Viewpoint 1 of the scene needs either a sample or the number of a model");
  json = scene();
  json["pillars"][2]["outline_mm"] = {{1, 2}, {3}};
  is_refused(json, "Pillar 3 of the scene has outline_mm");
  json = scene();
  json["pillars"][0]["shape"] = "oval";
  is_refused(json, "Pillar 1 of the scene has shape that is not round, square or hexagon");
  json = scene();
  json["pillars"][0]["width_mm"] = "wide";
  is_refused(json, "Pillar 1 of the scene has width_mm that is not a number");
  json = scene();
  json["pillars"][0]["x_mm"] = 12;
  is_refused(json, "Pillars 1 and 2");
}

}  // namespace formwright::relief_forest_tests
