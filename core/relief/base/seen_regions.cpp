// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/base/seen_regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "geometry/planar/plane.h"

namespace formwright {
namespace {

constexpr double min_crossing = 1e-6;   // in depth: two faces that cross by less touch
constexpr double min_ring_area = 1e-8;  // of a ring: rounding leaves some, here others than on another computer
constexpr double same_depth = 1e-12;
constexpr double sliver = 2e-8;  // wider than what rounding leaves between areas that meet

/// A face turned counter-clockwise, with its depth as a plane over it.
struct FlatFace {
  std::array<Vec2, 3> corner;
  double depth_at_first = 0;
  Vec2 slope{0, 0};
  std::array<int, 3> vertex;

  double depth(const Vec2& p) const { return depth_at_first + slope.dot(p - corner[0]); }
  Vec2 low() const { return corner[0].cwiseMin(corner[1]).cwiseMin(corner[2]); }
  Vec2 high() const { return corner[0].cwiseMax(corner[1]).cwiseMax(corner[2]); }
};

std::vector<FlatFace> flat_faces(const TriangleMesh& surface) {
  std::vector<FlatFace> faces;
  for (Eigen::Index f = 0; f < surface.F.rows(); ++f) {
    FlatFace face;
    std::array<double, 3> z;
    for (std::size_t k = 0; k < 3; ++k) {
      const int v = surface.F(f, static_cast<Eigen::Index>(k));
      face.vertex[k] = v;
      face.corner[k] = surface.V.row(v).head<2>().transpose();
      z[k] = surface.V(v, 2);
    }
    Vec2 ab = face.corner[1] - face.corner[0], ac = face.corner[2] - face.corner[0];
    const double twice = cross(ab, ac);
    if (twice == 0) continue;
    const double dab = z[1] - z[0], dac = z[2] - z[0];
    face.slope = Vec2(dab * ac.y() - dac * ab.y(), dac * ab.x() - dab * ac.x()) / twice;
    face.depth_at_first = z[0];
    if (twice < 0) {
      std::swap(face.corner[1], face.corner[2]);
      std::swap(face.vertex[1], face.vertex[2]);
    }
    faces.push_back(face);
  }
  return faces;
}

/// The borders of all faces together, as closed lines: what two faces share cancels.
std::vector<std::vector<Vec2>> borders_of(const std::vector<FlatFace>& faces) {
  std::map<std::pair<int, int>, int> count;
  std::map<int, Vec2> place;
  for (const FlatFace& face : faces)
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = face.vertex[k], b = face.vertex[(k + 1) % 3];
      place[a] = face.corner[k];
      const auto back = count.find({b, a});
      if (back == count.end()) ++count[{a, b}];
      else if (--back->second == 0) count.erase(back);
    }
  std::map<int, std::vector<int>> next;
  for (const auto& [edge, times] : count)
    next[edge.first].insert(next[edge.first].end(), static_cast<std::size_t>(times), edge.second);
  std::vector<std::vector<Vec2>> lines;
  while (!next.empty()) {
    const int first = next.begin()->first;
    std::vector<Vec2> line;
    int at = first;
    do {
      line.push_back(place.at(at));
      const auto leaving = next.find(at);
      at = leaving->second.back();
      leaving->second.pop_back();
      if (leaving->second.empty()) next.erase(leaving);
    } while (at != first);
    lines.push_back(std::move(line));
  }
  return lines;
}

/// The common part of two triangles (Sutherland and Hodgman 1974).
std::vector<Vec2> common_part(const FlatFace& a, const FlatFace& b) {
  std::vector<Vec2> polygon(a.corner.begin(), a.corner.end());
  for (std::size_t k = 0; k < 3 && !polygon.empty(); ++k) {
    const Vec2 from = b.corner[k], along = b.corner[(k + 1) % 3] - from;
    std::vector<Vec2> inside;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec2 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
      const double at_p = cross(along, Vec2(p - from)), at_q = cross(along, Vec2(q - from));
      if (at_p >= 0) inside.push_back(p);
      if ((at_p > 0 && at_q < 0) || (at_p < 0 && at_q > 0)) inside.push_back(p + (q - p) * (at_p / (at_p - at_q)));
    }
    polygon.swap(inside);
  }
  return polygon.size() < 3 ? std::vector<Vec2>{} : polygon;
}

/// Faces of one surface by the squares of a grid that they may reach into.
class FaceGrid {
 public:
  explicit FaceGrid(const std::vector<FlatFace>& faces) : faces_(faces) {
    Vec2 high = Vec2::Constant(-INFINITY);
    for (const FlatFace& face : faces) {
      low_ = low_.cwiseMin(face.low());
      high = high.cwiseMax(face.high());
    }
    side_ = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(faces.size()))), 1, 512);
    cell_ = ((high - low_) / side_).cwiseMax(1e-12);
    cells_.resize(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_));
    for (std::size_t f = 0; f < faces.size(); ++f)
      for_cells(faces[f].low(), faces[f].high(), [&](std::size_t cell) { cells_[cell].push_back(f); });
  }

  /// The faces whose boxes meet that of `face`, ascending.
  std::vector<std::size_t> near(const FlatFace& face) const {
    const Vec2 low = face.low(), high = face.high();
    std::set<std::size_t> found;
    for_cells(low, high, [&](std::size_t cell) {
      for (const std::size_t f : cells_[cell])
        if ((faces_[f].low().array() < high.array()).all() && (faces_[f].high().array() > low.array()).all())
          found.insert(f);
    });
    return {found.begin(), found.end()};
  }

 private:
  template <class Visit>
  void for_cells(const Vec2& low, const Vec2& high, const Visit& visit) const {
    const Vec2 from = (low - low_).cwiseQuotient(cell_), to = (high - low_).cwiseQuotient(cell_);
    if (from.x() > side_ || from.y() > side_ || to.x() < 0 || to.y() < 0) return;
    const auto at = [&](double place) { return std::clamp(static_cast<int>(place), 0, side_ - 1); };
    for (int y = at(from.y()); y <= at(to.y()); ++y)
      for (int x = at(from.x()); x <= at(to.x()); ++x)
        visit(static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(x));
  }

  const std::vector<FlatFace>& faces_;
  Vec2 low_ = Vec2::Constant(INFINITY), cell_{1, 1};
  int side_ = 1;
  std::vector<std::vector<std::size_t>> cells_;
};

/// Where `upper` is before `lower`. Only what `lower` covers counts. `wins_ties`: so is it at the same depth. `names`:
/// of the parts that must not cross; empty where they may.
Region where_before(const std::vector<FlatFace>& upper, const Region& of_upper, const std::vector<FlatFace>& lower,
                    const FaceGrid& lower_grid, bool wins_ties, const std::string& names, const Context& context) {
  std::vector<std::vector<std::vector<Vec2>>> behind(upper.size());  // of each face, what lies behind `lower`
  bool any_before = false, any_behind = false;
  for (std::size_t f = 0; f < upper.size(); ++f) {
    if (f % 256 == 0) context.check_cancelled();
    for (const std::size_t other : lower_grid.near(upper[f])) {
      std::vector<Vec2> shared = common_part(upper[f], lower[other]);
      double least = INFINITY, largest = -INFINITY;
      for (const Vec2& p : shared) {
        const double gap = lower[other].depth(p) - upper[f].depth(p);
        least = std::min(least, gap);
        largest = std::max(largest, gap);
      }
      if (shared.empty()) continue;
      if (least < -min_crossing && largest > min_crossing && !names.empty())
        throw Error(
            ErrorCode::invalid_input, "base_mesh",
            "Parts " + names +
                " of the base cross each other: move them apart, or take them as one surface (base_mesh_parts).");
      if (least + largest > same_depth || (least + largest >= -same_depth && wins_ties)) any_before = true;
      else {
        any_behind = true;
        behind[f].push_back(std::move(shared));
      }
    }
  }
  if (!any_before) return {};
  if (!any_behind) return of_upper;
  std::vector<std::vector<Vec2>> before;
  for (std::size_t f = 0; f < upper.size(); ++f) {
    const std::vector<Vec2> own(upper[f].corner.begin(), upper[f].corner.end());
    if (behind[f].empty()) before.push_back(own);
    else
      for (std::vector<Vec2>& ring : without(surrounded_by({own}), surrounded_by(behind[f])).rings)
        before.push_back(std::move(ring));
  }
  return grown(grown(surrounded_by(before), sliver), -sliver);
}

}  // namespace

Region outline_of(const TriangleMesh& surface) { return surrounded_by(borders_of(flat_faces(surface))); }

std::vector<Region> seen_regions(const std::vector<TriangleMesh>& surfaces, const std::vector<int>& part,
                                 const Context& context) {
  std::vector<std::vector<FlatFace>> faces;
  std::vector<Region> covered;
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    context.check_cancelled();
    faces.push_back(flat_faces(surfaces[k]));
    covered.push_back(surrounded_by(borders_of(faces.back())));
  }
  std::vector<Region> seen = covered;
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    if (covered[k].empty()) continue;
    const FaceGrid grid(faces[k]);
    const auto [low, high] = covered[k].box();
    for (std::size_t other = 0; other < surfaces.size(); ++other) {
      if (other == k || covered[other].empty()) continue;
      const auto [other_low, other_high] = covered[other].box();
      if ((other_low.array() >= high.array()).any() || (other_high.array() <= low.array()).any()) continue;
      const auto [first, second] = std::minmax(part[k], part[other]);
      const std::string names = first == second ? "" : std::to_string(first + 1) + " and " + std::to_string(second + 1);
      const Region hidden = where_before(faces[other], covered[other], faces[k], grid, other < k, names, context);
      if (!hidden.empty()) seen[k] = without(seen[k], hidden);
    }
  }
  for (Region& region : seen) region = cleaned(region, sliver, min_ring_area);
  return seen;
}

}  // namespace formwright
