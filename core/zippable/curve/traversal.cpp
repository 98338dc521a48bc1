// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/curve/traversal.h"

#include <algorithm>
#include <cmath>

namespace formwright {
namespace {

/// x on a part's lower line of a point of an interface, as offset + sign * along.
struct LinePlace {
  double offset = 0, sign = 1;
};

LinePlace place_on_line(const Segmentation& s, const Parameterisation& p, int part, int interface) {
  double before = 0;
  for (const InterfaceUse& use : s.segments[part].bottom.uses) {
    const double length = p.interface_length_mm[use.interface];
    if (use.interface == interface) return use.forward ? LinePlace{before, 1} : LinePlace{before + length, -1};
    before += length;
  }
  return {};
}

double wrapped(double x, double period) { return x - period * std::floor(x / period); }

/// Depth first, in lexicographic order; a path that cannot reach the end is given up as soon as that shows.
class TraversalSearch {
 public:
  TraversalSearch(const Segmentation& s, int limit, const Context& context)
      : limit_(static_cast<std::size_t>(limit)),
        context_(context),
        neighbours_(s.part_count()),
        visited_(s.part_count(), 0) {
    for (int i = 0; i < static_cast<int>(s.interfaces.size()); ++i) {
      neighbours_[s.interfaces[i].left].emplace_back(s.interfaces[i].right, i);
      neighbours_[s.interfaces[i].right].emplace_back(s.interfaces[i].left, i);
    }
    for (auto& list : neighbours_) std::sort(list.begin(), list.end());
  }

  std::vector<Traversal> run() {
    for (int part = 0; part < static_cast<int>(neighbours_.size()) && !done(); ++part) visit(part);
    return std::move(found_);
  }

 private:
  bool done() const { return found_.size() >= limit_ || steps_ > max_steps; }

  void visit(int part) {
    if (++steps_ % 1024 == 0) context_.check_cancelled();
    visited_[part] = 1;
    current_.parts.push_back(part);
    if (current_.parts.size() == neighbours_.size()) found_.push_back(current_);
    else if (can_be_finished(part))
      for (const auto& [next, interface] : neighbours_[part]) {
        if (done()) break;
        if (visited_[next]) continue;
        current_.interfaces.push_back(interface);
        visit(next);
        current_.interfaces.pop_back();
      }
    current_.parts.pop_back();
    visited_[part] = 0;
  }

  /// Every part that is left is reached from here over parts that are left, and at most one is a dead end.
  bool can_be_finished(int here) const {
    std::vector<char> seen = visited_;
    std::vector<int> open{here};
    std::size_t reached = current_.parts.size();
    int dead_ends = 0;
    while (!open.empty()) {
      const int part = open.back();
      open.pop_back();
      int exits_on = 0, last = -1;
      for (const auto& [next, interface] : neighbours_[part]) {
        if ((!visited_[next] || next == here) && next != last) ++exits_on, last = next;
        if (seen[next]) continue;
        seen[next] = 1;
        ++reached;
        open.push_back(next);
      }
      if (part != here && exits_on < 2 && ++dead_ends > 1) return false;
    }
    return reached == neighbours_.size();
  }

  static constexpr std::size_t max_steps = 3'000'000;  // some seconds; only graphs that nobody draws take more
  std::size_t limit_, steps_ = 0;
  const Context& context_;
  std::vector<std::vector<std::pair<int, int>>> neighbours_;  // neighbour, interface
  std::vector<char> visited_;
  Traversal current_;
  std::vector<Traversal> found_;
};

}  // namespace

std::vector<Traversal> traversals(const Segmentation& s, const Context& context, int limit) {
  return TraversalSearch(s, limit, context).run();
}

Crossings best_crossings(const Segmentation& s, const Parameterisation& p, const Traversal& traversal, double margin) {
  const int count = static_cast<int>(traversal.interfaces.size()), parts = static_cast<int>(traversal.parts.size());
  Crossings result;
  result.along_mm.resize(count);
  std::vector<double> low(count), high(count), middle(count);
  for (int i = 0; i < count; ++i) {
    const double length = p.interface_length_mm[traversal.interfaces[i]];
    low[i] = margin * length, high[i] = (1 - margin) * length;
    result.along_mm[i] = middle[i] = 0.5 * length;
  }
  // Of every part in between: exit - entry - period / 2 = constant + so * along_out - si * along_in, in periods.
  struct Part {
    double constant, in, out;
  };
  std::vector<Part> between;
  for (int i = 1; i + 1 < parts; ++i) {
    const int part = traversal.parts[i];
    const double period = p.period_mm[part];
    const LinePlace in = place_on_line(s, p, part, traversal.interfaces[i - 1]),
                    out = place_on_line(s, p, part, traversal.interfaces[i]);
    // Both ends stay on their own interfaces, so that which comes first along the line never changes.
    const double difference = out.offset + out.sign * middle[i] - in.offset - in.sign * middle[i - 1];
    const double turns = difference < 0 ? period : 0;
    between.push_back({(out.offset - in.offset + turns) / period - 0.5, -in.sign / period, out.sign / period});
  }
  constexpr double pull = 1e-4;  // towards the middles, where (5.7) does not care
  for (int sweep = 0; sweep < 2000; ++sweep) {
    double moved = 0;
    for (int i = 0; i < count; ++i) {
      const double length = p.interface_length_mm[traversal.interfaces[i]];
      double slope = pull * (result.along_mm[i] - middle[i]) / (length * length), curvature = pull / (length * length);
      const auto add = [&](int k, double factor) {
        if (k < 0 || k >= static_cast<int>(between.size())) return;
        const double misfit =
            between[k].constant + between[k].in * result.along_mm[k] + between[k].out * result.along_mm[k + 1];
        slope += factor * misfit, curvature += factor * factor;
      };
      if (i < static_cast<int>(between.size())) add(i, between[i].in);
      if (i > 0) add(i - 1, between[i - 1].out);
      const double next = std::clamp(result.along_mm[i] - slope / curvature, low[i], high[i]);
      moved = std::max(moved, std::abs(next - result.along_mm[i]) / length);
      result.along_mm[i] = next;
    }
    if (moved < 1e-13) break;
  }
  result.entry_mm.assign(parts, 0);
  result.exit_mm.assign(parts, 0);
  for (int i = 0; i < parts; ++i) {
    const int part = traversal.parts[i];
    const double period = p.period_mm[part];
    const auto x = [&](int k) {
      const LinePlace place = place_on_line(s, p, part, traversal.interfaces[k]);
      return place.offset + place.sign * result.along_mm[k];
    };
    if (i > 0) result.entry_mm[i] = wrapped(x(i - 1), period);
    if (i + 1 < parts) result.exit_mm[i] = wrapped(x(i), period);
    if (i == 0 || i + 1 == parts) continue;
    if (result.exit_mm[i] <= result.entry_mm[i]) result.exit_mm[i] += period;
    const double misfit = (result.exit_mm[i] - result.entry_mm[i]) / period - 0.5;
    result.unevenness += misfit * misfit / (parts - 2);
  }
  return result;
}

LinePoint across_interface(const Segmentation& s, const Parameterisation& p, LinePoint point) {
  const double x = wrapped(point.x_mm, p.period_mm[point.part]);
  double before = 0;
  const auto& uses = s.segments[point.part].bottom.uses;
  for (std::size_t k = 0; k < uses.size(); ++k) {
    const InterfaceUse& use = uses[k];
    const double length = p.interface_length_mm[use.interface];
    if (x < before + length || k + 1 == uses.size()) {
      const Interface& interface = s.interfaces[use.interface];
      const int other = use.forward ? interface.right : interface.left;
      const double along = use.forward ? x - before : before + length - x;
      const LinePlace place = place_on_line(s, p, other, use.interface);
      return {other, wrapped(place.offset + place.sign * along, p.period_mm[other])};
    }
    before += length;
  }
  return point;
}

std::vector<RankedTraversal> ranked_traversals(const Segmentation& s, const Parameterisation& p, double width_mm,
                                               const Context& context, int limit) {
  std::vector<RankedTraversal> ranked;
  for (Traversal& traversal : traversals(s, context, limit)) {
    RankedTraversal r;
    r.crossings = best_crossings(s, p, traversal);
    r.cost = r.crossings.unevenness;
    for (const int interface : traversal.interfaces) {
      const double lack = 1 - p.interface_length_mm[interface] / width_mm;
      if (lack > 0) r.cost += lack * lack;
    }
    r.cost =
        1e-6 * std::round(1e6 * r.cost);  // orders as even as each other stay in their own order, whatever the rounding
    r.traversal = std::move(traversal);
    ranked.push_back(std::move(r));
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const RankedTraversal& a, const RankedTraversal& b) { return a.cost < b.cost; });
  return ranked;
}

}  // namespace formwright
