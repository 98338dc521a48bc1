// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/catalog.h"

#include "fabrication/laser/laser_materials.h"
#include "formats/mesh_io.h"
#include "geometry/samples/samples.h"

namespace formwright {

const char* version() { return FORMWRIGHT_VERSION; }

const Operation* find_operation(const std::string& name) {
  for (const Operation& operation : operations())
    if (operation.name == name) return &operation;
  return nullptr;
}

namespace {

Json preset_list_json(const PresetList& list) {
  Json presets = Json::array();
  for (const Preset& preset : list.presets)
    presets.push_back(
        {{"name", preset.name}, {"title", preset.title}, {"parameters", preset.parameters}, {"hint", preset.hint}});
  return {{"name", list.name}, {"title", list.title}, {"group", list.group}, {"help", list.help}, {"presets", presets}};
}

}  // namespace

Json operation_json(const Operation& operation) {
  Json inputs = Json::array(), properties = Json::object(), presets = Json::array(), outputs = Json::array(),
       report = Json::array();
  for (const InputInfo& input : operation.inputs) {
    inputs.push_back({{"name", input.name},
                      {"label", input.label},
                      {"required", input.required},
                      {"extensions", input.extensions},
                      {"accepts_sample", input.accepts_sample},
                      {"folder_files", input.folder_files},
                      {"repeatable", input.repeatable},
                      {"help", input.help}});
    if (!input.optional_folder_files.empty()) inputs.back()["optional_folder_files"] = input.optional_folder_files;
  }
  for (const PresetList& list : operation.presets) presets.push_back(preset_list_json(list));
  for (const ParameterInfo& info : operation.parameters) properties[info.name] = parameter_schema(info);
  for (const OutputInfo& output : operation.outputs)
    outputs.push_back({{"name", output.name},
                       {"media_type", output.media_type},
                       {"label", output.label},
                       {"help", output.help},
                       {"default", output.made_by_default}});
  for (const ReportField& field : operation.report)
    report.push_back({{"name", field.name}, {"label", field.label}, {"unit", field.unit}, {"help", field.help}});
  return {{"name", operation.name},
          {"title", operation.title},
          {"summary", operation.summary},
          {"module", operation.module},
          {"inputs", inputs},
          {"parameters",
           {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
            {"type", "object"},
            {"additionalProperties", false},
            {"properties", properties}}},
          {"presets", presets},
          {"outputs", outputs},
          {"report", report}};
}

Json catalog_json() {
  Json all = Json::array(), samples = Json::array(), formats = Json::array();
  for (const Operation& operation : operations()) all.push_back(operation_json(operation));
  for (const SampleInfo& sample : sample_catalog())
    samples.push_back(
        {{"name", sample.name},
         {"title", sample.title},
         {"description", sample.description},
         {"default_vertices", sample.default_vertices},
         {"closed", sample.closed},
         {"has_texture", sample.has_texture},
         {"view_direction", {sample.view_direction.x(), sample.view_direction.y(), sample.view_direction.z()}},
         {"view_up", {sample.view_up.x(), sample.view_up.y(), sample.view_up.z()}}});
  for (const MeshFormatInfo& format : mesh_formats)
    formats.push_back({{"extension", format.extension}, {"media_type", format.media_type}, {"title", format.title}});
  return {{"version", version()},
          {"operations", all},
          {"samples", samples},
          {"mesh_formats", formats},
          {"laser_materials", laser_materials_json()}};
}

}  // namespace formwright
