// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "base/sha256.h"
#include "evidence/models/thermoform/measurable_marks.h"
#include "evidence/planning/marks_drawing.h"
#include "evidence/planning/measuring_plan.h"
#include "job/contract/model_input.h"
#include "job/contract/operation_options.h"
#include "job/operations/evidence/evidence_input.h"
#include "job/operations/evidence/evidence_operations.h"
#include "job/operations/evidence/measuring_form.h"
#include "job/operations/evidence/measuring_outlook.h"
#include "job/operations/thermoform/thermoform_input.h"

namespace formwright {
namespace {

/// Enough to see what a cause does to single points, and 16 times as fast as a result's 10,000 twice over.
constexpr int max_plan_triangles = 2500;
/// More are as good as a scan, and choosing further ones beside them would take memory for nothing.
constexpr std::size_t max_measured = 300;
constexpr double min_distance_mm = 8;  // two crosses with their numbers do not touch

struct PlanPointsOptions {
  int mark_count = 10;
  double mark_spacing_mm = 10;
  double gauge_sigma_mm = 0.3;
  bool rim_thickness = true;

  static constexpr std::string_view group_title = "Measuring by hand";
  static constexpr auto parameters = std::tuple{
      parameter(
          "mark_count", &PlanPointsOptions::mark_count, "Marks", unit::none, 1, 60,
          "Number of marks to measure. Ten show a fault of the machine that a scan would show, if it is strong; each mark takes about a minute.")
          .group(group_title)
          .slider(4, 30),
      parameter(
          "mark_spacing_mm", &PlanPointsOptions::mark_spacing_mm, "Grid of marks", unit::mm, 2, 100,
          "Marks lie on a grid of this spacing about the sheet's centre, so that a ruler finds them. 10 mm is usual.")
          .group(group_title)
          .slider(5, 25),
      parameter(
          "gauge_sigma_mm", &PlanPointsOptions::gauge_sigma_mm, "Measuring error", unit::mm, 0.01, 5,
          "Standard deviation of each coordinate that you measure. 0.3 mm is usual for calipers and a depth gauge.")
          .group(group_title)
          .slider(0.05, 1),
      parameter(
          "rim_thickness", &PlanPointsOptions::rim_thickness, "Thickness of the rim",
          "Also asks how thick the rim is in the middle of each side, for calipers: this shows a sheet that is thicker on one side, which marks hardly do.")
          .group(group_title)};
};

std::vector<OutputInfo> plan_points_outputs() {
  return {
      {"marks.svg", "image/svg+xml", "Marks at true size",
       "The numbered marks on the flat sheet, as seen from above. Print at 100 % and transfer them, or draw them with a ruler.",
       true},
      {"measured.csv", "text/csv", "Form to fill in",
       "One line for each mark, with where it is expected, and one for each side of the rim. Fill in x_mm, y_mm and z_mm, or thickness_mm; lines left blank are passed over.",
       true},
      {"mould.obj", "model/obj", "Mould", "The mould as it should stand in the machine.", true},
      {"setup.json", "application/json", "Set-up",
       "The settings of the machine. With mould.obj and the filled form it is a measured object.", true}};
}

std::vector<ReportField> plan_points_report_fields() {
  return {
      {"sentence", "What they show", "", "Which causes these marks would show, in a sentence."},
      {"marks", "Marks", "",
       "The chosen marks, the most telling first: number, place on the sheet, and where it is expected on the formed sheet."},
      {"rim", "Thickness of the rim", "",
       "Places of the rim whose thickness is to be measured: side, place on the sheet, and how thick the rim should be."},
      {"causes", "Causes", "",
       "For each cause: the strength from which these marks and the rim's thickness show it, the same with every mark of the grid, its usual strength, and the cause that is hardest to tell from it."},
      {"information_nats", "Information", "nats",
       "What measured and chosen marks together tell about all causes (mutual information, in units of 1.44 bits)."},
      {"information_of_measured_nats", "Information so far", "nats",
       "The same for the marks that are measured already."},
      {"information_of_all_nats", "Information of the grid", "nats", "The same for every mark of the grid."},
      {"sheet_mm", "Sheet", "mm", "Width and length of the flat sheet."},
      {"opening_mm", "Clamp opening", "mm", "Width and length of the clamp opening."},
      {"candidates", "Marks in reach", "", "Number of marks of the grid that can be measured from above."},
      {"spacing_mm", "Grid of marks", "mm", "Spacing of the grid that was used."},
      {"measured", "Measured", "", "Number of points that are measured already."},
      {"triangles", "Triangles", "", "Number of triangles in the simulated sheet."},
      {"simulations", "Simulations", "", "Number of simulations that were made."},
      {"seconds_plan", "Planning", "s", "Time for the simulations and the choice."},
      {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."},
      {"notes", "Notes", "", "What to know about the result, as sentences."}};
}

/// The object as a measured one would be read, without its points.
FormedObject object_of(const SimulationCall& simulation, const Simulated& simulated) {
  FormedObject object;
  object.name = simulated.mould.loaded->name.empty() ? "object" : simulated.mould.loaded->name;
  TriangleMesh mesh = simulated.mould.placement(simulated.mould.shape->mesh);
  object.setup.parameters = write_parameters(simulation.options);
  for (const ParameterInfo& placement : describe_parameters<PlacementOptions>())
    object.setup.parameters.erase(placement.name);
  object.setup.measured_surface = MeasuredSurface::outer;  // what a gauge touches
  if (simulation.setup) {
    object.setup.measured_surface = simulation.setup->measured_surface;
    object.setup.sheet_turned = simulation.setup->sheet_turned;
    object.setup.base_plate_end_z_mm = simulation.setup->base_plate_end_z_mm;
    if (object.setup.sheet_turned)  // the wedge was turned into the clamp's directions; an object has the sheet's
      for (const char* wedge : {"thickness_wedge_x", "thickness_wedge_y"})
        object.setup.parameters[wedge] = -object.setup.parameters[wedge].get<double>();
    mesh.V.col(2).array() += object.setup.base_plate_end_z_mm;
  }
  object.mould = std::make_shared<const MouldShape>(std::move(mesh));
  return object;
}

std::string plan_sentence(const ForwardModel& model, const MeasuringPlan& plan, std::size_t measured) {
  const bool with_rim = model.measurements().size() > 1;
  return outlook_sentence(model, plan,
                          std::string(measured > 0 ? "The measured points and these marks" : "These marks") +
                              (with_rim ? " and the rim's thickness" : ""));
}

InputInfo measured_so_far_info() {
  InputInfo info;
  info.name = "measured";
  info.label = "Measured so far";
  info.help = "A measured.csv with the points that you have already: the marks are chosen beside them.";
  info.extensions = {"csv"};
  info.required = false;
  info.object_file = "measured.csv";
  return info;
}

std::vector<MeasuredPoint> measured_so_far(const OperationCall& call, const PlanPointsOptions& options) {
  const auto input = call.inputs.find("measured");
  if (input == call.inputs.end()) return {};
  std::vector<MeasuredPoint> points = read_measured_points(*input->second.bytes, input->second.file_name);
  if (points.size() > max_measured)
    throw Error(ErrorCode::invalid_input, "measured",
                input->second.file_name + " has " + std::to_string(points.size()) + " points; with more than " +
                    std::to_string(max_measured) + " no further mark is needed: diagnose them.");
  for (MeasuredPoint& point : points)
    if (!(point.sigma_mm > 0)) point.sigma_mm = options.gauge_sigma_mm;
  return points;
}

std::vector<MeasuredThickness> thickness_so_far(const OperationCall& call) {
  const auto input = call.inputs.find("measured");
  if (input == call.inputs.end()) return {};
  std::vector<MeasuredThickness> readings = read_measured_thickness(*input->second.bytes, input->second.file_name);
  if (readings.size() > max_measured)
    throw Error(ErrorCode::invalid_input, "measured",
                input->second.file_name + " has " + std::to_string(readings.size()) +
                    " thickness readings; a plan takes up to " + std::to_string(max_measured) + ".");
  return readings;
}

OperationResult run_evidence_plan_points(const OperationCall& call, const Json& given, const Json& of_plan) {
  Stopwatch watch;
  const auto o = read_parameters<PlanPointsOptions>(of_plan);
  SimulationCall simulation = simulation_call(call, given);
  simulation.options.triangles = std::min(simulation.options.triangles, max_plan_triangles);
  const std::vector<MeasuredPoint> measured = measured_so_far(call, o);
  const std::vector<MeasuredThickness> measured_thickness = thickness_so_far(call);
  Simulated simulated;
  {
    const auto span = call.context.span(0, 0.04, "Forming the sheet");
    simulated = simulate(call, simulation);
  }
  FormedObject object = object_of(simulation, simulated);
  Model mould;
  mould.mesh = object.mould->mesh;
  const Bytes obj = write_model(mould, MeshFormat::obj, call.context);
  object.key = sha256_hex(obj);
  ThermoformModelOptions model_options;
  model_options.triangles = simulation.options.triangles;
  if (auto profile = machine_profile(call)) {
    model_options.profile = std::move(*profile);
    for (auto& [name, value] : model_options.profile.parameters.items())  // what is given by name wins
      value = object.setup.parameters.at(name);
  }
  MeasurableMarks marks;
  {
    const auto span = call.context.span(0.04, 0.08, "Looking for marks in reach");
    marks = measurable_marks(object, model_options, {o.mark_spacing_mm, o.gauge_sigma_mm}, call.context);
  }
  object.points = measured;
  object.points.insert(object.points.end(), marks.points.begin(), marks.points.end());
  const std::vector<RimPlace> rim =
      o.rim_thickness ? rim_to_measure(simulation.options, measured_thickness) : std::vector<RimPlace>{};
  object.thickness = measured_thickness;
  for (const RimPlace& place : rim)
    object.thickness.push_back({place.sheet_mm, simulation.options.sheet_thickness_mm, usual_thickness_sigma_mm});
  const ThermoformModel model({object}, model_options);
  SimulationBag bag(model);
  MeasuringPlanOptions plan_options;
  plan_options.points = o.mark_count;
  plan_options.measured = static_cast<Eigen::Index>(measured.size());
  plan_options.measured_others = static_cast<Eigen::Index>(measured_thickness.size());
  plan_options.min_distance = min_distance_mm / model.measurements().front().extent_mm;
  MeasuringPlan plan;
  {
    const auto span = call.context.span(0.08, 1, "Planning");
    plan = plan_measuring(bag, plan_options, call.context);
  }

  OperationResult result;
  Json list = Json::array();
  std::vector<MeasuredPoint> chosen;
  MarksDrawing drawing{{simulation.options.sheet_x_mm, simulation.options.sheet_y_mm},
                       {simulation.options.clamp_opening_x_mm, simulation.options.clamp_opening_y_mm},
                       {},
                       static_cast<int>(measured.size()) + 1};
  const auto two_digits = [](double value) { return std::round(100 * value) / 100; };
  for (const Eigen::Index row : plan.chosen) {
    MeasuredPoint mark = object.points[static_cast<std::size_t>(row)];
    mark.place_mm = plan.expected.front().row(row).transpose();
    list.push_back({{"number", drawing.first_number + static_cast<int>(chosen.size())},
                    {"sheet_x_mm", mark.sheet_mm.x()},
                    {"sheet_y_mm", mark.sheet_mm.y()},
                    {"expected_x_mm", two_digits(mark.place_mm.x())},
                    {"expected_y_mm", two_digits(mark.place_mm.y())},
                    {"expected_z_mm", two_digits(mark.place_mm.z())}});
    drawing.marks_mm.push_back(mark.sheet_mm);
    chosen.push_back(std::move(mark));
  }
  std::vector<std::string> notes = simulated.result->placement.notes;
  if (marks.spacing_mm > o.mark_spacing_mm)
    notes.push_back("The sheet is large: the marks lie on a grid of " + with_digits(marks.spacing_mm, 3) + " mm.");
  if (static_cast<int>(chosen.size()) < o.mark_count)
    notes.push_back("Only " + std::to_string(chosen.size()) + " marks tell anything more; a finer grid has others.");
  result.report["sentence"] = plan_sentence(model, plan, measured.size());
  result.report["marks"] = std::move(list);
  result.report["rim"] = Json::array();
  for (const RimPlace& place : rim)
    result.report["rim"].push_back({{"side", place.side},
                                    {"sheet_x_mm", place.sheet_mm.x()},
                                    {"sheet_y_mm", place.sheet_mm.y()},
                                    {"expected_mm", simulation.options.sheet_thickness_mm}});
  result.report["causes"] = outlook_json(model, plan);
  result.report["information_nats"] = plan.information.empty() ? plan.information_of_measured : plan.information.back();
  result.report["information_of_measured_nats"] = plan.information_of_measured;
  result.report["information_of_all_nats"] = plan.information_of_all;
  result.report["sheet_mm"] = {simulation.options.sheet_x_mm, simulation.options.sheet_y_mm};
  result.report["opening_mm"] = {simulation.options.clamp_opening_x_mm, simulation.options.clamp_opening_y_mm};
  result.report["candidates"] = marks.points.size();
  result.report["spacing_mm"] = marks.spacing_mm;
  result.report["measured"] = measured.size();
  result.report["triangles"] = simulated.result->sheet.mesh.face_count();
  result.report["simulations"] = bag.simulations();
  result.report["seconds_plan"] = watch.seconds();
  result.report["notes"] = notes;
  const auto add = [&](const char* name, Bytes bytes) {
    for (const OutputInfo& info : plan_points_outputs())
      if (info.name == name && call.wants(name)) result.outputs.push_back(make_output(info, std::move(bytes)));
  };
  add("marks.svg", to_bytes(marks_svg(drawing)));
  add("measured.csv", to_bytes(measuring_form_csv({measured, chosen, measured_thickness, rim})));
  add("mould.obj", obj);
  const auto setup = call.inputs.find("setup");
  add("setup.json", setup != call.inputs.end()
                        ? *setup->second.bytes
                        : to_bytes(write_object_setup(simulation.options, MeasuredSurface::outer).dump(1) + "\n"));
  return result;
}

}  // namespace

Operation evidence_plan_points_operation() {
  Operation operation;
  operation.name = "evidence-plan-points";
  operation.title = "Choose points to measure";
  operation.summary =
      "Chooses the few marks on a sheet that tell most about the machine when they are measured by hand, and says which faults they would show.";
  operation.inputs = {mould_input_info(), setup_input_info(), measured_so_far_info(), profile_input_info()};
  operation.outputs = plan_points_outputs();
  operation.report = plan_points_report_fields();
  operation.keeps_results = true;
  take_mergeable_options<ThermoformOptions, PlanPointsOptions>(operation, run_evidence_plan_points);
  return operation;
}

}  // namespace formwright
