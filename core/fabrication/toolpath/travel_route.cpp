// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/toolpath/travel_route.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace formwright {
namespace {

using Kind = RouteStop::Kind;

const Vec2& exit_of(const RouteStop& stop, int door) {
  return stop.kind == Kind::loop ? stop.doors_mm[static_cast<std::size_t>(door)]
                                 : stop.doors_mm[static_cast<std::size_t>(1 - door)];
}

/// Doors in the cells of a grid, for the nearest one that is still to be visited.
class DoorGrid {
 public:
  explicit DoorGrid(const std::vector<RouteStop>& stops) : left_(stops.size(), true) {
    Vec2 low(1e300, 1e300), high(-1e300, -1e300);
    std::size_t count = 0;
    for (const RouteStop& stop : stops)
      for (const Vec2& door : stop.doors_mm) {
        low = low.cwiseMin(door);
        high = high.cwiseMax(door);
        ++count;
      }
    const Vec2 size = (high - low).cwiseMax(1e-3);
    low_ = low;
    cell_mm_ = std::max(std::sqrt(size.x() * size.y() / static_cast<double>(std::max<std::size_t>(1, count)) * 2),
                        size.maxCoeff() / 1000);
    columns_ = 1 + static_cast<int>(size.x() / cell_mm_);
    rows_ = 1 + static_cast<int>(size.y() / cell_mm_);
    cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    for (std::size_t s = 0; s < stops.size(); ++s) {
      const int doors = stops[s].kind == Kind::one_direction ? 1 : static_cast<int>(stops[s].doors_mm.size());
      for (int d = 0; d < doors; ++d) {
        const Vec2& at = stops[s].doors_mm[static_cast<std::size_t>(d)];
        cells_[cell(column(at.x()), row(at.y()))].push_back({{static_cast<int>(s), d}, at});
      }
    }
  }

  RouteStep take_nearest(const Vec2& p) {
    const int x = column(p.x()), y = row(p.y());
    RouteStep best{-1, 0};
    double best_squared = std::numeric_limits<double>::max();
    for (int ring = 0; ring < columns_ + rows_; ++ring) {
      // Cells of this ring are at least ring - 1 cells away; a point beyond the grid counts from its edge.
      const double minimum = std::max(0, ring - 1) * cell_mm_;
      if (best.stop >= 0 && minimum * minimum > best_squared) break;
      for (int r = std::max(0, y - ring); r <= std::min(rows_ - 1, y + ring); ++r) {
        const bool whole = r == y - ring || r == y + ring;
        for (int c = x - ring; c <= x + ring; c += whole || ring == 0 ? 1 : 2 * ring)
          if (c >= 0 && c < columns_) look(cells_[cell(c, r)], p, best, best_squared);
      }
    }
    left_[static_cast<std::size_t>(best.stop)] = false;
    return best;
  }

 private:
  struct Door {
    RouteStep step;
    Vec2 at;
  };
  int column(double x) const { return std::clamp(static_cast<int>((x - low_.x()) / cell_mm_), 0, columns_ - 1); }
  int row(double y) const { return std::clamp(static_cast<int>((y - low_.y()) / cell_mm_), 0, rows_ - 1); }
  std::size_t cell(int c, int r) const {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c);
  }

  void look(std::vector<Door>& doors, const Vec2& p, RouteStep& best, double& best_squared) {
    std::erase_if(doors, [&](const Door& door) { return !left_[static_cast<std::size_t>(door.step.stop)]; });
    for (const Door& door : doors)
      if (const double squared = (door.at - p).squaredNorm(); squared < best_squared) {
        best_squared = squared;
        best = door.step;
      }
  }

  std::vector<bool> left_;
  Vec2 low_;
  double cell_mm_ = 1;
  int columns_ = 1, rows_ = 1;
  std::vector<std::vector<Door>> cells_;
};

class Improver {
 public:
  Improver(const std::vector<RouteStop>& stops, std::vector<RouteStep>& route, const Vec2& start,
           const Context& context)
      : stops_(stops), route_(route), start_(start), context_(context), n_(static_cast<int>(route.size())) {
    window_ = n_ <= 2000 ? n_ : std::max(50, 4'000'000 / n_);
  }

  void two_opt() {
    for (int i = 0; i < n_; ++i) {
      if (i % 64 == 0) context_.check_cancelled();
      for (int j = i; j < std::min(n_, i + window_) && kind(j) != Kind::one_direction; ++j) {
        // A reversed row is entered where it was left.
        const double now = gap(before(i), entry(i)) + link(j), then = gap(before(i), exit(j)) + to_next(entry(i), j);
        if (then < now - 1e-9 && (i < j || kind(i) == Kind::line)) reverse(i, j);
      }
    }
  }

  void or_opt() {
    for (int i = 0; i < n_; ++i) {
      if (i % 64 == 0) context_.check_cancelled();
      for (int length = 1; length <= 3 && i + length <= n_; ++length) {
        const int last = i + length - 1;
        bool turnable = true;
        for (int k = i; k <= last; ++k) turnable = turnable && kind(k) != Kind::one_direction;
        const double gain = gap(before(i), entry(i)) + link(last) - to_next(before(i), last);
        if (gain < 1e-9) continue;
        double best = 1e-9;
        int best_at = -1;
        bool best_turned = false;
        for (int k = std::max(-1, i - window_); k < std::min(n_, i + window_); ++k) {
          if (k >= i - 1 && k <= last) continue;
          const Vec2 from = k < 0 ? start_ : exit(k);
          const double old = k < n_ - 1 ? gap(from, entry(k + 1)) : 0;
          for (const bool turned : {false, true}) {
            if (turned && !turnable) continue;
            const double added = gap(from, turned ? exit(last) : entry(i)) +
                                 (k < n_ - 1 ? gap(turned ? entry(i) : exit(last), entry(k + 1)) : 0) - old;
            if (gain - added > best) {
              best = gain - added;
              best_at = k;
              best_turned = turned;
            }
          }
        }
        if (best <= 1e-9) continue;
        if (best_turned) reverse(i, last);
        const auto from = route_.begin() + i, to = route_.begin() + last + 1;
        if (best_at < i) std::rotate(route_.begin() + best_at + 1, from, to);
        else std::rotate(from, to, route_.begin() + best_at + 1);
        break;
      }
    }
  }

  void better_doors() {
    for (int i = 0; i < n_; ++i) {
      if (kind(i) != Kind::loop) continue;
      const RouteStop& stop = stops_[static_cast<std::size_t>(route_[i].stop)];
      double best = std::numeric_limits<double>::max();
      for (std::size_t d = 0; d < stop.doors_mm.size(); ++d)
        if (const double length = gap(before(i), stop.doors_mm[d]) + to_next(stop.doors_mm[d], i); length < best) {
          best = length;
          route_[i].door = static_cast<int>(d);
        }
    }
  }

 private:
  static double gap(const Vec2& a, const Vec2& b) { return (b - a).norm(); }
  Kind kind(int i) const { return stops_[static_cast<std::size_t>(route_[i].stop)].kind; }
  const Vec2& entry(int i) const {
    return stops_[static_cast<std::size_t>(route_[i].stop)].doors_mm[static_cast<std::size_t>(route_[i].door)];
  }
  const Vec2& exit(int i) const { return exit_of(stops_[static_cast<std::size_t>(route_[i].stop)], route_[i].door); }
  Vec2 before(int i) const { return i == 0 ? start_ : exit(i - 1); }
  double to_next(const Vec2& from, int i) const { return i + 1 < n_ ? gap(from, entry(i + 1)) : 0; }
  double link(int i) const { return to_next(exit(i), i); }
  void reverse(int i, int j) {
    std::reverse(route_.begin() + i, route_.begin() + j + 1);
    for (int k = i; k <= j; ++k)
      if (kind(k) == Kind::line) route_[k].door = 1 - route_[k].door;
  }

  const std::vector<RouteStop>& stops_;
  std::vector<RouteStep>& route_;
  Vec2 start_;
  const Context& context_;
  int n_, window_;
};

}  // namespace

double route_length_mm(const std::vector<RouteStop>& stops, const std::vector<RouteStep>& route, const Vec2& start_mm) {
  double sum = 0;
  Vec2 at = start_mm;
  for (const RouteStep& step : route) {
    const RouteStop& stop = stops[static_cast<std::size_t>(step.stop)];
    sum += (stop.doors_mm[static_cast<std::size_t>(step.door)] - at).norm();
    at = exit_of(stop, step.door);
  }
  return sum;
}

std::vector<RouteStep> short_route(const std::vector<RouteStop>& stops, const Vec2& start_mm, const Context& context,
                                   int max_rounds) {
  std::vector<RouteStep> route;
  if (stops.empty()) return route;
  DoorGrid grid(stops);
  Vec2 at = start_mm;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    if (i % 256 == 0) context.check_cancelled();
    route.push_back(grid.take_nearest(at));
    at = exit_of(stops[static_cast<std::size_t>(route.back().stop)], route.back().door);
  }
  double length = route_length_mm(stops, route, start_mm);
  for (int round = 0; round < max_rounds; ++round) {
    std::vector<RouteStep> better = route;
    Improver improver(stops, better, start_mm, context);
    improver.two_opt();
    improver.or_opt();
    improver.better_doors();
    const double now = route_length_mm(stops, better, start_mm);
    const bool enough = now > 0.999 * length;
    if (now < length) {
      route = std::move(better);
      length = now;
    }
    if (enough) break;
  }
  return route;
}

}  // namespace formwright
