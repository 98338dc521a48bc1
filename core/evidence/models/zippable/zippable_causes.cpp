// SPDX-License-Identifier: GPL-3.0-or-later
// What a diagnosis may vary when a ribbon is cut, sewn and zipped up. Names, labels and units of the simulation's own
// parameters are theirs.
#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "evidence/models/zippable/zippable_model.h"

namespace formwright {
namespace {

struct Varied {
  const char* name;
  double low, high, prior_sd, probe;
  const char *label = "", *unit = "";  // where it is no parameter of the simulation
};

struct Listed {
  const char *name, *label, *explanation, *remedy;
  std::vector<Varied> parameters;
  FaultOf fault_of = FaultOf::machine;
  bool through_the_cloth = true;
};

/// Of causes that act through the cloth: what another mesh and a stiffer cloth make of the same cause
/// (docs/evidence_zippable.md).
constexpr double cloth_gain_error = 0.05;

/// Of limbs that are turned inside out: what another mesh makes of the same limb (docs/evidence_zippable.md).
constexpr double tucked_gain_error = 0.1;
constexpr double min_tucked_share = 0.5;  // a limb is in or out
constexpr double max_tucked_share = 1.5;

std::vector<Listed> listed_causes(const MeasuredZippable& object, const RibbonPattern& pattern, double bending_n_mm) {
  constexpr double pascal_per_mpa = 1e6;
  // Stretches the cloth of a sphere as large as the object by about 1 %.
  const double usual_pressure_pa = 0.01 * pascal_per_mpa * object.setup.stretch_n_per_mm / (0.25 * pattern.size_mm);
  // As stiff as two ribbons side by side.
  const double usual_zipper_n_mm2 = 2 * bending_n_mm * pattern.width_mm;
  std::vector<Listed> list = {
      {"plan_scale",
       "Plan cut at another size",
       "Everything was cut larger or smaller than planned.",
       "Print or cut at 100 %, measure a long line of the plan, and correct the machine's scale.",
       {{"plan_scale", -0.2, 0.2, 0.01, 0.006}}},
      {"cloth_stretch",
       "Cloth longer or shorter once it is cut",
       "The cloth relaxed or shrank between cutting and measuring, differently along and across its grain.",
       "Let the cloth lie before it is cut, wash it first, do not pull it on the bed; the next plan makes up for it.",
       {{"cloth_stretch_along", -0.3, 0.3, 0.02, 0.01}, {"cloth_stretch_across", -0.3, 0.3, 0.02, 0.01}}},
      {"cloth_bias",
       "Cloth pulled askew",
       "The cloth lay askew when it was cut.",
       "Lay the cloth with its threads along the bed's edges; the next plan makes up for it.",
       {{"cloth_bias", -0.2, 0.2, 0.02, 0.01}}},
      {"kerf",
       "Cut wider than planned",
       "The cut removed more of the cloth than the plan's kerf, or less.",
       "Cut a test square, measure it, and set the kerf; the next plan makes up for it.",
       {{"more_kerf_mm", -1, 3, 0.4, 0.2}}},
      {"zipper_gap",
       "Zipper wider than planned",
       "The closed zipper holds both edges farther apart than the plan allows for.",
       "Measure the closed zipper from cloth to cloth and set teeth and gap; the next plan makes its panels narrower.",
       {{"more_gap_mm", 0, 8, 0.8, 0.25}}},
      {"seam_take_up",
       "Cloth lost in seams",
       "More cloth disappears under the zipper than planned.",
       "Sew on the marked line, closer to the edge; the next plan makes its panels wider.",
       {{"seam_take_up_mm", 0, 6, 0.5, 0.15}}},
      {"stuffing",
       "Stuffed harder or softer than stated",
       "What the object is filled with pushes the cloth outwards.",
       "Stuff less, or give the stuffing pressure in the set-up.",
       {{"stuffing_pressure_pa", 0, std::max(20 * usual_pressure_pa, 2 * object.setup.stuffing_pressure_pa),
         usual_pressure_pa, 0.3 * usual_pressure_pa}}}};
  if (object.hangs)
    list.push_back({"gravity",
                    "Its own weight",
                    "The object sags under its own weight where it hangs.",
                    "Measure it lying or stuffed, or give the weight of the cloth in the set-up.",
                    {{"weight_g_per_m2", 0, std::max(5000.0, 2 * object.setup.weight_g_per_m2), 200, 60}}});
  if (!object.lengths.empty())
    list.push_back({"marks_scale",
                    "Marks printed at another size",
                    "The numbered marks lie farther apart along the zipper than they should, or closer.",
                    "Print the tape template at 100 % and compare it with a ruler.",
                    {{"marks_scale", -0.1, 0.1, 0.01, 0.006, "Marks farther apart by"}},
                    FaultOf::measurement,
                    false});
  list.push_back({"tape_scale",
                  "Measured with another scale",
                  "The tape, calipers or scan show lengths that are too large or too small.",
                  "Measure something of known length with the same tape or scan.",
                  // Steel tapes are right within a few tenths of a per cent; the scale of a scan is often off by one.
                  {{"tape_scale", -0.1, 0.1, object.scan_mm.rows() > 0 ? 0.01 : 0.004, 0.006, "Measured too large by"}},
                  FaultOf::measurement,
                  false});
  list.push_back({"stiff_zipper",
                  "Zipper stiffer than the cloth",
                  "Our simulation lets seams bend as freely as the cloth, but a zipper resists.",
                  "Nothing at the machine: simulate with this bending stiffness of the zipper, or use a finer zipper.",
                  {{"zipper_bending_n_mm2", 0, 200 * usual_zipper_n_mm2, usual_zipper_n_mm2, 0.4 * usual_zipper_n_mm2}},
                  FaultOf::simulation});
  return list;
}

struct EqualSimulation {
  const char *name, *label;
};
constexpr EqualSimulation equal_simulations[] = {{"finer_cloth", "Smaller triangles"},
                                                 {"half_as_stiff", "Cloth that stretches twice as easily"}};

}  // namespace

void declare_zippable_parameters(const std::vector<MeasuredZippable>& objects, const RibbonPattern& pattern,
                                 std::vector<TuckableLimb>& tuckable, std::vector<ModelParameter>& parameters,
                                 std::vector<Cause>& causes) {
  const MeasuredZippable& object = objects.front();
  const std::vector<ParameterInfo> infos = describe_parameters<ZippingOptions>();
  const Json setup = write_parameters(object.setup);
  const auto add = [&](const Varied& varied, ParameterRole role, bool logarithmic) {
    ModelParameter p;
    p.name = varied.name;
    p.label = varied.label;
    p.unit = varied.unit;
    if (const auto info =
            std::find_if(infos.begin(), infos.end(), [&](const ParameterInfo& i) { return i.name == p.name; });
        info != infos.end()) {
      p.label = info->label;
      p.unit = info->unit;
      if (setup[p.name].is_number()) p.nominal = setup[p.name].get<double>();
    }
    p.role = role;
    p.low = std::min(varied.low, p.nominal);
    p.high = std::max(varied.high, p.nominal);
    p.logarithmic = logarithmic;
    p.prior_sd = varied.prior_sd;
    p.probe = varied.probe;
    parameters.push_back(p);
    return static_cast<int>(parameters.size()) - 1;
  };
  // Cloths of one name differ by a factor of two (cloth_presets.h).
  const double bending = bending_of(object.setup);
  add({"bending_n_mm", bending / 100, 100 * bending, 0.7, 0.4}, ParameterRole::base, true);
  parameters.back().nominal = bending;
  for (const Listed& row : listed_causes(object, pattern, bending)) {
    Cause cause{row.name, row.label, row.explanation, row.remedy, {}, "", 0, row.fault_of};
    for (const Varied& varied : row.parameters) cause.parameters.push_back(add(varied, ParameterRole::effect, false));
    cause.unit = parameters.back().unit;
    if (row.through_the_cloth) cause.gain_error = cloth_gain_error;
    causes.push_back(std::move(cause));
  }
  for (TuckableLimb& limb : tuckable) {
    const std::string of_object = objects.size() > 1 ? std::to_string(limb.object + 1) + "_" : "",
                      name = "tucked_in_" + of_object + std::to_string(limb.number);
    limb.parameter =
        add({name.c_str(), 0, max_tucked_share, 1, 1, "Turned inside out, share of the way", "of the way in"},
            ParameterRole::effect, false);
    causes.push_back({name,
                      "Part " + limb.place + " turned inside out" +
                          (objects.size() > 1 ? ": " + objects[static_cast<std::size_t>(limb.object)].name : ""),
                      "This part was not pushed out after zipping: it lies turned inwards, and stays there by itself.",
                      "Push it out from inside, with a stick or by stuffing it, and measure again.",
                      {limb.parameter},
                      "of the way in",
                      tucked_gain_error,
                      FaultOf::machine,
                      min_tucked_share});
  }
  for (const EqualSimulation& equal : equal_simulations) {
    add({equal.name, 0, 1, 1, 1, equal.label}, ParameterRole::discrepancy, false);
    parameters.back().nominal = 0;
  }
}

std::string zippable_cause_in_words(std::string_view cause, std::span<const double> values) {
  if (values.empty()) return "";
  const double v = values[0];
  const auto percent = [](double share) { return with_digits(100 * std::abs(share), 2) + " %"; };
  const auto mm = [](double length) { return with_digits(std::abs(length), 2) + " mm"; };
  const auto larger = [](double by, const char* more, const char* less) { return std::string(by > 0 ? more : less); };
  if (cause == "plan_scale") return "The plan was cut about " + percent(v) + larger(v, " too large.", " too small.");
  if (cause == "cloth_stretch" && values.size() > 1)
    return "Once it was cut the cloth became about " + percent(v) + larger(v, " longer", " shorter") +
           " along its grain and " + percent(values[1]) + larger(values[1], " longer", " shorter") + " across it.";
  if (cause == "cloth_bias")
    return "The cloth lay askew on the bed: its right angles are off by about " +
           with_digits(2 * std::abs(v) * 57.29577951308232, 2) + "°.";
  if (cause == "kerf")
    return "The cut removed about " + mm(v) + larger(v, " more", " less") + " than the plan allows for.";
  if (cause == "zipper_gap") return "The closed zipper is about " + mm(v) + " wider than the plan allows for.";
  if (cause == "seam_take_up")
    return "About " + mm(v) + " more cloth than planned disappears under the zipper at each edge.";
  if (cause == "stuffing") return "The stuffing pushes from inside with about " + with_digits(v, 2) + " Pa.";
  if (cause == "gravity") return "It sags as cloth of about " + with_digits(v, 2) + " g/m² does.";
  if (cause == "marks_scale")
    return "The marks along the zipper lie about " + percent(v) + larger(v, " too far apart.", " too close together.");
  if (cause == "tape_scale")
    return "Lengths were measured about " + percent(v) + larger(v, " too large.", " too small.");
  if (cause == "stiff_zipper")
    return "Our simulation leaves out that the zipper resists bending with about " + with_digits(v, 2) + " N mm².";
  return "";
}

}  // namespace formwright
