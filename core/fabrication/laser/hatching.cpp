// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/laser/hatching.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace formwright {

std::vector<std::vector<Vec2>> hatch(const std::vector<Polygon>& shapes, double spacing_mm, const Context& context) {
  double low = 1e300, high = -1e300;
  for (const Polygon& shape : shapes)
    for (const Vec2& p : shape) {
      low = std::min(low, p.y());
      high = std::max(high, p.y());
    }
  std::vector<std::vector<Vec2>> lines;
  if (low >= high) return lines;
  const double count = std::floor((high - low) / spacing_mm + 0.5);
  if (count > 200'000)
    throw Error(ErrorCode::invalid_input, "engrave_line_mm",
                "Filling the shapes takes over 200,000 lines: raise the line spacing.");
  // An edge crosses the lines from its lower end, included, to its upper one, not included.
  std::vector<std::vector<double>> crossings(static_cast<std::size_t>(count));
  for (const Polygon& shape : shapes) {
    context.check_cancelled();
    for (std::size_t i = 0; i < shape.size(); ++i) {
      Vec2 a = shape[i], b = shape[(i + 1) % shape.size()];
      if (a.y() == b.y()) continue;
      if (a.y() > b.y()) std::swap(a, b);
      const double from = std::ceil((a.y() - low) / spacing_mm - 0.5), to = (b.y() - low) / spacing_mm - 0.5;
      for (double k = std::max(0.0, from); k < std::min(to, count); ++k) {
        const double y = low + (k + 0.5) * spacing_mm;
        crossings[static_cast<std::size_t>(k)].push_back(a.x() + (b.x() - a.x()) * (y - a.y()) / (b.y() - a.y()));
      }
    }
  }
  for (std::size_t k = 0; k < crossings.size(); ++k) {
    auto& xs = crossings[k];
    std::sort(xs.begin(), xs.end());
    const double y = low + (static_cast<double>(k) + 0.5) * spacing_mm;
    std::vector<std::vector<Vec2>> row;
    for (std::size_t i = 0; i + 1 < xs.size(); i += 2)
      if (xs[i + 1] - xs[i] > 1e-3) row.push_back({{xs[i], y}, {xs[i + 1], y}});
    if (k % 2 == 1) {
      std::reverse(row.begin(), row.end());
      for (auto& line : row) std::swap(line[0], line[1]);
    }
    lines.insert(lines.end(), row.begin(), row.end());
  }
  return lines;
}

}  // namespace formwright
