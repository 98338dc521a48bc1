// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A whole file as a machine's job: taken or refused, and what is known of it can be written.
#include "fuzz/fuzz_check.h"
#include "machines/controllers.h"

namespace formwright::fuzz {

inline void load_job(const char* controller, const std::uint8_t* data, std::size_t size) {
  const auto driver = make_machine_driver({{"controller", controller}});
  driver->opened(0);
  try {
    driver->load("job", {reinterpret_cast<const std::byte*>(data), size});
  } catch (const Error& error) {
    check_invalid_input(error);
  }
  driver->state(1).dump();
  driver->take_events().dump();
}

}  // namespace formwright::fuzz
