// SPDX-License-Identifier: GPL-3.0-or-later
// SVG drawings: styles, transforms, dashes and clips included.
#include <cmath>

#include "base/error.h"
#include "fabrication/svg/grammar/drawing_limits.h"
#include "fabrication/svg/svg_reader.h"
#include "fuzz/fuzz_check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace formwright;
  using fuzz::check;
  SvgDrawing drawing;
  try {
    drawing = read_svg_drawing({reinterpret_cast<const std::byte*>(data), size}, {}, Context());
  } catch (const Error& error) {
    const std::string_view message = error.what();
    check(error.code() == ErrorCode::invalid_input && error.where() == "drawing" && message.ends_with('.'));
    return 0;
  }
  const CutSheet& sheet = drawing.sheet;
  check(sheet.width_mm >= 0 && sheet.width_mm <= max_reach_mm && sheet.height_mm >= 0 &&
        sheet.height_mm <= max_reach_mm && sheet.kerf_mm >= 0 && sheet.kerf_mm <= 10);
  check(!sheet.paths.empty());
  for (const CutPath& path : sheet.paths) {
    check(path.points_mm.size() >= 2);
    for (const Vec2& p : path.points_mm) check(std::abs(p.x()) <= max_reach_mm && std::abs(p.y()) <= 2 * max_reach_mm);
  }
  for (const std::string& note : drawing.notes) check(note.ends_with('.'));
  return 0;
}
