// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// PNG (libpng) and JPEG (stb: baseline and progressive) from bytes.
#include <string_view>

#include "base/bytes.h"
#include "imaging/picture/image.h"

namespace formwright {

/// The longest side and the number of pixels that a picture may have.
inline constexpr int max_picture_side = 32768;
inline constexpr std::int64_t max_picture_pixels = sizeof(void*) == 4 ? 34'000'000 : 134'300'000;  // a square of 11,585

/// Any PNG or JPEG as 8-bit sRGB; the kind is found by content. Embedded colour profiles, gamma and orientation are
/// not followed; 16 bits are rounded to 8. `file_name` may be empty; `where` names the input, for errors.
/// Throws Error{invalid_input, where} with one sentence: neither PNG nor JPEG, damaged, too large.
Image read_picture(ByteView bytes, std::string_view file_name, std::string_view where,
                   std::int64_t max_pixels = max_picture_pixels);

}  // namespace formwright
