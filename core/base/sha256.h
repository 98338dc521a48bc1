// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// FIPS 180-4, in the core because WASM has no crypto library to link.
#include <string>

#include "base/bytes.h"

namespace formwright {
/// 64 lower-case hexadecimal digits.
std::string sha256_hex(ByteView bytes);
}  // namespace formwright
