// SPDX-License-Identifier: GPL-3.0-or-later
// Several models made one, each where a scene has it: thesis section 3.3, "Multiple objects", Fig. 3.18.
#include <span>

#include "geometry/mesh/measures.h"
#include "geometry/samples/sample_parameters.h"
#include "job/contract/operation_options.h"
#include "job/operations/mesh/mesh_operations.h"
#include "job/operations/mesh/model_scene.h"

namespace formwright {
namespace {

constexpr double max_faces_together = 20e6;

struct CombineOptions {
  int scene_vertices = 6000;
  static constexpr auto parameters = std::tuple{scene_vertices_parameter(&CombineOptions::scene_vertices)};
};

std::vector<InputInfo> combine_inputs() {
  return {
      scene_input_info(
          "Models with their places as JSON, such as the scene.json of an earlier run. Without one, the given models stand side by side; without models, a family of a sample is made."),
      scene_models_info()};
}

std::vector<OutputInfo> combine_outputs() {
  std::vector<OutputInfo> outputs = mesh_outputs("model", MeshFormat::ply);
  outputs.push_back(
      {"scene.json", "application/json", "Scene", "The models with their places, to edit and to run again.", true});
  return outputs;
}

std::vector<PlacedModel> models_of(const OperationCall& call, const CombineOptions& options) {
  if (const auto scene = call.inputs.find(scene_input); scene != call.inputs.end())
    return read_model_scene(*scene->second.bytes);
  int count = 0;
  while (call.inputs.contains(scene_model_name(count + 1))) ++count;
  return count > 0 ? models_in_a_row(count) : sample_model_scene(options.scene_vertices);
}

OperationResult run_combine(const OperationCall& call, const CombineOptions& options) {
  const std::vector<PlacedModel> models = models_of(call, options);
  OperationResult result;
  std::vector<Model> parts;
  std::vector<std::string> names, repairs;
  Json list = Json::array();
  double faces = 0, seconds_read = 0;
  for (std::size_t k = 0; k < models.size(); ++k) {
    const auto count = static_cast<double>(models.size());
    const double begin = 0.8 * static_cast<double>(k) / count;
    const auto span = call.context.span(begin, begin + 0.8 / count, "Reading the models");
    const auto loaded = load_scene_model(call, models[k].source, "Model " + std::to_string(k + 1));
    faces += loaded->model.mesh.face_count();
    if (faces > max_faces_together)
      refuse_scene("The models have more than 20 million triangles together: simplify the largest ones first.");
    Model part = loaded->model;
    part.mesh.V = placed(part.mesh.V, models[k].placement);
    const BoundingBox box = bounding_box(part.mesh);
    const Vec3 size = box.size();
    list.push_back({{"name", models[k].name},
                    {"vertices", part.mesh.vertex_count()},
                    {"size_mm", {size.x(), size.y(), size.z()}}});
    seconds_read += loaded->seconds_read + loaded->seconds_repair;
    for (const std::string& sentence : loaded->repairs) repairs.push_back(models[k].name + ": " + sentence);
    parts.push_back(std::move(part));
    names.push_back(models[k].name);
  }
  Stopwatch watch;
  const Model all = joined(parts, names);
  const Vec3 size = bounding_box(all.mesh).size();
  Json& report = result.report;
  report["vertices"] = all.mesh.vertex_count();
  report["faces"] = all.mesh.face_count();
  report["models"] = list;
  report["size_mm"] = {size.x(), size.y(), size.z()};
  report["repairs"] = repairs;
  report["seconds_read"] = seconds_read;
  report["seconds_work"] = watch.lap();
  call.context.progress(0.9, "Writing");
  const std::vector<OutputInfo> outputs = combine_outputs();
  result.outputs = write_mesh_outputs(call, mesh_outputs("model", MeshFormat::ply), all);
  if (call.wants("scene.json")) {
    const std::string text = model_scene_json(models).dump(1);
    const auto bytes = std::as_bytes(std::span(text));
    result.outputs.push_back(make_output(outputs.back(), Bytes(bytes.begin(), bytes.end())));
  }
  report["seconds_write"] = watch.lap();
  return result;
}

}  // namespace

Operation combine_operation() {
  Operation operation;
  operation.name = "combine";
  operation.title = "Combine";
  operation.summary = "Puts several models into one, each moved, turned and scaled, for a relief of them all.";
  operation.inputs = combine_inputs();
  operation.outputs = combine_outputs();
  operation.report = {
      {"vertices", "Vertices", "", "Number of vertices of the result."},
      {"faces", "Triangles", "", "Number of triangles of the result."},
      {"models", "Models", "", "For each model: its name, its number of vertices and its size where it stands."},
      {"size_mm", "Size", "mm", "Size of all models together along x, y and z."},
      {"repairs", "Repairs", "", "What was found wrong in the models and repaired, as sentences."},
      {"seconds_read", "Reading", "s", "Time for reading and repairing the models; 0 if they were read before."},
      {"seconds_work", "Working", "s", "Time for putting the models together."},
      {"seconds_write", "Writing", "s", "Time for writing the output files."}};
  take_options<CombineOptions>(operation, run_combine);
  return operation;
}

}  // namespace formwright
