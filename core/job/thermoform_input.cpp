// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/thermoform_input.h"

#include "geometry/io/mesh_io.h"

namespace formwright {

FormedModel formed_model(const OperationCall& call, const ThermoformOptions& options) {
  FormedModel formed;
  formed.loaded = load_model(call, "mould");
  formed.placement = place(formed.loaded->model.mesh, options, clamp_opening_mm(options));
  const auto input = call.inputs.find("sheet");
  if (input == call.inputs.end() || !input->second.bytes)
    throw Error(ErrorCode::invalid_input, "sheet", "Give the sheet.ply of a simulation as well: it says where the sheet arrives last.");
  ReadOptions read;
  read.where = "sheet";
  const ModelFile file = read_model_file(*input->second.bytes, input->second.file_name, read, call.context);
  const auto column = [&](const char* name) -> const Eigen::VectorXd& {
    for (const VertexColumn& c : file.columns)
      if (c.name == name) return c.values;
    throw Error(ErrorCode::invalid_input, "sheet", std::string("The sheet has no column ") + name + ": give the sheet.ply that the simulation writes.");
  };
  auto sheet = std::make_shared<FormedSheet>();
  sheet->mesh = file.model.mesh;
  sheet->sheet_mm.resize(sheet->mesh.V.rows(), 2);
  sheet->sheet_mm.col(0) = column("sheet_x_mm");
  sheet->sheet_mm.col(1) = column("sheet_y_mm");
  sheet->thickness_mm = column("thickness_mm");
  sheet->stretch = column("stretch");
  sheet->contact_s = column("contact_s");
  formed.sheet = sheet;
  return formed;
}

}  // namespace formwright
