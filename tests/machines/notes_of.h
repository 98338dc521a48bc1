// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "machines/driver/machine_driver.h"

namespace formwright {

/// What the driver has noted since its events were last taken, one note a line.
inline std::string notes_of(MachineDriver& driver) {
  std::string notes;
  const Json events = driver.take_events();
  for (const Json& event : events)
    if (event["event"] == "note") notes += event["text"].get<std::string>() + "\n";
  return notes;
}

}  // namespace formwright
