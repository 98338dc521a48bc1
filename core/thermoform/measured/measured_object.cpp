// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/measured/measured_object.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/statistics.h"
#include "base/error.h"
#include "base/data/json_text.h"
#include "base/data/number_table.h"
#include "thermoform/sheet/sheet_lookup.h"

namespace formwright {
namespace {

[[noreturn]] void refuse_setup(const std::string& sentence) {
  throw Error(ErrorCode::invalid_input, "setup", "setup.json: " + sentence);
}

double number(const Json& value, const std::string& key) {
  if (!value.is_number() || !std::isfinite(value.get<double>())) refuse_setup("“" + key + "” must be a number.");
  return value.get<double>();
}

}  // namespace

ObjectSetup read_object_setup(ByteView bytes) {
  const Json json = parse_json_text(as_text(bytes));
  if (!json.is_object()) refuse_setup("this is not a JSON object; see docs/measured_data.md for one.");
  ObjectSetup setup;
  double start_z = 0, end_z = 0;
  bool has_start = false;
  const auto pair = [&](const Json& value, const std::string& key, const char* x, const char* y) {
    if (!value.is_array() || value.size() != 2) refuse_setup("“" + key + "” must be two numbers, such as [240, 260].");
    setup.parameters[x] = number(value[0], key);
    setup.parameters[y] = number(value[1], key);
  };
  const std::vector<ParameterInfo> known = describe_parameters<ThermoformOptions>(),
                                   placements = describe_parameters<PlacementOptions>();
  const auto is_among = [](const std::vector<ParameterInfo>& infos, const std::string& key) {
    return std::any_of(infos.begin(), infos.end(), [&](const ParameterInfo& info) { return info.name == key; });
  };
  for (const auto& [key, value] : json.items()) {
    if (key == "sheet_mm") pair(value, key, "sheet_x_mm", "sheet_y_mm");
    else if (key == "clamp_opening_mm") pair(value, key, "clamp_opening_x_mm", "clamp_opening_y_mm");
    else if (key == "base_plate_start_z_mm") start_z = number(value, key), has_start = true;
    else if (key == "base_plate_end_z_mm") end_z = number(value, key);
    else if (key == "measured_surface") {
      if (value == "outer") setup.measured_surface = MeasuredSurface::outer;
      else if (value != "mid") refuse_setup("“measured_surface” must be \"mid\" or \"outer\".");
    } else if (key == "sheet_turned") {
      if (!value.is_boolean()) refuse_setup("“sheet_turned” must be true or false.");
      setup.sheet_turned = value.get<bool>();
    } else if (is_among(placements, key)) {
      setup.notes.push_back("“" + key +
                            "” in setup.json was left out: mould.obj is in machine coordinates, as the mould stood. "
                            "Turn or move the mould itself.");
    } else if (is_among(known, key)) {
      setup.parameters[key] = value;
    } else {
      setup.notes.push_back("“" + key + "” in setup.json is not known and was left out.");
    }
  }
  setup.base_plate_end_z_mm = end_z;
  if (has_start) {
    if (!(end_z > start_z))
      refuse_setup("the base plate must start below its end: base_plate_start_z_mm < base_plate_end_z_mm.");
    setup.parameters["platform_travel_mm"] = end_z - start_z;
  }
  if (setup.parameters.contains("clamp_height_mm"))
    setup.parameters["clamp_height_mm"] = number(setup.parameters["clamp_height_mm"], "clamp_height_mm") - end_z;
  read_parameters<ThermoformOptions>(setup.parameters);  // throws with the parameter's name
  return setup;
}

Json write_object_setup(const ThermoformOptions& o, MeasuredSurface surface) {
  return {{"sheet_mm", {o.sheet_x_mm, o.sheet_y_mm}},
          {"sheet_thickness_mm", o.sheet_thickness_mm},
          {"clamp_opening_mm", {o.clamp_opening_x_mm, o.clamp_opening_y_mm}},
          {"clamp_height_mm", o.clamp_height_mm},
          {"base_plate_start_z_mm", -o.platform_travel_mm},
          {"base_plate_end_z_mm", 0},
          {"mould_speed_mm_per_s", o.mould_speed_mm_per_s},
          {"relaxation_s", o.relaxation_s},
          {"vacuum_kpa", o.vacuum_kpa},
          {"density_kg_per_m3", o.density_kg_per_m3},
          {"poisson_ratio", o.poisson_ratio},
          {"measured_surface", surface == MeasuredSurface::outer ? "outer" : "mid"}};
}

std::vector<MeasuredPoint> read_measured_points(ByteView csv, const std::string& file_name) {
  const auto rows = read_number_table(csv, file_name, "measured",
                                      {{"sheet_x_mm"},
                                       {"sheet_y_mm"},
                                       {"x_mm", true, true},
                                       {"y_mm", true, true},
                                       {"z_mm", true, true},
                                       {"sigma_mm", false}});
  std::vector<MeasuredPoint> points;
  for (const std::vector<double>& row : rows) {
    if (row[5] < 0)
      throw Error(ErrorCode::invalid_input, "measured",
                  file_name + ", point " + std::to_string(points.size() + 1) + ": “sigma_mm” is negative.");
    points.push_back({Vec2(row[0], row[1]), Vec3(row[2], row[3], row[4]), row[5]});
  }
  return points;
}

std::string write_measured_points(const std::vector<MeasuredPoint>& points) {
  std::string text = "sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm,sigma_mm\n";
  char line[160];
  for (const MeasuredPoint& p : points) {
    std::snprintf(line, sizeof line, "%.7g,%.7g,%.7g,%.7g,%.7g,%.4g\n", p.sheet_mm.x(), p.sheet_mm.y(), p.place_mm.x(),
                  p.place_mm.y(), p.place_mm.z(), p.sigma_mm);
    text += line;
  }
  return text;
}

namespace {

struct Predicted {
  Vec3 place_mm, normal;
  bool inside;
};

/// Predicts one point after another.
class Prediction {
 public:
  Prediction(const FormedSheet& sheet, MeasuredSurface surface, double clamp_z_mm, double sheet_thickness_mm,
             const MeasurementEffects& effects, double base_plate_z_mm)
      : lookup_(sheet),
        effects_(effects),
        scan_(effects.scan()),
        outer_(surface == MeasuredSurface::outer),
        origin_(0, 0, base_plate_z_mm),
        clamped_z_mm_(clamp_z_mm + (outer_ ? 0.5 * sheet_thickness_mm : 0)) {}

  Predicted operator()(const Vec2& printed_mm) const {
    const Vec2 sheet_mm = effects_.on_sheet(printed_mm);
    Predicted predicted{Vec3(sheet_mm.x(), sheet_mm.y(), clamped_z_mm_), Vec3::UnitZ(), false};
    if (const auto at = lookup_.find(sheet_mm)) {
      const Vec3 middle = lookup_.middle(*at), outer = lookup_.outer(*at);
      predicted.place_mm = outer_ ? outer : middle;
      predicted.inside = true;
      if ((outer - middle).norm() > 1e-12) predicted.normal = (outer - middle).normalized();
    }
    predicted.place_mm = origin_ + scan_ * (predicted.place_mm - origin_);
    return predicted;
  }

 private:
  SheetLookup lookup_;
  MeasurementEffects effects_;
  Eigen::Affine3d scan_;  // about the origin
  bool outer_;
  Vec3 origin_;
  double clamped_z_mm_;
};

}  // namespace

Positions predict_measured(const FormedSheet& sheet, const TextureCoordinates& sheet_mm, MeasuredSurface surface,
                           double clamp_z_mm, double sheet_thickness_mm, const MeasurementEffects& effects,
                           double base_plate_z_mm) {
  const Prediction predict(sheet, surface, clamp_z_mm, sheet_thickness_mm, effects, base_plate_z_mm);
  Positions places(sheet_mm.rows(), 3);
  for (Eigen::Index i = 0; i < places.rows(); ++i)
    places.row(i) = predict(sheet_mm.row(i).transpose()).place_mm.transpose();
  return places;
}

Comparison compare(const FormedSheet& sheet, const std::vector<MeasuredPoint>& points, MeasuredSurface surface,
                   double clamp_z_mm, double sheet_thickness_mm, const MeasurementEffects& effects,
                   double base_plate_z_mm, Context& context) {
  const Prediction predict(sheet, surface, clamp_z_mm, sheet_thickness_mm, effects, base_plate_z_mm);
  Comparison result;
  result.points.reserve(points.size());
  std::vector<double> errors;
  double sum = 0, squares = 0, along = 0;
  int counted = 0;
  for (const MeasuredPoint& point : points) {
    if (counted++ % 10000 == 0) context.check_cancelled();
    const Predicted predicted = predict(point.sheet_mm);
    const Vec3 difference = point.place_mm - predicted.place_mm;
    const ComparedPoint compared{predicted.place_mm, difference.norm(), predicted.inside};
    sum += compared.error_mm;
    squares += difference.squaredNorm();
    along += difference.dot(predicted.normal);
    errors.push_back(compared.error_mm);
    result.points.push_back(compared);
  }
  const auto count = static_cast<double>(points.size());
  result.mean_mm = sum / count;
  result.root_mean_square_mm = std::sqrt(squares / count);
  result.along_normal_mean_mm = along / count;
  std::sort(errors.begin(), errors.end());
  result.median_mm = quantile(errors, 0.5);
  result.percentile_90_mm = quantile(errors, 0.9);
  result.percentile_95_mm = quantile(errors, 0.95);
  result.maximum_mm = errors.back();
  std::vector<double> deviations;
  for (const double e : errors) deviations.push_back(std::abs(e - result.median_mm));
  const double limit = result.median_mm + 5 * 1.4826 * quantile(deviations, 0.5);
  double kept = 0;
  for (const double e : errors) {
    if (e > limit) ++result.outliers;
    else kept += e;
  }
  const auto left = static_cast<double>(errors.size()) - result.outliers;
  result.mean_without_outliers_mm = left > 0 ? kept / left : result.mean_mm;
  return result;
}

}  // namespace formwright
