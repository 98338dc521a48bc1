// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/pieces/closure_marks.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "geometry/planar/plane.h"
#include "zippable/plan/pieces/tape_runs.h"

namespace formwright {
namespace {

/// Per point of an open polyline, how far it moves for edges to move by 1 to the left: to where they meet, by 2 at
/// most.
std::vector<Vec2> miters(const std::vector<Vec2>& points) {
  std::vector<Vec2> result;
  const auto normal = [&](std::size_t i) {
    const Vec2 segment = points[i + 1] - points[i];
    return Vec2(Vec2(-segment.y(), segment.x()) / std::max(segment.norm(), 1e-12));
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 before = normal(i > 0 ? i - 1 : 0), after = normal(i + 1 < points.size() ? i : i - 1),
               sum = before + after;
    result.push_back(sum / std::max(1 + before.dot(after), 0.5 * sum.norm()));
  }
  return result;
}

double distance_to_mm(const std::vector<Vec2>& line, const Vec2& p) {
  double minimum = 1e300;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vec2 segment = line[i + 1] - line[i];
    const double t = std::clamp((p - line[i]).dot(segment) / std::max(segment.squaredNorm(), 1e-24), 0.0, 1.0);
    minimum = std::min(minimum, (p - line[i] - t * segment).norm());
  }
  return minimum;
}

class Marking {
 public:
  Marking(const FlatDesign& design, const std::vector<Vec2>& flat, const Splitting& splitting,
          const ClosureMarkOptions& options, const Context& context)
      : design_(design),
        flat_(flat),
        splitting_(splitting),
        options_(options),
        context_(context),
        faces_(std::size_t(splitting.piece_count)) {
    for (int f = 0; f < design.F.rows(); ++f) faces_[splitting.piece_of_face[f]].push_back(f);
  }

  ClosureMarks marks;

  void mark(int cut, const HandleClosure& closure) {
    marks.length_mm.push_back(closure.length_mm);
    const std::size_t first = marks.stretches.size();
    for (const ClosureSide side : {ClosureSide::hook, ClosureSide::loop})
      add_stretches(cut, side, closure.sides[static_cast<std::size_t>(side)]);
    for (std::size_t i = first; i < marks.stretches.size(); ++i) {
      context_.check_cancelled();
      const ClosureStretch& stretch = marks.stretches[i];
      if (stretch.side == ClosureSide::hook && options_.tape_mm > 0) add_tape_edge(stretch);
      if (stretch.side == ClosureSide::loop && options_.flap_mm > 0) add_flaps(stretch);
    }
    // A loop's end is its beginning.
    const double end = closure.length_mm * (closure.closed ? 1 - 1e-9 : 1 + 1e-9);
    for (int number = 0; number * options_.marker_spacing_mm < end; ++number) {
      const double along = number * options_.marker_spacing_mm;
      const auto hook = place(closure.sides[0], along), loop = place(closure.sides[1], along);
      if (hook && loop) marks.markers.push_back({cut, number, along, {*hook, *loop}});
    }
  }

 private:
  void add_stretches(int cut, ClosureSide side, const std::vector<ClosureRun>& runs) {
    const std::vector<int> face = faces_of_boundary(design_.F, design_.vertex_count());
    ClosureStretch* last = nullptr;
    for (const ClosureRun& run : runs)
      for (int k = 0; k < run.edge_count(); ++k) {
        const int v = design_.vertex_of(run, k), piece = splitting_.piece_of_face[face[v]];
        if (!last || last->piece != piece || last->vertices.back() != v) {
          marks.stretches.push_back({cut, side, piece, {v}, run.along_mm[k], 0});
          last = &marks.stretches.back();
        }
        last->vertices.push_back(design_.next(v));
        last->to_mm = run.along_mm[k + 1];
      }
  }

  /// On an edge's line, as far from its ends in the plane as the cut's place is from theirs in space: where room was
  /// made for the zipper the edge's end has moved along it. None where the place is gone with that.
  std::optional<SideMark> place(const std::vector<ClosureRun>& runs, double along) const {
    for (const ClosureRun& run : runs)
      for (int k = 0; k < run.edge_count(); ++k) {
        const double from = run.along_mm[k], to = run.along_mm[k + 1], share = (along - from) / (to - from);
        if (!(share >= -1e-9 && share <= 1 + 1e-9)) continue;
        const int a = design_.vertex_of(run, k), b = design_.next(a);
        const Vec2 segment = flat_[b] - flat_[a];
        const double length = segment.norm(), whole = design_.length_in_space_mm(a, b), lost = whole - length;
        if (!(length > 0)) continue;
        const bool a_moved = design_.boundary[a].sample >= 0, b_moved = design_.boundary[b].sample >= 0;
        const double at = share * whole - (a_moved && b_moved ? 0.5 * lost : a_moved ? lost : 0.0);
        if (at < -1e-6 * whole || at > length + 1e-6 * whole) continue;
        const Vec2 u = segment / length;
        return SideMark{flat_[a] + std::clamp(at, 0.0, length) * u, u, Vec2(-u.y(), u.x()), a};
      }
    return std::nullopt;
  }

  std::vector<Vec2> line_of(const ClosureStretch& stretch) const {
    std::vector<Vec2> line;
    line.reserve(stretch.vertices.size());
    for (const int v : stretch.vertices) line.push_back(flat_[v]);
    return line;
  }

  bool inside(int piece, const Vec2& p) const {
    return std::any_of(faces_[piece].begin(), faces_[piece].end(), [&](int f) {
      for (int k = 0; k < 3; ++k) {
        const Vec2 &a = flat_[design_.F(f, k)], &b = flat_[design_.F(f, (k + 1) % 3)];
        if (cross(b - a, p - a) < 0) return false;
      }
      return true;
    });
  }

  /// Only where it lies on the piece, and not where a bend of the edge comes nearer than the tape is wide.
  void add_tape_edge(const ClosureStretch& stretch) {
    constexpr double step_mm = 1;
    const std::vector<Vec2> line = line_of(stretch), miter = miters(line);
    std::vector<Vec2> run;
    const auto end_run = [&] {
      if (run.size() > 1) marks.tape_edges.push_back({stretch.cut, stretch.piece, run});
      run.clear();
    };
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
      const Vec2 from = line[i] + options_.tape_mm * miter[i], to = line[i + 1] + options_.tape_mm * miter[i + 1];
      const double length = (line[i + 1] - line[i]).norm();
      const int count = std::max(1, static_cast<int>(std::ceil(std::max(length, (to - from).norm()) / step_mm)));
      bool before = false;
      for (int k = 0; k <= count; ++k) {
        const Vec2 p = from + static_cast<double>(k) / count * (to - from);
        const bool good = inside(stretch.piece, p) && distance_to_mm(line, p) > 0.98 * options_.tape_mm;
        if (!good) {
          end_run();
          if (k > 0) marks.narrow_mm += length / count;
        } else {
          // Points on one edge are on one straight line: the last replaces the one before.
          if (run.size() > 1 && before && k > 1) run.back() = p;
          else if (run.empty() || (run.back() - p).norm() > 1e-9) run.push_back(p);
        }
        before = good && !(run.size() < 2);
      }
    }
    end_run();
  }

  void add_flaps(const ClosureStretch& stretch) {
    ClosureStretch part = stretch;
    part.vertices = {stretch.vertices.front()};
    double length = 0;
    for (std::size_t i = 1; i < stretch.vertices.size(); ++i) {
      const double edge = (flat_[stretch.vertices[i]] - flat_[stretch.vertices[i - 1]]).norm();
      if (options_.flap_length_mm > 0 && part.vertices.size() > 1 && length + edge > options_.flap_length_mm) {
        add_flap(part);
        part.vertices = {stretch.vertices[i - 1]};
        length = 0;
      }
      part.vertices.push_back(stretch.vertices[i]);
      length += edge;
    }
    add_flap(part);
  }

  /// Tapered at 45 degrees from both ends, and less deep wherever it would meet its own piece, another flap or itself.
  void add_flap(const ClosureStretch& stretch) {
    constexpr int max_rounds = 8;
    const std::vector<Vec2> edge = line_of(stretch);
    const double length = std::inner_product(edge.begin() + 1, edge.end(), edge.begin(), 0.0, std::plus<>(),
                                             [](const Vec2& a, const Vec2& b) { return (a - b).norm(); });
    const double depth = std::min(options_.flap_mm, 0.25 * length);
    if (!(depth > 1e-3)) return;
    std::vector<Vec2> foot{edge.front()};
    std::vector<double> at{0}, deep;
    std::vector<int> vertex{0};  // per edge of the foot: the stretch's vertex where its edge begins
    double done = 0;
    for (std::size_t i = 0; i + 1 < edge.size(); ++i) {
      const double step = (edge[i + 1] - edge[i]).norm();
      for (const double ramp : {depth, length - depth})
        if (ramp > done + 0.05 * depth && ramp < done + step - 0.05 * depth) {
          foot.push_back(edge[i] + (ramp - done) / step * (edge[i + 1] - edge[i]));
          at.push_back(ramp), vertex.push_back(static_cast<int>(i));
        }
      done += step;
      foot.push_back(edge[i + 1]);
      at.push_back(done), vertex.push_back(static_cast<int>(i + 1));
    }
    for (const double mm : at) deep.push_back(std::clamp(std::min(mm, length - mm), 0.0, depth));
    const std::vector<double> wanted = deep;
    const std::vector<Vec2> miter = miters(foot);
    const auto outer = [&](std::size_t j) { return Vec2(foot[j] - deep[j] * miter[j]); };
    using Triangle = std::array<Vec2, 3>;
    const auto triangles = [&](std::size_t j) {
      std::vector<Triangle> list;
      if (deep[j] > 0) list.push_back({foot[j], outer(j), outer(j + 1)});
      if (deep[j + 1] > 0) list.push_back({foot[j], outer(j + 1), foot[j + 1]});
      return list;
    };
    const auto fails = [&](std::size_t j) {
      const std::vector<Triangle> mine = triangles(j);
      const Vec2 segment = foot[j + 1] - foot[j];
      if (!mine.empty() && !((outer(j + 1) - outer(j)).dot(segment) > 0.05 * segment.squaredNorm())) return true;
      const auto meets = [&](const Triangle& other, double touching_mm) {
        return std::any_of(mine.begin(), mine.end(),
                           [&](const Triangle& t) { return triangles_overlap(t, other, touching_mm); });
      };
      const int count = design_.vertex_count(), v = stretch.vertices[vertex[j]];
      for (const int f : faces_[stretch.piece]) {
        bool beside = false;
        for (int k = 0; k < 3; ++k) beside |= (design_.F(f, k) - v + 1 + count) % count <= 3;
        if (meets({flat_[design_.F(f, 0)], flat_[design_.F(f, 1)], flat_[design_.F(f, 2)]},
                  beside ? 1e-7 : -options_.clearance_mm))
          return true;
      }
      for (const EdgeFlap& flap : marks.flaps) {
        if (flap.piece != stretch.piece) continue;
        const bool next = flap.to_vertex == stretch.vertices.front() || flap.from_vertex == stretch.vertices.back();
        for (const Triangle& t : flap.triangles)
          if (meets(t, next ? 1e-7 : -options_.clearance_mm)) return true;
      }
      for (std::size_t i = 0; i + 1 < j; ++i)
        for (const Triangle& t : triangles(i))
          if (meets(t, i + 2 < j ? -options_.clearance_mm : 1e-7)) return true;
      return false;
    };
    for (int round = 0; round <= max_rounds; ++round) {
      std::vector<char> bad(foot.size(), 0);
      for (std::size_t j = 0; j + 1 < foot.size(); ++j)
        if (fails(j)) bad[j] = bad[j + 1] = 1;
      if (std::none_of(bad.begin(), bad.end(), [](char b) { return b; })) break;
      for (std::size_t j = 0; j < foot.size(); ++j)
        if (bad[j]) deep[j] = round + 2 > max_rounds ? 0 : deep[j] / 2;
    }
    EdgeFlap flap{stretch.piece, stretch.vertices.front(), stretch.vertices.back(), {}, {}};
    for (std::size_t j = 0; j + 1 < foot.size(); ++j) {
      if (j > 0) flap.outer_mm.push_back(outer(j));
      for (const Triangle& t : triangles(j)) flap.triangles.push_back(t);
      if (deep[j] < 0.99 * wanted[j] || deep[j + 1] < 0.99 * wanted[j + 1]) marks.shallow_mm += at[j + 1] - at[j];
    }
    if (!flap.triangles.empty()) marks.flaps.push_back(std::move(flap));
  }

  const FlatDesign& design_;
  const std::vector<Vec2>& flat_;
  const Splitting& splitting_;
  const ClosureMarkOptions& options_;
  const Context& context_;
  std::vector<std::vector<int>> faces_;  // per piece
};

}  // namespace

double ClosureMarks::total_mm() const { return std::accumulate(length_mm.begin(), length_mm.end(), 0.0); }

ClosureMarks mark_closures(const FlatDesign& design, const std::vector<Vec2>& flat_mm, const Splitting& splitting,
                           const ClosureMarkOptions& options, const Context& context) {
  Marking marking(design, flat_mm, splitting, options, context);
  for (std::size_t i = 0; i < design.closures.size(); ++i) marking.mark(static_cast<int>(i) + 1, design.closures[i]);
  return std::move(marking.marks);
}

std::string closure_words(int cut, ClosureSide side, bool tape) {
  return std::string(!tape ? "JOIN " : side == ClosureSide::hook ? "HOOK " : "LOOP ") + std::to_string(cut);
}

}  // namespace formwright
