// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/relief/painting/loaded_painting.h"

#include <algorithm>

#include "base/parallel.h"
#include "geometry/queries/point_distance.h"
#include "job/operations/relief/painting/painting_file.h"

namespace formwright {
namespace {

constexpr const char *painting_name = "painting", *painted_mesh_name = "painted_mesh";
constexpr double max_mean_distance = 0.02;  // of the painted model's diagonal: a simplified model is far nearer
constexpr std::size_t vertices_a_chunk = 2048;

bool is_json(const InputBlob& input) {
  const std::string_view text = as_text(*input.bytes);
  const std::size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  return first != std::string_view::npos && text[first] == '{';
}

/// The vertex of `to` that is nearest on its surface, for every vertex of `from`.
std::vector<int> nearest_vertices(const TriangleMesh& from, const TriangleMesh& to, Context& context) {
  const PointDistance surface(to);
  std::vector<int> nearest(static_cast<std::size_t>(from.vertex_count()));
  std::vector<double> distance(nearest.size());
  parallel_for(nearest.size(), vertices_a_chunk, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 p = from.V.row(static_cast<Eigen::Index>(i)).transpose();
      const auto found = surface.nearest(p);
      distance[i] = found->distance;
      Eigen::Index corner = 0;
      found->barycentric.maxCoeff(&corner);
      nearest[i] = to.F(found->face, corner);
    }
  });
  double sum = 0;
  for (const double d : distance) sum += d;
  const double diagonal = (to.V.colwise().maxCoeff() - to.V.colwise().minCoeff()).norm();
  if (sum > max_mean_distance * diagonal * static_cast<double>(distance.size()))
    throw Error(
        ErrorCode::invalid_input, painted_mesh_name,
        "The painted model has another shape than the model of the relief: paint this model, or leave the painting out.");
  return nearest;
}

std::shared_ptr<const std::vector<int>> nearest_vertices(const OperationCall& call, const LoadedModel& from,
                                                         const LoadedModel& to) {
  const std::string key = "painted:" + from.key + ":" + to.key;
  if (auto known = call.session.find<const std::vector<int>>(key)) return known;
  auto nearest =
      std::make_shared<const std::vector<int>>(nearest_vertices(from.model.mesh, to.model.mesh, call.context));
  call.session.keep(key, nearest, 1e-6 * static_cast<double>(nearest->size() * sizeof(int)));
  return nearest;
}

/// The input "painting" for the vertices of `painted`, as they are after its repair.
Painting read_input(const OperationCall& call, const LoadedModel& painted) {
  const InputBlob& input = call.inputs.at(painting_name);
  const int repaired = painted.model.mesh.vertex_count(), in_file = painted.columns.file_vertices;
  const std::string name = input.file_name.empty() ? "The painting" : input.file_name;
  if (is_json(input)) {
    const PaintingFile file = read_painting(*input.bytes, painting_name, name, {repaired, in_file}, painted.name);
    return file.vertices == repaired ? file.painting : painting_of(file.painting, painted.columns.file_vertex);
  }
  const auto model = load_model(call, painting_name);
  const Painting painting = painting_of_columns(model->columns, painting_name, model->name);
  if (painting.empty())
    throw Error(ErrorCode::invalid_input, painting_name,
                name + ": its vertices have no weight, region, thickness_mm or carve_depth_mm: give a painted model.");
  if (const int count = model->model.mesh.vertex_count(); count != repaired)
    throw Error(ErrorCode::invalid_input, painting_name,
                name + ": it is painted for " + std::to_string(count) + " vertices, and " + painted.name + " has " +
                    std::to_string(repaired) +
                    ": paint this model, or give the model that was painted as painted_mesh.");
  return painting;
}

/// What merging vertices cost, in a sentence; empty where nothing was lost.
std::string merging_note(const LoadedModel& model) {
  int lost = 0;
  for (const std::string_view name : painted_columns)
    if (const ModelColumn* const column = model.columns.find(name)) lost = std::max(lost, column->lost);
  if (lost == 0) return "";
  return std::to_string(lost) + (lost == 1 ? " vertex was" : " vertices were") +
         " painted otherwise than another one at the same place, whose painting counts.";
}

}  // namespace

InputInfo painting_input_info() {
  InputInfo info;
  info.name = painting_name;
  info.label = "Painting";
  info.help =
      "What is painted onto the model: a JSON file, or a PLY or glTF model whose vertices have weight, region, thickness_mm or carve_depth_mm. It counts before such numbers of the model itself.";
  info.extensions = {"json", "ply", "glb"};
  info.required = false;
  return info;
}

InputInfo painted_mesh_input_info() {
  InputInfo info = model_input_info();
  info.name = painted_mesh_name;
  info.label = "Painted model";
  info.help =
      "The model whose vertices the painting counts, where that is not the model of the relief but the same shape with other vertices.";
  info.required = false;
  return info;
}

LoadedPainting load_painting(const OperationCall& call, const LoadedModel& model) {
  LoadedPainting loaded;
  const bool elsewhere = call.inputs.contains(painted_mesh_name);
  if (elsewhere && !call.inputs.contains(painting_name))
    throw Error(ErrorCode::invalid_input, painted_mesh_name,
                "There is a painted model without a painting: give the painting, too, or leave the model out.");
  if (!call.inputs.contains(painting_name)) {
    loaded.painting = painting_of_columns(model.columns, "mesh", model.name);
    if (loaded.painting.empty()) return loaded;
    if (std::string note = merging_note(model); !note.empty()) loaded.notes.push_back(std::move(note));
    return loaded;
  }
  if (!elsewhere) {
    loaded.painting = read_input(call, model);
    return loaded;
  }
  const auto painted = load_model(call, painted_mesh_name);
  loaded.painting = read_input(call, *painted);
  if (painted->key != model.key)
    loaded.painting = painting_of(loaded.painting, *nearest_vertices(call, model, *painted));
  return loaded;
}

}  // namespace formwright
