// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstdio>

#include "evidence/models/zippable/zippable_model.h"
#include "evidence/models/zippable/zipper_place.h"
#include "evidence/planning/measuring_plan.h"
#include "job/contract/model_input.h"
#include "job/contract/operation_options.h"
#include "job/operations/evidence/evidence_operations.h"
#include "job/operations/evidence/measuring_outlook.h"
#include "job/operations/zippable/zippable_inputs.h"
#include "zippable/plan/plan_record.h"

namespace formwright {
namespace {

/// Chosen from: more are no better, and each takes memory beside all the others.
constexpr int zipped_candidates = 250, flat_candidates = 60;

struct PlanLengthsOptions {
  int length_count = 20;
  double tape_sigma_mm = 0.5;
  bool flat_lengths = true;

  static constexpr auto parameters = std::tuple{
      parameter(
          "length_count", &PlanLengthsOptions::length_count, "Lengths", unit::none, 6, 100,
          "Number of lengths to measure. Twenty show most errors of making at their usual strength; each takes about half a minute.")
          .group("Measuring by hand")
          .slider(6, 40),
      parameter(
          "tape_sigma_mm", &PlanLengthsOptions::tape_sigma_mm, "Measuring error", unit::mm, 0.01, 20,
          "Standard deviation of a length that you measure. 0.5 mm is usual for calipers on cloth, 1 mm for a tape.")
          .group("Measuring by hand")
          .slider(0.1, 2),
      parameter(
          "flat_lengths", &PlanLengthsOptions::flat_lengths, "Also on the flat pieces",
          "Also asks for lengths on the pieces as they were cut, before they are sewn: these tell errors of the cut from errors of the seams.")
          .group("Measuring by hand")};
};

std::vector<OutputInfo> plan_lengths_outputs() {
  return {{"lengths.csv", "text/csv", "Form to fill in",
           "One line for each length, with what is expected: fill in length_mm. Lines left blank are passed over.",
           true}};
}

std::vector<ReportField> plan_lengths_fields() {
  return {
      {"sentence", "What they show", "", "Which causes these lengths would show, in a sentence."},
      {"lengths", "Lengths", "", "The chosen lengths, the most telling first: from, to, state and what is expected."},
      {"causes", "Causes", "",
       "For each cause: the strength from which these lengths show it, the same with every length that can be measured, its usual strength, and the cause that is hardest to tell from it."},
      {"information_nats", "Information", "nats",
       "What the chosen lengths together tell about all causes (mutual information, in units of 1.44 bits)."},
      {"information_of_all_nats", "Information of all lengths", "nats",
       "The same for every length that was looked at."},
      {"candidates", "Lengths looked at", "", "Number of lengths to choose from."},
      {"marks", "Marks", "", "Number of marks along the zipper."},
      {"simulations", "Simulations", "", "Number of simulations that were made."},
      {"seconds_plan", "Planning", "s", "Time for the simulations and the choice."},
      {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."}};
}

OperationResult run_evidence_plan_lengths(const OperationCall& call, const PlanLengthsOptions& o) {
  Stopwatch watch;
  Context& context = call.context;
  const FlatDesign design = read_flat_design(*call.inputs.at("design").bytes);
  MeasuredZippable object;
  object.name = "object";
  object.design = ribbon_of(design);
  if (const auto plan = call.inputs.find("plan"); plan != call.inputs.end()) {
    const PlanRecord record = read_plan_record(*plan->second.bytes, static_cast<std::size_t>(design.F.rows()), "plan");
    object.marker_spacing_mm = record.marker_spacing_mm;
    object.design.turn_of_triangle_rad = record.turn_of_triangle_rad;
  }
  const RibbonPattern pattern = pattern_of(object.design, 0, context);
  object.lengths = measurable_lengths(pattern, object.marker_spacing_mm, zipped_candidates,
                                      o.flat_lengths ? flat_candidates : 0, o.tape_sigma_mm);
  if (object.lengths.size() < static_cast<std::size_t>(o.length_count))
    throw Error(ErrorCode::invalid_input, "length_count",
                "Between the marks of this zipper only " + std::to_string(object.lengths.size()) +
                    " lengths can be measured: ask for fewer, or plan with marks closer together.");
  const std::vector<MeasuredLength> candidates = object.lengths;
  std::unique_ptr<const ZippableModel> model;
  {
    const auto span = context.span(0, 0.1, "Simulating the zipped shape");
    model = std::make_unique<const ZippableModel>(std::vector{std::move(object)}, context, TuckedLimbs::are_left_out);
  }
  SimulationBag bag(*model);
  MeasuringPlanOptions options;
  options.points = o.length_count;
  MeasuringPlan plan;
  {
    const auto span = context.span(0.1, 1, "Planning");
    plan = plan_measuring(bag, options, context);
  }
  OperationResult result;
  Json list = Json::array();
  std::string form = "from,to,state,length_mm,sigma_mm,expected_mm\n";
  for (const Eigen::Index row : plan.chosen) {
    const MeasuredLength& length = candidates[static_cast<std::size_t>(row)];
    const std::string from = mark_text(length.from, length.flat), to = mark_text(length.to, length.flat);
    const char* state = length.flat ? "flat" : "zipped";
    const double expected_mm = std::round(10 * plan.expected.front()(row, 0)) / 10;
    list.push_back({{"from", from}, {"to", to}, {"state", state}, {"expected_mm", expected_mm}});
    char numbers[64];
    std::snprintf(numbers, sizeof numbers, ",,%.3g,%.1f\n", o.tape_sigma_mm, expected_mm);
    form += from + "," + to + "," + state + numbers;
  }
  result.report["sentence"] = outlook_sentence(*model, plan, "These lengths");
  result.report["lengths"] = std::move(list);
  result.report["causes"] = outlook_json(*model, plan);
  result.report["information_nats"] = plan.information.empty() ? 0.0 : plan.information.back();
  result.report["information_of_all_nats"] = plan.information_of_all;
  result.report["candidates"] = candidates.size();
  result.report["marks"] = static_cast<int>(design.zipper_mm / model->objects().front().marker_spacing_mm) + 1;
  result.report["simulations"] = bag.simulations();
  result.report["seconds_plan"] = watch.seconds();
  if (call.wants("lengths.csv")) result.outputs.push_back(make_output(plan_lengths_outputs().front(), to_bytes(form)));
  return result;
}

}  // namespace

Operation evidence_plan_lengths_operation() {
  Operation operation;
  operation.name = "evidence-plan-lengths";
  operation.title = "Choose lengths to measure";
  operation.summary =
      "Chooses the few lengths of a zippable that tell most about how it was cut and sewn, and says which errors they would show.";
  operation.inputs = {flat_design_info(), plan_record_info()};
  operation.outputs = plan_lengths_outputs();
  operation.report = plan_lengths_fields();
  take_options<PlanLengthsOptions>(operation, run_evidence_plan_lengths);
  return operation;
}

}  // namespace formwright
