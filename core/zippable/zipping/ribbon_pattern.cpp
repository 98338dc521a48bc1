// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/zipping/ribbon_pattern.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "base/error.h"

namespace formwright {
namespace {

[[noreturn]] void refuse(const std::string& sentence) { throw Error(ErrorCode::invalid_input, "design", sentence); }

double twice_area(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// Halves edges and keeps both sides of the zipper alike.
class Refinement {
 public:
  Refinement(const std::vector<RibbonEdgePlace>& places, const Triangles& triangles) : places_(places) {
    for (Eigen::Index f = 0; f < triangles.rows(); ++f)
      faces_.push_back({triangles(f, 0), triangles(f, 1), triangles(f, 2)}),
          design_face_.push_back(static_cast<int>(f));
    for (int f = 0; f < static_cast<int>(faces_.size()); ++f)
      for (int k = 0; k < 3; ++k) attach(faces_[f][k], faces_[f][(k + 1) % 3], f);
    find_mates();
  }

  /// Edges of both sides that meet become twins.
  void join(const std::vector<HandleClosure>& closures, int boundary_count) {
    for (std::size_t c = 0; c < closures.size(); ++c) {
      std::array<std::map<double, std::array<int, 2>>, 2>
          edges;  // by where they begin, in the direction of the cut: both ends
      std::array<std::map<double, double>, 2> end_of;
      std::set<double> places;
      for (std::size_t side = 0; side < 2; ++side)
        for (const ClosureRun& run : closures[c].sides[side])
          for (int k = 0; k < run.edge_count(); ++k) {
            int a = (run.first_vertex + k) % boundary_count, b = (run.first_vertex + k + 1) % boundary_count;
            double from = run.along_mm[k], to = run.along_mm[k + 1];
            if (!faces_of_.contains(ends(a, b)))
              refuse("design.json: a cut runs along an edge that does not exist: make the design again.");
            if (from > to) std::swap(a, b), std::swap(from, to);
            edges[side][from] = {a, b}, end_of[side][from] = to;
            places.insert(from), places.insert(to);
          }
      const double hair = 1e-9 * closures[c].length_mm;
      for (std::size_t side = 0; side < 2; ++side)
        for (const double place : places) {
          auto edge = edges[side].upper_bound(place - hair);
          if (edge == edges[side].begin()) continue;
          --edge;
          const double from = edge->first, to = end_of[side].at(from);
          if (place < from + hair || place > to - hair) continue;
          const auto [a, b] = edge->second;
          const int middle = split(a, b, (place - from) / (to - from), [](int, int) {});
          edges[side][from] = {a, middle}, end_of[side][from] = place;
          edges[side][place] = {middle, b}, end_of[side][place] = to;
        }
      for (const auto& [from, left] : edges[0]) {
        const auto right = edges[1].lower_bound(from - hair);
        if (right == edges[1].end() || right->first > from + hair) continue;
        add_twins(left, right->second, static_cast<int>(c), from, end_of[0].at(from));
      }
    }
  }

  void split_longer_than(double edge_mm, Context& context) {
    std::set<std::tuple<double, int, int>> queue;  // longest first
    const auto push = [&](int a, int b) {
      const double squared = (places_[a].flat_mm - places_[b].flat_mm).squaredNorm();
      if (squared > edge_mm * edge_mm) queue.insert({-squared, std::min(a, b), std::max(a, b)});
    };
    for (const auto& [ends, faces] : faces_of_) push(ends.first, ends.second);
    for (int count = 0; !queue.empty(); ++count) {
      if (count % 256 == 0) context.check_cancelled();
      const auto [key, a, b] = *queue.begin();
      queue.erase(queue.begin());
      if (!faces_of_.contains({a, b})) continue;  // its twin's turn came first
      if (const auto twin = twins_.find({a, b}); twin != twins_.end()) {
        split_twins(a, b, push);
        continue;
      }
      const bool seam = on_seam(a, b);
      const int other_a = seam ? mate_[a] : -1, other_b = seam ? mate_[b] : -1;
      const int middle = split(a, b, 0.5, push);
      if (!seam) continue;
      queue.erase({key, std::min(other_a, other_b), std::max(other_a, other_b)});
      // Rounding may give the two sides different keys: whatever is left over is no edge any more.
      std::erase_if(queue, [&](const auto& item) {
        return std::get<1>(item) == std::min(other_a, other_b) && std::get<2>(item) == std::max(other_a, other_b);
      });
      const int other = split(other_a, other_b, 0.5, push);
      mate_[middle] = other, mate_[other] = middle;
      along_[middle] = along_[other] = 0.5 * (along_[a] + along_[b]);
    }
  }

  RibbonPattern result() const {
    RibbonPattern pattern;
    const auto count = static_cast<Eigen::Index>(places_.size());
    pattern.flat.V = Positions::Zero(count, 3);
    pattern.predicted_mm.resize(count, 3);
    for (Eigen::Index i = 0; i < count; ++i) {
      pattern.flat.V.row(i).head<2>() = places_[i].flat_mm;
      pattern.predicted_mm.row(i) = places_[i].predicted_mm;
    }
    pattern.flat.F.resize(static_cast<Eigen::Index>(faces_.size()), 3);
    double area = 0;
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      const auto& t = faces_[f];
      pattern.flat.F.row(static_cast<Eigen::Index>(f)) << t[0], t[1], t[2];
      pattern.closed_at_mm.push_back(std::max({along_[t[0]], along_[t[1]], along_[t[2]]}));
      area += 0.5 * twice_area(places_[t[0]].flat_mm, places_[t[1]].flat_mm, places_[t[2]].flat_mm);
    }
    pattern.triangle_of_design = design_face_;
    pattern.zipper_mm = zipper_mm_;
    pattern.width_mm = zipper_mm_ > 0 ? area / zipper_mm_ : std::sqrt(area);
    pattern.size_mm =
        (pattern.predicted_mm.colwise().maxCoeff() - pattern.predicted_mm.colwise().minCoeff()).maxCoeff();
    for (int v = 0; v < static_cast<int>(places_.size()); ++v)
      if (places_[v].left && mate_[v] >= 0) pattern.seams.push_back({v, mate_[v], along_[v], 0});
    std::sort(pattern.seams.begin(), pattern.seams.end(), [](const SeamPair& a, const SeamPair& b) {
      return std::tie(a.along_mm, a.left) < std::tie(b.along_mm, b.left);
    });
    for (std::size_t i = 0; i + 1 < pattern.seams.size(); ++i) {
      SeamPair &a = pattern.seams[i], &b = pattern.seams[i + 1];
      if (places_[a.left].piece != places_[b.left].piece) continue;
      a.length_mm += 0.5 * (b.along_mm - a.along_mm);
      b.length_mm += 0.5 * (b.along_mm - a.along_mm);
    }
    add_closures(pattern);
    return pattern;
  }

 private:
  using Ends = std::pair<int, int>;
  static Ends ends(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

  void attach(int a, int b, int face) {
    auto& faces = faces_of_.try_emplace(ends(a, b), std::array{-1, -1}).first->second;
    if (faces[1] >= 0) refuse("design.json: three triangles share an edge of the ribbon: make the design again.");
    faces[faces[0] < 0 ? 0 : 1] = face;
  }

  struct Twin {
    std::array<int, 2> left, right;  // edges, in the direction of the cut
    int closure;
    double from_mm, to_mm;
  };

  void add_twins(const std::array<int, 2>& left, const std::array<int, 2>& right, int closure, double from_mm,
                 double to_mm) {
    const Twin twin{left, right, closure, from_mm, to_mm};
    twins_[ends(left[0], left[1])] = twins_[ends(right[0], right[1])] = twin;
  }

  template <class Push>
  void split_twins(int a, int b, const Push& push) {
    const Twin twin = twins_.at(ends(a, b));
    twins_.erase(ends(twin.left[0], twin.left[1])), twins_.erase(ends(twin.right[0], twin.right[1]));
    const int left = split(twin.left[0], twin.left[1], 0.5, push),
              right = split(twin.right[0], twin.right[1], 0.5, push);
    const double middle = 0.5 * (twin.from_mm + twin.to_mm);
    add_twins({twin.left[0], left}, {twin.right[0], right}, twin.closure, twin.from_mm, middle);
    add_twins({left, twin.left[1]}, {right, twin.right[1]}, twin.closure, middle, twin.to_mm);
  }

  void add_closures(RibbonPattern& pattern) const {
    std::map<std::tuple<int, double, int, int>, double> length;  // by cut, place along it, both vertices
    for (const auto& [edge, twin] : twins_) {
      if (edge != ends(twin.left[0], twin.left[1])) continue;  // each stands twice
      const double half = 0.5 * (twin.to_mm - twin.from_mm);
      length[{twin.closure, twin.from_mm, twin.left[0], twin.right[0]}] += half;
      length[{twin.closure, twin.to_mm, twin.left[1], twin.right[1]}] += half;
    }
    for (const auto& [pair, mm] : length) {
      const auto [closure, along, left, right] = pair;
      pattern.closures.push_back({left, right, closure, along, mm});
    }
  }

  void find_mates() {
    const std::size_t count = places_.size();
    mate_.assign(count, -1), along_.assign(count, 0);
    std::map<std::pair<int, bool>, int> place_of;
    for (int v = 0; v < static_cast<int>(count); ++v)
      if (places_[v].sample >= 0 && !place_of.try_emplace({places_[v].sample, places_[v].left}, v).second)
        refuse("design.json: sample " + std::to_string(places_[v].sample) +
               " of the zipper occurs twice on one side: make the design again.");
    int before = -1;
    for (const auto& [key, v] : place_of) {  // ascending samples
      const auto other = place_of.find({key.first, !key.second});
      if (other == place_of.end())
        refuse("design.json: sample " + std::to_string(key.first) +
               " of the zipper has no counterpart on the other side: make the design again.");
      mate_[v] = other->second;
      if (!places_[v].left) continue;
      if (before >= 0 && places_[before].piece == places_[v].piece)
        zipper_mm_ += (places_[v].flat_mm - places_[before].flat_mm).norm();
      along_[v] = along_[other->second] = zipper_mm_;
      before = v;
    }
  }

  /// Both ends on one side of one stretch of the zipper, and on the ribbon's edge.
  bool on_seam(int a, int b) const {
    return mate_[a] >= 0 && mate_[b] >= 0 && places_[a].piece == places_[b].piece &&
           places_[a].left == places_[b].left && faces_of_.at(ends(a, b))[1] < 0 &&
           faces_of_.contains(ends(mate_[a], mate_[b]));
  }

  template <class Push>
  int split(int a, int b, double share, const Push& push) {
    const int middle = static_cast<int>(places_.size());
    RibbonEdgePlace place = places_[a];
    place.flat_mm = (1 - share) * places_[a].flat_mm + share * places_[b].flat_mm;
    place.predicted_mm = (1 - share) * places_[a].predicted_mm + share * places_[b].predicted_mm;
    places_.push_back(place);
    mate_.push_back(-1), along_.push_back(std::max(along_[a], along_[b]));
    const auto around = faces_of_.extract(ends(a, b)).mapped();
    for (const int face : around) {
      if (face < 0) continue;
      int k = 0;
      while (faces_[face][k] == a || faces_[face][k] == b) ++k;
      const int tip = faces_[face][k], first = faces_[face][(k + 1) % 3], second = faces_[face][(k + 2) % 3];
      const int added = static_cast<int>(faces_.size());
      faces_[face] = {tip, first, middle};
      faces_.push_back({tip, middle, second});
      design_face_.push_back(design_face_[static_cast<std::size_t>(face)]);
      auto& side = faces_of_.at(ends(tip, second));
      side[side[0] == face ? 0 : 1] = added;
      attach(first, middle, face), attach(middle, second, added);
      attach(tip, middle, face), attach(tip, middle, added);
      push(tip, middle);
    }
    push(a, middle), push(middle, b);
    return middle;
  }

  std::vector<RibbonEdgePlace> places_;
  std::vector<std::array<int, 3>> faces_;
  std::vector<int> design_face_;
  std::map<Ends, std::array<int, 2>> faces_of_;
  std::map<Ends, Twin> twins_;  // by the edge of either side
  std::vector<int> mate_;
  std::vector<double> along_;  // where the slider passes a place; off the zipper, the last place that it lies between
  double zipper_mm_ = 0;
};

}  // namespace

RibbonDesign ribbon_of(const FlatDesign& design) {
  RibbonDesign ribbon;
  ribbon.triangles = design.F;
  ribbon.closures = design.closures;
  for (const FlatVertex& v : design.boundary)
    ribbon.places.push_back({v.flat_mm, v.position_mm, v.sample,
                             v.sample < 0 ? -1 : design.piece_of[static_cast<std::size_t>(v.sample)], v.left});
  return ribbon;
}

RibbonPattern make_ribbon_pattern(const std::vector<RibbonEdgePlace>& places, const Triangles& triangles,
                                  double edge_mm, Context& context, const std::vector<HandleClosure>& closures) {
  if (triangles.rows() == 0) refuse("design.json has no triangles: make the design again.");
  const int count = static_cast<int>(places.size());
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    for (int k = 0; k < 3; ++k)
      if (triangles(f, k) < 0 || triangles(f, k) >= count)
        refuse("design.json: triangle " + std::to_string(f) +
               " refers to a point that does not exist: make the design again.");
    if (!(twice_area(places[triangles(f, 0)].flat_mm, places[triangles(f, 1)].flat_mm,
                     places[triangles(f, 2)].flat_mm) > 0))
      refuse("design.json: triangle " + std::to_string(f) + " has no area or is turned over: make the design again.");
  }
  Refinement refinement(places, triangles);
  refinement.join(closures, count);
  if (edge_mm > 0) refinement.split_longer_than(edge_mm, context);
  return refinement.result();
}

RibbonPattern pattern_of(const RibbonDesign& design, double edge_mm, Context& context) {
  RibbonPattern pattern = make_ribbon_pattern(design.places, design.triangles, edge_mm, context, design.closures);
  for (const int triangle : pattern.triangle_of_design)
    if (!design.turn_of_triangle_rad.empty())
      pattern.turn_of_triangle_rad.push_back(design.turn_of_triangle_rad[static_cast<std::size_t>(triangle)]);
  return pattern;
}

}  // namespace formwright
