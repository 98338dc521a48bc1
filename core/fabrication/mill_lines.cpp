// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/mill_lines.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace formwright {
namespace {

constexpr double thinning_mm = 0.002, clearance_mm = 0.5;

class Lines {
 public:
  Lines(ToolpathBuilder& builder, const HeightField& tips, const MillMotion& motion, double material_mm, int pass)
      : builder_(builder), tips_(tips), motion_(motion), material_mm_(material_mm), pass_(pass) {}

  void run(const std::vector<MillRun>& runs, int stepover_rows) {
    bool down = false;
    int row = 0, column = 0;
    for (const MillRun& run : runs) {
      const bool neighbour = down && std::abs(run.row - row) <= stepover_rows;
      const bool back = neighbour ? std::abs(column - run.to) < std::abs(column - run.from) : false;
      const int first = back ? run.to : run.from, last = back ? run.from : run.to;
      if (neighbour && std::abs(column - first) <= 2 * std::max(1, stepover_rows)) {
        link(row, column, run.row, first);
      } else {
        flush();
        enter(run.row, first, last);
      }
      for (int c = first;; c += first < last ? 1 : -1) {
        add(run.row, c);
        if (c == last) break;
      }
      down = true;
      row = run.row;
      column = last;
    }
    flush();
    up();
  }

 private:
  /// Rounded up to whole micrometres: written with three decimals, it is never lower.
  static double raised(double z) { return std::ceil(1e3 * z - 1e-6) / 1e3; }

  Vec3 point(int row, int column) const {
    const double along = column * tips_.pitch_x_mm, across = row * tips_.pitch_y_mm;
    const MillOptions& o = motion_.options;
    return {o.x_mm + (motion_.transposed ? across : along), o.y_mm + (motion_.transposed ? along : across), raised(tips_.at(row, column))};
  }

  void add(int row, int column) { points_.push_back(point(row, column)); }

  /// From stretch to stretch over the nodes between: along the row, then across at the height of the higher one of two neighbours, so that
  /// nothing between them is cut into.
  void link(int row, int column, int to_row, int to_column) {
    while (column != to_column) {
      column += column < to_column ? 1 : -1;
      add(row, column);
    }
    while (row != to_row) {
      const int next = row + (row < to_row ? 1 : -1);
      Vec3 from = point(row, column), to = point(next, column);
      from.z() = to.z() = std::max(from.z(), to.z());
      points_.push_back(from);
      points_.push_back(to);
      row = next;
    }
  }

  void up() {
    const Vec3& at = builder_.at();
    if (at.z() < motion_.options.safe_height_mm) builder_.travel_to({at.x(), at.y(), motion_.options.safe_height_mm});
  }

  ToolMove move(std::vector<Vec3> points, double speed) const {
    ToolMove result;
    result.layer = motion_.layer;
    result.pass = pass_;
    result.power_percent = 100;
    result.speed_mm_per_s = speed;
    result.points_mm = std::move(points);
    return result;
  }

  /// Down to the stretch's first node, to and fro along its beginning no steeper than the ramp.
  void enter(int row, int first, int last) {
    up();
    const Vec3 start = point(row, first);
    builder_.travel_to({start.x(), start.y(), motion_.options.safe_height_mm});
    const double top = std::max(material_mm_, start.z());
    // The last bit over the material is fast, too.
    builder_.travel_to({start.x(), start.y(), std::min(motion_.options.safe_height_mm, top + clearance_mm)});
    const double slope = motion_.options.ramp_degrees >= 90 ? 1e9 : std::tan(motion_.options.ramp_degrees * std::numbers::pi / 180);
    const int way = first < last ? 1 : -1;
    const double step = slope * tips_.pitch_x_mm;
    // As far as the surface does not rise more steeply than the ramp.
    const int most = std::min(std::abs(last - first), static_cast<int>(std::ceil(4 * motion_.options.diameter_mm / tips_.pitch_x_mm)));
    int length = 0;
    while (length < most && point(row, first + way * (length + 1)).z() <= start.z() + (length + 1) * step) ++length;
    std::vector<Vec3> ramp{builder_.at()};
    double z = builder_.at().z();  // not rounded, or steps would be shorter than the slope
    if (length > 0 && slope < 1e8)
      for (int at = 0, direction = 1; z > start.z() + step || at != 0;) {
        if (at == length) direction = -1;
        if (at == 0) direction = 1;
        at += direction;
        Vec3 p = point(row, first + way * at);
        z = std::max(p.z(), z - step);
        p.z() = raised(z);
        ramp.push_back(p);
      }
    ramp.push_back(start);
    builder_.work(move(thinned(ramp, thinning_mm), motion_.options.plunge_speed_mm_per_s));
  }

  void flush() {
    if (points_.size() > 1) builder_.work(move(thinned(points_, thinning_mm), motion_.speed_mm_per_s));
    points_.clear();
  }

  ToolpathBuilder& builder_;
  const HeightField& tips_;
  const MillMotion& motion_;
  double material_mm_;
  int pass_;
  std::vector<Vec3> points_;
};

}  // namespace

std::vector<Vec3> thinned(const std::vector<Vec3>& points, double tolerance_mm) {
  if (points.size() < 3) return points;
  std::vector<Vec3> kept{points.front()};
  std::size_t from = 0;
  // The slopes over which the line from the last kept point may leave, so that all points since are within the tolerance below it.
  while (from + 1 < points.size()) {
    double least = -1e300, most = 1e300, so_far = 0;
    std::size_t to = from + 1, best = to;
    const Vec2 start = points[from].head<2>();
    const Vec2 way = (points[to].head<2>() - start).normalized();
    for (; to < points.size(); ++to) {
      const Vec2 run = points[to].head<2>() - start;
      const double along = run.dot(way);
      if (along <= so_far || (run - along * way).norm() > 1e-6) break;  // a bend in the plane, or back
      so_far = along;
      const double slope = (points[to].z() - points[from].z()) / along;
      if (slope >= least && slope <= most) best = to;
      least = std::max(least, slope);  // from here on the line passes over this point ...
      most = std::min(most, (points[to].z() + tolerance_mm - points[from].z()) / along);  // ... and not too far over it
      if (least > most) break;
    }
    kept.push_back(points[best]);
    from = best;
  }
  return kept;
}

void run_lines(ToolpathBuilder& builder, const HeightField& tips, const std::vector<MillRun>& runs, int stepover_rows, double material_mm, int pass, const MillMotion& motion) {
  Lines(builder, tips, motion, material_mm, pass).run(runs, stepover_rows);
}

}  // namespace formwright
