// SPDX-License-Identifier: GPL-3.0-or-later
// What a diagnosis may vary in a thermoforming simulation. Names, labels, units and ranges are those of the
// simulation's own parameters.
#include <algorithm>

#include "evidence/models/thermoform/thermoform_extensions.h"
#include "evidence/models/thermoform/thermoform_model.h"

namespace formwright {
namespace {

/// Ranges about those of thesis 4.2.3, a little wider: an optimum at a bound says nothing about what lies beyond.
constexpr VariedParameter base_parameters[] = {{"young_modulus_pa", true, 2.5e5, 1e7, 0.6, 0.25},
                                               {"creep_per_s", true, 1, 5000, 1.5, 0.4},
                                               {"yield_strain", false, 0, 0.3, 0.05, 0.02},
                                               {"viscosity_s", true, 1e-7, 1e-3, 1, 1}};

constexpr VariedParameter mould_place[] = {{"mould_shift_x_mm", false, -4, 4, 1, 0.5},
                                           {"mould_shift_y_mm", false, -4, 4, 1, 0.5}};

/// Of causes that act through the sheet, as virtual machines with another elastic law, mesh and vacuum have it
/// (docs/evidence.md, the confusion table).
constexpr double sheet_gain_error = 0.05;

/// Of a cause's usual strength, that a machine in order may have as well: no heater is even to the last kelvin, no
/// mould on its mark to the last tenth. Assumed, not measured.
constexpr double usual_share = 0.05;

struct CauseTable {
  const char *name, *label, *explanation, *remedy;
  std::vector<VariedParameter> parameters;
  FaultOf fault_of = FaultOf::machine;
};

const std::vector<CauseTable>& cause_table() {
  static const std::vector<CauseTable> table = {
      {"heating_gradient",
       "Uneven heating, side to side",
       "One side of the sheet was colder, so stiffer, than the other.",
       "Turn the heater, shield the hot side, or heat longer so that the sheet evens out; shut out draughts.",
       {{"heating_gradient_x", false, -0.8, 0.8, 0.35, 0.2}, {"heating_gradient_y", false, -0.8, 0.8, 0.35, 0.2}}},
      {"heating_centre",
       "Uneven heating, centre to rim",
       "The middle of the sheet and its rim were not equally hot.",
       "Change the heater's distance, reflectors or zones; a longer soak evens out the middle and the rim.",
       {{"heating_centre", false, -0.8, 0.8, 0.35, 0.2}}},
      {"slip",
       "Sheet slides on the mould",
       "Where the sheet touched the mould it slid on instead of sticking.",
       "Roughen or warm the mould, leave out release agent, or accept it: a print made with this profile accounts for it.",
       {{"slip", false, 0, 10, 1.5, 0.7}}},
      {"anisotropy",
       "Sheet stiffer in one direction",
       "The sheet stretches more easily along one direction, as extruded sheet does.",
       "Always insert the sheets in the same direction, mark their extrusion direction, or use cast sheets.",
       {{"anisotropy", false, -0.8, 0.8, 0.4, 0.2}}},
      {"thickness_wedge",
       "Sheet thicker on one side",
       "The flat sheet was not equally thick.",
       "Measure the sheets at four corners before use and put the thick side where it is least in the way.",
       {{"thickness_wedge_x", false, -0.8, 0.8, 0.3, 0.15}, {"thickness_wedge_y", false, -0.8, 0.8, 0.3, 0.15}}},
      {"cooling",
       "Sheet chills on the mould",
       "The mould was cold: what touched it stiffened and stopped flowing.",
       "Warm the mould, or raise it faster and draw the vacuum sooner.",
       {{"cooling", false, 0, 8, 1, 0.5}}},
      {"weak_vacuum",
       "Vacuum too weak",
       "Less vacuum reached the sheet than the gauge says. A sheet that is colder all over does nearly the same.",
       "Look for leaks at the clamp and the platform's seal, add vent holes, check the pump; or heat longer.",
       {{"weak_vacuum", false, 0, 0.9, 0.35, 0.2}}},
      {"clamp_slip",
       "Sheet slips in the clamp",
       "The vacuum drew the sheet's rim in from under the clamp.",
       "Tighten the clamp, renew its rubber, or use a larger sheet so that there is more to hold.",
       {{"clamp_slip_mm", false, 0, 15, 2, 1}}},
      {"mould_shift",
       "Mould in the wrong place",
       "The mould did not stand in its intended place.",
       "Use stops or a drawn outline on the platform to place the mould.",
       {{"mould_shift_x_mm", false, -15, 15, 1.5, 0.75}, {"mould_shift_y_mm", false, -15, 15, 1.5, 0.75}}},
      {"mould_rotation",
       "Mould turned",
       "The mould was rotated about the vertical axis.",
       "Use two stops on the platform, not one.",
       {{"mould_rotation_deg", false, -30, 30, 4, 2}}},
      {"mould_scale",
       "Mould of the wrong size",
       "The mould is larger or smaller than its model: printed parts and gypsum shrink or swell.",
       "Measure the mould and correct the scale with which it is made.",
       {{"mould_scale", false, -0.15, 0.15, 0.02, 0.012}}},
      {"print_scale",
       "Pattern printed at the wrong size",
       "The printer, or the paper's transfer, scaled the picture.",
       "Print at 100 % without fitting to the page, measure a printed ruler, and correct the printer's scale.",
       {{"print_scale", false, -0.1, 0.1, 0.012, 0.008}}},
      {"print_stretch_x",
       "Pattern stretched from side to side",
       "The printer printed the picture too long or too short from side to side alone.",
       "Measure a printed ruler both ways; clean or set the printer's rollers, or turn the sheet if its width is right.",
       {{"print_stretch_x", false, -0.1, 0.1, 0.012, 0.008}}},
      {"print_stretch_y",
       "Pattern stretched from front to back",
       "The printer printed the picture too long or too short from front to back alone.",
       "Measure a printed ruler both ways; clean or set the printer's rollers, or turn the sheet if its width is right.",
       {{"print_stretch_y", false, -0.1, 0.1, 0.012, 0.008}}},
      {"scan_scale",
       "Scan of the wrong size",
       "The 3D scan is larger or smaller than the object.",
       "Put a known length into the scan and scale by it.",
       {{"scan_scale", false, -0.1, 0.1, 0.01, 0.008}},
       FaultOf::measurement},
      {"scan_stretch_x",
       "Scan stretched from side to side",
       "The 3D scan is too long or too short from side to side alone.",
       "Scan something of known length both ways; have the scanner calibrated, or correct its speed that way.",
       {{"scan_stretch_x", false, -0.1, 0.1, 0.012, 0.008}},
       FaultOf::measurement},
      {"scan_stretch_y",
       "Scan stretched from front to back",
       "The 3D scan is too long or too short from front to back alone.",
       "Scan something of known length both ways; have the scanner calibrated, or correct its speed that way.",
       {{"scan_stretch_y", false, -0.1, 0.1, 0.012, 0.008}},
       FaultOf::measurement},
      {"scan_stretch_z",
       "Scan stretched in height",
       "The 3D scan is too high or too low for its width.",
       "Scan something of known height beside the object; have the scanner calibrated, or correct the heights.",
       {{"scan_stretch_z", false, -0.1, 0.1, 0.015, 0.008}},
       FaultOf::measurement},
      {"scan_rotation",
       "Scan turned",
       "The scan is not in the machine's coordinates, but turned.",
       "Align the scan by the clamp's rim or by marks on the platform.",
       {{"scan_turn_x_deg", false, -20, 20, 0.6, 0.4},
        {"scan_turn_y_deg", false, -20, 20, 0.6, 0.4},
        {"scan_turn_z_deg", false, -20, 20, 0.6, 0.4}},
       FaultOf::measurement},
      {"scan_shift",
       "Scan in the wrong place",
       "The scan is not in the machine's coordinates, but shifted.",
       "Align the scan by the clamp's rim or by marks on the platform.",
       {{"scan_shift_x_mm", false, -10, 10, 1, 0.7},
        {"scan_shift_y_mm", false, -10, 10, 1, 0.7},
        {"scan_shift_z_mm", false, -10, 10, 1, 0.7}},
       FaultOf::measurement}};
  return table;
}

/// Another choice that a simulation of equal merit makes. Its sensitivities are what that simulation would do.
struct Discrepancy {
  std::string_view name, label;
  double prior_sd;
  void (*apply)(ThermoformOptions&);
};

constexpr Discrepancy discrepancies[] = {
    {"other_elastic_law", "Other elastic law", 1,
     [](ThermoformOptions& o) {
       o.elastic_law = o.elastic_law == ElasticLaw::stable_neo_hookean ? ElasticLaw::st_venant_kirchhoff
                                                                       : ElasticLaw::stable_neo_hookean;
     }},
    {"other_yield_rule", "Other yield rule", 0.3,
     [](ThermoformOptions& o) {
       o.yield_rule = o.yield_rule == YieldRule::elastic_excess ? YieldRule::total_strain : YieldRule::elastic_excess;
     }},
    {"slower_vacuum", "Vacuum builds up twice as slowly", 1,
     [](ThermoformOptions& o) { o.vacuum_ramp_s = std::max(0.05, 2 * o.vacuum_ramp_s); }},
    {"finer_sheet", "Twice as many triangles", 1.5, [](ThermoformOptions& o) { o.triangles *= 2; }}};

}  // namespace

void declare_thermoform_parameters(const Json& nominal, const ThermoformModelOptions& options,
                                   std::vector<ModelParameter>& parameters, std::vector<Cause>& causes) {
  std::vector<ParameterInfo> infos = describe_parameters<ThermoformOptions>();
  const std::size_t of_the_sheet = infos.size();
  for (ParameterInfo& info : describe_parameters<MeasurementEffects>()) infos.push_back(std::move(info));
  const auto add = [&](const VariedParameter& varied, ParameterRole role) {
    const auto info =
        std::find_if(infos.begin(), infos.end(), [&](const ParameterInfo& i) { return i.name == varied.name; });
    ModelParameter p;
    p.name = info->name;
    p.label = info->label;
    p.unit = info->unit;
    p.role = role;
    p.nominal = nominal.value(p.name, info->default_value.get<double>());
    p.low = std::min(varied.low, p.nominal);
    p.high = std::max(varied.high, p.nominal);
    if (varied.logarithmic && !(p.nominal > 0)) p.nominal = info->default_value.get<double>();
    p.logarithmic = varied.logarithmic;
    p.prior_sd = varied.prior_sd;
    if (role == ParameterRole::effect) p.usual_sd = usual_share * varied.prior_sd;
    p.probe = varied.probe;
    parameters.push_back(p);
    return static_cast<int>(parameters.size()) - 1;
  };
  for (const VariedParameter& varied : base_parameters) add(varied, ParameterRole::base);
  for (const ThermoformExtension& extension : thermoform_extensions())
    if (extension.parameter != nullptr)
      add(*extension.parameter,
          has_extension(extension, nominal, options) ? ParameterRole::base : ParameterRole::effect);
  if (options.fit_mould_place)
    for (const VariedParameter& varied : mould_place) add(varied, ParameterRole::base);
  for (const CauseTable& row : cause_table()) {
    if (options.fit_mould_place && std::string_view(row.name) == "mould_shift") continue;
    if (std::find(options.without.begin(), options.without.end(), row.name) != options.without.end()) continue;
    Cause cause{row.name, row.label, row.explanation, row.remedy, {}, "", 0, row.fault_of};
    for (const VariedParameter& varied : row.parameters) cause.parameters.push_back(add(varied, ParameterRole::effect));
    cause.unit = parameters.back().unit;
    if (std::any_of(infos.begin(), infos.begin() + static_cast<std::ptrdiff_t>(of_the_sheet),
                    [&](const ParameterInfo& i) { return i.name == parameters.back().name; }))
      cause.gain_error = sheet_gain_error;
    causes.push_back(std::move(cause));
  }
  for (const Discrepancy& discrepancy : discrepancies) {
    ModelParameter p;
    p.name = discrepancy.name;
    p.label = discrepancy.label;
    p.role = ParameterRole::discrepancy;
    p.high = 1;
    p.prior_sd = discrepancy.prior_sd;
    p.probe = 1;
    parameters.push_back(p);
  }
}

std::vector<std::string> thermoform_cause_names() {
  std::vector<std::string> names;
  for (const CauseTable& row : cause_table()) names.emplace_back(row.name);
  return names;
}

void apply_discrepancy(const std::string& name, ThermoformOptions& options) {
  for (const Discrepancy& discrepancy : discrepancies)
    if (discrepancy.name == name) discrepancy.apply(options);
}

}  // namespace formwright
