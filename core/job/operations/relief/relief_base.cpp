// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/relief/relief_base.h"

#include "relief/base/base_shape.h"

namespace formwright {
namespace {

constexpr const char* base_file = "base_mesh";

}  // namespace

InputInfo base_input_info() {
  InputInfo info = model_input_info();
  info.name = base_file;
  info.label = "Base";
  info.help =
      "A surface to work the relief into, in millimetres: x right, y up, z towards the viewer, the middle of the relief at 0, 0, 0.";
  info.required = false;
  info.accepts_sample = false;
  return info;
}

std::shared_ptr<const LoadedModel> load_base(const OperationCall& call, const ReliefOptions& options) {
  if (!call.inputs.contains(base_file)) return nullptr;
  if (options.base != BaseShape::flat)
    throw Error(ErrorCode::invalid_input, "base",
                "The base is given twice, as a file and as a built-in shape: leave one of them out.");
  return load_model(call, base_file);
}

BaseSurface relief_base(const LoadedModel* file, const ReliefOptions& options, const ViewFrame& frame,
                        Context& context) {
  if (file != nullptr) {
    const TriangleMesh mesh = base_from_file(file->model.mesh, options);
    if (options.base_mesh_parts == PartsOfBase::together || count_base_parts(mesh) == 1) return BaseSurface(mesh);
    return BaseSurface(mesh, std::nullopt, std::make_shared<const BaseParts>(mesh, frame.kappa, context));
  }
  if (options.base == BaseShape::flat) return {};
  return BaseSurface(base_shape(options, frame), base_bands(options, frame));
}

}  // namespace formwright
