// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "base/data/json.h"

namespace formwright {
/// JSON as text. Bytes that are not UTF-8 (a file's name, a word of its content) are replaced: nlohmann's dump()
/// throws.
std::string json_text(const Json& value, int indent = -1);

/// Largest resident size of this process so far.
double peak_memory_mb();

/// This computer's name in its network.
std::string machine_name();

/// Whether the end of the terminal (SIGHUP) is not to end this program: nohup started it.
bool hangup_is_ignored();
}  // namespace formwright
