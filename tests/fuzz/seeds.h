// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>

#include "base/bytes.h"

namespace formwright::fuzz {

/// By target, by name.
using Seeds = std::map<std::string, std::map<std::string, Bytes>>;
Seeds fuzz_seeds();

}  // namespace formwright::fuzz
