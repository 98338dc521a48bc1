// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace formwright {

/// Hexadecimal digits of `bytes` random bytes from the operating system. Throws std::runtime_error without them.
std::string random_hex(int bytes);

/// Compares in a time that depends on the lengths alone.
bool equal_in_constant_time(std::string_view a, std::string_view b);

}  // namespace formwright
