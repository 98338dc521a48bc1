// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/curve/handle_closure.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "zippable/curve/zipper_curve.h"

namespace formwright {
namespace {

using Key = std::array<double, 3>;

Key key_of(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

}  // namespace

double TapedCuts::Cut::apart_mm(double a, double b) const {
  const double gap = std::abs(a - b);
  return closed ? std::min(gap, length_mm - gap) : gap;
}

TapedCuts::TapedCuts(const Segmentation& s, const Parameterisation& p, const std::vector<TapedCut>& cuts)
    : period_mm_(p.period_mm) {
  struct Step {
    int cut;
    double from_mm, to_mm;
  };
  std::map<std::pair<Key, Key>, Step> steps;  // by both ends
  for (std::size_t c = 0; c < cuts.size(); ++c) {
    const auto& points = cuts[c].points_mm;
    Cut cut;
    cut.closed = cuts[c].closed;
    for (std::size_t i = 0; i + (cut.closed ? 0 : 1) < points.size(); ++i) {
      const Vec3 &a = points[i], &b = points[(i + 1) % points.size()];
      const double from = cut.length_mm;
      cut.length_mm += (b - a).norm();
      steps[{key_of(a), key_of(b)}] = {static_cast<int>(c), from, cut.length_mm};
    }
    cuts_.push_back(std::move(cut));
  }
  if (cuts.empty()) return;
  const Adjacency adjacency(s.mesh);
  for (int h = 0; h < 3 * s.mesh.face_count(); ++h) {
    if (adjacency.opposite(h) >= 0) continue;
    const Key a = key_of(s.mesh.V.row(adjacency.from(h)).transpose()),
              b = key_of(s.mesh.V.row(adjacency.to(h)).transpose());
    const auto ahead = steps.find({a, b}), against = steps.find({b, a});
    if (ahead == steps.end() && against == steps.end()) continue;
    const bool left = ahead != steps.end();
    const Step& step = left ? ahead->second : against->second;
    const double xa = p.corners_mm(h, 0), xb = p.corners_mm(next_halfedge(h), 0);
    Span span{xa, xb, step.cut, left ? 0 : 1, left ? step.from_mm : step.to_mm, left ? step.to_mm : step.from_mm};
    const bool upper = xb < xa;  // upper lines are walked towards smaller x
    if (upper) std::swap(span.from_mm, span.to_mm), std::swap(span.along_from_mm, span.along_to_mm);
    lines_[{s.face_segment[h / 3], upper}].push_back(span);
  }
  // Where a line comes to a cut or leaves it, both sides of the cut need a corner.
  for (auto& [which, spans] : lines_) {
    std::sort(spans.begin(), spans.end(), [](const Span& a, const Span& b) { return a.from_mm < b.from_mm; });
    const double period = p.period_mm[which.first];
    for (const Span& span : spans)
      for (const bool end : {false, true}) {
        const double x = end ? span.to_mm : span.from_mm, along = end ? span.along_to_mm : span.along_from_mm;
        const bool goes_on = std::any_of(spans.begin(), spans.end(), [&](const Span& other) {
          const double there = end ? other.from_mm : other.to_mm, turns = (x - there) / period;
          return other.cut == span.cut && other.side == span.side && std::abs(turns - std::round(turns)) < 1e-9 &&
                 cuts_[span.cut].apart_mm(end ? other.along_from_mm : other.along_to_mm, along) <
                     1e-9 * cuts_[span.cut].length_mm;
        });
        if (!goes_on) cuts_[span.cut].corners_mm.push_back(along);
      }
  }
}

const std::vector<TapedCuts::Span>& TapedCuts::line(int part, bool upper) const {
  static const std::vector<Span> none;
  const auto found = lines_.find({part, upper});
  return found == lines_.end() ? none : found->second;
}

std::optional<TapedCuts::Place> TapedCuts::at(int part, bool upper, double x, double towards) const {
  const double period = period_mm_[part], inside = x + 1e-7 * (towards - x);
  for (const Span& span : line(part, upper)) {
    const double shift = period * std::floor((inside - span.from_mm) / period);
    if (inside - shift >= span.to_mm) continue;
    return Place{span.cut, span.side,
                 std::clamp(span.along_at(x - shift), std::min(span.along_from_mm, span.along_to_mm),
                            std::max(span.along_from_mm, span.along_to_mm))};
  }
  return std::nullopt;
}

void TapedCuts::place_on(OpeningArc& arc, double grid_step_mm) const {
  const double period = period_mm_[arc.part], low = std::min(arc.from_mm, arc.to_mm),
               high = std::max(arc.from_mm, arc.to_mm), hair = 1e-9 * period;
  std::vector<double> places;
  for (const Span& span : line(arc.part, arc.upper)) {
    const Cut& cut = cuts_[span.cut];
    const double first = period * std::floor((low - span.from_mm) / period);
    for (double shift = first; span.from_mm + shift < high; shift += period)
      for (const double shared : cut.shared_mm)
        for (const double along : {shared, shared + cut.length_mm}) {  // a loop's origin is its end, too
          const double share = (along - span.along_from_mm) / (span.along_to_mm - span.along_from_mm);
          const double x = span.from_mm + shift + share * (span.to_mm - span.from_mm);
          if (share >= -1e-12 && share <= 1 + 1e-12 && x > low + hair && x < high - hair) places.push_back(x);
        }
  }
  for (const int i : arc.grid) {
    const double x = i * grid_step_mm;
    const bool beside = std::any_of(places.begin(), places.end(),
                                    [&](double other) { return std::abs(other - x) < 0.3 * grid_step_mm; });
    if (!beside && !at(arc.part, arc.upper, x, x + hair)) places.push_back(x);
  }
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end(), [&](double a, double b) { return b - a < hair; }),
               places.end());
  if (arc.to_mm < arc.from_mm) std::reverse(places.begin(), places.end());
  // Rulings go from the nearest corner, in the same order.
  std::vector<int> grid(places.size(), no_grid);
  const auto off = [&](std::size_t k, int i) { return std::abs(places[k] - i * grid_step_mm); };
  for (const int i : arc.grid) {
    if (places.empty()) break;
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < places.size(); ++k)
      if (off(k, i) < off(nearest, i)) nearest = k;
    if (grid[nearest] == no_grid || off(nearest, i) < off(nearest, grid[nearest])) grid[nearest] = i;
  }
  arc.places_mm = std::move(places), arc.grid = std::move(grid);
}

void TapedCuts::share_places(std::vector<OpeningArc>& arcs, const std::vector<double>& grid_step_mm, double sample_mm) {
  std::vector<int> origin_side(cuts_.size(), 2);
  for (const OpeningArc& arc : arcs)
    for (const bool end : {false, true}) {
      const auto place = at(arc.part, arc.upper, end ? arc.to_mm : arc.from_mm, end ? arc.from_mm : arc.to_mm);
      if (!place) continue;
      Cut& cut = cuts_[place->cut];
      cut.corners_mm.push_back(place->along_mm);
      if (cut.closed && place->side < origin_side[place->cut])
        cut.origin_mm = place->along_mm, origin_side[place->cut] = place->side;
    }
  for (Cut& cut : cuts_) {
    for (double& corner : cut.corners_mm)
      if (cut.closed && corner >= cut.length_mm) corner -= cut.length_mm;
    std::sort(cut.corners_mm.begin(), cut.corners_mm.end());
    for (const double corner : cut.corners_mm) {
      const auto there = [&](double other) { return cut.apart_mm(corner, other) < 1e-9 * cut.length_mm; };
      if (std::none_of(cut.shared_mm.begin(), cut.shared_mm.end(), there)) cut.shared_mm.push_back(corner);
    }
    // Exactly one of them, so that a loop begins at 0 and ends at its length.
    if (cut.closed && !cut.shared_mm.empty())
      cut.origin_mm = *std::min_element(cut.shared_mm.begin(), cut.shared_mm.end(), [&](double a, double b) {
        return cut.apart_mm(a, cut.origin_mm) < cut.apart_mm(b, cut.origin_mm);
      });
  }
  for (const OpeningArc& arc : arcs)
    for (const int i : arc.grid) {
      const double x = i * grid_step_mm[arc.part];
      const auto place = at(arc.part, arc.upper, x, x + 1e-9 * period_mm_[arc.part]);
      if (!place || place->side != 0) continue;
      Cut& cut = cuts_[place->cut];
      const auto near = [&](double corner) { return cut.apart_mm(place->along_mm, corner) < 0.3 * sample_mm; };
      if (std::none_of(cut.corners_mm.begin(), cut.corners_mm.end(), near)) cut.shared_mm.push_back(place->along_mm);
    }
  for (OpeningArc& arc : arcs) place_on(arc, grid_step_mm[arc.part]);
}

double TapedCuts::from_origin_mm(const Cut& cut, double along, double near) const {
  // Both sides say exactly the same of what meets.
  for (const double shared : cut.shared_mm)
    if (cut.apart_mm(along, shared) < 1e-8 * cut.length_mm) along = shared;
  double result = along - cut.origin_mm;
  if (cut.closed) result += cut.length_mm * std::round((near - result) / cut.length_mm);
  return std::clamp(result, 0.0, cut.length_mm);
}

std::vector<HandleClosure> TapedCuts::closures(const std::vector<OpeningArc>& arcs, int vertex_count) const {
  std::vector<HandleClosure> result;
  result.reserve(cuts_.size());
  for (const Cut& cut : cuts_) result.push_back({cut.length_mm, cut.closed, {}});
  for (const OpeningArc& arc : arcs) {
    std::vector<double> x{arc.from_mm};
    x.insert(x.end(), arc.places_mm.begin(), arc.places_mm.end());
    x.push_back(arc.to_mm);
    ClosureRun* run = nullptr;
    int run_cut = -1, run_side = -1;
    for (std::size_t k = 0; k + 1 < x.size(); ++k) {
      const double middle = 0.5 * (x[k] + x[k + 1]);
      const auto here = at(arc.part, arc.upper, middle, x[k + 1]), from = at(arc.part, arc.upper, x[k], middle),
                 to = at(arc.part, arc.upper, x[k + 1], middle);
      if (!here || !from || !to || from->cut != here->cut || to->cut != here->cut) {
        run = nullptr;
        continue;
      }
      const Cut& cut = cuts_[here->cut];
      double near = here->along_mm - cut.origin_mm;
      if (near < 0) near += cut.length_mm;
      const double a = from_origin_mm(cut, from->along_mm, near), b = from_origin_mm(cut, to->along_mm, near);
      if (!run || run_cut != here->cut || run_side != here->side || run->along_mm.back() != a) {
        auto& runs = result[here->cut].sides[here->side];
        runs.push_back({static_cast<int>((arc.first_vertex + static_cast<int>(k)) % vertex_count), {a}});
        run = &runs.back(), run_cut = here->cut, run_side = here->side;
      }
      run->along_mm.push_back(b);
    }
  }
  std::erase_if(result,
                [](const HandleClosure& closure) { return closure.sides[0].empty() || closure.sides[1].empty(); });
  return result;
}

}  // namespace formwright
