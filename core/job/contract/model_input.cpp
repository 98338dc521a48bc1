// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/contract/model_input.h"

#include "formats/shared/mesh_source.h"
#include "geometry/repair/repair.h"
#include "geometry/samples/samples.h"

namespace formwright {
namespace {

double megabytes(const LoadedModel& loaded) {
  const Model& model = loaded.model;
  double bytes =
      static_cast<double>(model.mesh.V.size() + model.UV.size() + model.vertex_colours.size()) * sizeof(double) +
      static_cast<double>(model.mesh.F.size() + model.FT.size()) * sizeof(int);
  for (const Texture& texture : model.textures) bytes += static_cast<double>(texture.bytes.size());
  return bytes * 1e-6 + loaded.columns.megabytes();
}

int sample_vertices(const InputBlob& input) {
  if (input.sample_vertices != 0) return input.sample_vertices;
  for (const SampleInfo& sample : sample_catalog())
    if (sample.name == input.sample) return sample.default_vertices;
  return min_sample_vertices;
}

}  // namespace

InputInfo model_input_info() {
  InputInfo info{"mesh", "Model", "A triangle or polygon mesh.", {}, true, true};
  for (const MeshFormatInfo& format : mesh_formats) info.extensions.emplace_back(format.extension);
  return info;
}

std::shared_ptr<const LoadedModel> load_model(const OperationCall& call, const std::string& input_name) {
  const InputBlob& input = call.inputs.at(input_name);
  const std::string key = "model:" + input.key();
  if (auto known = call.session.find<const LoadedModel>(key)) {
    // A copy of the small parts only would do, but a second report must not claim the first one's seconds.
    if (known->seconds_read == 0 && known->seconds_repair == 0) return known;
    auto again = std::make_shared<LoadedModel>(*known);
    again->seconds_read = again->seconds_repair = 0;
    std::shared_ptr<const LoadedModel> kept = again;
    call.session.keep(key, kept, megabytes(*again));
    return kept;
  }
  auto loaded = std::make_shared<LoadedModel>();
  loaded->key = input.key();
  ModelFile file;
  Stopwatch watch;
  call.context.progress(0, "Reading the model");
  if (!input.sample.empty()) {
    file.model = make_sample(input.sample, sample_vertices(input), call.context);
    loaded->name = input.sample;
    loaded->file_format = "sample";
  } else {
    ReadOptions options;
    options.where = input_name;
    file = read_model_file(*input.bytes, input.file_name, options, call.context);
    loaded->name = input.file_name.empty() ? "The model" : clean_text(input.file_name);
    loaded->file_format = mesh_format_info(file.format).extension;
    loaded->repairs = file.notes;
  }
  loaded->seconds_read = watch.lap();
  call.context.progress(0.6, "Checking the model");
  const RepairedMesh repaired = repair(file.model.mesh, {}, call.context);
  loaded->repairs.insert(loaded->repairs.end(), repaired.sentences.begin(), repaired.sentences.end());
  loaded->model = repaired_model(file.model, repaired);
  loaded->columns = carried_columns(file, repaired);
  loaded->seconds_repair = watch.lap();
  std::shared_ptr<const LoadedModel> kept = loaded;
  call.session.keep(key, kept, megabytes(*loaded));
  return kept;
}

OutputBlob make_output(const OutputInfo& info, Bytes bytes) {
  return {info.name, info.media_type, std::make_shared<const Bytes>(std::move(bytes))};
}

std::vector<OutputInfo> mesh_outputs(const std::string& stem, MeshFormat made_by_default) {
  std::vector<OutputInfo> outputs;
  for (const MeshFormatInfo& format : mesh_formats)
    outputs.push_back({stem + "." + std::string(format.extension), std::string(format.media_type),
                       std::string(format.title), "", format.format == made_by_default});
  return outputs;
}

std::vector<OutputBlob> write_mesh_outputs(const OperationCall& call, const std::vector<OutputInfo>& outputs,
                                           const Model& model, std::span<const VertexColumn> columns) {
  WriteOptions write;
  write.columns = columns;
  std::vector<OutputBlob> written;
  for (const OutputInfo& info : outputs)
    if (call.wants(info.name))
      written.push_back(
          make_output(info, write_model(model, *mesh_format_of_extension(info.name), write, call.context)));
  return written;
}

}  // namespace formwright
