// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string_view>

#include "base/bytes.h"

namespace formwright {

/// Makes `words` (ASCII) the subject among the document's properties, by an update at the end that repeats the
/// information dictionary with one entry more (ISO 32000-1, 7.5.6 and 14.3.3). A file without a table of references as
/// libharu writes it, or without an information dictionary, stays as it is.
void note_pdf(Bytes& file, std::string_view words);

}  // namespace formwright
