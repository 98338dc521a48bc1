// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The driver for each controller.
#include <memory>

#include "machines/driver/machine_driver.h"

namespace formwright {

/// `options` as DriverOptions. Throws Error invalid_input.
std::unique_ptr<MachineDriver> make_machine_driver(const Json& options);

/// A job for `load_prepared` of a driver with these options: on any thread, while that driver is at work.
std::unique_ptr<PreparedJob> prepare_job(const Json& options, ByteView job);

}  // namespace formwright
