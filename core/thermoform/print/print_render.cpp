// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/print/print_render.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "imaging/light.h"
#include "imaging/png_writer.h"

namespace formwright {
namespace {

constexpr int band_rows = 64;
constexpr int sides = 2;                 // points along a pixel's side
constexpr std::int64_t fraction = 256;   // corners are rounded to this part of a point's distance: exact edge tests

using Whole = Eigen::Matrix<std::int64_t, 2, 1>;

/// Twice the signed area of a, b, p.
std::int64_t area(const Whole& a, const Whole& b, const Whole& p) { return (b.x() - a.x()) * (p.y() - a.y()) - (b.y() - a.y()) * (p.x() - a.x()); }

/// One band of rows, with every point's colour and distance to the sheet.
class Band {
 public:
  Band(const PrintGrid& grid, int first_row, int left, int right)
      : first_row_(first_row), last_row_(std::min(grid.height, first_row + band_rows)), left_(left), columns_(right - left) {
    const auto points = static_cast<std::size_t>(columns_) * sides * static_cast<std::size_t>(last_row_ - first_row_) * sides;
    gap_.assign(points, std::numeric_limits<float>::infinity());
    light_.resize(points);
  }

  void draw(const std::array<Vec2, 3>& pixels, const std::array<double, 3>& gap_mm, const ModelColours& colours, const FaceColour& face) {
    std::array<Whole, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = Whole(std::llround(pixels[k].x() * sides * fraction), std::llround(pixels[k].y() * sides * fraction));
    std::int64_t whole = area(p[0], p[1], p[2]);
    if (whole == 0) return;
    const std::int64_t sign = whole < 0 ? -1 : 1;
    const double scale = 1.0 / static_cast<double>(whole);
    const auto low = [](std::int64_t value) { return static_cast<int>(std::floor(static_cast<double>(value) / (sides * fraction))); };
    const int y0 = std::max(first_row_, low(std::min({p[0].y(), p[1].y(), p[2].y()}))), y1 = std::min(last_row_ - 1, low(std::max({p[0].y(), p[1].y(), p[2].y()})));
    const int x0 = std::max(left_, low(std::min({p[0].x(), p[1].x(), p[2].x()}))), x1 = std::min(left_ + columns_ - 1, low(std::max({p[0].x(), p[1].x(), p[2].x()})));
    const bool each_point = face.kind == FaceColour::Kind::checker || face.kind == FaceColour::Kind::contours;  // hard edges within
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        std::array<std::size_t, sides * sides> won{};
        std::array<Vec3, sides * sides> where;
        int count = 0;
        for (int v = 0; v < sides; ++v)
          for (int u = 0; u < sides; ++u) {
            const Whole q((x * sides + u) * fraction + fraction / 2, (y * sides + v) * fraction + fraction / 2);
            const std::int64_t a = area(p[1], p[2], q), b = area(p[2], p[0], q), c = whole - a - b;
            if (a * sign < 0 || b * sign < 0 || c * sign < 0) continue;
            const Vec3 weight(static_cast<double>(a) * scale, static_cast<double>(b) * scale, static_cast<double>(c) * scale);
            const auto gap = static_cast<float>(weight[0] * gap_mm[0] + weight[1] * gap_mm[1] + weight[2] * gap_mm[2]);
            const std::size_t i = point(x, y, u, v);
            if (!(gap < gap_[i])) continue;
            gap_[i] = gap;
            where[static_cast<std::size_t>(count)] = weight;
            won[static_cast<std::size_t>(count++)] = i;
          }
        if (count == 0) continue;
        Vec3 mean = Vec3::Zero();
        for (int i = 0; i < count; ++i) mean += where[static_cast<std::size_t>(i)] / count;
        Light light{};
        if (!each_point) light = colours.colour(face, mean);
        for (int i = 0; i < count; ++i) light_[won[static_cast<std::size_t>(i)]] = each_point ? colours.colour(face, where[static_cast<std::size_t>(i)]) : light;
      }
  }

  void resolve(Image& image) const {
    const auto& byte = byte_of_light();
    for (int y = first_row_; y < last_row_; ++y)
      for (int x = left_; x < left_ + columns_; ++x) {
        Light sum{};
        int count = 0;
        for (int v = 0; v < sides; ++v)
          for (int u = 0; u < sides; ++u) {
            const std::size_t i = point(x, y, u, v);
            if (std::isinf(gap_[i])) continue;
            ++count;
            for (std::size_t k = 0; k < 3; ++k) sum[k] += light_[i][k];
          }
        if (count == 0) continue;
        Rgba& pixel = image.at(x, y);
        for (std::size_t k = 0; k < 3; ++k) pixel[k] = byte[static_cast<std::size_t>(std::clamp(sum[k] / static_cast<float>(count) + 0.5f, 0.0f, 65535.0f))];
        pixel[3] = 255;
      }
  }

 private:
  std::size_t point(int x, int y, int u, int v) const {
    return (static_cast<std::size_t>(y - first_row_) * sides + static_cast<std::size_t>(v)) * static_cast<std::size_t>(columns_) * sides +
           static_cast<std::size_t>(x - left_) * sides + static_cast<std::size_t>(u);
  }

  int first_row_, last_row_, left_, columns_;
  std::vector<float> gap_;
  std::vector<Light> light_;
};

}  // namespace

PrintGrid print_grid(const ThermoformPrintOptions& options) {
  PrintGrid grid;
  grid.per_metre = pixels_per_metre(options.dots_per_inch);
  const double width = std::round(options.sheet_x_mm * grid.per_metre / 1000), height = std::round(options.sheet_y_mm * grid.per_metre / 1000);
  if (width * height > static_cast<double>(most_pixels))
    throw Error(ErrorCode::invalid_input, "dots_per_inch",
                "The print would have " + std::to_string(static_cast<long long>(width * height * 1e-6)) + " million pixels, and " + std::to_string(most_pixels / 1'000'000) +
                    " million fit: choose fewer dots per inch.");
  grid.width = std::max(1, static_cast<int>(width));
  grid.height = std::max(1, static_cast<int>(height));
  return grid;
}

Image render_print(const RefinedSurface& surface, const ProjectedSurface& projected, const ModelColours& colours, const PrintGrid& grid, Context& context) {
  context.progress(0, "Drawing the print");
  const auto corners = [&](std::size_t f) {
    std::array<Vec2, 3> pixels;
    for (std::size_t k = 0; k < 3; ++k) pixels[k] = grid.pixel(projected.sheet_mm.row(surface.mesh.F(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(k))));
    return pixels;
  };
  // Faces by the bands they touch, in their own order.
  const std::size_t bands = static_cast<std::size_t>((grid.height + band_rows - 1) / band_rows);
  std::vector<std::vector<std::uint32_t>> faces(bands);
  double left = grid.width, right = 0;
  for (std::size_t f = 0; f < projected.face.size(); ++f) {
    if (projected.face[f] != Coverage::coloured) continue;
    const std::array<Vec2, 3> p = corners(f);
    const double top = std::min({p[0].y(), p[1].y(), p[2].y()}), bottom = std::max({p[0].y(), p[1].y(), p[2].y()});
    if (!(bottom >= 0) || !(top <= grid.height)) continue;
    left = std::min({left, p[0].x(), p[1].x(), p[2].x()});
    right = std::max({right, p[0].x(), p[1].x(), p[2].x()});
    const auto first = static_cast<std::size_t>(std::max(0.0, top) / band_rows), last = std::min(bands - 1, static_cast<std::size_t>(std::max(0.0, bottom) / band_rows));
    for (std::size_t band = first; band <= last; ++band) faces[band].push_back(static_cast<std::uint32_t>(f));
  }
  Image image(grid.width, grid.height, {255, 255, 255, 0});
  const int from = std::max(0, static_cast<int>(std::floor(left)) - 1), to = std::min(grid.width, static_cast<int>(std::ceil(right)) + 1);
  if (from >= to) return image;
  parallel_for(bands, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      context.check_cancelled();
      if (faces[b].empty()) continue;
      Band band(grid, static_cast<int>(b) * band_rows, from, to);
      for (const std::uint32_t f : faces[b]) {
        const std::array<Vec2, 3> pixels = corners(f);
        std::array<double, 3> gap{};
        for (std::size_t k = 0; k < 3; ++k) gap[k] = projected.gap_mm[surface.mesh.F(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(k))];
        band.draw(pixels, gap, colours, colours.face(surface, f, pixels));
      }
      band.resolve(image);
    }
  });
  return image;
}

}  // namespace formwright
