// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/sheet/nesting.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <optional>

#include "base/error.h"

namespace formwright {
namespace {

class Bitmap {
 public:
  Bitmap(int cells_x, int cells_y)
      : width(cells_x),
        height(cells_y),
        words((cells_x + 63) / 64),
        bits(std::size_t(words) * std::size_t(cells_y), 0) {}

  int width, height, words;

  void set(int x, int y) {
    if (x >= 0 && y >= 0 && x < width && y < height) row(y)[x / 64] |= std::uint64_t{1} << (x % 64);
  }
  std::uint64_t* row(int y) { return bits.data() + std::ptrdiff_t(y) * words; }
  const std::uint64_t* row(int y) const { return bits.data() + std::ptrdiff_t(y) * words; }

  /// A word of `shape`'s row y as it stands `x` cells to the right.
  static std::uint64_t shifted(const Bitmap& shape, int y, int x, int word) {
    const int from = word - x / 64, by = x % 64;
    std::uint64_t value = 0;
    if (from >= 0 && from < shape.words) value = shape.row(y)[from] << by;
    if (by > 0 && from >= 1 && from - 1 < shape.words) value |= shape.row(y)[from - 1] >> (64 - by);
    return value;
  }
  bool row_meets(const Bitmap& shape, int y, int x, int shape_y) const {
    const std::uint64_t* mine = row(y);
    for (int w = x / 64; w < std::min(words, (x + shape.width + 63) / 64); ++w)
      if (mine[w] & shifted(shape, shape_y, x, w)) return true;
    return false;
  }
  void add(const Bitmap& shape, int x, int y) {
    for (int j = 0; j < shape.height; ++j)
      for (int w = 0; w < words; ++w) row(y + j)[w] |= shifted(shape, j, x, w);
  }

 private:
  std::vector<std::uint64_t> bits;
};

struct TurnedShape {
  Eigen::Matrix2d turn;
  Vec2 lower_mm;  // of the turned shape, where the bitmap begins
  Bitmap bitmap;
};

/// Every cell that the polygon grown by `grow_mm` can touch.
TurnedShape rasterised(const Polygon& shape, double angle, double cell, double grow_mm) {
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(angle).toRotationMatrix();
  Polygon points;
  Vec2 lower = Vec2::Constant(1e300), upper = Vec2::Constant(-1e300);
  for (const Vec2& p : shape)
    points.push_back(turn * p), lower = lower.cwiseMin(points.back()), upper = upper.cwiseMax(points.back());
  lower -= Vec2::Constant(grow_mm), upper += Vec2::Constant(grow_mm);
  const Vec2 cells = (upper - lower) / cell;
  TurnedShape result{turn, lower,
                     Bitmap(static_cast<int>(std::ceil(cells.x())), static_cast<int>(std::ceil(cells.y())))};
  Bitmap& bitmap = result.bitmap;
  const auto centre = [&](int i) { return (i + 0.5) * cell; };
  const double reach = grow_mm + cell * std::numbers::sqrt2 / 2;
  std::vector<std::vector<double>> crossings(static_cast<std::size_t>(bitmap.height));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 a = points[i] - lower, b = points[(i + 1) % points.size()] - lower, along = b - a;
    const Vec2 low = a.cwiseMin(b), high = a.cwiseMax(b);
    const auto cell_of = [&](double mm) { return static_cast<int>(std::floor(mm / cell)); };
    for (int y = std::max(0, cell_of(low.y() - reach)); y <= std::min(bitmap.height - 1, cell_of(high.y() + reach));
         ++y) {
      for (int x = std::max(0, cell_of(low.x() - reach)); x <= std::min(bitmap.width - 1, cell_of(high.x() + reach));
           ++x) {
        const Vec2 p(centre(x), centre(y));
        const double t = along.squaredNorm() > 0 ? std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0) : 0.0;
        if ((p - a - t * along).squaredNorm() <= reach * reach) bitmap.set(x, y);
      }
      const double level = centre(y);
      if ((a.y() <= level) != (b.y() <= level))
        crossings[std::size_t(y)].push_back(a.x() + (level - a.y()) / along.y() * along.x());
    }
  }
  for (int y = 0; y < bitmap.height; ++y) {
    auto& row = crossings[std::size_t(y)];
    std::sort(row.begin(), row.end());
    for (std::size_t k = 0; k + 1 < row.size(); k += 2)
      for (int x = static_cast<int>(std::ceil(row[k] / cell - 0.5)); centre(x) <= row[k + 1]; ++x) bitmap.set(x, y);
  }
  return result;
}

/// The leftmost, then lowest place where the shape is free.
std::optional<std::pair<int, int>> first_free(const Bitmap& sheet, const Bitmap& shape, int x_end) {
  int last_hit = 0;  // most places are taken for the same reason as the one before
  for (int x = 0; x + shape.width <= std::min(sheet.width, x_end + shape.width - 1); ++x)
    for (int y = 0; y + shape.height <= sheet.height; ++y) {
      if (sheet.row_meets(shape, y + last_hit, x, last_hit)) continue;
      bool taken = false;
      for (int j = 0; j < shape.height && !taken; ++j)
        if (sheet.row_meets(shape, y + j, x, j)) taken = true, last_hit = j;
      if (!taken) return std::pair{x, y};
    }
  return std::nullopt;
}

}  // namespace

double nesting_cell_mm(const NestingOptions& options) { return std::max(options.bed_x_mm, options.bed_y_mm) / 300; }

std::vector<double> fitting_turns(const Polygon& hull, double x_mm, double y_mm, bool keep_direction) {
  struct Turn {
    double angle, area_mm2;
  };
  std::vector<Turn> turns;
  double tightest = 1e300;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2 along = hull[(i + 1) % hull.size()] - hull[i], u = along.normalized(), v(-u.y(), u.x());
    if (!(along.norm() > 0)) continue;
    double low_u = 1e300, high_u = -1e300, low_v = 1e300, high_v = -1e300;
    for (const Vec2& p : hull) {
      low_u = std::min(low_u, u.dot(p)), high_u = std::max(high_u, u.dot(p));
      low_v = std::min(low_v, v.dot(p)), high_v = std::max(high_v, v.dot(p));
    }
    const double width = high_u - low_u, height = high_v - low_v, area = width * height,
                 angle = -std::atan2(u.y(), u.x());
    const double quarter = std::numbers::pi / 2;
    const bool lies = width <= x_mm && height <= y_mm, stands = height <= x_mm && width <= y_mm;
    if (keep_direction) {
      // Only the tightest rectangle has a long side to speak of.
      if (area >= tightest - 1e-9 * area) continue;
      tightest = area;
      turns.clear();
      if (width >= height ? lies : stands) turns = {{width >= height ? angle : angle + quarter, area}};
    } else {
      if (lies) turns.push_back({angle, area});
      if (stands) turns.push_back({angle + quarter, area});
    }
  }
  std::stable_sort(turns.begin(), turns.end(), [](const Turn& a, const Turn& b) { return a.area_mm2 < b.area_mm2; });
  std::vector<double> angles;
  for (std::size_t i = 0; i < turns.size() && i < 4; ++i) angles.push_back(turns[i].angle);
  return angles;
}

Nesting nest(const std::vector<Polygon>& shapes, const NestingOptions& options, Context& context) {
  Nesting nesting;
  nesting.cell_mm = nesting_cell_mm(options);
  nesting.places.resize(shapes.size());
  const double free_x = options.bed_x_mm - 2 * options.margin_mm, free_y = options.bed_y_mm - 2 * options.margin_mm;
  // Half the spacing of the shapes at the edge lies in the margin.
  const int width = static_cast<int>(std::floor((free_x + options.spacing_mm) / nesting.cell_mm)),
            height = static_cast<int>(std::floor((free_y + options.spacing_mm) / nesting.cell_mm));
  std::vector<std::size_t> order(shapes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(signed_area_mm2(shapes[a])) > std::abs(signed_area_mm2(shapes[b]));
  });
  std::vector<Bitmap> sheets;
  for (const std::size_t i : order) {
    context.check_cancelled();
    const double spare = 3 * nesting.cell_mm;
    std::vector<TurnedShape> turned;
    for (const double angle :
         fitting_turns(convex_hull(shapes[i]), free_x - spare, free_y - spare, options.keep_direction))
      for (const double half : {0.0, std::numbers::pi})
        turned.push_back(rasterised(shapes[i], angle + half, nesting.cell_mm, options.spacing_mm / 2));
    if (turned.empty())
      throw Error(ErrorCode::invalid_input, "bed_x_mm",
                  "A piece does not fit the bed: give a larger bed or smaller margins.");
    for (std::size_t s = 0;; ++s) {
      if (s == sheets.size()) sheets.emplace_back(std::max(width, 1), std::max(height, 1));
      const TurnedShape* best = nullptr;
      std::pair<int, int> place;
      int best_end = sheets[s].width + 1;
      for (const TurnedShape& shape : turned) {
        const auto found = first_free(sheets[s], shape.bitmap, best_end - shape.bitmap.width);
        if (found && found->first + shape.bitmap.width < best_end)
          best = &shape, place = *found, best_end = found->first + shape.bitmap.width;
        context.check_cancelled();
      }
      if (!best) continue;
      sheets[s].add(best->bitmap, place.first, place.second);
      const double edge = options.margin_mm - options.spacing_mm / 2;
      nesting.places[i] = {
          static_cast<int>(s), best->turn,
          Vec2(edge + place.first * nesting.cell_mm, edge + place.second * nesting.cell_mm) - best->lower_mm};
      break;
    }
  }
  nesting.sheet_count = static_cast<int>(sheets.size());
  return nesting;
}

}  // namespace formwright
