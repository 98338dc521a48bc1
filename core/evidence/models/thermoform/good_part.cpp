// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/thermoform/good_part.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "evidence/calibration.h"

namespace formwright {

MachineInOrder machine_in_order(const std::vector<FormedObject>& good_parts, const ThermoformModelOptions& options,
                                Context& context) {
  const ThermoformModel usual(good_parts, options);
  MachineInOrder result;
  {
    const auto span = context.span(0, 0.8, "Choosing the simulation");
    result.choice = choose_simulation(usual.for_choosing(), context);
  }
  const ThermoformModel& model = usual.extended_by(result.choice.taken());
  SimulationBag bag(model);
  const auto span = context.span(0.8, 1, "Calibrating to the good part");
  const Calibration calibration = calibrate_quickly(bag, context, result.choice.u);
  result.profile = model.profile_at(calibration.u);
  result.error_mm = calibration.error;
  return result;
}

void check_good_parts(const std::vector<FormedObject>& good_parts, const std::vector<FormedObject>& objects) {
  for (const FormedObject& part : good_parts)
    if (std::none_of(objects.begin(), objects.end(), [&](const FormedObject& o) { return o.key == part.key; }))
      throw Error(
          ErrorCode::invalid_input, "good",
          part.name +
              ": this good part was formed over another mould than the measured objects: give one with the same mould.obj, or leave it out.");
}

std::string change_of_stiffness(const ThermoformModel& model, const Eigen::VectorXd& u) {
  constexpr double clear = 1.25;  // from one day to the next heaters differ by less
  for (std::size_t p = 0; p < model.parameters().size(); ++p) {
    if (model.parameters()[p].name != "young_modulus_pa") continue;
    const double ratio = std::exp(u[static_cast<Eigen::Index>(p)]);
    if (ratio > clear)
      return "The sheet was about " + with_digits(ratio, 2) +
             " times as stiff as that of the good part: it was less hot, or is another plastic. A weak vacuum looks alike.";
    if (ratio < 1 / clear)
      return "The sheet was about " + with_digits(1 / ratio, 2) +
             " times as soft as that of the good part: it was hotter, or is another plastic.";
  }
  return {};
}

}  // namespace formwright
