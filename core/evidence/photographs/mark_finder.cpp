// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/photographs/mark_finder.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/index.h"
#include "evidence/photographs/mark_code.h"
#include "evidence/photographs/plane_map.h"
#include "imaging/picture/dark_quads.h"

namespace formwright {
namespace {

constexpr double max_white_border = 3;      // cells of the 28 of the border
constexpr double min_cell_contrast = 2500;  // of 65535 of light between black and white
using Quad = std::array<Vec2, 4>;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

struct ReadQuad {
  ReadCode code;
  bool mirrored = false;
};

/// Reads the cells of a square with these corners.
std::optional<ReadQuad> read_cells(const LightPicture& picture, const Quad& quad) {
  const Quad unit{Vec2(0, 0), Vec2(mark_cells, 0), Vec2(mark_cells, mark_cells), Vec2(0, mark_cells)};
  const auto map = fit_plane_map(unit, quad);
  if (!map) return std::nullopt;
  const auto cell = [&](double column, double row) {
    double sum = 0;
    for (int v = -1; v <= 1; ++v)
      for (int u = -1; u <= 1; ++u) sum += picture.bilinear((*map)(Vec2(column + 0.5 + 0.2 * u, row + 0.5 + 0.2 * v)));
    return sum / 9;
  };
  double black = 0, white = 0;
  std::vector<double> border;
  for (int i = 0; i < mark_cells - 1; ++i) {
    const int last = mark_cells - 1;
    for (const auto& [column, row] : {std::pair{i, 0}, {last, i}, {last - i, last}, {0, last - i}})
      border.push_back(cell(column, row));
    white += cell(i + 0.5, -0.9) + cell(i + 0.5, last + 0.9) + cell(-0.9, i + 0.5) + cell(last + 0.9, i + 0.5);
  }
  for (const double value : border) black += value / static_cast<double>(border.size());
  white /= 4.0 * (mark_cells - 1);
  if (!std::isfinite(white) || white - black < min_cell_contrast) return std::nullopt;
  const double level = 0.5 * (black + white);
  if (static_cast<double>(std::count_if(border.begin(), border.end(), [&](double v) { return v > level; })) >
      max_white_border)
    return std::nullopt;
  std::uint64_t bits = 0;
  for (int row = 1; row < mark_cells - 1; ++row)
    for (int column = 1; column < mark_cells - 1; ++column) bits = bits << 1 | (cell(column, row) > level ? 1u : 0u);
  if (const auto code = read_code(bits)) return ReadQuad{*code, false};
  if (const auto code = read_code(mirrored_bits(bits))) return ReadQuad{*code, true};
  return std::nullopt;
}

/// A mark turned counter-clockwise by k quarters has its back left corner k places further back in clockwise order.
template <class T>
std::array<T, 4> from_back_left(const std::array<T, 4>& clockwise, int quarter_turns) {
  std::array<T, 4> result;
  for (std::size_t k = 0; k < 4; ++k) result[k] = clockwise[(k + 4 - index(quarter_turns)) % 4];
  return result;
}

struct Reading {
  SquareCorners corners;
  int wrong_cells = 0;
  double area = 0;
};

class Readings {
 public:
  void read(const LightPicture& picture, const Quad& quad) {
    const auto refined = refine_square(picture, quad);
    const auto read = read_cells(picture, refined ? refined->corner_px : quad);
    if (!read) return;
    const int number = read->code.number;
    if (read->mirrored) {
      mirrored_[number] = true;
      return;
    }
    if (!refined) {
      blurred_[number] = true;
      return;
    }
    Reading reading;
    reading.corners.corner_px = from_back_left(refined->corner_px, read->code.quarter_turns);
    reading.corners.covariance_px2 = from_back_left(refined->covariance_px2, read->code.quarter_turns);
    reading.corners.shared_px = from_back_left(refined->shared_px, read->code.quarter_turns);
    reading.wrong_cells = read->code.wrong_cells;
    const Quad& c = reading.corners.corner_px;
    reading.area = std::abs(cross(c[2] - c[0], c[3] - c[1]));
    const auto [before, is_new] = best_.emplace(number, reading);
    if (!is_new && (reading.wrong_cells < before->second.wrong_cells ||
                    (reading.wrong_cells == before->second.wrong_cells && reading.area > before->second.area)))
      before->second = reading;
  }

  SeenMarks result() const {
    SeenMarks seen;
    for (const auto& [number, reading] : best_) seen.marks.push_back({number, reading.corners});
    for (const auto& [number, is] : mirrored_)
      if (!best_.contains(number)) seen.mirrored.push_back(number);
    for (const auto& [number, is] : blurred_)
      if (!best_.contains(number)) seen.blurred.push_back(number);
    return seen;
  }

 private:
  std::map<int, Reading> best_;
  std::map<int, bool> mirrored_, blurred_;
};

}  // namespace

SeenMarks find_coded_marks(const LightPicture& picture, const Context& context) {
  Readings readings;
  const DarkQuads quads = find_dark_quads(picture, context);
  for (std::size_t i = 0; i < quads.corners_px.size(); ++i) {
    if (i % 64 == 0) context.check_cancelled();
    readings.read(picture, quads.corners_px[i]);
  }
  SeenMarks seen = readings.result();
  seen.cut_short = quads.cut_short;
  return seen;
}

}  // namespace formwright
