// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/pieces/markers.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace formwright {
namespace {

/// A place between two samples of the zipper that follow each other.
struct ZipperPlace {
  int before, after;
  double share;  // of the distance from one to the other
};

class Side {
 public:
  Side(const FlatDesign& design, const std::vector<Vec2>& flat, bool left)
      : flat_(flat), vertex_(left ? design.left_vertex : design.right_vertex), left_(left), length_(vertex_.size(), 0) {
    double length = 0;
    for (const auto& piece : design.pieces)
      for (std::size_t k = 0; k < piece.size(); ++k) {
        if (k > 0) length += (at(piece[k]) - at(piece[k - 1])).norm();
        length_[piece[k]] = length;
      }
  }

  double length_mm(const ZipperPlace& place) const {
    return length_[place.before] + place.share * (length_[place.after] - length_[place.before]);
  }

  SideMark mark(const ZipperPlace& place) const {
    const Vec2 segment =
        (left_ ? 1 : -1) * (at(place.after) - at(place.before));  // the boundary runs back along the right side
    const Vec2 along = segment.norm() > 0 ? Vec2(segment.normalized()) : Vec2(1, 0);
    return {at(place.before) + place.share * (at(place.after) - at(place.before)), along, Vec2(-along.y(), along.x()),
            vertex_[left_ ? place.before : place.after]};
  }

 private:
  const Vec2& at(int sample) const { return flat_[vertex_[sample]]; }

  const std::vector<Vec2>& flat_;
  const std::vector<int>& vertex_;
  bool left_;
  std::vector<double> length_;  // per sample
};

}  // namespace

SideMark side_mark(const FlatDesign& design, const std::vector<Vec2>& flat_mm, bool left, double arclength_mm) {
  const Side side(design, flat_mm, left);
  ZipperPlace place{design.pieces[0][0], design.pieces[0][1], 0};
  for (const auto& piece : design.pieces)
    for (std::size_t k = 0; k + 1 < piece.size(); ++k) {
      const double from = design.arclength_mm[piece[k]], to = design.arclength_mm[piece[k + 1]];
      if (from > arclength_mm || !(to > from)) continue;
      place = {piece[k], piece[k + 1], std::min(1.0, (arclength_mm - from) / (to - from))};
    }
  return side.mark(place);
}

Markers place_markers(const FlatDesign& design, const OffsetRibbon& ribbon, double spacing_mm) {
  if (design.zipper_mm / spacing_mm > 9999)
    throw Error(ErrorCode::invalid_input, "marker_spacing_mm",
                "That would be more than 9999 markers: place them farther apart.");
  Markers result;
  const Side left(design, ribbon.flat_mm, true), right(design, ribbon.flat_mm, false);
  double last_arclength = 0, last_left = 0, last_right = 0;
  const auto end_interval = [&](double arclength, const ZipperPlace& place) {
    const double l = left.length_mm(place), r = right.length_mm(place);
    result.intervals.push_back({arclength - last_arclength, l - last_left, r - last_right});
    last_arclength = arclength, last_left = l, last_right = r;
  };
  ZipperPlace place{0, 0, 0};
  for (const auto& piece : design.pieces)
    for (std::size_t k = 0; k + 1 < piece.size(); ++k) {
      const double from = design.arclength_mm[piece[k]], to = design.arclength_mm[piece[k + 1]];
      for (;;) {
        const int number = static_cast<int>(result.markers.size());
        const double arclength = number * spacing_mm;
        if (arclength > to) break;
        place = {piece[k], piece[k + 1], to > from ? std::clamp((arclength - from) / (to - from), 0.0, 1.0) : 0.0};
        if (number > 0) end_interval(arclength, place);
        result.markers.push_back({number, arclength, left.mark(place), right.mark(place)});
      }
      place = {piece[k], piece[k + 1], 1};
    }
  if (design.zipper_mm > last_arclength) end_interval(design.zipper_mm, place);
  return result;
}

}  // namespace formwright
