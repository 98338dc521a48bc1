// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/pieces/zipper_offset.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "base/format.h"
#include "geometry/planar/plane.h"
#include "base/error.h"
#include "fabrication/planar/polygon.h"
#include "zippable/ribbon/ribbon.h"

namespace formwright {
namespace {

/// Unit vectors to the left of the zipper along the formed ribbon, per sample: across the mean of the triangles on both
/// sides.
std::vector<Vec3> left_along_surface(const FlatDesign& design) {
  std::vector<Vec3> normal(design.left_vertex.size(), Vec3::Zero()), left = normal;
  for (Eigen::Index f = 0; f < design.F.rows(); ++f) {
    const auto p = [&](int k) -> const Vec3& { return design.boundary[design.F(f, k)].position_mm; };
    const Vec3 area = (p(1) - p(0)).cross(p(2) - p(0));
    for (int k = 0; k < 3; ++k)
      if (const int sample = design.boundary[design.F(f, k)].sample; sample >= 0) normal[sample] += area;
  }
  for (const auto& piece : design.pieces)
    for (std::size_t k = 0; k < piece.size(); ++k) {
      const auto position = [&](std::size_t i) -> const Vec3& {
        return design.boundary[design.left_vertex[piece[i]]].position_mm;
      };
      const Vec3 along = position(std::min(k + 1, piece.size() - 1)) - position(k > 0 ? k - 1 : 0);
      const Vec3 across = normal[piece[k]].cross(along);
      left[piece[k]] = across.norm() > 0 ? Vec3(across.normalized()) : k > 0 ? left[piece[k - 1]] : Vec3(Vec3::UnitX());
    }
  return left;
}

/// Changes directions `from` to `end` (excluded) by least squares so that t . (d[i + 1] - d[i]) = 0 on every segment, t
/// its direction: then offsets to both sides are equally long.
void make_sides_equal(const std::vector<Vec3>& points, std::size_t from, std::size_t end,
                      std::vector<Vec3>& directions) {
  const std::size_t count = end - from;
  if (count < 2) return;
  std::vector<Vec3> along;
  for (std::size_t i = from; i + 1 < end; ++i) {
    const Vec3 step = points[i + 1] - points[i];
    along.push_back(step.norm() > 0 ? Vec3(step.normalized()) : Vec3(Vec3::Zero()));
  }
  // Normal equations of the constraints: tridiagonal, 2 on the diagonal, minus the cosine between neighbouring segments
  // beside it.
  const std::size_t rows = along.size();
  std::vector<double> diagonal(rows), upper(rows, 0.0), value(rows);
  for (std::size_t i = 0; i < rows; ++i) {
    const bool empty = along[i].isZero();
    diagonal[i] = empty ? 1 : 2;
    value[i] = empty ? 0 : along[i].dot(directions[from + i + 1] - directions[from + i]);
    if (i > 0) {
      const double beside = -along[i - 1].dot(along[i]), factor = beside / diagonal[i - 1];
      upper[i - 1] = beside;
      diagonal[i] -= factor * beside;
      value[i] -= factor * value[i - 1];
    }
  }
  for (std::size_t i = rows; i-- > 0;)
    value[i] = (value[i] - (i + 1 < rows ? upper[i] * value[i + 1] : 0.0)) / diagonal[i];
  for (std::size_t i = 0; i < rows; ++i) {
    directions[from + i] += value[i] * along[i];
    directions[from + i + 1] -= value[i] * along[i];
  }
}

/// Twice the areas after and before, of triangle f.
using AreaPair = std::pair<double, double>;

/// Lets shares rise and fall along the zipper only so fast that the moved edge leaves the old one's direction by a
/// tenth.
void smooth_shares(const FlatDesign& design, double offset_mm, std::vector<double>& shares) {
  for (const auto& piece : design.pieces) {
    const auto limit = [&](int at, int beside) {
      const double rise = 0.1 * std::abs(design.arclength_mm[at] - design.arclength_mm[beside]) / std::abs(offset_mm);
      shares[at] = std::min(shares[at], shares[beside] + rise);
    };
    for (std::size_t k = 1; k < piece.size(); ++k) limit(piece[k], piece[k - 1]);
    for (std::size_t k = piece.size() - 1; k-- > 0;) limit(piece[k], piece[k + 1]);
  }
}

/// Lowers shares at triangles that would lose too much of their area, until none does. False: at some no share was left
/// to lower.
bool make_room(const FlatDesign& design, double offset_mm, OffsetRibbon& ribbon, const std::function<void()>& move,
               const std::function<AreaPair(Eigen::Index)>& areas) {
  bool all_have_room = true;
  for (int round = 0;; ++round) {
    move();
    all_have_room = true;
    std::vector<char> too_wide(ribbon.offset_share.size(), 0);
    bool any = false;
    for (Eigen::Index f = 0; f < design.F.rows(); ++f) {
      const auto [after, before] = areas(f);
      if (after >= 0.1 * before) continue;
      all_have_room = false;
      for (int k = 0; k < 3; ++k)
        if (const int sample = design.boundary[design.F(f, k)].sample; sample >= 0 && ribbon.offset_share[sample] > 0)
          too_wide[sample] = 1, any = true;
    }
    if (!any) break;
    for (std::size_t s = 0; s < too_wide.size(); ++s)
      if (too_wide[s]) ribbon.offset_share[s] = round < 16 ? 0.8 * ribbon.offset_share[s] : 0.0;
    smooth_shares(design, offset_mm, ribbon.offset_share);
  }
  for (const double share : ribbon.offset_share) {
    if (share < 1) ++ribbon.narrow_samples;
    ribbon.min_share = std::min(ribbon.min_share, share);
  }
  return all_have_room;
}

void move_in_plane(const FlatDesign& design, double offset_mm, OffsetRibbon& ribbon) {
  Polygon outline;
  std::vector<double> distances;
  for (int v = 0; v < design.vertex_count(); ++v) {
    outline.push_back(design.boundary[v].flat_mm);
    distances.push_back(design.zipper_edge(v) ? offset_mm : 0.0);
  }
  const std::vector<Vec2> steps = offset_steps(outline, distances);
  const auto move = [&] {
    ribbon.flat_mm = outline;
    for (std::size_t v = 0; v < outline.size(); ++v)
      if (const int sample = design.boundary[v].sample; sample >= 0)
        ribbon.flat_mm[v] += ribbon.offset_share[sample] * steps[v];
  };
  const auto area = [&](const std::vector<Vec2>& flat, Eigen::Index f) {
    return cross(flat[design.F(f, 1)] - flat[design.F(f, 0)], flat[design.F(f, 2)] - flat[design.F(f, 0)]);
  };
  make_room(design, offset_mm, ribbon, move,
            [&](Eigen::Index f) { return AreaPair(area(ribbon.flat_mm, f), area(outline, f)); });
}

void move_in_space(const FlatDesign& design, double offset_mm, OffsetRibbon& ribbon) {
  const std::vector<Vec3> surface = left_along_surface(design);
  std::vector<Vec3> direction(surface.size(), Vec3::Zero()), steps = direction, positions;
  std::vector<std::vector<Vec3>> points(design.pieces.size());
  double usable_mm = 0;
  for (std::size_t p = 0; p < design.pieces.size(); ++p) {
    const auto& piece = design.pieces[p];
    std::vector<Vec3> lefts;
    for (const int sample : piece)
      points[p].push_back(design.boundary[design.left_vertex[sample]].position_mm), lefts.push_back(surface[sample]);
    const BinormalField field = binormals(points[p], lefts, 2 * offset_mm);
    for (std::size_t k = 0; k < piece.size(); ++k) direction[piece[k]] = field.left[k];
    for (std::size_t k = 0; k + 1 < piece.size(); ++k)
      if (field.usable[k] && field.usable[k + 1]) usable_mm += (points[p][k + 1] - points[p][k]).norm();
  }
  ribbon.binormal_share = usable_mm / std::max(design.zipper_mm, 1e-300);
  bool equal_sides = true;
  const auto move = [&] {
    ribbon.shear_max_mm = 0;
    for (std::size_t p = 0; p < design.pieces.size(); ++p) {
      const auto& piece = design.pieces[p];
      std::vector<Vec3> own;
      for (const int sample : piece) own.push_back(ribbon.offset_share[sample] * direction[sample]);
      const std::vector<Vec3> before = own;
      if (equal_sides) make_sides_equal(points[p], 0, piece.size(), own);
      for (std::size_t k = 0; k < piece.size(); ++k) {
        steps[piece[k]] = own[k];
        ribbon.shear_max_mm = std::max(ribbon.shear_max_mm, offset_mm * (own[k] - before[k]).norm());
      }
    }
    positions.clear();
    for (const FlatVertex& v : design.boundary) {
      positions.push_back(v.position_mm);
      if (v.sample >= 0) positions.back() += (v.left ? 1 : -1) * offset_mm * steps[v.sample];
    }
  };
  const auto areas = [&](Eigen::Index f) {
    const int a = design.F(f, 0), b = design.F(f, 1), c = design.F(f, 2);
    const auto old = [&](int v) -> const Vec3& { return design.boundary[v].position_mm; };
    const Vec3 before = (old(b) - old(a)).cross(old(c) - old(a)),
               after = (positions[b] - positions[a]).cross(positions[c] - positions[a]);
    return AreaPair(before.norm() > 0 ? after.dot(before.normalized()) : 0.0, before.norm());
  };
  // Where the ribbon is too narrow even for the change that makes sides equal, or that would be larger than the offset,
  // they stay unequal.
  if (!make_room(design, offset_mm, ribbon, move, areas) || ribbon.shear_max_mm > offset_mm) {
    equal_sides = false;
    ribbon.offset_share.assign(ribbon.offset_share.size(), 1.0);
    ribbon.narrow_samples = 0, ribbon.min_share = 1;
    make_room(design, offset_mm, ribbon, move, areas);
  }
  ribbon.sides_made_equal = equal_sides;
  ribbon.flat_mm = unfold(positions, design.F);
}

}  // namespace

ZipperModel zipper_model(const PlanOptions& options) {
  // Per side, of common coil zippers; the number is about the width of the closed teeth.
  constexpr ZipperModel coils[] = {{0, 0, 0}, {11.5, 4.2, 0.8}, {13.5, 6.0, 1.0}, {15.5, 7.6, 1.2}};
  ZipperModel model = coils[static_cast<int>(options.coil)];
  model.tape_width_mm = options.tape_width_mm.value_or(model.tape_width_mm);
  model.teeth_width_mm = options.teeth_width_mm.value_or(model.teeth_width_mm);
  model.gap_mm = options.gap_mm.value_or(model.gap_mm);
  return model;
}

BinormalField binormals(const std::vector<Vec3>& points, const std::vector<Vec3>& left_on_surface, double window_mm) {
  constexpr double min_sine = 0.02, min_along_surface = 0.5;
  const std::size_t count = points.size();
  BinormalField field{left_on_surface, std::vector<char>(count, 0)};
  std::vector<double> at(count, 0.0);
  for (std::size_t i = 1; i < count; ++i) at[i] = at[i - 1] + (points[i] - points[i - 1]).norm();
  for (std::size_t i = 1; i + 1 < count; ++i)
    for (double window = window_mm; !field.usable[i]; window *= 2) {
      // Near an end both windows are as long as the shorter one.
      std::size_t behind = 1, ahead = 1;
      while (behind < i && i + ahead + 1 < count && at[i] - at[i - behind] < window && at[i + ahead] - at[i] < window)
        ++behind, ++ahead;
      const Vec3 a = points[i] - points[i - behind], b = points[i + ahead] - points[i], c = a.cross(b);
      if (c.norm() > min_sine * a.norm() * b.norm()) {
        const Vec3 binormal = c.normalized() * (c.dot(left_on_surface[i]) < 0 ? -1.0 : 1.0);
        if (binormal.dot(left_on_surface[i]) < min_along_surface) break;
        field.left[i] = binormal;
        field.usable[i] = 1;
      }
      if (window > 8 * window_mm || behind == i || i + ahead + 1 == count) break;
    }
  if (count > 2 && field.usable[1]) field.left[0] = field.left[1], field.usable[0] = 1;
  if (count > 2 && field.usable[count - 2]) field.left[count - 1] = field.left[count - 2], field.usable[count - 1] = 1;
  for (std::size_t i = 0; i < count;) {
    std::size_t end = i;
    while (end < count && field.usable[end]) ++end;
    make_sides_equal(points, i, end, field.left);
    i = std::max(end, i + 1);
  }
  return field;
}

/// Of the zipper's length, what belongs to samples at which the edge is moved by less.
static double narrow_length_mm(const FlatDesign& design, const std::vector<double>& shares) {
  double sum = 0;
  for (const auto& piece : design.pieces)
    for (std::size_t k = 1; k < piece.size(); ++k) {
      const double step = std::abs(design.arclength_mm[piece[k]] - design.arclength_mm[piece[k - 1]]);
      for (const int end : {piece[k - 1], piece[k]}) sum += shares[end] < 1 ? 0.5 * step : 0;
    }
  return sum;
}

OffsetRibbon offset_ribbon(const FlatDesign& design, ZipperOffset method, double offset_mm) {
  OffsetRibbon ribbon;
  ribbon.offset_share.assign(design.left_vertex.size(), 1.0);
  for (const FlatVertex& v : design.boundary) ribbon.flat_mm.push_back(v.flat_mm);
  if (offset_mm < 0 && method == ZipperOffset::gluing)
    throw Error(
        ErrorCode::invalid_input, "seam_take_up_mm",
        "For gluing the edges cannot be moved outwards: choose sewing, a wider gap, or less cloth lost in seams.");
  if (offset_mm != 0) {
    if (method == ZipperOffset::sewing) move_in_plane(design, offset_mm, ribbon);
    else move_in_space(design, offset_mm, ribbon);
  }
  ribbon.narrow_mm = narrow_length_mm(design, ribbon.offset_share);
  for (const double share : ribbon.offset_share)
    ribbon.offset_mean_mm += offset_mm * share / static_cast<double>(ribbon.offset_share.size());
  if (std::abs(ribbon.offset_mean_mm) < 0.5 * std::abs(offset_mm)) {
    throw Error(ErrorCode::invalid_input, "coil",
                "The ribbon is too narrow for this zipper, whose sides need " +
                    with_decimals(2 * std::abs(offset_mm), 1) +
                    " mm together: choose a smaller coil or a wider ribbon.");
  }
  for (int v = 0; v < design.vertex_count(); ++v)
    if (design.zipper_edge(v))
      (design.boundary[v].left ? ribbon.left_mm : ribbon.right_mm) +=
          (ribbon.flat_mm[design.next(v)] - ribbon.flat_mm[v]).norm();
  return ribbon;
}

}  // namespace formwright
