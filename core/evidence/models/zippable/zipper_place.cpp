// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/zippable/zipper_place.h"

#include <algorithm>
#include <cmath>

namespace formwright {
namespace {

constexpr double min_share_of_size = 0.1;  // shorter lengths tell little for their error
constexpr double max_widths = 2;           // from one side of the ribbon to the other; beside an opening there is none
constexpr int marks_along = 4;             // a flat length along the ribbon
constexpr double same_turn_rad = 1e-6;

}  // namespace

TriangleMesh cloth_mesh(const RibbonPattern& pattern, const Positions& x) { return {x, pattern.flat.F}; }

ZipperPlace zipper_place(const RibbonPattern& pattern, double along_mm) {
  const std::vector<SeamPair>& seams = pattern.seams;
  // Where a stretch of the zipper ends the next one begins at the same length.
  for (std::size_t i = 0; i + 1 < seams.size(); ++i) {
    const double from = seams[i].along_mm, to = seams[i + 1].along_mm;
    if (to > from && along_mm <= to)
      return {{static_cast<int>(i), static_cast<int>(i + 1)}, std::clamp((along_mm - from) / (to - from), 0.0, 1.0)};
  }
  const int last = static_cast<int>(seams.size()) - 1;
  return {{last, last}, 0};
}

Vec2 flat_place(const RibbonPattern& pattern, const ZipperMark& mark, double marker_spacing_mm) {
  return zipper_place(pattern, mark.number * marker_spacing_mm)
      .interpolate(pattern,
                   [&](const SeamPair& pair) {
                     return Vec3(pattern.flat.V.row(mark.left ? pair.left : pair.right).transpose());
                   })
      .head<2>();
}

double piece_turn(const RibbonPattern& pattern, const ZipperMark& mark, double marker_spacing_mm) {
  if (pattern.turn_of_triangle_rad.empty()) return 0;
  const ZipperPlace place = zipper_place(pattern, mark.number * marker_spacing_mm);
  const SeamPair& pair = pattern.seams[static_cast<std::size_t>(place.pair[0])];
  const int vertex = mark.left ? pair.left : pair.right;
  for (Eigen::Index f = 0; f < pattern.flat.F.rows(); ++f)
    if ((pattern.flat.F.row(f).array() == vertex).any())
      return pattern.turn_of_triangle_rad[static_cast<std::size_t>(f)];
  return 0;
}

std::vector<MeasuredLength> measurable_lengths(const RibbonPattern& pattern, double marker_spacing_mm, int zipped,
                                               int flat, double sigma_mm) {
  const int marks = static_cast<int>(pattern.zipper_mm / marker_spacing_mm) + 1;
  const auto predicted = [&](int number) {
    return zipper_place(pattern, number * marker_spacing_mm).interpolate(pattern, [&](const SeamPair& pair) {
      return Vec3(pattern.predicted_mm.row(pair.left).transpose());
    });
  };
  std::vector<MeasuredLength> all, lengths;
  // Of several thousand marks, some hundreds spread evenly.
  const int stride = std::max(1, marks / 200);
  for (int a = 0; a < marks; a += stride)
    for (int b = a + stride; b < marks; b += stride)
      if ((predicted(a) - predicted(b)).norm() > min_share_of_size * pattern.size_mm)
        all.push_back({{a, true}, {b, true}, false, 0, sigma_mm});
  const auto count = static_cast<std::size_t>(std::max(zipped, 0));
  for (std::size_t i = 0; i < std::min(count, all.size()); ++i)
    lengths.push_back(all[i * all.size() / std::min(count, all.size())]);
  const int steps = std::min(std::max(flat, 0), marks);
  for (int i = 0; i < steps; ++i) {
    const int number = static_cast<int>(static_cast<long long>(i) * marks / steps);
    MeasuredLength length{{number, true}, {std::min(number + marks_along, marks - 1), true}, true, 0, sigma_mm};
    if (i % 2 == 0) {
      // Across, to the nearest mark of the other side.
      const Vec2 from = flat_place(pattern, length.from, marker_spacing_mm);
      double nearest = -1;
      for (int other = 0; other < marks; ++other) {
        const double distance = (flat_place(pattern, {other, false}, marker_spacing_mm) - from).norm();
        if (nearest < 0 || distance < nearest) nearest = distance, length.to = {other, false};
      }
    }
    const bool one_place = length.to.left && length.to.number == length.from.number,
               across = (flat_place(pattern, length.to, marker_spacing_mm) -
                         flat_place(pattern, length.from, marker_spacing_mm))
                            .norm() < max_widths * pattern.width_mm;
    if (!one_place && (length.to.left || across) &&
        std::abs(piece_turn(pattern, length.from, marker_spacing_mm) -
                 piece_turn(pattern, length.to, marker_spacing_mm)) < same_turn_rad)
      lengths.push_back(length);
  }
  return lengths;
}

}  // namespace formwright
