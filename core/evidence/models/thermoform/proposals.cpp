// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/thermoform/proposals.h"

#include <algorithm>

namespace formwright {

std::vector<ProposedMeasurement> proposed_measurements(const ThermoformModel& model,
                                                       const ThermoformModelOptions& options) {
  const FormedObject& first = model.objects().front();
  const auto own = read_parameters<ThermoformOptions>(first.setup.parameters);
  std::vector<ProposedMeasurement> proposals;
  const auto add = [&](const std::string& what, const FormedObject& object) {
    proposals.push_back({what, std::make_unique<ThermoformModel>(std::vector<FormedObject>{object}, options)});
  };
  {
    FormedObject turned = first;
    turned.setup.sheet_turned = !turned.setup.sheet_turned;
    for (MeasuredPoint& point : turned.points) point.sheet_mm = -point.sheet_mm;
    for (MeasuredThickness& reading : turned.thickness) reading.sheet_mm = -reading.sheet_mm;
    add("Form and measure the same mould once more with the sheet turned by half a turn (\"sheet_turned\": true in its setup.json): what comes with the sheet turns with it, "
        "what the machine does stays.",
        turned);
  }
  const auto moved = [&](const std::string& what, const char* suffix, auto&& change) {
    TriangleMesh mesh = first.mould->mesh;
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
      mesh.V.row(i) = change(Vec3(mesh.V.row(i).transpose())).transpose();
    FormedObject object = first;
    object.key += suffix;
    object.mould = std::make_shared<const MouldShape>(std::move(mesh));
    add(what, object);
  };
  const double reach = first.mould->mesh.V.leftCols<2>().cwiseAbs().maxCoeff();
  if (reach < 0.48 * std::min(own.clamp_opening_x_mm, own.clamp_opening_y_mm))
    moved(
        "Form and measure the same mould once more, turned by a quarter turn on the platform (its mould.obj turned "
        "likewise).",
        ":quarter-turn", [](const Vec3& p) { return Vec3(-p.y(), p.x(), p.z()); });
  const double plate = first.setup.base_plate_end_z_mm, height = first.mould->mesh.V.col(2).maxCoeff() - plate;
  const double taller = std::min(1.5, 0.85 * own.platform_travel_mm / std::max(height, 1.0));
  if (taller > 1.1)
    moved("Form and measure a second, higher mould: most effects grow with depth, each in its own way.", ":higher",
          [=](const Vec3& p) { return Vec3(p.x(), p.y(), plate + taller * (p.z() - plate)); });
  return proposals;
}

}  // namespace formwright
