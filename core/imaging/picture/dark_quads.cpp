// SPDX-License-Identifier: GPL-3.0-or-later
#include "imaging/picture/dark_quads.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "imaging/picture/light.h"
#include "imaging/picture/opencv_call.h"

namespace formwright {
namespace {

using Quad = std::array<Vec2, 4>;
constexpr int search_side_px = 4096;         // longer side of the picture that outlines are searched in
constexpr std::size_t max_outlines = 20000;  // of four corners, per threshold
constexpr double threshold_levels = 8;       // of 255, below the mean around
constexpr double min_outline_px = 4 * 10;    // a mark of less than 10 pixels cannot be read
constexpr double polygon_share = 0.05;       // of the outline's length, by which a side may bulge

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

}  // namespace

DarkQuads find_dark_quads(const LightPicture& picture, const Context& context) {
  DarkQuads result;
  if (std::min(picture.width, picture.height) < 32) return result;
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
    result.cut_short = result.cut_short || quads.size() >= max_outlines;
    result.corners_px.insert(result.corners_px.end(), quads.begin(), quads.end());
  }
  return result;
}

}  // namespace formwright
