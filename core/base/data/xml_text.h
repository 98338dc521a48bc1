// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Words put between the tags of XML and HTML (XML 1.0, 2.4).
#include <string>
#include <string_view>

namespace formwright {

/// Between two tags. Control characters, which no XML may hold, are the caller's to remove.
std::string xml_text(std::string_view text);
/// Between double quotes, as an attribute's value.
std::string xml_attribute(std::string_view text);

}  // namespace formwright
