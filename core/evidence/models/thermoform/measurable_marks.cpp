// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/thermoform/measurable_marks.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "base/format.h"
#include "geometry/queries/ray_caster.h"

namespace formwright {
namespace {

constexpr double rim_mm = 4;  // beside the clamp, where a gauge does not stand
constexpr double max_lean_deg = 75;
constexpr double beside_mm = 0.5;  // of the mark, where the sheet's slope is taken
constexpr std::size_t max_marks = 3000;
constexpr std::size_t min_marks = 4;

std::vector<Vec2> grid(double spacing_mm, const Vec2& half_mm) {
  std::vector<Vec2> places;
  const auto last = [&](double half) {
    return static_cast<int>(std::floor(std::max(0.0, half - rim_mm) / spacing_mm));
  };
  const int columns = last(half_mm.x()), rows = last(half_mm.y());
  for (int j = -rows; j <= rows; ++j)
    for (int i = -columns; i <= columns; ++i) places.emplace_back(spacing_mm * i, spacing_mm * j);
  return places;
}

}  // namespace

MeasurableMarks measurable_marks(const FormedObject& object, const ThermoformModelOptions& model_options,
                                 const MarkOptions& options, Context& context) {
  const auto own = read_parameters<ThermoformOptions>(object.setup.parameters);
  const Vec2 half(0.5 * own.clamp_opening_x_mm, 0.5 * own.clamp_opening_y_mm);
  MeasurableMarks marks;
  marks.spacing_mm = options.spacing_mm;
  std::vector<Vec2> places;
  const auto count = [&](double spacing) { return 4 * half.x() * half.y() / (spacing * spacing); };
  while (count(marks.spacing_mm) > static_cast<double>(max_marks)) marks.spacing_mm *= 2;
  places = grid(marks.spacing_mm, half);

  // Each mark, and two places beside it for the slope.
  FormedObject probed = object;
  probed.points.clear();
  for (const Vec2& place : places)
    for (const Vec2& beside : {Vec2(0, 0), Vec2(beside_mm, 0), Vec2(0, beside_mm)})
      probed.points.push_back({place + beside, Vec3::Zero(), options.sigma_mm});
  const ThermoformModel model({probed}, model_options);
  const Eigen::MatrixXd at = model.predict(0, model.nominal(), context);
  TriangleMesh sheet = model.formed(0, model.nominal(), context)->mesh;
  sheet.V.col(2).array() += object.setup.base_plate_end_z_mm;
  const RayCaster rays(sheet);
  const double least = std::cos(max_lean_deg * std::numbers::pi / 180);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(3 * i);
    const Vec3 place = at.row(row).transpose();
    const Vec3 normal =
        Vec3((at.row(row + 1) - at.row(row)).transpose()).cross(Vec3((at.row(row + 2) - at.row(row)).transpose()));
    if (!(normal.z() >= least * normal.norm()) || normal.norm() == 0) continue;
    // From above a millimetre of the sheet's own thickness is no cover.
    if (rays.first_hit(place, Vec3::UnitZ(), 1 + own.sheet_thickness_mm, 1e6)) continue;
    marks.points.push_back({places[i], place, options.sigma_mm});
  }
  if (marks.points.size() < min_marks)
    throw Error(ErrorCode::invalid_input, "spacing_mm",
                "On a grid of " + with_digits(marks.spacing_mm, 3) + " mm only " + std::to_string(marks.points.size()) +
                    " marks could be reached from above: make “spacing_mm” smaller.");
  return marks;
}

}  // namespace formwright
