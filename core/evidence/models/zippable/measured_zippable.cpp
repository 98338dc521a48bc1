// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/zippable/measured_zippable.h"

#include <algorithm>
#include <cmath>

#include "base/data/json_text.h"
#include "base/error.h"
#include "formats/mesh_io.h"
#include "zippable/plan/plan_record.h"

namespace formwright {
namespace {

constexpr std::size_t min_zippable_lengths = 6;
constexpr Eigen::Index min_scan_points = 100;
constexpr double max_scan_sigma_mm = 100;

[[noreturn]] void refuse_folder(const std::string& sentence) {
  throw Error(ErrorCode::invalid_input, "object", sentence);
}

/// Numbers of the set-up that are not the simulation's.
double taken(Json& json, const char* key, double otherwise, double low, double high) {
  if (!json.contains(key)) return otherwise;
  const Json value = json[key];
  json.erase(key);
  if (!value.is_number() || !(value.get<double>() >= low && value.get<double>() <= high))
    refuse_folder("setup.json: “" + std::string(key) + "” must be a number of millimetres above 0.");
  return value.get<double>();
}

void read_setup(ByteView bytes, MeasuredZippable& object) {
  Json json = parse_json_text(as_text(bytes));
  if (!json.is_object()) refuse_folder("setup.json: this is not a JSON object; see docs/evidence_zippable.md for one.");
  object.marker_spacing_mm = taken(json, "marker_spacing_mm", object.marker_spacing_mm, 1, 10000);
  object.scan_sigma_mm = taken(json, "scan_sigma_mm", object.scan_sigma_mm, 1e-3, max_scan_sigma_mm);
  object.hangs = json.contains("hung_at_mm");
  if (json.contains("measured_surface")) {
    const Json surface = json["measured_surface"];
    if (surface != "outer" && surface != "mid") refuse_folder("setup.json: “measured_surface” must be outer or mid.");
    object.scan_is_outside = surface == "outer";
    json.erase("measured_surface");
  }
  try {
    object.setup = read_parameters<ZippingOptions>(json);
  } catch (const Error& error) {
    refuse_folder("setup.json: " + std::string(error.what()));
  }
}

}  // namespace

MeasuredZippable read_measured_zippable(const std::string& name, const std::map<std::string, Bytes>& files,
                                        Context& context) {
  MeasuredZippable object;
  object.name = name;
  const auto file = [&](const std::string& wanted) {
    const auto found = files.find(wanted);
    return found == files.end() ? nullptr : &found->second;
  };
  const FlatDesign design = read_flat_design(files.at("design.json"));
  object.design = ribbon_of(design);
  if (const Bytes* plan = file("plan.json")) {
    const PlanRecord record = read_plan_record(*plan, static_cast<std::size_t>(design.F.rows()), "object");
    object.marker_spacing_mm = record.marker_spacing_mm;
    object.design.turn_of_triangle_rad = record.turn_of_triangle_rad;
  }
  if (const Bytes* setup = file("setup.json")) read_setup(*setup, object);
  if (const Bytes* lengths = file("lengths.csv")) object.lengths = read_measured_lengths(*lengths);
  for (const MeasuredLength& length : object.lengths)
    for (const ZipperMark& mark : {length.from, length.to})
      if (mark.number * object.marker_spacing_mm > design.zipper_mm)
        refuse_folder("lengths.csv: mark " + std::to_string(mark.number) +
                      " lies beyond the zipper, whose last mark is " +
                      std::to_string(static_cast<int>(design.zipper_mm / object.marker_spacing_mm)) +
                      ": correct the number, or “marker_spacing_mm” in setup.json.");
  for (const char* scan : {"scan.ply", "scan.obj", "scan.stl", "scan.glb"})
    if (const Bytes* bytes = file(scan)) {
      ReadOptions options;
      options.where = "object";
      object.scan_mm = read_model_file(*bytes, scan, options, context).model.mesh.V;
      if (object.scan_mm.rows() < min_scan_points)
        refuse_folder(std::string(scan) + " has " + std::to_string(object.scan_mm.rows()) + " points; at least " +
                      std::to_string(min_scan_points) + " are needed.");
    }
  if (object.scan_mm.rows() == 0 && object.lengths.size() < min_zippable_lengths)
    refuse_folder("lengths.csv has " + std::to_string(object.lengths.size()) + " lengths; at least " +
                  std::to_string(min_zippable_lengths) + " are needed, or a scan of the zipped object.");
  return object;
}

}  // namespace formwright
