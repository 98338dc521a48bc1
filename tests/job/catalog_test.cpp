// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/catalog.h"

#include <catch2/catch_test_macros.hpp>

#include <algorithm>
#include <set>
#include <sstream>

#include "job/contract/file_pack.h"
#include "job/run.h"

#ifndef __EMSCRIPTEN__
#include <fstream>
#endif

namespace formwright {
namespace {

std::string message_of(const JobResult& result) { return result.error ? result.error->message : ""; }

TEST_CASE("Catalog.EveryNameStandsOnceAndEverythingIsSaid") {
  std::set<std::string> names;
  for (const Operation& operation : operations()) {
    {
      INFO(operation.name);
      CHECK(names.insert(operation.name).second);
    }
    CHECK_FALSE(operation.summary.empty());
    std::set<std::string> own;
    for (const ParameterInfo& info : operation.parameters) {
      {
        INFO(info.name);
        CHECK(own.insert(info.name).second);
        CHECK_FALSE(info.label.empty());
      }
      {
        INFO(operation.name << " " << info.name);
        CHECK(info.help.ends_with("."));
      }
      {
        INFO(info.name);
        CHECK(info.minimum <= info.slider_minimum);
        CHECK(info.maximum >= info.slider_maximum);
      }
      if (info.default_value.is_number()) {
        INFO(info.name);
        CHECK(info.default_value.get<double>() >= info.minimum);
        CHECK(info.default_value.get<double>() <= info.maximum);
      }
      // A length, angle or time carries its unit in its name.
      const std::vector<std::pair<std::string, std::string>> suffixes = {{"mm", "_mm"}, {"°", "_deg"}, {"s", "_s"}};
      for (const auto& [unit, suffix] : suffixes)
        if (info.unit == unit) {
          INFO(info.name);
          CHECK((info.name.ends_with(suffix) || (unit == "°" && info.name.ends_with("_degrees"))));
        }
    }
    std::set<std::string> fields;
    for (const ReportField& field : operation.report) {
      INFO(field.name);
      CHECK(fields.insert(field.name).second);
    }
  }
}

TEST_CASE("Catalog.AParameterOfOneChoiceNamesIt") {
  for (const Operation& operation : operations())
    for (const ParameterInfo& info : operation.parameters) {
      if (info.only_with.empty()) continue;
      INFO(operation.name << " " << info.name);
      const auto choice = std::ranges::find(operation.parameters, info.only_with, &ParameterInfo::name);
      REQUIRE(choice != operation.parameters.end());
      CHECK_FALSE(info.only_with_choices.empty());
      for (const std::string& value : info.only_with_choices)
        CHECK(std::ranges::find(choice->choices, value) != choice->choices.end());
    }
}

TEST_CASE("Catalog.PresetsHoldValuesThatTheirOperationTakes") {
  for (const Operation& operation : operations()) {
    std::set<std::string> flags;  // all that a command takes shares one list of flags
    for (const ParameterInfo& info : operation.parameters) flags.insert(info.name);
    for (const InputInfo& input : operation.inputs) flags.insert(input.name);
    for (const PresetList& list : operation.presets) {
      INFO(operation.name << " " << list.name);
      CHECK(flags.insert(list.name).second);
      CHECK(list.help.ends_with("."));
      CHECK(std::any_of(operation.parameters.begin(), operation.parameters.end(),
                        [&](const ParameterInfo& info) { return info.group == list.group; }));
      REQUIRE(list.presets.size() >= 2);
      std::set<std::string> names, titles;
      for (const Preset& preset : list.presets) {
        INFO(preset.name);
        CHECK(names.insert(preset.name).second);
        CHECK(titles.insert(preset.title).second);
        CHECK((preset.hint.empty() || preset.hint.ends_with(".")));
        CHECK_NOTHROW(operation.prepare(preset.parameters));
        CHECK(preset.parameters.size() == list.presets.front().parameters.size());
        for (const auto& [name, value] : preset.parameters.items())
          CHECK(list.presets.front().parameters.contains(name));
      }
    }
  }
}

// Whoever chooses nothing has what a name stands for, too, except for cloth, whose bending is computed.
TEST_CASE("Catalog.TheFirstPresetHoldsTheDefaults") {
  for (const char* name : {"thermoform-simulate", "mill-job"})
    for (const PresetList& list : find_operation(name)->presets)
      for (const auto& [parameter, value] : list.presets.front().parameters.items()) {
        INFO(name << " " << list.name << " " << parameter);
        for (const ParameterInfo& info : find_operation(name)->parameters)
          if (info.name == parameter) CHECK(info.default_value == value);
      }
}

#ifndef __EMSCRIPTEN__
TEST_CASE("Catalog.IsTheSnapshot") {
  // A change of the public declaration shows up in review: `build/formwright describe > tests/job/catalog.json`.
  std::ifstream stream(FORMWRIGHT_CATALOG_SNAPSHOT);
  std::stringstream text;
  text << stream.rdbuf();
  CHECK(catalog_json().dump(2) + "\n" == text.str());
}
#endif

Json error_of(const Json& message) {
  Session session;
  const JobResult result = run_job(message, [](const std::string&) { return nullptr; }, session, {});
  return result.error ? error_json(*result.error)["error"] : Json("no error");
}

TEST_CASE("RunJob.AnswersEveryWrongMessageWithTheFieldConcerned") {
  const Json mesh = {{"mesh", {{"sample", "star"}}}};
  CHECK(error_of(Json::array())["code"] == "invalid_input");
  CHECK(error_of(Json(Json::value_t::discarded))["code"] == "invalid_input");
  CHECK(error_of({{"operation", 5}})["where"] == "operation");
  CHECK(error_of({{"operation", "carve"}})["where"] == "operation");
  CHECK(error_of({{"operation", "relief"}, {"extra", 1}})["where"] == "extra");
  CHECK(error_of({{"operation", "relief"}})["where"] == "mesh");
  CHECK(error_of({{"operation", "relief"}, {"inputs", {{"mesh", {{"sample", "nobody"}}}}}})["code"] == "invalid_input");
  CHECK(error_of({{"operation", "relief"},
                  {"inputs", {{"mesh", {{"sample", "bust"}, {"sha256", std::string(64, 'a')}}}}}})["where"] == "mesh");
  CHECK(error_of({{"operation", "relief"}, {"inputs", {{"mesh", {{"sha256", std::string(64, 'a')}}}}}})["where"] ==
        "mesh");
  CHECK(error_of({{"operation", "relief"}, {"inputs", mesh}, {"parameters", {{"thickness_mm", 0}}}})["where"] ==
        "thickness_mm");
  CHECK(error_of({{"operation", "relief"}, {"inputs", mesh}, {"parameters", {{"thicknes_mm", 1}}}})["where"] ==
        "thicknes_mm");
  CHECK(error_of({{"operation", "relief"}, {"inputs", mesh}, {"outputs", {"relief.xyz"}}})["where"] == "outputs");
}

TEST_CASE("RunJob.MakesOnlyWhatIsAskedFor") {
  Session session;
  const Json message = {{"operation", "import"},
                        {"inputs", {{"mesh", {{"sample", "star"}, {"vertices", 600}}}}},
                        {"outputs", {"model.stl"}}};
  const JobResult result = run_job(message, [](const std::string&) { return nullptr; }, session, {});
  {
    INFO(message_of(result));
    REQUIRE_FALSE(result.error);
  }
  REQUIRE(result.outputs.size() == 1u);
  CHECK(result.outputs[0].name == "model.stl");
}

/// A flat sheet with a pattern as its picture, as a scan: the smallest that can be measured.
struct PrintedSheet {
  Bytes scan, pattern, texture;

  explicit PrintedSheet(Session& session) {
    const Json message = {{"operation", "evidence-pattern"},
                          {"parameters",
                           {{"sheet_x_mm", 90},
                            {"sheet_y_mm", 100},
                            {"clamp_opening_x_mm", 78},
                            {"clamp_opening_y_mm", 88},
                            {"coarsest_mm", 20},
                            {"dots_per_inch", 150}}}};
    const JobResult result = run_job(message, [](const std::string&) { return nullptr; }, session, {});
    for (const OutputBlob& output : result.outputs) {
      if (output.name == "pattern.json") pattern = *output.bytes;
      if (output.name == "pattern.png") texture = *output.bytes;
    }
    std::string text;
    constexpr int n = 20;
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i)
        text += "v " + std::to_string(90.0 * i / n) + " " + std::to_string(100.0 * j / n) + " 0\nvt " +
                std::to_string(1.0 * i / n) + " " + std::to_string(1.0 * j / n) + "\n";
    const auto corner = [](int index) { return " " + std::to_string(index) + "/" + std::to_string(index); };
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const int a = j * (n + 1) + i + 1;
        text += "f" + corner(a) + corner(a + 1) + corner(a + n + 2) + corner(a + n + 1) + "\n";
      }
    scan = to_bytes(text);
  }
  const Bytes* of(const std::string& input) const {
    return input == "scan" ? &scan : input == "pattern" ? &pattern : input == "texture" ? &texture : nullptr;
  }
};

/// The design of a small zippable, for what is made of it.
Bytes zippable_design(Session& session) {
  const Json message = {{"operation", "zippable-design"},
                        {"inputs", {{"mesh", {{"sample", "t_shape"}, {"vertices", 2000}}}}},
                        {"outputs", {"design.json"}},
                        {"parameters", {{"size_mm", 200}, {"width_mm", 60}}}};
  return *run_job(message, [](const std::string&) { return nullptr; }, session, {}).outputs.at(0).bytes;
}

/// That design with the lengths that a tape would take if all were as designed.
Bytes measured_zippable(Session& session) {
  const auto design = std::make_shared<const Bytes>(zippable_design(session));
  const std::string hash(64, 'd');
  const Json message = {{"operation", "evidence-plan-lengths"},
                        {"inputs", {{"design", {{"sha256", hash}, {"file_name", "design.json"}}}}},
                        {"outputs", Json::array()},
                        {"parameters", {{"length_count", 8}}}};
  const JobResult planned = run_job(message, [&](const std::string&) { return design; }, session, {});
  std::string lengths = "from,to,state,length_mm\n";
  for (const Json& length : planned.report.at("lengths"))
    lengths += length["from"].get<std::string>() + "," + length["to"].get<std::string>() + "," +
               length["state"].get<std::string>() + "," + length["expected_mm"].dump() + "\n";
  return pack_files({{"design.json", *design}, {"lengths.csv", as_bytes(lengths)}}, Context());
}

/// A measured object, and a photographed relief, as small as they can be, packed.
struct MeasuredObjects {
  std::map<std::string, Bytes> of_operation;

  explicit MeasuredObjects(Session& session) {
    const Json message = {{"operation", "evidence-virtual-object"},
                          {"inputs", {{"mould", {{"sample", "pyramid"}}}}},
                          {"outputs", {"object.zip"}},
                          {"parameters",
                           {{"size_mm", 50},
                            {"sheet_x_mm", 100},
                            {"sheet_y_mm", 100},
                            {"clamp_opening_x_mm", 90},
                            {"clamp_opening_y_mm", 90},
                            {"points", 60},
                            {"triangles", 500}}}};
    const JobResult result = run_job(message, [](const std::string&) { return nullptr; }, session, {});
    for (const OutputBlob& output : result.outputs)
      of_operation["evidence-calibrate"] = of_operation["evidence-diagnose"] = *output.bytes;
    std::string points = "x_mm,y_mm,brightness\n";
    for (int i = 0; i < 64; ++i)
      points += std::to_string(5 + 5 * (i % 8)) + "," + std::to_string(5 + 5 * (i / 8)) + "," +
                std::to_string(0.6 + 0.001 * i) + "\n";
    const std::string relief = "v 0 0 0\nv 45 0 4\nv 45 45 6\nv 0 45 1\nf 1 2 3\nf 1 3 4\n",
                      setup = R"({"light_direction": [-1, 1, 1]})";
    of_operation["evidence-diagnose-relief"] = pack_files(
        {{"relief.obj", as_bytes(relief)}, {"setup.json", as_bytes(setup)}, {"shading.csv", as_bytes(points)}},
        Context());
    of_operation["evidence-diagnose-zippable"] = measured_zippable(session);
  }
};

TEST_CASE("RunJob.ReportsOnlyDeclaredFigures") {
  Session session;
  const PrintedSheet printed(session);
  const MeasuredObjects measured(session);
  for (const Operation& operation : operations()) {
    // Its photographs are made by tests/evidence/photographs; the test of its command looks at its figures.
    if (operation.name == "evidence-photographs") continue;
    Json message = {{"operation", operation.name}};
    if (!operation.inputs.empty() && operation.inputs.front().accepts_sample)
      message["inputs"][operation.inputs.front().name] = {{"sample", "hemisphere"}, {"vertices", 800}};
    if (operation.name == "mill-job") message["parameters"] = {{"width_mm", 20}};
    if (operation.name == "evidence-plan-points") message["parameters"] = {{"triangles", 300}};
    std::map<std::string, std::shared_ptr<const Bytes>> files;
    for (const InputInfo& input : operation.inputs) {
      if (const Bytes* given = printed.of(input.name); given && operation.name == "evidence-register") {
        const std::string hash(64, static_cast<char>('a' + static_cast<char>(files.size())));
        files[hash] = std::make_shared<const Bytes>(*given);
        message["inputs"][input.name] = {{"sha256", hash}, {"file_name", input.name + "." + input.extensions.front()}};
        message["parameters"]["picture_px"] = 400;
        continue;
      }
      if (!input.required || input.accepts_sample) continue;
      if (const auto pack = measured.of_operation.find(operation.name); pack != measured.of_operation.end()) {
        const std::string hash(64, 'f');
        files[hash] = std::make_shared<const Bytes>(pack->second);
        message["inputs"][input.name] = {{"sha256", hash}, {"file_name", "object.zip"}};
        // The thesis's grid needs the fewest simulations where only the report's form matters.
        if (operation.name == "evidence-calibrate")
          message["parameters"] = {{"triangles", 500}, {"method", "grid"}, {"grid_values", 2}};
        else if (operation.name == "evidence-diagnose") message["parameters"] = {{"triangles", 500}, {"pairs", false}};
        else message["parameters"] = {{"pairs", false}};
        continue;
      }
      if (input.name == "design") {
        const std::string hash(64, 'd');
        files[hash] = std::make_shared<const Bytes>(zippable_design(session));
        message["inputs"][input.name] = {{"sha256", hash}, {"file_name", "design.json"}};
        if (operation.name == "zippable-simulate")
          message["parameters"] = {{"steps", 20}, {"hold_open_percent", 0}, {"frames", 2}};
        continue;
      }
      if (input.name == "drawing") {
        const ByteView drawing = as_bytes(
            "<svg width='50mm' height='50mm'><rect x='9' y='9' width='50' height='20' fill='none' stroke='red'/></svg>");
        const std::string hash(64, 'c');
        files[hash] = std::make_shared<const Bytes>(drawing.begin(), drawing.end());
        message["inputs"][input.name] = {{"sha256", hash}, {"file_name", "drawing.svg"}};
        continue;
      }
      // What a measured object consists of, as small as it can be.
      const std::string text = input.name == "setup"
                                   ? R"({"clamp_height_mm": 2, "triangles": 400})"
                                   : "sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm,sigma_mm\n0,0,0,0,50,0.1\n";
      const ByteView bytes = as_bytes(text);
      const std::string hash(64, static_cast<char>('a' + static_cast<char>(files.size())));
      files[hash] = std::make_shared<const Bytes>(bytes.begin(), bytes.end());
      message["inputs"][input.name] = {{"sha256", hash}, {"file_name", input.object_file}};
    }
    const JobResult result = run_job(message, [&](const std::string& hash) { return files[hash]; }, session, {});
    {
      INFO(operation.name << ": " << message_of(result));
      REQUIRE_FALSE(result.error);
    }
    std::set<std::string> declared;
    for (const ReportField& field : operation.report) declared.insert({field.name, field.old_name});
    for (const auto& [name, value] : result.report.items()) {
      INFO(operation.name << " " << name);
      CHECK(declared.contains(name));
    }
    for (const OutputBlob& output : result.outputs) CHECK(operation.output(output.name) != nullptr);
  }
}

TEST_CASE("Session.KeepsTheNewestWithinItsCapacity") {
  Session session(100);
  session.keep("a", std::make_shared<int>(1), 60);
  session.keep("b", std::make_shared<int>(2), 30);
  CHECK(*session.find<int>("a") == 1);  // used: now the newest
  session.keep("c", std::make_shared<int>(3), 30);
  CHECK(session.find<int>("b") == nullptr);
  CHECK(session.find<int>("a") != nullptr);
  CHECK(session.find<double>("a") == nullptr);  // another type is not what was asked for
  session.keep("huge", std::make_shared<int>(4), 1e6);
  CHECK(*session.find<int>("huge") == 4);
  CHECK(session.find<int>("c") == nullptr);
  session.drop("hu");
  CHECK(session.used_mb() == 0);
}

TEST_CASE("Relief.ASecondThicknessReusesTheFactorisation") {
  Session session;
  Json message = {{"operation", "relief"},
                  {"inputs", {{"mesh", {{"sample", "star"}, {"vertices", 1500}}}}},
                  {"outputs", Json::array()}};
  const auto run = [&] { return run_job(message, [](const std::string&) { return nullptr; }, session, {}); };
  CHECK_FALSE(run().report["factor_reused"]);
  message["parameters"] = {{"thickness_mm", 2}};
  CHECK(run().report["factor_reused"]);
  message["parameters"] = {{"thickness_mm", 2}, {"width_mm", 50}};
  CHECK(run().report["factor_reused"]);
  message["parameters"] = {{"projection", "orthographic"}};
  CHECK_FALSE(run().report["factor_reused"]);
}

TEST_CASE("Thermoform.AnotherPlateHeightIsFormedAnew") {
  // The mould stands in machine coordinates: the same travel from another height is another forming.
  Session session;
  const auto run = [&](double plate_mm) {
    const Json setup = {{"triangles", 400},
                        {"base_plate_start_z_mm", plate_mm - 120},
                        {"base_plate_end_z_mm", plate_mm},
                        {"clamp_height_mm", plate_mm + 1}};
    const std::string rows = "sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm\n0,0,0,0,50\n";
    const auto blob = [](std::string_view text) {
      return std::make_shared<const Bytes>(as_bytes(text).begin(), as_bytes(text).end());
    };
    const std::map<std::string, std::shared_ptr<const Bytes>> files{{std::string(64, 'a'), blob(setup.dump())},
                                                                    {std::string(64, 'b'), blob(rows)}};
    const Json message = {{"operation", "thermoform-compare"},
                          {"inputs",
                           {{"mould", {{"sample", "hemisphere"}, {"vertices", 800}}},
                            {"setup", {{"sha256", std::string(64, 'a')}, {"file_name", "setup.json"}}},
                            {"measured", {{"sha256", std::string(64, 'b')}, {"file_name", "measured.csv"}}}}},
                          {"outputs", Json::array()}};
    const JobResult result = run_job(message, [&](const std::string& hash) { return files.at(hash); }, session, {});
    {
      INFO(message_of(result));
      CHECK_FALSE(result.error);
    }
    return result.report.value("seconds_simulation", -1.0);
  };
  CHECK(run(0) > 0);
  CHECK(run(0) == 0);
  CHECK(run(2) > 0);
}

}  // namespace
}  // namespace formwright
