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

double twice_area(const Vec2& a, const Vec2& b, const Vec2& c) { return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x(); }

/// Halves edges and keeps both sides of the zipper alike.
class Refinement {
 public:
  Refinement(const std::vector<RibbonEdgePlace>& places, const Triangles& triangles) : places_(places) {
    for (Eigen::Index f = 0; f < triangles.rows(); ++f) faces_.push_back({triangles(f, 0), triangles(f, 1), triangles(f, 2)});
    for (int f = 0; f < static_cast<int>(faces_.size()); ++f)
      for (int k = 0; k < 3; ++k) attach(faces_[f][k], faces_[f][(k + 1) % 3], f);
    find_mates();
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
      const bool seam = on_seam(a, b);
      const int other_a = seam ? mate_[a] : -1, other_b = seam ? mate_[b] : -1;
      const int middle = split(a, b, push);
      if (!seam) continue;
      queue.erase({key, std::min(other_a, other_b), std::max(other_a, other_b)});
      // Rounding may give the two sides different keys: whatever is left over is no edge any more.
      std::erase_if(queue, [&](const auto& item) {
        return std::get<1>(item) == std::min(other_a, other_b) && std::get<2>(item) == std::max(other_a, other_b);
      });
      const int other = split(other_a, other_b, push);
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
    pattern.zipper_mm = zipper_mm_;
    pattern.width_mm = zipper_mm_ > 0 ? area / zipper_mm_ : std::sqrt(area);
    pattern.size_mm = (pattern.predicted_mm.colwise().maxCoeff() - pattern.predicted_mm.colwise().minCoeff()).maxCoeff();
    for (int v = 0; v < static_cast<int>(places_.size()); ++v)
      if (places_[v].left && mate_[v] >= 0) pattern.seams.push_back({v, mate_[v], along_[v], 0});
    std::sort(pattern.seams.begin(), pattern.seams.end(),
              [](const SeamPair& a, const SeamPair& b) { return std::tie(a.along_mm, a.left) < std::tie(b.along_mm, b.left); });
    for (std::size_t i = 0; i + 1 < pattern.seams.size(); ++i) {
      SeamPair &a = pattern.seams[i], &b = pattern.seams[i + 1];
      if (places_[a.left].piece != places_[b.left].piece) continue;
      a.length_mm += 0.5 * (b.along_mm - a.along_mm);
      b.length_mm += 0.5 * (b.along_mm - a.along_mm);
    }
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

  void find_mates() {
    const std::size_t count = places_.size();
    mate_.assign(count, -1), along_.assign(count, 0);
    std::map<std::pair<int, bool>, int> place_of;
    for (int v = 0; v < static_cast<int>(count); ++v)
      if (places_[v].sample >= 0 && !place_of.try_emplace({places_[v].sample, places_[v].left}, v).second)
        refuse("design.json: sample " + std::to_string(places_[v].sample) + " of the zipper stands twice on one side: make the design again.");
    int before = -1;
    for (const auto& [key, v] : place_of) {  // ascending samples
      const auto other = place_of.find({key.first, !key.second});
      if (other == place_of.end())
        refuse("design.json: sample " + std::to_string(key.first) + " of the zipper has no place opposite: make the design again.");
      mate_[v] = other->second;
      if (!places_[v].left) continue;
      if (before >= 0 && places_[before].piece == places_[v].piece) zipper_mm_ += (places_[v].flat_mm - places_[before].flat_mm).norm();
      along_[v] = along_[other->second] = zipper_mm_;
      before = v;
    }
  }

  /// Both ends on one side of one stretch of the zipper, and on the ribbon's edge.
  bool on_seam(int a, int b) const {
    return mate_[a] >= 0 && mate_[b] >= 0 && places_[a].piece == places_[b].piece && places_[a].left == places_[b].left &&
           faces_of_.at(ends(a, b))[1] < 0 && faces_of_.contains(ends(mate_[a], mate_[b]));
  }

  template <class Push>
  int split(int a, int b, const Push& push) {
    const int middle = static_cast<int>(places_.size());
    RibbonEdgePlace place = places_[a];
    place.flat_mm = 0.5 * (places_[a].flat_mm + places_[b].flat_mm);
    place.predicted_mm = 0.5 * (places_[a].predicted_mm + places_[b].predicted_mm);
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
  std::map<Ends, std::array<int, 2>> faces_of_;
  std::vector<int> mate_;
  std::vector<double> along_;  // where the slider passes a place; off the zipper, the last place that it lies between
  double zipper_mm_ = 0;
};

}  // namespace

RibbonDesign ribbon_of(const FlatDesign& design) {
  RibbonDesign ribbon;
  ribbon.triangles = design.F;
  for (const FlatVertex& v : design.boundary)
    ribbon.places.push_back({v.flat_mm, v.position_mm, v.sample, v.sample < 0 ? -1 : design.piece_of[static_cast<std::size_t>(v.sample)], v.left});
  return ribbon;
}

RibbonPattern make_ribbon_pattern(const std::vector<RibbonEdgePlace>& places, const Triangles& triangles, double edge_mm, Context& context) {
  if (triangles.rows() == 0) refuse("design.json has no triangles: make the design again.");
  const int count = static_cast<int>(places.size());
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    for (int k = 0; k < 3; ++k)
      if (triangles(f, k) < 0 || triangles(f, k) >= count)
        refuse("design.json: triangle " + std::to_string(f) + " names a place that is not there: make the design again.");
    if (!(twice_area(places[triangles(f, 0)].flat_mm, places[triangles(f, 1)].flat_mm, places[triangles(f, 2)].flat_mm) > 0))
      refuse("design.json: triangle " + std::to_string(f) + " has no area or is turned over: make the design again.");
  }
  Refinement refinement(places, triangles);
  if (edge_mm > 0) refinement.split_longer_than(edge_mm, context);
  return refinement.result();
}

}  // namespace formwright
