// SPDX-License-Identifier: GPL-3.0-or-later
// Hides errors of making in virtual zippables and asks the diagnosis for them: one line of JSON for each case.
//   zippable_table [--seeds N] [--only CAUSE|none] [--shape NAME] [--level X] [--tape-sigma MM] [--lengths N] [--flat
//   N]
//                  [--scan N] [--pairs] [--repair]
// --repair also makes a second shape by a plan that the finding corrects, and says how far each is from its design.
#include <chrono>
#include <cstdio>
#include <cstring>

#include "evidence/diagnosis/diagnosis.h"
#include "evidence/models/zippable/zippable_model.h"
#include "evidence/virtual_zippable.h"
#include "zippable/plan/planned.h"

namespace {

using namespace formwright;
using namespace formwright::virtual_lab;

constexpr const char* shapes[] = {"star", "cat", "heart", "t_shape"};
constexpr double size_mm = 200, width_mm = 25;

struct Arguments {
  unsigned seeds = 1;
  std::string only, shape;
  double level = 1;
  ZippableObservation observation;
  bool pairs = false, repair = false;
};

/// Mean distance from the design of what the cloth comes to rest as.
double off_mm(const FlatDesign& design, const ZippingOptions& options) {
  Context context;
  const RibbonDesign ribbon = ribbon_of(design);
  const double width = pattern_of(ribbon, 0, context).width_mm;
  const RibbonPattern pattern = pattern_of(ribbon, 0.4 * width, context);
  const ZippedAtRest rest = zipped_at_rest(pattern, options, pattern.predicted_mm, context);
  return compare_shapes(rest.x, pattern.predicted_mm, Eigen::VectorXd::Ones(rest.x.rows())).mean_mm;
}

Json one_case(const std::string& cause, const std::string& shape, unsigned seed, const Arguments& a) {
  Context context;
  std::mt19937 random(seed);
  const FlatDesign design = test::designed(shape, width_mm, size_mm);
  HiddenMaking making = draw_making(random);
  if (cause != "none") hide_cause(cause, a.level, size_mm, width_mm, random, making);
  ZippableObservation observation = a.observation;
  observation.hangs = cause == "gravity" || seed % 2 == 1;
  making.options.hung_at_mm = 0.2 * design.zipper_mm;
  Json line = {{"seed", seed},
               {"shape", shape},
               {"cause", cause},
               {"level", a.level},
               {"lengths", observation.zipped_lengths},
               {"flat", observation.flat_lengths},
               {"scan", observation.scan_points},
               {"tape_sigma_mm", observation.tape_sigma_mm}};
  if (const int limb = hidden_limb(design, making); limb > 0) line["cause"] = "tucked_in_" + std::to_string(limb);
  const auto start = std::chrono::steady_clock::now();
  const ZippableModel model({make_zippable(shape, design, making, observation, random)}, context);
  SimulationBag bag(model);
  DiagnosisOptions options;
  options.pairs = a.pairs;
  const Diagnosis d = diagnose(bag, options, context);
  line["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  line["reading"] = reading_name(d.reading);
  line["doubts"] = d.doubts;
  Json verdict = Json::array();
  for (const int c : d.verdict) verdict.push_back(model.causes()[static_cast<std::size_t>(c)].name);
  line["verdict"] = verdict;
  Json twins = Json::array();
  for (const NotSeparable& pair : d.not_separable)
    twins.push_back({model.causes()[static_cast<std::size_t>(pair.cause_a)].name,
                     model.causes()[static_cast<std::size_t>(pair.cause_b)].name, pair.similarity});
  line["not_separable"] = twins;
  Json first = Json::array();
  for (std::size_t i = 0; i < std::min<std::size_t>(3, d.causes.size()); ++i) {
    const CauseFinding& f = d.causes[i];
    first.push_back({{"name", model.causes()[static_cast<std::size_t>(f.cause)].name},
                     {"probability", f.probability},
                     {"strength", f.strength},
                     {"low", f.low},
                     {"high", f.high},
                     {"values", f.values}});
  }
  line["first"] = first;
  const Json true_values = write_parameters(static_cast<const MakingErrors&>(making.options));
  line["truth"] = true_values;
  line["truth"]["stuffing_pressure_pa"] = making.options.stuffing_pressure_pa;
  line["truth"]["weight_g_per_m2"] = making.options.weight_g_per_m2;
  line["truth"]["zipper_bending_n_mm2"] = making.options.zipper_bending_n_mm2;
  line["truth"]["marks_scale"] = making.marks_scale;
  line["truth"]["tape_scale"] = making.tape_scale;
  if (making.tucked_limb) line["truth"]["tucked_limb"] = hidden_limb(design, making);
  line["error_before_mm"] = d.held_out.before.mean;
  line["error_after_mm"] = d.held_out.after.mean;
  line["simulations"] = d.simulations;
  if (!a.repair || d.reading == Reading::unknown) return line;
  const FlatDesign second = test::designed(shape == "heart" ? "star" : "heart", width_mm, size_mm);
  ZippingOptions clean = making.options, corrected = making.options;
  static_cast<MakingErrors&>(clean) = {};
  const Json found = model.profile_at(d.extended.u).parameters;
  Json left = true_values;
  // A plan that makes up for what was found leaves what was not found.
  for (const auto& [name, value] : found.items()) left[name] = left[name].get<double>() - value.get<double>();
  static_cast<MakingErrors&>(corrected) = read_parameters<MakingErrors>(left);
  line["second_shape_mm"] = {{"without_error", off_mm(second, clean)},
                             {"as_planned_before", off_mm(second, making.options)},
                             {"as_planned_after", off_mm(second, corrected)}};
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  for (int i = 1; i < argc; ++i) {
    const auto is = [&](const char* name) { return std::strcmp(argv[i], name) == 0; };
    const auto next = [&] { return i + 1 < argc ? argv[++i] : ""; };
    if (is("--seeds")) a.seeds = static_cast<unsigned>(std::atoi(next()));
    else if (is("--only")) a.only = next();
    else if (is("--shape")) a.shape = next();
    else if (is("--level")) a.level = std::atof(next());
    else if (is("--tape-sigma")) a.observation.tape_sigma_mm = std::atof(next());
    else if (is("--lengths")) a.observation.zipped_lengths = std::atoi(next());
    else if (is("--flat")) a.observation.flat_lengths = std::atoi(next());
    else if (is("--scan")) a.observation.scan_points = std::atoi(next());
    else if (is("--pairs")) a.pairs = true;
    else if (is("--repair")) a.repair = true;
    else return std::fprintf(stderr, "There is no option %s.\n", argv[i]), 2;
  }
  std::vector<std::string> causes = zippable_cause_names();
  causes.insert(causes.end() - 1, "none");  // the seed goes by the place in this list
  for (unsigned turn = 0; turn < a.seeds; ++turn)
    for (std::size_t c = 0; c < causes.size(); ++c) {
      if (!a.only.empty() && a.only != causes[c]) continue;
      const std::string shape = a.shape.empty() ? shapes[(c + turn) % 4] : a.shape;
      Json line;
      const auto seed = static_cast<unsigned>(100 * (turn + 1) + c);
      try {
        line = one_case(causes[c], shape, seed, a);
      } catch (const std::exception& error) {
        line = {{"seed", seed}, {"shape", shape}, {"cause", causes[c]}, {"error", error.what()}};
      }
      std::printf("%s\n", line.dump().c_str());
      std::fflush(stdout);
    }
  return 0;
}
