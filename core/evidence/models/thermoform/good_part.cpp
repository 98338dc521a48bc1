// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/thermoform/good_part.h"

#include <algorithm>

#include "base/error.h"
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

}  // namespace formwright
