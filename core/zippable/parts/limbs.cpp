// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/parts/limbs.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "geometry/paths/geodesic_distance.h"
#include "zippable/parts/limb_tips.h"

namespace formwright {
namespace {

constexpr double min_prominence = 0.03;                              // of the largest mean distance
constexpr int loops_of_sweep = 160;                                  // from the tip to the farthest place
constexpr double min_share_of_area = 0.01, max_share_of_area = 0.5;  // of the whole: what is larger is the body
constexpr double farther = 1.35;             // times the distance of a loop: between them its growth is compared
constexpr double min_widening = 0.15;        // 0 for plane, cone and tube
constexpr double min_ratio = 0.18;           // area over squared length of the loop: 0.159 for a hemisphere
constexpr double max_share_of_others = 0.1;  // of the loop's length: a neck is one loop
constexpr double transition_share = 1.0 / 6, drawn_together = 0.2;

using EdgeEnds = std::pair<int, int>;

/// Across one triangle, from the edge between two vertices to another one.
struct LoopPiece {
  Vec3 from, to;
  EdgeEnds from_edge, to_edge;
};

/// The boundary of a geodesic ball about the tip.
struct LevelLoop {
  std::vector<LoopPiece> pieces;
  double distance_mm = 0, length_mm = 0, area_mm2 = 0;  // area: of the ball
  Vec3 centre = Vec3::Zero(), area_vector = Vec3::Zero(), ball_centre = Vec3::Zero();
  double ratio() const { return area_mm2 / std::max(length_mm * length_mm, 1e-300); }
};

LevelLoop level_loop(const TriangleMesh& mesh, const Eigen::VectorXd& distance, double level) {
  LevelLoop loop;
  loop.distance_mm = level;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    std::array<Vec3, 3> p;
    std::array<double, 3> d;
    int inside = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = mesh.V.row(mesh.F(f, static_cast<Eigen::Index>(k)));
      d[k] = distance[mesh.F(f, static_cast<Eigen::Index>(k))] - level;
      inside += d[k] < 0;
    }
    if (inside == 0) continue;
    const double whole = 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).norm();
    const Vec3 middle = (p[0] + p[1] + p[2]) / 3;
    if (inside == 3) {
      loop.area_mm2 += whole, loop.ball_centre += whole * middle;
      continue;
    }
    // The corner that is alone on its side.
    std::size_t lone = 0;
    while ((d[lone] < 0) != (inside == 1)) ++lone;
    const std::size_t next = (lone + 1) % 3, last = (lone + 2) % 3;
    const double s = d[lone] / (d[lone] - d[next]), t = d[lone] / (d[lone] - d[last]);
    const double area = inside == 1 ? s * t * whole : (1 - s * t) * whole;
    loop.area_mm2 += area, loop.ball_centre += area * middle;
    const Vec3 a = p[lone] + s * (p[next] - p[lone]), b = p[lone] + t * (p[last] - p[lone]);
    const auto edge_to = [&](std::size_t other) -> EdgeEnds {
      return std::minmax({mesh.F(f, static_cast<Eigen::Index>(lone)), mesh.F(f, static_cast<Eigen::Index>(other))});
    };
    loop.pieces.push_back({a, b, edge_to(next), edge_to(last)});
    if (inside == 2) std::swap(loop.pieces.back().from, loop.pieces.back().to);  // the ball lies to the left
  }
  for (const LoopPiece& piece : loop.pieces) {
    const double length = (piece.to - piece.from).norm();
    loop.length_mm += length;
    loop.centre += 0.5 * length * (piece.from + piece.to);
  }
  loop.centre /= std::max(loop.length_mm, 1e-300);
  loop.ball_centre /= std::max(loop.area_mm2, 1e-300);
  for (const LoopPiece& piece : loop.pieces)
    loop.area_vector += 0.5 * (piece.from - loop.centre).cross(piece.to - loop.centre);
  return loop;
}

/// Of the length, what does not belong to the longest of the closed curves.
double share_of_others(const LevelLoop& loop) {
  std::map<EdgeEnds, EdgeEnds> above;
  const auto root = [&](EdgeEnds edge) {
    for (auto at = above.try_emplace(edge, edge).first; at->second != edge; at = above.find(edge)) edge = at->second;
    return edge;
  };
  for (const LoopPiece& piece : loop.pieces) above[root(piece.from_edge)] = root(piece.to_edge);
  std::map<EdgeEnds, double> length;
  double longest = 0;
  for (const LoopPiece& piece : loop.pieces)
    longest = std::max(longest, length[root(piece.from_edge)] += (piece.to - piece.from).norm());
  return 1 - longest / std::max(loop.length_mm, 1e-300);
}

/// How much faster the loops get longer beyond a distance than before it, by logarithms.
double widening(const std::vector<LevelLoop>& loops, std::size_t at) {
  const auto log_length = [&](double index) {
    const auto below = static_cast<std::size_t>(index);
    const double share = index - static_cast<double>(below);
    return std::log((1 - share) * loops[below].length_mm + share * loops[below + 1].length_mm);
  };
  // loops[i] has i + 1 steps of distance.
  const double steps = static_cast<double>(at + 1);
  return log_length(farther * steps - 1) - 2 * std::log(loops[at].length_mm) + log_length(steps / farther - 1);
}

std::optional<LevelLoop> neck_of(const TriangleMesh& mesh, const Eigen::VectorXd& distance, double whole_mm2,
                                 const Context& context) {
  const double farthest = distance.maxCoeff();
  std::vector<LevelLoop> loops;
  for (int i = 1; i < loops_of_sweep; ++i) {
    if (i % 16 == 0) context.check_cancelled();
    loops.push_back(level_loop(mesh, distance, farthest * i / loops_of_sweep));
  }
  double widest = min_widening;
  std::size_t body = 0;  // where the first widening is most sudden; 0: there is none
  for (std::size_t i = 1; farther * static_cast<double>(i + 1) < static_cast<double>(loops.size()); ++i) {
    const LevelLoop& loop = loops[i];
    if (loop.area_mm2 > max_share_of_area * whole_mm2) break;
    if (loop.area_mm2 < min_share_of_area * whole_mm2 || loop.ratio() < min_ratio) continue;
    const double w = widening(loops, i);
    if (body > 0 && w < min_widening) break;
    if (w > widest) widest = w, body = i;
  }
  if (body == 0) return {};
  std::size_t neck = body;
  for (std::size_t i = 0; i <= body; ++i)
    if (loops[i].ratio() > loops[neck].ratio()) neck = i;
  if (loops[neck].area_mm2 < min_share_of_area * whole_mm2 || share_of_others(loops[neck]) > max_share_of_others)
    return {};
  return loops[neck];
}

/// The tip of one lies in the other.
bool overlap(const Limb& a, const Limb& b) {
  return a.distance_mm[b.tip] < a.length_mm || b.distance_mm[a.tip] < b.length_mm;
}

}  // namespace

std::vector<Limb> find_limbs(const TriangleMesh& mesh, int max_count, Context& context) {
  if (mesh.vertex_count() == 0 || mesh.face_count() == 0) return {};
  const Adjacency adjacency(mesh);
  const Eigen::VectorXd mean = mean_distance_mm(mesh, adjacency, context);
  const double whole_mm2 = surface_area(mesh);
  std::vector<Limb> limbs;
  for (const LimbTip& tip : prominent_maxima(adjacency, mean, min_prominence * mean.maxCoeff())) {
    Limb limb;
    limb.tip = tip.vertex;
    limb.distance_mm = geodesic_distance_mm(mesh, adjacency, {tip.vertex});
    const auto neck = neck_of(mesh, limb.distance_mm, whole_mm2, context);
    if (!neck || !(neck->area_vector.norm() > 0)) continue;
    limb.length_mm = neck->distance_mm, limb.neck_mm = neck->length_mm, limb.area_mm2 = neck->area_mm2;
    limb.centre = neck->centre;
    limb.towards = neck->area_vector.normalized();
    if (limb.towards.dot(neck->ball_centre - neck->centre) < 0) limb.towards = -limb.towards;
    limbs.push_back(std::move(limb));
  }
  std::stable_sort(limbs.begin(), limbs.end(), [](const Limb& a, const Limb& b) { return a.area_mm2 > b.area_mm2; });
  std::vector<Limb> apart;
  for (Limb& limb : limbs) {
    if (static_cast<int>(apart.size()) == max_count) break;
    if (std::none_of(apart.begin(), apart.end(), [&](const Limb& larger) { return overlap(larger, limb); }))
      apart.push_back(std::move(limb));
  }
  return apart;
}

Positions tucked_in(const Positions& x, const Limb& limb) {
  Positions tucked = x;
  for (Eigen::Index v = 0; v < x.rows(); ++v) {
    const double beyond = (limb.length_mm - limb.distance_mm[v]) / (transition_share * limb.length_mm);
    if (!(beyond > 0)) continue;
    const double s = std::min(beyond, 1.0), share = s * s * (3 - 2 * s);
    const Vec3 from_centre = x.row(v).transpose() - limb.centre, along = limb.towards.dot(from_centre) * limb.towards;
    const Vec3 drawn = (1 - drawn_together * 4 * share * (1 - share)) * (from_centre - along);
    tucked.row(v) = limb.centre + (1 - 2 * share) * along + drawn;
  }
  return tucked;
}

}  // namespace formwright
