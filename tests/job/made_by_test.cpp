// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/made_by.h"

#include <algorithm>
#include <catch2/catch_test_macros.hpp>

#include "job/catalog.h"
#include "job/run.h"

namespace formwright {
namespace {

const std::map<std::string, InputBlob> bunny = {{"mesh", {std::string(64, 'a'), "bunny.obj", nullptr, "", 0}}};

Json record(const Json& parameters, const std::map<std::string, InputBlob>& inputs = bunny) {
  return made_by(*find_operation("relief"), parameters, inputs);
}

TEST_CASE("MadeBy.WhatWasGivenIsSaid") {
  const Json made = record({{"width_mm", 100}, {"thickness_mm", 5}});
  CHECK(made["parameters"] == Json{{"thickness_mm", 5.0}, {"width_mm", 100.0}});
  CHECK(made["operation"] == "relief");
  CHECK(made["version"] == version());
  CHECK(made["inputs"]["mesh"]["sha256"] == std::string(64, 'a'));
}

// A value that was given goes before a machine profile's, so the two jobs may come to different results.
TEST_CASE("MadeBy.AGivenDefaultIsAnotherJobThanNone") {
  const Operation& operation = *find_operation("thermoform-simulate");
  const std::map<std::string, InputBlob> inputs = {{"profile", {std::string(64, 'c'), "profile.json", nullptr, "", 0}}};
  const auto vacuum = std::ranges::find(operation.parameters, "vacuum_kpa", &ParameterInfo::name);
  REQUIRE(vacuum != operation.parameters.end());
  const Json given = {{"vacuum_kpa", vacuum->default_value}};
  CHECK(made_by(operation, given, inputs)["job"] != made_by(operation, Json::object(), inputs)["job"]);
}

TEST_CASE("MadeBy.TheSameJobHasTheSameNumber") {
  const Json one = record({{"thickness_mm", 4}, {"width_mm", 100.0}});
  CHECK(one["job"] == record({{"width_mm", 100}, {"thickness_mm", 4.0}})["job"]);
  CHECK(one["job"] != record({{"thickness_mm", 4.5}, {"width_mm", 100}})["job"]);
  auto other = bunny;
  other["mesh"].sha256 = std::string(64, 'b');
  CHECK(one["job"] != record({{"thickness_mm", 4}, {"width_mm", 100}}, other)["job"]);
}

TEST_CASE("MadeBy.AFileNameThatIsNoTextDoesNoHarm") {
  auto strange = bunny;
  strange["mesh"].file_name = "b\xffn<ny\n.obj";
  OutputBlob drawing{"a.svg", "image/svg+xml", std::make_shared<const Bytes>(to_bytes("<svg></svg>"))};
  note_made_by(drawing, record(Json::object(), strange));
  const std::string text(as_text(*drawing.bytes));
  CHECK(text.find("\\ufffdn&lt;ny\\n.obj") != std::string::npos);
  CHECK(text.find('\n') == text.find(".obj") + text.substr(text.find(".obj")).find('\n'));
}

TEST_CASE("MadeBy.ALongRecordIsNotedInShort") {
  auto many = bunny;
  for (int i = 2; i < 40; ++i) many["mesh_" + std::to_string(i)] = many["mesh"];
  OutputBlob drawing{"a.svg", "image/svg+xml", std::make_shared<const Bytes>(to_bytes("<svg></svg>"))};
  const Json made = record(Json::object(), many);
  note_made_by(drawing, made);
  CHECK(drawing.bytes->size() < 300);
  CHECK(as_text(*drawing.bytes).find(made["job"].get<std::string>()) != std::string_view::npos);
}

TEST_CASE("MadeBy.ReportAndFilesOfAJobSpeakOfTheSameJob") {
  Session session;
  const Json message = {{"operation", "convert"},
                        {"inputs", {{"mesh", {{"sample", "pyramid"}, {"vertices", 0}}}}},
                        {"outputs", {"model.obj", "model.stl", "model.ply", "model.glb"}}};
  const JobResult result = run_job(message, [](const std::string&) { return nullptr; }, session, {});
  REQUIRE_FALSE(result.error);
  const auto job = result.report["made_by"]["job"].get<std::string>();
  CHECK(job.size() == 16);
  REQUIRE(result.outputs.size() == 4);
  for (const OutputBlob& output : result.outputs) {
    INFO(output.name);
    CHECK(as_text(*output.bytes).find(job) != std::string_view::npos);
  }
}

}  // namespace
}  // namespace formwright
