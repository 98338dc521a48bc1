// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/controllers.h"

#include "machines/grbl/grbl_driver.h"
#include "machines/k40/k40_driver.h"
#include "machines/marlin/marlin_driver.h"
#include "machines/ruida/ruida_driver.h"

namespace formwright {

std::unique_ptr<MachineDriver> make_machine_driver(const Json& options) {
  const auto read = read_parameters<DriverOptions>(options);
  switch (read.controller) {
    case DriverController::grbl: return std::make_unique<GrblDriver>(read);
    case DriverController::marlin: return std::make_unique<MarlinDriver>(read);
    case DriverController::k40: return std::make_unique<K40Driver>(read);
    case DriverController::ruida: return std::make_unique<RuidaDriver>(read);
  }
  machines_detail::refuse("controller", "There is no driver for this controller: choose another.");
}

std::unique_ptr<PreparedJob> prepare_job(const Json& options, ByteView job) {
  return make_machine_driver(options)->prepare(job);
}

}  // namespace formwright
