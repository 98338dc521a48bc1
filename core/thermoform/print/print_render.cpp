// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/print/print_render.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "imaging/picture/light.h"
#include "imaging/picture/png_writer.h"

namespace formwright {
namespace {

constexpr int band_rows = 64;
constexpr int sides = 2;                // points along a pixel's side
constexpr std::int64_t fraction = 256;  // corners are rounded to this part of a point's distance: exact edge tests

using Whole = Eigen::Matrix<std::int64_t, 2, 1>;

/// Twice the signed area of a, b, p.
std::int64_t area(const Whole& a, const Whole& b, const Whole& p) {
  return (b.x() - a.x()) * (p.y() - a.y()) - (b.y() - a.y()) * (p.x() - a.x());
}

/// One band of rows: which face shows at every point, and how far it is from the sheet. Colours come last, where they
/// show.
class Band {
 public:
  Band(const PrintGrid& grid, int first_row, int left, int right)
      : first_row_(first_row),
        last_row_(std::min(grid.height, first_row + band_rows)),
        left_(left),
        columns_(right - left) {
    const auto points =
        static_cast<std::size_t>(columns_) * sides * static_cast<std::size_t>(last_row_ - first_row_) * sides;
    gap_.assign(points, std::numeric_limits<float>::infinity());
    face_.assign(points, -1);
  }

  void draw(int face, const std::array<Vec2, 3>& pixels, const std::array<double, 3>& gap_mm) {
    std::array<Whole, 3> p;
    for (std::size_t k = 0; k < 3; ++k)
      p[k] = Whole(std::llround(pixels[k].x() * sides * fraction), std::llround(pixels[k].y() * sides * fraction));
    if (area(p[0], p[1], p[2]) < 0) {
      std::swap(p[1], p[2]);
      draw_positive(face, p, {gap_mm[0], gap_mm[2], gap_mm[1]});
    } else {
      draw_positive(face, p, gap_mm);
    }
  }

  void colour(const ModelColours& colours, const std::vector<FaceColour>& faces, Image& image) const {
    const auto& byte = byte_of_light();
    for (int y = first_row_; y < last_row_; ++y)
      for (int x = left_; x < left_ + columns_; ++x) {
        const std::size_t upper = point(x * sides, y * sides), lower = point(x * sides, y * sides + 1);
        const std::array<std::int32_t, 4> shown{face_[upper], face_[upper + 1], face_[lower], face_[lower + 1]};
        Light sum{};
        int count = 0;
        std::array<bool, 4> done{};
        for (std::size_t i = 0; i < 4; ++i) {
          if (shown[i] < 0 || done[i]) continue;
          const FaceColour& face = faces[static_cast<std::size_t>(shown[i])];
          if (face.has_edges_within()) {
            sum += colours.colour(face, place(x, y, i));
            ++count;
            continue;
          }
          // Points of the same face, and of faces on which the same picture goes on, take one colour, at their middle.
          Vec2 middle = Vec2::Zero();
          int together = 0;
          for (std::size_t j = i; j < 4; ++j) {
            if (shown[j] < 0 || done[j]) continue;
            const Vec2 at = place(x, y, j);
            if (shown[j] != shown[i] && !continues(face, faces[static_cast<std::size_t>(shown[j])], at)) continue;
            done[j] = true;
            middle += at;
            ++together;
          }
          sum += static_cast<float>(together) * colours.colour(face, middle / together);
          count += together;
        }
        if (count == 0) continue;
        Rgba& pixel = image.at(x, y);
        for (std::size_t k = 0; k < 3; ++k)
          pixel[k] =
              byte[static_cast<std::size_t>(std::clamp(sum[k] / static_cast<float>(count) + 0.5f, 0.0f, 65535.0f))];
        pixel[3] = 255;
      }
  }

 private:
  static_assert(sides == 2, "colour() takes four points a pixel");

  std::size_t point(int u, int v) const {
    return static_cast<std::size_t>(v - first_row_ * sides) * static_cast<std::size_t>(columns_) * sides +
           static_cast<std::size_t>(u - left_ * sides);
  }
  static Vec2 place(int x, int y, std::size_t i) {
    return {x + (i % 2 == 0 ? 0.25 : 0.75), y + (i / 2 == 0 ? 0.25 : 0.75)};
  }

  /// Points (in rows of points) whose middles lie within, edges included: what two faces share goes to the nearer one
  /// and then to the first.
  void draw_positive(int face, const std::array<Whole, 3>& p, const std::array<double, 3>& gap_mm) {
    const std::int64_t whole = area(p[0], p[1], p[2]);
    if (whole == 0) return;
    // First and last point whose middle, (i + 1/2) * fraction, is not outside.
    const auto first = [](std::int64_t low) { return (low + fraction / 2 - 1) >> 8; };
    const auto last = [](std::int64_t high) { return (high - fraction / 2) >> 8; };
    static_assert(fraction == 1 << 8);
    const std::int64_t v0 = std::max<std::int64_t>(first_row_ * sides, first(std::min({p[0].y(), p[1].y(), p[2].y()})));
    const std::int64_t v1 =
        std::min<std::int64_t>(last_row_ * sides - 1, last(std::max({p[0].y(), p[1].y(), p[2].y()})));
    const std::int64_t u0 = std::max<std::int64_t>(left_ * sides, first(std::min({p[0].x(), p[1].x(), p[2].x()})));
    const std::int64_t u1 =
        std::min<std::int64_t>((left_ + columns_) * sides - 1, last(std::max({p[0].x(), p[1].x(), p[2].x()})));
    const double scale = 1.0 / static_cast<double>(whole);
    const std::int64_t step_a = -(p[2].y() - p[1].y()) * fraction, step_b = -(p[0].y() - p[2].y()) * fraction;
    for (std::int64_t v = v0; v <= v1; ++v) {
      const Whole q(u0 * fraction + fraction / 2, v * fraction + fraction / 2);
      std::int64_t a = area(p[1], p[2], q), b = area(p[2], p[0], q);
      std::size_t i = point(static_cast<int>(u0), static_cast<int>(v));
      for (std::int64_t u = u0; u <= u1; ++u, ++i, a += step_a, b += step_b) {
        const std::int64_t c = whole - a - b;
        if ((a | b | c) < 0) continue;
        const auto gap = static_cast<float>((static_cast<double>(a) * gap_mm[0] + static_cast<double>(b) * gap_mm[1] +
                                             static_cast<double>(c) * gap_mm[2]) *
                                            scale);
        if (!(gap < gap_[i])) continue;
        gap_[i] = gap;
        face_[i] = face;
      }
    }
  }

  int first_row_, last_row_, left_, columns_;
  std::vector<float> gap_;
  std::vector<std::int32_t> face_;
};

}  // namespace

PrintGrid print_grid(const ThermoformPrintOptions& options) {
  PrintGrid grid;
  grid.per_metre = pixels_per_metre(options.dots_per_inch);
  const double width = std::round(options.sheet_x_mm * grid.per_metre / 1000),
               height = std::round(options.sheet_y_mm * grid.per_metre / 1000);
  if (width * height > static_cast<double>(max_image_pixels))
    throw Error(ErrorCode::invalid_input, "dots_per_inch",
                "The print would have " + std::to_string(static_cast<long long>(width * height * 1e-6)) +
                    " million pixels, and " + std::to_string(max_image_pixels / 1'000'000) +
                    " million fit: choose fewer dots per inch.");
  grid.width = std::max(1, static_cast<int>(width));
  grid.height = std::max(1, static_cast<int>(height));
  return grid;
}

Image render_print(const RefinedSurface& surface, const ProjectedSurface& projected, const ModelColours& colours,
                   const PrintGrid& grid, Context& context) {
  context.progress(0, "Drawing the print");
  const auto corners = [&](std::size_t f) {
    std::array<Vec2, 3> pixels;
    for (std::size_t k = 0; k < 3; ++k)
      pixels[k] = grid.pixel(
          projected.sheet_mm.row(surface.mesh.F(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(k))));
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
    const auto first = static_cast<std::size_t>(std::max(0.0, top) / band_rows),
               last = std::min(bands - 1, static_cast<std::size_t>(std::max(0.0, bottom) / band_rows));
    for (std::size_t band = first; band <= last; ++band) faces[band].push_back(static_cast<std::uint32_t>(f));
  }
  Image image(grid.width, grid.height, {255, 255, 255, 0});
  const int from = std::max(0, static_cast<int>(std::floor(left)) - 1),
            to = std::min(grid.width, static_cast<int>(std::ceil(right)) + 1);
  if (from >= to) return image;
  parallel_for(bands, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      context.check_cancelled();
      if (faces[b].empty()) continue;
      Band band(grid, static_cast<int>(b) * band_rows, from, to);
      std::vector<FaceColour> ready;
      ready.reserve(faces[b].size());
      for (const std::uint32_t f : faces[b]) {
        const std::array<Vec2, 3> pixels = corners(f);
        std::array<double, 3> gap{};
        for (std::size_t k = 0; k < 3; ++k)
          gap[k] = projected.gap_mm[surface.mesh.F(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(k))];
        band.draw(static_cast<int>(ready.size()), pixels, gap);
        ready.push_back(colours.face(surface, f, pixels));
      }
      band.colour(colours, ready, image);
    }
  });
  return image;
}

}  // namespace formwright
