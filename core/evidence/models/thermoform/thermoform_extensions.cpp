// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/thermoform/thermoform_extensions.h"

#include <algorithm>

namespace formwright {
namespace {

constexpr VariedParameter network{"network_share", false, 0, 0.8, 0.3, 0.08};

void use_a_finer_sheet(ThermoformModelOptions& options) { options.triangles *= 2; }
void use_shorter_steps(ThermoformModelOptions& options) { options.step_mm /= 2; }

}  // namespace

const std::vector<ThermoformExtension>& thermoform_extensions() {
  using enum ExtensionTrial;
  static const std::vector<ThermoformExtension> table = {
      {"lasting_network", "Part of the plastic never flows",
       "Part of the hot plastic pulls back like rubber, the more the more it is drawn, and keeps steep walls thicker.",
       "The setting “Stiffness that never flows” (network_share) keeps that part; the profile has it. A simulation takes up to a third longer.",
       fit, &network},
      {"constant_volume",
       "The plastic keeps its volume",
       "Hot plastic thins exactly as much as it is stretched, and is stiffer in two directions at once than in one.",
       "The setting “Elastic law” (elastic_law) does that; the profile has it. A simulation takes as long as before.",
       fit,
       nullptr,
       {{"elastic_law", "incompressible_neo_hookean"}}},
      {"sliding",
       "The sheet slides until the vacuum holds it",
       "While the mould rises, little presses the sheet onto it: it slides over edges and tops before it sticks.",
       "The setting “Sheet slides on the mould” (slip) lets it slide; the profile has it. A simulation takes up to twice as long.",
       fit_if_one_look_promises,
       nullptr,
       {{"slip", 0.35}}},
      {"slow_vacuum",
       "The vacuum builds up slowly",
       "The pump takes longer to empty the space below the sheet, which flows on before it is held.",
       "The setting “Vacuum builds up in” (vacuum_ramp_s) does that; the profile has it. A simulation takes as long as before.",
       fit_if_one_look_promises,
       nullptr,
       {{"vacuum_ramp_s", 0.6}}},
      {"total_strain_yields",
       "What has yielded flows on",
       "Once a place has yielded, all of its stretch flows, not only what exceeds the yield strain: it thins to a neck.",
       "The setting “Yield rule” (yield_rule) does that; the profile has it. A simulation takes as long as before.",
       fit_if_one_look_promises,
       nullptr,
       {{"yield_rule", "total_strain"}}},
      {"bending",
       "The sheet resists bending",
       "A thick sheet does not follow a sharp edge as a skin without stiffness would.",
       "The setting “Bending stiffness” (bending) computes that. A simulation takes two to three times as long.",
       one_look,
       nullptr,
       {{"bending", true}}},
      {"finer_sheet", "The triangles are too large", "Twice as many triangles follow the mould nearer.",
       "Twice the “Triangles” (triangles) take two to three times as long.", one_look, nullptr, Json::object(),
       use_a_finer_sheet},
      {"shorter_steps", "The time steps are too long",
       "Half the step finds other places where the sheet touches first.",
       "Half the “Largest step” (step_mm) takes up to twice as long.", one_look, nullptr, Json::object(),
       use_shorter_steps}};
  return table;
}

bool has_extension(const ThermoformExtension& extension, const Json& nominal, const ThermoformModelOptions& options) {
  if (std::find(options.extensions.begin(), options.extensions.end(), extension.name) != options.extensions.end())
    return true;
  if (extension.parameter != nullptr) return nominal.value(extension.parameter->name, 0.0) != 0;
  if (extension.settings.empty()) return false;
  for (const auto& [name, value] : extension.settings.items()) {
    if (!nominal.contains(name)) return false;
    const Json& own = nominal[name];
    if (value.is_number() ? own < value : own != value) return false;
  }
  return true;
}

void apply_extension(const ThermoformExtension& extension, ThermoformModelOptions& options) {
  options.extensions.emplace_back(extension.name);
  if (extension.change != nullptr) extension.change(options);
}

}  // namespace formwright
