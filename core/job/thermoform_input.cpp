// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/thermoform_input.h"

#include <algorithm>

namespace formwright {
namespace {

std::shared_ptr<const FormedSheet> read_sheet(const InputBlob& input, Context& context) {
  ReadOptions options;
  options.where = "sheet";
  const ModelFile file = read_model_file(*input.bytes, input.file_name, options, context);
  const auto column = [&](const char* name) -> const Eigen::VectorXd& {
    const auto found = std::ranges::find(file.columns, name, &VertexColumn::name);
    if (found == file.columns.end())
      throw Error(ErrorCode::invalid_input, "sheet", std::string("The sheet has no column ") + name + ": give the sheet.ply that the simulation wrote.");
    return found->values;
  };
  auto sheet = std::make_shared<FormedSheet>();
  sheet->mesh = file.model.mesh;
  sheet->sheet_mm.resize(sheet->mesh.V.rows(), 2);
  sheet->sheet_mm << column("sheet_x_mm"), column("sheet_y_mm");
  sheet->thickness_mm = column("thickness_mm");
  sheet->stretch = column("stretch");
  sheet->contact_s = column("contact_s");
  return sheet;
}

}  // namespace

FormedModel formed_model(const OperationCall& call, const ThermoformOptions& options) {
  FormedModel formed;
  formed.loaded = load_model(call, "mould");
  formed.placement = place(formed.loaded->model.mesh, options, clamp_opening_mm(options));
  const auto sheet = call.inputs.find("sheet");
  if (sheet == call.inputs.end()) throw Error(ErrorCode::invalid_input, "sheet", "There is no formed sheet: simulate first and give its sheet.ply.");
  formed.sheet = read_sheet(sheet->second, call.context);
  return formed;
}

}  // namespace formwright
