// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// JSON keeps the order in which it was written: reports read like their declaration.
#include <nlohmann/json.hpp>

namespace formwright {
using Json = nlohmann::ordered_json;
}
