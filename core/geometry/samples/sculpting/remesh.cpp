// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/samples/sculpting/remesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "base/error.h"
#include "base/index.h"
#include "base/parallel.h"

namespace formwright::samples {
namespace {

constexpr std::size_t grain = 2048;

double cotangent(const Point& apex, const Point& p, const Point& q) {
  const Point u = p - apex, v = q - apex;
  const double twice_area = length(cross(u, v));
  return twice_area > 1e-300 ? dot(u, v) / twice_area : 1e6;
}

Point normal_of(const Point& a, const Point& b, const Point& c) { return cross(b - a, c - a); }

// a . b > least |a| |b|
bool agree(const Point& a, const Point& b, double minimum) {
  const double d = dot(a, b), product = length2(a) * length2(b);
  return d > 0 && d * d > minimum * minimum * product;
}

class Remesher {
 public:
  Remesher(const Surface& surface, const std::vector<int>& patch, const TargetShape& shape, int target, int ghost,
           Context& context)
      : s_(surface, patch), shape_(shape), target_(target + (ghost >= 0 ? 1 : 0)), ghost_(ghost), context_(context) {
    // n vertices carry 2 n triangles of area sqrt(3)/4 edge^2.
    double area = 0;
    for (int h = 0; h < s_.halfedge_slots(); h += 3)
      if (!touches_ghost(h))
        area += 0.5 * length(normal_of(s_.point(s_.start(h)), s_.point(s_.start(h + 1)), s_.point(s_.start(h + 2))));
    edge_ = std::sqrt(area * 2 / (std::sqrt(3.0) * target));
  }

  Surface run(std::vector<int>& patch) {
    // From a handful of triangles: halve edges, longest first, until none is too long.
    for (double longest = longest_edge(); longest > 2.8 * edge_; longest = longest_edge()) {
      scale_ = longest;
      split_longer_than(0.7 * longest);
      flip_to_delaunay();
      relax(0.1, false);
      relax(0.1, false);
    }
    scale_ = edge_;
    // A first mesh much finer than wanted needs more rounds to come down.
    const double excess = static_cast<double>(s_.vertex_count()) / target_;
    const int coarsening = excess > 2 ? 3 + static_cast<int>(std::log2(excess)) : 0;
    for (int k = 0; k < coarsening; ++k) {
      collapse_short(0.8);
      flip_by_valence();
      relax(0.2, false);
    }
    for (int k = 0; k < 3; ++k) {
      split_long(4.0 / 3);
      collapse_short(0.8);
      flip_by_valence();
      relax(0.15, k == 1);
      context_.check_cancelled();
    }
    for (int k = 0; k < 3; ++k) {
      dissolve_slivers();
      match_count();
      if (k == 0) flip_by_valence();
      flip_to_delaunay();
      relax(k == 1 ? 0.02 : 0.05, k != 1);
      context_.check_cancelled();
    }
    flip_to_delaunay();
    polish();
    context_.check_cancelled();
    return s_.compact(&patch);
  }

 private:
  // A surface with a boundary is closed by triangles to one vertex, the ghost, which has no place in space.
  bool touches_ghost(int h) const {
    return ghost_ >= 0 && (s_.start(h) == ghost_ || s_.end(h) == ghost_ || s_.start(s_.previous(h)) == ghost_);
  }
  // An edge that may be looked at: alive and between two real vertices.
  bool real(int h) const { return s_.alive(h) && (ghost_ < 0 || (s_.start(h) != ghost_ && s_.end(h) != ghost_)); }

  // Once in a while within a loop over half-edges.
  void poll(int h) const {
    if ((h & 0x3fff) == 0) context_.check_cancelled();
  }

  double longest_edge() const {
    double longest = 0;
    for (int h = 0; h < s_.halfedge_slots(); ++h)
      if (real(h)) longest = std::max(longest, s_.edge_length2(h));
    return std::sqrt(longest);
  }

  void split_long(double factor) { split_longer_than(factor * edge_); }

  void split_longer_than(double length) {
    const double limit = length * length;
    const int slots = s_.halfedge_slots();
    for (int h = 0; h < slots; ++h) {
      poll(h);
      if (real(h) && h < s_.twin(h) && s_.edge_length2(h) > limit) split_at_middle(h);
    }
  }

  void split_at_middle(int h) {
    const Point middle = (s_.point(s_.start(h)) + s_.point(s_.end(h))) / 2;
    const int m = s_.split(h, middle);
    Point slope;
    s_.move(m, limited(middle, shape_.project(middle, s_.patches(m), 0.1 * scale_, slope)));
  }

  Point limited(const Point& from, const Point& to) const {
    const Point step = to - from;
    const double l2 = length2(step), maximum = 0.3 * scale_;
    return l2 <= maximum * maximum ? to : from + step * (maximum / std::sqrt(l2));
  }

  void collapse_short(double factor) {
    const double limit = factor * factor * edge_ * edge_;
    for (int h = 0; h < s_.halfedge_slots(); ++h) {
      poll(h);
      if (real(h) && s_.edge_length2(h) < limit) try_collapse(h, 4.0 / 3);
    }
  }

  bool try_collapse(int h, double longest) {
    Point p;
    if (!s_.can_collapse(h, p)) return false;
    const double limit = longest * longest * edge_ * edge_;
    if (!survives(h, s_.start(h), p, limit) || !survives(h, s_.end(h), p, limit)) return false;
    s_.collapse(h, p);
    return true;
  }

  // Moving `v` (an end of h) to p turns no remaining triangle over and makes no edge too long.
  bool survives(int h, int v, const Point& p, double limit) const {
    const int t = s_.twin(h), begin = s_.out(v);
    int k = begin;
    do {
      if (k / 3 != h / 3 && k / 3 != t / 3 && !touches_ghost(k)) {
        const Point& b = s_.point(s_.end(k));
        const Point& c = s_.point(s_.start(s_.previous(k)));
        if (distance2(p, b) > limit) return false;
        if (!agree(normal_of(s_.point(v), b, c), normal_of(p, b, c), 0.35)) return false;
      }
      k = s_.rotate(k);
    } while (k != begin);
    return true;
  }

  // The edge may turn: not a feature, not folded, the other diagonal free and its triangles sound.
  bool can_flip(int h) const {
    if (s_.is_feature(h)) return false;
    const int t = s_.twin(h), a = s_.start(s_.previous(h)), b = s_.start(s_.previous(t));
    const Point &u = s_.point(s_.start(h)), &v = s_.point(s_.start(t)), &pa = s_.point(a), &pb = s_.point(b);
    const Point n1 = normal_of(u, v, pa), n2 = normal_of(v, u, pb);
    const Point f1 = normal_of(pb, pa, u), f2 = normal_of(pa, pb, v);
    const Point mean = n1 + n2;
    if (!agree(n1, n2, 0.5) || !agree(f1, f2, 0.5) || !agree(f1, mean, 0.5) || !agree(f2, mean, 0.5)) return false;
    return !s_.adjacent(a, b);
  }

  void flip_by_valence() {
    std::vector<int> valence(index(s_.vertex_slots()), 0);
    for (int h = 0; h < s_.halfedge_slots(); ++h)
      if (s_.alive(h)) ++valence[index(s_.start(h))];
    const auto excess = [&](int v, int change) {
      const int e = valence[index(v)] + change - 6;
      return e * e;
    };
    for (int h = 0; h < s_.halfedge_slots(); ++h) {
      poll(h);
      if (!real(h) || h > s_.twin(h)) continue;
      const int t = s_.twin(h), u = s_.start(h), v = s_.start(t), a = s_.start(s_.previous(h)),
                b = s_.start(s_.previous(t));
      if (valence[index(u)] <= 4 || valence[index(v)] <= 4) continue;
      const int before = excess(u, 0) + excess(v, 0) + excess(a, 0) + excess(b, 0);
      const int after = excess(u, -1) + excess(v, -1) + excess(a, 1) + excess(b, 1);
      if (after >= before || !can_flip(h)) continue;
      // Never for a much worse shape.
      const Point &pu = s_.point(u), &pv = s_.point(v), &pa = s_.point(a), &pb = s_.point(b);
      if (distance2(pa, pb) > 2.2 * distance2(pu, pv)) continue;
      s_.flip(h);
      --valence[index(u)];
      --valence[index(v)];
      ++valence[index(a)];
      ++valence[index(b)];
    }
  }

  void flip_to_delaunay() {
    for (int round = 0; round < 4; ++round) {
      int flips = 0;
      for (int h = 0; h < s_.halfedge_slots(); ++h) {
        poll(h);
        if (!real(h) || h > s_.twin(h) || s_.is_feature(h)) continue;
        const int t = s_.twin(h), u = s_.start(h), v = s_.start(t), a = s_.start(s_.previous(h)),
                  b = s_.start(s_.previous(t));
        const Point &pu = s_.point(u), &pv = s_.point(v), &pa = s_.point(a), &pb = s_.point(b);
        const double weight = cotangent(pa, pu, pv) + cotangent(pb, pu, pv);
        if (weight >= -1e-6 || s_.valence(u) <= 3 || s_.valence(v) <= 3 || !can_flip(h)) continue;
        // On a curved surface the other diagonal may be no better: insist on a gain.
        if (cotangent(pu, pa, pb) + cotangent(pv, pa, pb) <= weight) continue;
        s_.flip(h);
        ++flips;
      }
      if (flips == 0) break;
    }
  }

  void relax(double step, bool chord) {
    const int vertices = s_.vertex_slots(), faces = s_.halfedge_slots() / 3;
    normals_.resize(index(faces));
    parallel_for(index(faces), grain, [&](std::size_t from, std::size_t to) {
      for (std::size_t f = from; f < to; ++f) {
        const int h = static_cast<int>(3 * f);
        if (s_.alive(h))
          normals_[f] = normal_of(s_.point(s_.start(h)), s_.point(s_.start(h + 1)), s_.point(s_.start(h + 2)));
      }
    });
    moved_.resize(index(vertices));
    if (!chord) slopes_.clear();
    slopes_.resize(index(vertices));
    parallel_for(index(vertices), grain, [&](std::size_t from, std::size_t to) {
      context_.check_cancelled();
      for (std::size_t v = from; v < to; ++v)
        if (s_.vertex_alive(static_cast<int>(v)) && static_cast<int>(v) != ghost_)
          moved_[v] = relaxed(static_cast<int>(v), step, slopes_[v]);
    });
    for (int v = 0; v < vertices; ++v)
      if (s_.vertex_alive(v) && v != ghost_) s_.move(v, moved_[index(v)]);
  }

  Point relaxed(int v, double step, Point& slope) const {
    const Point& p = s_.point(v);
    const std::uint32_t patches = s_.patches(v);
    const int meeting = std::popcount(patches), begin = s_.out(v);
    if (meeting > 2) return p;
    Point centre{0, 0, 0}, normal{0, 0, 0};
    double total = 0;
    int h = begin;
    do {
      if (meeting == 2) {
        if (s_.is_feature(h)) {
          centre += s_.point(s_.end(h));
          total += 1;
        }
      } else {
        // Centroids of the triangles around, by area: evens out sizes as well as angles.
        const Point& n = normals_[index(h / 3)];
        const double area = length(n);
        centre += (p + s_.point(s_.end(h)) + s_.point(s_.start(s_.previous(h)))) * (area / 3);
        normal += n;
        total += area;
      }
      h = s_.rotate(h);
    } while (h != begin);
    if (total <= 0) return p;
    Point move = centre / total - p;
    if (meeting == 1) {
      const double n2 = length2(normal);
      if (n2 > 0) move -= normal * (dot(move, normal) / n2);
      move = move * 1.3;  // the centroid includes p itself: over-relax
    }
    const Point there = limited(p, p + move);
    return limited(there, shape_.project(there, patches, step * scale_, slope));
  }

  // Collapses the shortest edge of triangles with an angle below about 24 degrees.
  void dissolve_slivers() {
    for (int h = 0; h < s_.halfedge_slots(); ++h) {
      poll(h);
      if (!s_.alive(h) || touches_ghost(h)) continue;
      const Point &a = s_.point(s_.start(h)), &b = s_.point(s_.end(h)), &c = s_.point(s_.start(s_.previous(h)));
      if (cotangent(c, a, b) > 2.25) try_collapse(h, 1.6);
    }
  }

  // Splits the longest or collapses the shortest edges until the count is right.
  void match_count() {
    for (int round = 0; round < 20 && s_.vertex_count() != target_; ++round) {
      context_.check_cancelled();
      const bool grow = s_.vertex_count() < target_;
      std::vector<std::pair<double, int>> edges;
      for (int h = 0; h < s_.halfedge_slots(); ++h)
        if (real(h) && h < s_.twin(h)) edges.emplace_back(grow ? -s_.edge_length2(h) : s_.edge_length2(h), h);
      const std::size_t missing = index(std::abs(target_ - s_.vertex_count()));
      const std::size_t first = std::min(edges.size(), grow ? missing : 3 * missing + 8);
      std::partial_sort(edges.begin(), edges.begin() + static_cast<std::ptrdiff_t>(first), edges.end());
      for (std::size_t e = 0; e < first && s_.vertex_count() != target_; ++e) {
        const int h = edges[e].second;
        if (!s_.alive(h)) continue;
        if (grow) {
          split_at_middle(h);
        } else if (!try_collapse(h, 1.6 + 0.1 * round)) {
          try_collapse(s_.twin(h), 1.6 + 0.1 * round);
        }
      }
    }
  }

  void polish() {
    const int vertices = s_.vertex_slots();
    slopes_.clear();
    slopes_.resize(index(vertices));
    for (double step : {1e-2, 1e-3, 1e-3}) {
      parallel_for(index(vertices), grain, [&](std::size_t from, std::size_t to) {
        context_.check_cancelled();
        for (std::size_t i = from; i < to; ++i) {
          const int v = static_cast<int>(i);
          if (!s_.vertex_alive(v) || v == ghost_) continue;
          const Point p = s_.point(v);
          Point q = shape_.project(p, s_.patches(v), step * edge_, slopes_[i]);
          const double maximum = 0.1 * edge_;
          if (distance2(p, q) > maximum * maximum) q = p + (q - p) * (maximum / length(q - p));
          s_.move(v, q);
        }
      });
    }
  }

  HalfedgeSurface s_;
  const TargetShape& shape_;
  int target_, ghost_;
  Context& context_;
  double edge_;       // wanted mean length
  double scale_ = 0;  // the length now, on the way there
  std::vector<Point> normals_, moved_, slopes_;
};

}  // namespace

Point ImplicitTarget::project(const Point& p, std::uint32_t, double step, Point& slope) const {
  if (slope == Point{}) {
    const double a = field_({p.x + step, p.y - step, p.z - step}), b = field_({p.x - step, p.y - step, p.z + step}),
                 c = field_({p.x - step, p.y + step, p.z - step}), d = field_({p.x + step, p.y + step, p.z + step});
    const Point gradient = Point{a - b - c + d, c + d - a - b, b + d - a - c} / (4 * step);
    const double g2 = length2(gradient);
    if (!(g2 > 0.01)) return p;
    slope = gradient / g2;
    return p - slope * (0.25 * (a + b + c + d));
  }
  return p - slope * field_(p);
}

Surface remesh(const Surface& surface, std::vector<int>& patch, const TargetShape& target, int vertex_count,
               Context& context) {
  return Remesher(surface, patch, target, vertex_count, -1, context).run(patch);
}

Surface remesh_open(const Surface& surface, const std::function<int(const Point&, const Point&)>& side,
                    const TargetShape& target, int vertex_count, Context& context) {
  Surface closed = surface;
  const int ghost = static_cast<int>(surface.points.size());
  closed.points.push_back({0, 0, 0});
  std::vector<int> patch(surface.triangles.size(), 0);
  // Boundary edges are the directed edges without a reverse.
  std::vector<std::pair<std::pair<int, int>, int>> edges;  // (low, high), direction
  for (const Corners& t : surface.triangles)
    for (std::size_t c = 0; c < 3; ++c) {
      const int a = t[c], b = t[(c + 1) % 3];
      edges.push_back({{std::min(a, b), std::max(a, b)}, a < b ? 1 : 0});
    }
  std::sort(edges.begin(), edges.end());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (e + 1 < edges.size() && edges[e].first == edges[e + 1].first) {
      ++e;
      continue;
    }
    const auto [low, high] = edges[e].first;
    const int a = edges[e].second == 1 ? low : high, b = edges[e].second == 1 ? high : low;
    closed.triangles.push_back({b, a, ghost});
    patch.push_back(first_rim_patch + side(surface.points[index(a)], surface.points[index(b)]));
  }
  Surface result = Remesher(closed, patch, target, vertex_count, ghost, context).run(patch);
  // The ghost keeps its place among the vertices that came before it: find it by its triangles.
  int last = -1;
  Surface open;
  for (std::size_t f = 0; f < result.triangles.size(); ++f) {
    if (patch[f] < first_rim_patch) {
      open.triangles.push_back(result.triangles[f]);
    } else if (last < 0) {
      const Corners& t = result.triangles[f];
      for (const int v : t)
        if (result.points[index(v)] == Point{0, 0, 0}) last = v;
    }
  }
  for (int v = 0; v < static_cast<int>(result.points.size()); ++v)
    if (v != last) open.points.push_back(result.points[index(v)]);
  for (Corners& t : open.triangles)
    for (int& v : t) v -= v > last ? 1 : 0;
  return open;
}

Surface mesh_implicit(const ImplicitShape& shape, double area_mm2, int vertex_count, Context& context) {
  // The grid edges crossed by a surface of area A number 1.5 A / cell^2 on average over directions.
  const double cell = std::min(shape.largest_cell_mm, std::sqrt(1.5 * area_mm2 / (1.1 * vertex_count)));
  const Surface rough = marching_cubes(shape, cell, context);
  std::vector<int> patch;
  return remesh(rough, patch, ImplicitTarget(shape.field), vertex_count, context);
}

}  // namespace formwright::samples
