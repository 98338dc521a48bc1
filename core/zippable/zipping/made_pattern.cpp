// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/zipping/made_pattern.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "geometry/mesh/adjacency.h"

namespace formwright {
namespace {

/// Closed runs of the border, the cloth on the left.
std::vector<std::vector<int>> border_loops(const RibbonPattern& pattern) {
  std::vector<int> next(static_cast<std::size_t>(pattern.flat.vertex_count()), -1);
  for (const auto& [a, b] : border_edges(pattern)) next[static_cast<std::size_t>(a)] = b;
  std::vector<std::vector<int>> loops;
  for (std::size_t start = 0; start < next.size(); ++start) {
    std::vector<int> loop;
    for (int v = static_cast<int>(start); next[static_cast<std::size_t>(v)] >= 0;) {
      loop.push_back(v);
      v = std::exchange(next[static_cast<std::size_t>(v)], -1);
    }
    if (!loop.empty()) loops.push_back(std::move(loop));
  }
  return loops;
}

double twice_area(const std::array<Vec2, 3>& p) {
  const Vec2 a = p[1] - p[0], b = p[2] - p[0];
  return a.x() * b.y() - a.y() * b.x();
}

/// How far, up to 1, a triangle's corners may go along `steps` before it has lost all but a tenth of its area.
double room(const std::array<Vec2, 3>& p, const std::array<Vec2, 3>& steps) {
  constexpr double kept = 0.1;
  const auto area = [&](double share) {
    return twice_area({p[0] + share * steps[0], p[1] + share * steps[1], p[2] + share * steps[2]});
  };
  const double least = kept * area(0);
  if (area(1) >= least) return 1;
  double low = 0, high = 1;
  for (int k = 0; k < 40; ++k) {
    const double middle = 0.5 * (low + high);
    (area(middle) >= least ? low : high) = middle;
  }
  return low;
}

/// Moves vertices by `steps`, by less around triangles that would be left without area: cloth ends in points.
void move_where_there_is_room(RibbonPattern& pattern, std::vector<Vec2>& steps) {
  constexpr int rounds = 40;
  const Triangles& F = pattern.flat.F;
  for (int round = 0;; ++round) {
    std::vector<double> share(steps.size(), 1);
    bool enough = true;
    for (Eigen::Index f = 0; f < F.rows(); ++f) {
      std::array<Vec2, 3> p, step;
      for (int k = 0; k < 3; ++k) {
        p[static_cast<std::size_t>(k)] = pattern.flat.V.row(F(f, k)).head<2>();
        step[static_cast<std::size_t>(k)] = steps[static_cast<std::size_t>(F(f, k))];
      }
      const double has = room(p, step);
      if (has >= 1) continue;
      enough = false;
      for (int k = 0; k < 3; ++k) {
        double& of_vertex = share[static_cast<std::size_t>(F(f, k))];
        of_vertex = std::min(of_vertex, has);
      }
    }
    if (enough) break;
    for (std::size_t v = 0; v < steps.size(); ++v) steps[v] *= round < rounds ? share[v] : 0.0;
  }
  for (std::size_t v = 0; v < steps.size(); ++v)
    pattern.flat.V.row(static_cast<Eigen::Index>(v)).head<2>() += steps[v].transpose();
}

/// Across the edges, not along them: what is sewn together must keep its length. So corners are moved less far than
/// where the moved edges would meet.
void move_edges(RibbonPattern& pattern, const MakingErrors& errors) {
  const ZipperSides sides(pattern);
  constexpr double max_mitre = 1.3;
  std::vector<Vec2> of_vertex(static_cast<std::size_t>(pattern.flat.vertex_count()), Vec2::Zero());
  for (const std::vector<int>& loop : border_loops(pattern)) {
    const std::size_t n = loop.size();
    std::vector<Vec2> outwards(n, Vec2::Zero());
    std::vector<double> by(n);
    for (std::size_t i = 0; i < n; ++i) {
      const int a = loop[i], b = loop[(i + 1) % n];
      const Vec2 edge = (pattern.flat.V.row(b) - pattern.flat.V.row(a)).head<2>();
      if (edge.norm() > 0) outwards[i] = Vec2(edge.y(), -edge.x()).normalized();
      by[i] = sides.zipper_edge(pattern, a, b) ? errors.edge_shift_mm() : -0.5 * errors.more_kerf_mm;
    }
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t before = (i + n - 1) % n;
      const double cosine = outwards[before].dot(outwards[i]);
      of_vertex[static_cast<std::size_t>(loop[i])] =
          by[before] == by[i] ? Vec2(by[i] * (outwards[before] + outwards[i]) / std::max(1 + cosine, 2 / max_mitre))
          : std::abs(by[before]) > std::abs(by[i]) ? Vec2(by[before] * outwards[before])
                                                   : Vec2(by[i] * outwards[i]);
    }
  }
  move_where_there_is_room(pattern, of_vertex);
}

}  // namespace

std::vector<std::array<int, 2>> border_edges(const RibbonPattern& pattern) {
  const Adjacency adjacency(pattern.flat);
  std::vector<std::array<int, 2>> edges;
  for (int h = 0; h < 3 * adjacency.face_count(); ++h)
    if (adjacency.opposite(h) < 0) edges.push_back({adjacency.from(h), adjacency.to(h)});
  return edges;
}

ZipperSides::ZipperSides(const RibbonPattern& pattern)
    : along_mm(static_cast<std::size_t>(pattern.flat.vertex_count()), -1), left(along_mm.size(), 0) {
  for (const SeamPair& seam : pattern.seams) {
    along_mm[static_cast<std::size_t>(seam.left)] = along_mm[static_cast<std::size_t>(seam.right)] = seam.along_mm;
    left[static_cast<std::size_t>(seam.left)] = 1;
  }
}

bool ZipperSides::zipper_edge(const RibbonPattern& pattern, int a, int b) const {
  const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
  if (along_mm[i] < 0 || along_mm[j] < 0 || left[i] != left[j]) return false;
  // Where a stretch ends the next one begins at the same length of zipper, across an opening.
  const double length = (pattern.flat.V.row(a) - pattern.flat.V.row(b)).norm();
  return std::abs(along_mm[i] - along_mm[j]) > 0.5 * length;
}

RibbonPattern made_pattern(const RibbonPattern& designed, const MakingErrors& errors) {
  RibbonPattern pattern = designed;
  if (errors.edge_shift_mm() != 0 || errors.more_kerf_mm != 0) move_edges(pattern, errors);
  if (!errors.changes_the_cloth()) return pattern;
  const Eigen::Matrix2d change = errors.cloth_change();
  if (!(change.determinant() > 0))
    throw Error(ErrorCode::could_not_solve, "", "The cloth has no area when it is pulled askew this far.");
  pattern.cloth_change.assign(static_cast<std::size_t>(pattern.flat.F.rows()), change);
  for (std::size_t f = 0; f < pattern.turn_of_triangle_rad.size(); ++f) {
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(pattern.turn_of_triangle_rad[f]).toRotationMatrix();
    pattern.cloth_change[f] = turn.transpose() * change * turn;
  }
  return pattern;
}

}  // namespace formwright
