// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/photographs/mark_finder.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

#include "base/index.h"
#include "evidence/photographs/mark_code.h"
#include "evidence/photographs/plane_map.h"
#include "imaging/picture/light.h"
#include "imaging/picture/opencv_call.h"

namespace formwright {
namespace {

constexpr int search_side_px = 4096;            // longer side of the picture that outlines are searched in
constexpr std::size_t max_outlines = 20000;     // of four corners, per threshold
constexpr double threshold_levels = 8;          // of 255, below the mean around
constexpr double min_outline_px = 4 * 10;       // a mark of less than 10 pixels cannot be read
constexpr double polygon_share = 0.05;          // of the outline's length, by which a side may bulge
constexpr double max_white_border = 3;          // cells of the 28 of the border
constexpr double min_cell_contrast = 2500;      // of 65535 of light between black and white
using Quad = std::array<Vec2, 4>;

/// Reduced by a whole number and coded as sRGB, in which shadows and lights are alike far apart.
cv::Mat search_picture(const LightPicture& picture, int& factor, const Context& context) {
  factor = std::max(1, (std::max(picture.width, picture.height) + search_side_px - 1) / search_side_px);
  const int width = picture.width / factor, height = picture.height / factor;
  cv::Mat result(height, width, CV_8UC1);
  const auto& byte = byte_of_light();
  for (int y = 0; y < height; ++y) {
    if (y % 128 == 0) context.check_cancelled();
    auto* const row = result.ptr<std::uint8_t>(y);
    for (int x = 0; x < width; ++x) {
      double sum = 0;
      for (int v = 0; v < factor; ++v)
        for (int u = 0; u < factor; ++u) sum += picture.at(x * factor + u, y * factor + v);
      row[x] = byte[static_cast<std::size_t>(sum / (factor * factor))];
    }
  }
  return result;
}

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Corners clockwise in the picture; none where the outline is no convex quadrilateral with sides of some length.
std::optional<Quad> quad_of(const std::vector<cv::Point>& outline, int factor) {
  const auto length = static_cast<double>(outline.size());
  std::vector<cv::Point> polygon;
  cv::approxPolyDP(outline, polygon, polygon_share * length, true);
  if (polygon.size() != 4) return std::nullopt;
  Quad quad;
  for (std::size_t k = 0; k < 4; ++k) quad[k] = factor * Vec2(polygon[k].x + 0.5, polygon[k].y + 0.5);
  double turn = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec2 side = quad[(k + 1) % 4] - quad[k], next = quad[(k + 2) % 4] - quad[(k + 1) % 4];
    const double sine = cross(side, next) / (side.norm() * next.norm());
    if (!(std::abs(sine) > 0.15) || side.norm() < 0.08 * factor * length) return std::nullopt;
    if (k > 0 && sine * turn < 0) return std::nullopt;
    turn = sine;
  }
  if (turn < 0) std::swap(quad[1], quad[3]);
  return quad;
}

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
      for (int u = -1; u <= 1; ++u)
        sum += picture.bilinear((*map)(Vec2(column + 0.5 + 0.2 * u, row + 0.5 + 0.2 * v)));
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
    for (int column = 1; column < mark_cells - 1; ++column)
      bits = bits << 1 | (cell(column, row) > level ? 1u : 0u);
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
  bool cut_short = false;
  if (std::min(picture.width, picture.height) < 32) return {};
  int factor = 1;
  cv::Mat grey;
  opencv_call([&] { grey = search_picture(picture, factor, context); });
  const int side = std::max(grey.cols, grey.rows);
  for (const int share : {24, 80}) {  // of the picture: windows for large and for small marks
    const int window = std::max(11, side / share) | 1;
    std::vector<Quad> quads;
    opencv_call([&] {
      cv::Mat dark;
      cv::adaptiveThreshold(grey, dark, 255, cv::ADAPTIVE_THRESH_MEAN_C, cv::THRESH_BINARY_INV, window,
                            threshold_levels);
      context.check_cancelled();
      std::vector<std::vector<cv::Point>> outlines;
      cv::findContours(dark, outlines, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
      context.check_cancelled();
      for (const auto& outline : outlines) {
        const auto length = static_cast<double>(outline.size());
        if (length < min_outline_px || length > 2.0 * side) continue;
        if (const auto quad = quad_of(outline, factor)) quads.push_back(*quad);
        if (quads.size() >= max_outlines) break;
      }
    });
    cut_short = cut_short || quads.size() >= max_outlines;
    for (std::size_t i = 0; i < quads.size(); ++i) {
      if (i % 64 == 0) context.check_cancelled();
      readings.read(picture, quads[i]);
    }
  }
  SeenMarks seen = readings.result();
  seen.cut_short = cut_short;
  return seen;
}

}  // namespace formwright
