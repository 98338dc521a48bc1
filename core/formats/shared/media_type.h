// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a picture's first bytes say it is.
#include <string>

#include "base/bytes.h"

namespace formwright {

inline std::string picture_media_type(ByteView bytes) {
  const std::string_view text = as_text(bytes);
  if (text.starts_with("\x89PNG\r\n\x1a\n")) return "image/png";
  if (text.starts_with("\xff\xd8\xff")) return "image/jpeg";
  if (text.starts_with("GIF8")) return "image/gif";
  if (text.starts_with("BM")) return "image/bmp";
  if (text.size() >= 12 && text.starts_with("RIFF") && text.substr(8, 4) == "WEBP") return "image/webp";
  return "";
}

}  // namespace formwright
