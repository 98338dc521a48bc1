// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>

#include "fabrication/laser/laser_stroke.h"
#include "fabrication/toolpath/travel_route.h"

namespace formwright {
namespace {

constexpr int max_nested = 100;

class Order {
 public:
  Order(const std::vector<LaserStroke>& strokes, bool free_start, const Context& context)
      : strokes_(strokes),
        free_start_(free_start),
        context_(context),
        insides_(strokes.size()),
        estimates_(strokes.size()) {
    for (std::size_t i = 0; i < strokes.size(); ++i) {
      // Rings within rings beyond the hundredth are taken as one lot.
      int parent = strokes[i].inside_of, depth = 0;
      std::vector<int> ancestors;
      for (int a = parent; a >= 0; a = strokes[static_cast<std::size_t>(a)].inside_of) ancestors.push_back(a), ++depth;
      if (depth > max_nested) parent = ancestors[static_cast<std::size_t>(depth - max_nested)];
      (parent < 0 ? roots_ : insides_[static_cast<std::size_t>(parent)]).push_back(static_cast<int>(i));
    }
    for (const int root : roots_) estimate(root);
  }

  std::vector<StrokeRun> run(const Vec2& start_mm) {
    at_ = start_mm;
    emit(roots_, std::nullopt);
    return std::move(runs_);
  }

 private:
  struct Estimate {
    Vec2 entry{0, 0}, exit{0, 0};
  };

  std::vector<Vec2> doors(const LaserStroke& stroke) const {
    if (stroke.closed && free_start_) return stroke.points_mm;
    if (stroke.closed) return {stroke.points_mm.front()};
    return {stroke.points_mm.front(), stroke.points_mm.back()};
  }

  RouteStop stop_of(int i) const {
    const LaserStroke& stroke = strokes_[static_cast<std::size_t>(i)];
    if (!insides_[static_cast<std::size_t>(i)].empty())
      return {RouteStop::Kind::one_direction,
              {estimates_[static_cast<std::size_t>(i)].entry, estimates_[static_cast<std::size_t>(i)].exit}};
    // An even number of passes ends where it began.
    const bool there_and_back = !stroke.closed && !stroke.fixed_direction && stroke.passes % 2 == 0;
    return {stroke.closed || there_and_back ? RouteStop::Kind::loop
            : stroke.fixed_direction        ? RouteStop::Kind::one_direction
                                            : RouteStop::Kind::line,
            doors(stroke)};
  }

  std::vector<RouteStep> route(const std::vector<int>& group, const Vec2& from) const {
    std::vector<RouteStop> stops;
    for (const int i : group) stops.push_back(stop_of(i));
    return short_route(stops, from, context_);
  }

  int nearest_door(int i, const Vec2& from, const std::optional<Vec2>& to) const {
    const auto places = doors(strokes_[static_cast<std::size_t>(i)]);
    int best = 0;
    double best_mm = std::numeric_limits<double>::max();
    for (std::size_t d = 0; d < places.size(); ++d)
      if (const double mm = (places[d] - from).norm() + (to ? (*to - places[d]).norm() : 0); mm < best_mm) {
        best_mm = mm;
        best = static_cast<int>(d);
      }
    return best;
  }

  void estimate(int i) {
    const auto& inner = insides_[static_cast<std::size_t>(i)];
    if (inner.empty()) return;
    for (const int k : inner) estimate(k);
    const Vec2 corner = strokes_[static_cast<std::size_t>(i)].points_mm.front();
    const auto steps = route(inner, corner);
    const RouteStop first = stop_of(inner[static_cast<std::size_t>(steps.front().stop)]),
                    last = stop_of(inner[static_cast<std::size_t>(steps.back().stop)]);
    const Vec2 left = last.doors_mm[static_cast<std::size_t>(
        last.kind == RouteStop::Kind::loop ? steps.back().door : 1 - steps.back().door)];
    const auto places = doors(strokes_[static_cast<std::size_t>(i)]);
    estimates_[static_cast<std::size_t>(i)] = {first.doors_mm[static_cast<std::size_t>(steps.front().door)],
                                               places[static_cast<std::size_t>(nearest_door(i, left, std::nullopt))]};
  }

  void emit(const std::vector<int>& group, const std::optional<Vec2>& then) {
    const auto steps = route(group, at_);
    for (std::size_t s = 0; s < steps.size(); ++s) {
      const int i = group[static_cast<std::size_t>(steps[s].stop)];
      std::optional<Vec2> next = then;
      if (s + 1 < steps.size()) {
        const RouteStop stop = stop_of(group[static_cast<std::size_t>(steps[s + 1].stop)]);
        next = stop.doors_mm[static_cast<std::size_t>(steps[s + 1].door)];
      }
      const LaserStroke& stroke = strokes_[static_cast<std::size_t>(i)];
      int door = steps[s].door;
      if (const auto& inner = insides_[static_cast<std::size_t>(i)]; !inner.empty()) {
        emit(inner, std::nullopt);
        door = nearest_door(i, at_, next);
      }
      const auto places = doors(stroke);
      const int last_point = static_cast<int>(stroke.points_mm.size()) - 1;
      const bool back = !stroke.closed && stroke.passes % 2 == 0 && !stroke.fixed_direction;
      runs_.push_back({i, stroke.closed ? door : door == 0 ? 0 : last_point});
      at_ = stroke.closed || back ? places[static_cast<std::size_t>(door)] : places[static_cast<std::size_t>(1 - door)];
    }
  }

  const std::vector<LaserStroke>& strokes_;
  bool free_start_;
  const Context& context_;
  std::vector<int> roots_;
  std::vector<std::vector<int>> insides_;
  std::vector<Estimate> estimates_;
  std::vector<StrokeRun> runs_;
  Vec2 at_{0, 0};
};

}  // namespace

std::vector<StrokeRun> order_strokes(const std::vector<LaserStroke>& strokes, const Vec2& start_mm, bool free_start,
                                     const Context& context) {
  return Order(strokes, free_start, context).run(start_mm);
}

}  // namespace formwright
