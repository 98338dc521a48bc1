// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/base/cut_into_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "geometry/planar/delaunay.h"
#include "geometry/planar/plane.h"
#include "relief/base/piece_list.h"
#include "relief/view/straight_view.h"

namespace formwright {
namespace {

constexpr double min_area = 1e-18;  // of a part of a triangle: smaller ones are rounding

struct Segment {
  Vec2 from, to;
};

/// The borders of all parts, each once, by the squares of a grid.
class Borders {
 public:
  explicit Borders(const BaseParts& parts) {
    std::set<std::array<double, 4>> known;
    for (int part = 0; part < parts.count(); ++part)
      for (const std::vector<Vec2>& ring : parts.seen(part).rings)
        for (std::size_t k = 0; k < ring.size(); ++k) {
          Vec2 a = ring[k], b = ring[(k + 1) % ring.size()];
          if (std::pair(b.x(), b.y()) < std::pair(a.x(), a.y())) std::swap(a, b);
          if (!known.insert({a.x(), a.y(), b.x(), b.y()}).second) continue;
          segments_.push_back({a, b});
          low_ = low_.cwiseMin(a.cwiseMin(b));
          high_ = high_.cwiseMax(a.cwiseMax(b));
        }
    side_ = std::clamp(static_cast<int>(segments_.size()), 1, 256);
    cell_ = ((high_ - low_) / side_).cwiseMax(1e-12);
    cells_.resize(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_));
    for (std::size_t s = 0; s < segments_.size(); ++s) {
      // A long slanted one lies in the squares of its pieces alone.
      const Vec2 along = segments_[s].to - segments_[s].from;
      const int pieces = 1 + static_cast<int>(along.cwiseAbs().cwiseQuotient(cell_).maxCoeff());
      for (int piece = 0; piece < pieces; ++piece) {
        const Vec2 a = segments_[s].from + along * piece / pieces, b = segments_[s].from + along * (piece + 1) / pieces;
        for_cells(a.cwiseMin(b), a.cwiseMax(b), [&](std::vector<int>& cell) {
          if (cell.empty() || cell.back() != static_cast<int>(s)) cell.push_back(static_cast<int>(s));
        });
      }
    }
  }

  const Segment& operator[](int s) const { return segments_[static_cast<std::size_t>(s)]; }

  /// Those that may reach into a box, ascending.
  std::vector<int> near(const Vec2& low, const Vec2& high) {
    std::vector<int> found;
    if ((high.array() < low_.array()).any() || (low.array() > high_.array()).any()) return found;
    for_cells(low, high, [&](std::vector<int>& cell) { found.insert(found.end(), cell.begin(), cell.end()); });
    std::ranges::sort(found);
    found.erase(std::unique(found.begin(), found.end()), found.end());
    std::erase_if(found, [&](int s) {
      const auto& [a, b] = (*this)[s];
      return (a.cwiseMax(b).array() < low.array()).any() || (a.cwiseMin(b).array() > high.array()).any();
    });
    return found;
  }

 private:
  template <class Visit>
  void for_cells(const Vec2& low, const Vec2& high, const Visit& visit) {
    const Vec2 from = (low - low_).cwiseQuotient(cell_), to = (high - low_).cwiseQuotient(cell_);
    const auto at = [&](double place) { return static_cast<int>(std::clamp(place, 0.0, side_ - 1.0)); };
    // Rounding may put an end into the next square.
    constexpr double edge = 1e-6;
    for (int y = at(from.y() - edge); y <= at(to.y() + edge); ++y)
      for (int x = at(from.x() - edge); x <= at(to.x() + edge); ++x)
        visit(cells_[static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(x)]);
  }

  std::vector<Segment> segments_;
  Vec2 low_ = Vec2::Constant(INFINITY), high_ = Vec2::Constant(-INFINITY), cell_{1, 1};
  int side_ = 1;
  std::vector<std::vector<int>> cells_;
};

/// A corner of a part of a triangle: a vertex of the mesh (b < 0), the place where a border crosses an edge, or an end
/// of a border within the triangle (a: the face).
struct PartCorner {
  enum Kind { vertex, on_edge, inside };
  std::array<int, 4> key{vertex, -1, -1, -1};
  int origin = -1;
  Vec3 straight = Vec3::Zero();  // of the joint surface
  Vec2 room = Vec2::Zero();      // how far it may be before and behind the part, where that is painted
  bool bounded = true;
  int sides = 0;  // of the triangle, on which it lies: bit k for that from corner k on
};

class PartCutter {
 public:
  PartCutter(const ViewFrame& frame, const Positions& joint, const Eigen::VectorXd& m, const DepthBounds& bounds,
             const BaseParts& parts)
      : frame_(frame),
        straight_(straightened(joint, frame.kappa)),
        m_(m),
        bounds_(bounds),
        parts_(parts),
        borders_(parts) {}

  void cut(int face, const Eigen::Vector3i& corners) {
    std::array<PartCorner, 3> whole;
    Vec2 low = Vec2::Constant(INFINITY), high = Vec2::Constant(-INFINITY);
    for (std::size_t k = 0; k < 3; ++k) {
      whole[k] = vertex_corner(corners[static_cast<Eigen::Index>(k)]);
      whole[k].sides = 1 << k | 1 << (k + 2) % 3;
      low = low.cwiseMin(whole[k].straight.head<2>());
      high = high.cwiseMax(whole[k].straight.head<2>());
    }
    const std::vector<int> near = borders_.near(low, high);
    std::vector<PartCorner> places(whole.begin(), whole.end());
    std::vector<std::array<int, 2>> edges;
    for (const int s : near) add_border(face, whole, s, places, edges);
    if (places.size() == 3) {
      add_part({whole[0], whole[1], whole[2]});
      return;
    }
    const double doubled = doubled_area(whole);
    std::vector<Vec2> points;
    for (const PartCorner& place : places) points.emplace_back(place.straight.head<2>());
    const PlaneTriangles parts = constrained_delaunay(points, edges);
    // Borders of neighbouring parts may run side by side, a rounding error apart, and cross.
    for (std::size_t k = places.size(); k < parts.points.size(); ++k) {
      places.push_back(within(whole, parts.points[k]));
      places.back().key = {PartCorner::inside, face, static_cast<int>(k), -1};
    }
    for (const Eigen::Vector3i& t : parts.triangles) {
      std::array<PartCorner, 3> part{places[static_cast<std::size_t>(t[0])], places[static_cast<std::size_t>(t[1])],
                                     places[static_cast<std::size_t>(t[2])]};
      if ((part[0].sides & part[1].sides & part[2].sides) != 0) continue;  // between points of one side
      if (doubled < 0) std::swap(part[1], part[2]);
      add_part(part);
    }
  }

  ReliefPieces pieces() { return list_.pieces(bounds_.painted()); }

 private:
  static Vec2 side(const std::array<PartCorner, 3>& whole, std::size_t k) {
    return (whole[(k + 1) % 3].straight - whole[k].straight).head<2>();
  }

  PartCorner vertex_corner(int vertex) const {
    PartCorner c;
    c.key = {PartCorner::vertex, vertex, -1, -1};
    c.origin = vertex;
    c.straight = straight_.row(vertex).transpose();
    // Of the model, where the ray is the same: on which side of a border it lies does not hang on the solution's last
    // digit.
    const Vec3 own = frame_.P.row(vertex).transpose();
    c.straight.head<2>() = straightened(own, frame_.kappa).head<2>();
    c.room = {bounds_.above, bounds_.below};
    if (bounds_.painted()) c.room = {bounds_.above_of[vertex], bounds_.below_of[vertex]};
    c.bounded = bounds_.bounded[static_cast<std::size_t>(vertex)] != 0;
    return c;
  }

  static PartCorner between(const PartCorner& a, const PartCorner& b, double share) {
    PartCorner c;
    c.straight = a.straight + share * (b.straight - a.straight);
    c.room = a.room + share * (b.room - a.room);
    c.bounded = a.bounded && b.bounded;
    c.origin = share < 0.5 ? a.origin : b.origin;
    return c;
  }

  static double doubled_area(const std::array<PartCorner, 3>& whole) {
    return cross(side(whole, 0), Vec2(-side(whole, 2)));
  }

  /// The place of the surface that is seen at a point within the triangle.
  static PartCorner within(const std::array<PartCorner, 3>& whole, const Vec2& p) {
    const double doubled = doubled_area(whole);
    const Vec2 off = p - whole[0].straight.head<2>();
    const double share_b = cross(off, Vec2(-side(whole, 2))) / doubled, share_c = cross(side(whole, 0), off) / doubled;
    PartCorner place = between(whole[0], whole[1], share_b);
    place.straight += share_c * (whole[2].straight - whole[0].straight);
    place.room += share_c * (whole[2].room - whole[0].room);
    place.bounded = place.bounded && whole[2].bounded;
    if (share_c > 0.5) place.origin = whole[2].origin;
    place.straight.head<2>() = p;
    return place;
  }

  /// Adds what a triangle has of a border: the places where it crosses sides, ends within, and edges between them.
  void add_border(int face, const std::array<PartCorner, 3>& whole, int s, std::vector<PartCorner>& places,
                  std::vector<std::array<int, 2>>& edges) const {
    const Segment& border = borders_[s];
    const Vec2 along = border.to - border.from;
    const double squared = along.squaredNorm();
    std::vector<std::pair<double, int>> met;  // where along the border, and which place
    const auto add = [&](double t, PartCorner place) {
      met.emplace_back(t, static_cast<int>(places.size()));
      places.push_back(std::move(place));
    };
    int left_of_all[2] = {0, 0};  // of each end, how many sides have it to their left
    for (std::size_t k = 0; k < 3; ++k) {
      // The same place from both sides of an edge, whichever triangle asks.
      const bool forwards = whole[k].origin < whole[(k + 1) % 3].origin;
      const PartCorner &a = forwards ? whole[k] : whole[(k + 1) % 3], &b = forwards ? whole[(k + 1) % 3] : whole[k];
      const Vec2 from = a.straight.head<2>(), to = b.straight.head<2>(), edge = to - from;
      for (int end = 0; end < 2; ++end) {
        const bool left = cross(edge, Vec2((end == 0 ? border.from : border.to) - from)) > 0;
        if (left == forwards) ++left_of_all[end];
      }
      const double at_a = cross(along, Vec2(from - border.from)), at_b = cross(along, Vec2(to - border.from));
      if ((at_a < 0) == (at_b < 0)) continue;
      PartCorner place = between(a, b, at_a / (at_a - at_b));
      const double t = along.dot(place.straight.head<2>() - border.from) / squared;
      if (t < 0 || t > 1) continue;
      place.key = {PartCorner::on_edge, a.origin, b.origin, s};
      place.sides = 1 << k;
      add(t, std::move(place));
    }
    const double doubled = doubled_area(whole);
    for (int end = 0; end < 2; ++end) {
      if (left_of_all[end] != 0 && left_of_all[end] != 3) continue;
      if ((left_of_all[end] == 3) != (doubled > 0)) continue;
      PartCorner place = within(whole, end == 0 ? border.from : border.to);
      const Vec2 p = place.straight.head<2>();
      // Borders that meet there end at one place.
      const auto known = std::ranges::find_if(places, [&](const PartCorner& other) {
        return other.key[0] == PartCorner::inside && other.straight.head<2>() == p;
      });
      if (known != places.end()) met.emplace_back(end, static_cast<int>(known - places.begin()));
      else {
        place.key = {PartCorner::inside, face, static_cast<int>(places.size()), -1};
        add(end, std::move(place));
      }
    }
    std::ranges::sort(met);
    for (std::size_t k = 1; k < met.size(); ++k) edges.push_back({met[k - 1].second, met[k].second});
  }

  void add_part(const std::array<PartCorner, 3>& corners) {
    const Vec2 a = corners[0].straight.head<2>(), b = corners[1].straight.head<2>(), c = corners[2].straight.head<2>();
    if (std::abs(cross(Vec2(b - a), Vec2(c - a))) < min_area &&
        corners[0].key[0] + corners[1].key[0] + corners[2].key[0] > 0)
      return;
    const std::optional<BaseParts::Hit> hit = parts_.foremost((a + b + c) / 3);
    if (!hit || !hit->carries) return;
    Eigen::Vector3i face;
    for (std::size_t k = 0; k < 3; ++k) face[static_cast<Eigen::Index>(k)] = vertex(corners[k], hit->part);
    list_.add_face(face, hit->part);
  }

  int vertex(const PartCorner& c, int part) {
    const std::array<int, 5> key{c.key[0], c.key[1], c.key[2], c.key[3], part};
    const auto [found, is_new] = vertices_.try_emplace(key, list_.vertex_count());
    if (is_new) list_.add_vertex(brought_back(c, part), c.origin, c.room);
    return found->second;
  }

  /// Scaled about the viewpoint by 1 / mu, straight on shifted in depth, and kept within the part's bounds.
  Vec3 brought_back(const PartCorner& c, int part) const {
    const double kappa = frame_.kappa, own = m_[part];
    const Vec2 on_plate = c.straight.head<2>();
    double z = (depth_from_straight(c.straight.z(), kappa) - own) / (1 + kappa * own);
    const int vertex = c.key[0] == PartCorner::vertex ? c.key[1] : -1;
    if (vertex >= 0 && bounds_.group[static_cast<std::size_t>(vertex)] == part) {
      if (c.bounded) z = std::clamp(z, bounds_.nearest_allowed(vertex), bounds_.farthest[vertex]);
    } else if (c.bounded) {
      if (const auto passage = parts_.passage(part, on_plate)) {
        const Vec2 limits = BaseParts::limits(*passage, c.room[0], c.room[1]);
        z = std::clamp(z, limits[0], limits[1]);
      }
    }
    return on_ray(on_plate, z, kappa);
  }

  const ViewFrame& frame_;
  Positions straight_;
  const Eigen::VectorXd& m_;
  const DepthBounds& bounds_;
  const BaseParts& parts_;
  Borders borders_;
  std::map<std::array<int, 5>, int> vertices_;
  PieceList list_;
};

}  // namespace

ReliefPieces cut_into_parts(const ViewFrame& frame, const Triangles& F, const Eigen::VectorXd& joint,
                            const Eigen::VectorXd& m, const DepthBounds& bounds, const BaseParts& parts,
                            Context& context) {
  PartCutter cutter(frame, frame.moved(joint), m, bounds, parts);
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    if (f % 4096 == 0) context.check_cancelled();
    cutter.cut(static_cast<int>(f), F.row(f).transpose());
  }
  return cutter.pieces();
}

}  // namespace formwright
