// SPDX-License-Identifier: GPL-3.0-or-later
// Hides effects in virtual objects and asks the diagnosis for them: one line of JSON for each case;
// score_confusion_table.py counts them.
//   confusion_table [--seed N] [--cases N | --repeat N] [--levels 1,0.5,0.25] [--noise 0.05,0.15] [--only CAUSE]
//   [--mould NAME]
//                   [--triangles N] [--pairs N] [--no-pairs] [--left-out] [--calibrated] [--unseen] [--verbose]
// --pairs hides two causes at a time, --no-pairs does not look for two, --left-out takes the hidden cause off the list
// that is asked,
// --calibrated has a profile of the machine from when it was well; --engine only says which engine answers.
#include <cstdio>
#include <cstring>
#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "evidence/calibration.h"
#include "evidence/diagnosis/diagnosis.h"
#include "evidence/diagnosis/simulation_choice.h"
#include "evidence/diagnosis/unseen.h"
#include "evidence/virtual_lab.h"

namespace {

using namespace formwright;
using namespace formwright::virtual_lab;

/// Raised whenever the diagnosis comes to answer differently: run_confusion_table.py asks older lines again.
constexpr int engine = 24;

struct Arguments {
  unsigned seed = 1;
  int repeat = 1, cases = 0;
  std::vector<double> levels{1, 0.5, 0.25}, noise{0.05, 0.15};
  std::string only, mould;
  bool unseen = false, verbose = false, calibrated = false, pairs_searched = true, left_out = false;
  int pairs = 0, triangles = ThermoformModelOptions{}.triangles;
};

std::vector<double> numbers(const char* text) {
  std::vector<double> list;
  std::stringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) list.push_back(std::stod(part));
  return list;
}

/// One hidden truth and the answer to it.
Json one_case(const std::vector<std::string>& hidden, double level, double sigma, unsigned seed,
              const Arguments& arguments) {
  std::mt19937 random(seed);
  const HiddenWorld world = draw_world(random);
  std::vector<HiddenEffect> effects;
  for (const std::string& cause : hidden) effects.push_back(draw_effect(cause, level, random));
  Mould mould = static_cast<Mould>(std::uniform_int_distribution<int>(0, drawn_moulds - 1)(random));
  for (std::size_t m = 0; m < mould_names.size(); ++m)
    if (arguments.mould == mould_names[m]) mould = static_cast<Mould>(m);
  Observation observation;
  observation.sigma_mm = sigma;
  const FormedObject object = make_object(mould, world, effects, observation, random);
  ThermoformModelOptions asked;
  asked.triangles = arguments.triangles;
  if (arguments.left_out) asked.without = hidden;
  if (arguments.calibrated) {
    // The machine was calibrated on another object while it was well.
    ThermoformModelOptions well;
    well.fit_mould_place = true;
    well.triangles = 2500;
    Context calibration;
    const ThermoformModel usual_before(
        {make_object(static_cast<Mould>((static_cast<int>(mould) + 2) % 4), world, {}, observation, random)}, well);
    const ThermoformModel& before =
        usual_before.extended_by(choose_simulation(usual_before.for_choosing(), calibration).taken());
    SimulationBag before_bag(before);
    asked.profile = before.profile_at(calibrate(before_bag, calibration).u);
    for (const char* name : {"mould_shift_x_mm", "mould_shift_y_mm"}) asked.profile.parameters.erase(name);
  }
  Context context;
  const ThermoformModel usual({object}, asked);
  const SimulationChoice choice = choose_simulation(usual.for_choosing(), context);
  const ThermoformModel& model = usual.extended_by(choice.taken());
  SimulationBag bag(model);
  Json line;
  line["seed"] = seed;
  DiagnosisOptions options;
  options.pairs = arguments.pairs_searched;
  options.start = choice.u;
  const Diagnosis d = diagnose(bag, options, context);
  line["engine"] = engine;
  line["simulation"] = choice.taken();
  line["mould"] = mould_names[static_cast<std::size_t>(mould)];
  line["hidden"] = hidden;
  line["values"] = Json::array();
  for (const HiddenEffect& e : effects) line["values"].push_back(e.values);
  line["level"] = level;
  line["left_out"] = arguments.left_out;
  line["sigma_mm"] = sigma;
  line["reading"] = reading_name(d.reading);
  line["doubtful"] = d.doubtful();
  line["doubts"] = d.doubts;
  Json verdict = Json::array();
  for (const int cause : d.verdict) verdict.push_back(model.causes()[static_cast<std::size_t>(cause)].name);
  line["verdict"] = verdict;
  line["first"] =
      verdict.empty() || d.reading == Reading::unknown ? reading_name(d.reading) : verdict[0].get<std::string>();
  line["structure_mm"] = {d.unexplained_before, d.unexplained_after};
  line["held_out_mm"] = {d.held_out.before.mean, d.held_out.after.mean};
  line["noise_mm"] = {d.noise.front().sigma, d.noise_floor};
  line["simulations"] = d.simulations + choice.simulations;
  line["seconds"] = d.seconds + choice.seconds;
  line["looked_again"] = d.looked_again;
  line["answers"] = Json::array();
  for (const Answer& answer : d.answers) {
    if (answer.probability < 0.001) continue;
    Json names = Json::array();
    for (const int cause : answer.causes) names.push_back(model.causes()[static_cast<std::size_t>(cause)].name);
    line["answers"].push_back({names, answer.unknown_cause, answer.probability});
  }
  Json top = Json::array();
  for (std::size_t i = 0; i < 3; ++i) {
    const CauseFinding& f = d.causes[i];
    top.push_back({model.causes()[static_cast<std::size_t>(f.cause)].name, f.probability, f.strength, f.low, f.high});
  }
  line["causes"] = top;
  const auto nearest =
      std::max_element(d.causes.begin(), d.causes.end(),
                       [](const CauseFinding& a, const CauseFinding& b) { return a.likeness < b.likeness; });
  line["nearest"] = {model.causes()[static_cast<std::size_t>(nearest->cause)].name, nearest->likeness};
  // By how much the data prefer each explanation over none, before priors.
  double none = 0, unknown = 0, right = -1e9, wrong = -1e9;
  for (const Hypothesis& h : d.hypotheses)
    if (h.causes.empty()) (h.unknown_structure ? unknown : none) = h.log_evidence;
  for (const Hypothesis& h : d.hypotheses) {
    if (h.causes.empty() || h.unknown_structure) continue;
    std::vector<std::string> named;
    for (const int c : h.causes) named.push_back(model.causes()[static_cast<std::size_t>(c)].name);
    const bool contains = std::all_of(hidden.begin(), hidden.end(), [&](const std::string& n) {
      return std::find(named.begin(), named.end(), n) != named.end();
    });
    if (contains && named.size() == hidden.size()) right = std::max(right, h.log_evidence);
    else if (!contains && named.size() <= std::max<std::size_t>(1, hidden.size()))
      wrong = std::max(wrong, h.log_evidence);
  }
  line["over_none"] = {{"unknown", unknown - none}, {"right", right - none}, {"wrong", wrong - none}};
  // How strong each hidden cause would have to be to show in these data at all, as the diagnosis itself says.
  line["min_visible_strength"] = Json::array();
  line["strength"] = Json::array();
  for (const HiddenEffect& e : effects) {
    double squares = 0;
    for (const auto& [name, value] : e.values.items()) squares += std::pow(value.get<double>(), 2);
    line["strength"].push_back(std::sqrt(squares));
    for (const CauseFinding& f : d.causes)
      if (model.causes()[static_cast<std::size_t>(f.cause)].name == e.cause)
        line["min_visible_strength"].push_back(std::isfinite(f.min_visible_strength) ? Json(f.min_visible_strength)
                                                                                     : Json());
  }
  line["trials"] = Json::array();
  for (const HeldOutTrial& trial : d.trials) {
    std::string names;
    for (const int c : trial.causes)
      names += (names.empty() ? "" : "+") + model.causes()[static_cast<std::size_t>(c)].name;
    line["trials"].push_back({names, trial.significant, trial.gain.before.mean, trial.gain.after.mean,
                              trial.gain.gain_share, trial.gain.gain_low});
  }
  if (arguments.verbose) {
    for (std::size_t i = 0; i < std::min<std::size_t>(8, d.hypotheses.size()); ++i) {
      const Hypothesis& h = d.hypotheses[i];
      std::string names;
      for (const int c : h.causes) names += model.causes()[static_cast<std::size_t>(c)].name + " ";
      std::fprintf(stderr, "   %-40s %s log evidence %9.1f structure %.3f p %.4f\n", names.c_str(),
                   h.unknown_structure ? "+unknown" : "        ", h.log_evidence, h.structure, h.probability);
    }
    for (std::size_t p = 0; p < 4; ++p)
      std::fprintf(stderr, "   %-20s base %.3g extended %.3g\n", model.parameters()[p].name.c_str(),
                   model.parameters()[p].value(d.base.u[static_cast<Eigen::Index>(p)]),
                   model.parameters()[p].value(d.extended.u[static_cast<Eigen::Index>(p)]));
  }
  if (arguments.unseen) {
    const auto other = static_cast<Mould>((static_cast<int>(mould) + 1) % 4);
    ThermoformModel second({make_object(other, world, effects, observation, random)}, asked);
    const HeldOutGain gain = predict_unseen(second.extended_by(choice.taken()), model, d, context).gain;
    line["unseen_mm"] = {gain.before.mean, gain.after.mean};
  }
  return line;
}

}  // namespace

int main(int count, char** values) {
  Arguments a;
  for (int i = 1; i < count; ++i) {
    const std::string flag = values[i];
    const auto next = [&] { return values[++i]; };
    if (flag == "--seed") a.seed = static_cast<unsigned>(std::stoul(next()));
    else if (flag == "--repeat") a.repeat = std::stoi(next());
    else if (flag == "--cases") a.cases = std::stoi(next());
    else if (flag == "--levels") a.levels = numbers(next());
    else if (flag == "--noise") a.noise = numbers(next());
    else if (flag == "--only") a.only = next();
    else if (flag == "--mould") a.mould = next();
    else if (flag == "--triangles") a.triangles = std::stoi(next());
    else if (flag == "--pairs") a.pairs = std::stoi(next());
    else if (flag == "--no-pairs") a.pairs_searched = false;
    else if (flag == "--calibrated") a.calibrated = true;
    else if (flag == "--left-out") a.left_out = true;
    else if (flag == "--unseen") a.unseen = true;
    else if (flag == "--verbose") a.verbose = true;
    else if (flag == "--engine") return std::printf("%d\n", engine), 0;
    else return std::fprintf(stderr, "unknown flag %s\n", flag.c_str()), 2;
  }
  std::vector<std::string> names = cause_names();
  names.insert(names.begin(), "none");
  unsigned seed = a.seed * 1000;
  const auto tell = [&](const std::vector<std::string>& hidden, double level, double sigma) {
    try {
      std::printf("%s\n", one_case(hidden, level, sigma, ++seed, a).dump().c_str());
    } catch (const std::exception& error) {
      std::printf("%s\n", Json({{"seed", seed}, {"hidden", hidden}, {"error", error.what()}}).dump().c_str());
    }
    std::fflush(stdout);
  };
  std::mt19937 choice(a.seed);
  for (int k = 0; k < a.pairs; ++k) {
    const auto pick = [&] { return names[1 + choice() % (names.size() - 1)]; };
    const std::string first = pick();
    std::string second = pick();
    while (second == first) second = pick();
    tell({first, second}, a.levels[static_cast<std::size_t>(k) % a.levels.size()],
         a.noise[static_cast<std::size_t>(k) % a.noise.size()]);
  }
  if (a.pairs > 0) return 0;
  if (a.cases > 0) {
    for (int k = 0; k < a.cases; ++k) {
      const std::string& cause = names[choice() % names.size()];
      tell(cause == "none" ? std::vector<std::string>{} : std::vector<std::string>{cause},
           a.levels[choice() % a.levels.size()], a.noise[choice() % a.noise.size()]);
    }
    return 0;
  }
  for (int r = 0; r < a.repeat; ++r)
    for (const std::string& cause : names) {
      if (!a.only.empty() && cause != a.only) continue;
      for (const double level : a.levels)
        for (const double sigma : a.noise)
          tell(cause == "none" ? std::vector<std::string>{} : std::vector<std::string>{cause}, level, sigma);
    }
}
