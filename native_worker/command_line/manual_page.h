// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

namespace formwright {

/// formwright(1) in the man macros of groff, from the catalog.
std::string manual_page();

}  // namespace formwright
