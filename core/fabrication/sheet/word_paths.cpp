// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/sheet/word_paths.h"

#include "imaging/drawing/drawing.h"

namespace formwright {

double words_width_mm(const std::string& words, double height_mm) {
  return height_mm * (static_cast<double>(words.size()) - 1.0 / 3);
}

std::vector<CutPath> word_paths(const std::string& words, const Vec2& centre, const Vec2& along, double height_mm,
                                CutLayer layer) {
  const Vec2 up(-along.y(), along.x());
  const auto place = [&](const Vec2& p) { return Vec2(centre + p.x() * along + p.y() * up); };
  std::vector<CutPath> paths;
  for (const Stroke& s : outlined({Vec2::Zero(), height_mm, words}).strokes) {
    if (!paths.empty() && paths.back().points_mm.back() == place(s.from)) paths.back().points_mm.push_back(place(s.to));
    else paths.push_back({layer, {place(s.from), place(s.to)}, false, ""});
  }
  return paths;
}

}  // namespace formwright
