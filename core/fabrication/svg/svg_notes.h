// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What of a drawing is not as its author sees it: counted while reading, said in sentences.
#include <cstddef>
#include <string>
#include <vector>

namespace formwright {

struct SvgNotes {
  std::size_t words = 0, pictures = 0, foreign = 0, masks = 0, filters = 0, clips = 0, markers = 0, dots = 0;
  std::size_t malformed = 0, other_colours = 0, unknown_colours = 0, paint_servers = 0, hairlines = 0, unstroked = 0;
  std::size_t rules = 0, animations = 0, scripts = 0, entities = 0, other_files = 0, languages = 0, outside = 0;
};

/// One sentence for every kind that there is, with what to do.
void add_sentences(const SvgNotes& notes, std::vector<std::string>& sentences);

}  // namespace formwright
