// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/mill/mill_lines.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace formwright {
namespace {

// Ramps are followed closely, or they would be steeper than asked for.
constexpr double clearance_mm = 0.5, ramp_tolerance_mm = 0.002;

/// Rounded up to whole micrometres: written with three decimals, it is never lower.
double raised(double z) { return std::ceil(1e3 * z - 1e-6) / 1e3; }

class Lines {
 public:
  Lines(ToolpathBuilder& builder, const HeightField& tips, const MillMotion& motion, double material_mm, int pass,
        HeightField& been)
      : builder_(builder), tips_(tips), motion_(motion), material_mm_(material_mm), pass_(pass), been_(been) {}

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
  Vec3 point(int row, int column) const {
    const double along = column * tips_.pitch_x_mm, across = row * tips_.pitch_y_mm;
    const MillOptions& o = motion_.options;
    return {o.x_mm + (motion_.transposed ? across : along), o.y_mm + (motion_.transposed ? along : across),
            tips_.at(row, column)};
  }

  void add(int row, int column) { points_.push_back(point(row, column)); }

  /// From stretch to stretch over the nodes between: along the row, then across at the height of the higher one of two
  /// neighbours, so that nothing between them is cut into.
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
    const double slope =
        motion_.options.ramp_degrees >= 90 ? 1e9 : std::tan(motion_.options.ramp_degrees * std::numbers::pi / 180);
    const int heading = first < last ? 1 : -1;
    const double step = slope * tips_.pitch_x_mm;
    // As far as the surface does not rise more steeply than the ramp.
    const int maximum = std::min(std::abs(last - first),
                                 static_cast<int>(std::ceil(4 * motion_.options.diameter_mm / tips_.pitch_x_mm)));
    int length = 0;
    while (length < maximum && point(row, first + heading * (length + 1)).z() <= start.z() + (length + 1) * step)
      ++length;
    std::vector<Vec3> ramp{builder_.at()};
    double z = builder_.at().z();
    if (length > 0 && slope < 1e8)
      for (int at = 0, direction = 1; z > start.z() + step || at != 0;) {
        if (at == length) direction = -1;
        if (at == 0) direction = 1;
        at += direction;
        Vec3 p = point(row, first + heading * at);
        z = std::max(p.z(), z - step);
        p.z() = z;
        ramp.push_back(p);
      }
    ramp.push_back(start);
    work(ramp, motion_.options.plunge_speed_mm_per_s, ramp_tolerance_mm);
  }

  void flush() {
    if (points_.size() > 1) work(points_, motion_.speed_mm_per_s, motion_.options.path_tolerance_mm);
    points_.clear();
  }

  void work(const std::vector<Vec3>& points, double speed, double tolerance_mm) {
    std::vector<Vec3> fewer = thinned(points, tolerance_mm);
    for (std::size_t i = 1; i < fewer.size(); ++i) record(fewer[i - 1], fewer[i]);
    builder_.work(move(std::move(fewer), speed));
  }

  /// Where the tip runs over nodes, as carried out.
  void record(const Vec3& a, const Vec3& b) {
    const auto column = [&](const Vec3& p) {
      return static_cast<int>(std::lround(
          (motion_.transposed ? p.y() - motion_.options.y_mm : p.x() - motion_.options.x_mm) / tips_.pitch_x_mm));
    };
    const auto row = [&](const Vec3& p) {
      return static_cast<int>(std::lround(
          (motion_.transposed ? p.x() - motion_.options.x_mm : p.y() - motion_.options.y_mm) / tips_.pitch_y_mm));
    };
    const auto lower = [&](int r, int c, double z) {
      been_.at(r, c) = std::min(been_.at(r, c), static_cast<float>(z));
    };
    const int from = column(a), to = column(b), steps = std::abs(to - from);
    lower(row(a), from, a.z());
    lower(row(b), to, b.z());
    for (int i = 1; i < steps && row(a) == row(b); ++i)
      lower(row(a), from + (to > from ? i : -i), a.z() + (b.z() - a.z()) * i / steps);
  }

  ToolpathBuilder& builder_;
  const HeightField& tips_;
  const MillMotion& motion_;
  double material_mm_;
  int pass_;
  HeightField& been_;
  std::vector<Vec3> points_;
};

}  // namespace

std::vector<Vec3> thinned(const std::vector<Vec3>& points, double tolerance_mm) {
  const auto vertex = [&](std::size_t i) { return Vec3(points[i].x(), points[i].y(), raised(points[i].z())); };
  std::vector<Vec3> kept{vertex(0)};
  for (std::size_t from = 0, best; from + 1 < points.size(); from = best) {
    const Vec3 start = kept.back();
    const Vec2 step = points[from + 1].head<2>() - points[from].head<2>();
    best = from + 1;
    Vec3 end = vertex(best);
    // The slopes over which the line may leave, so that it passes through the band over all points since: a swinging
    // door. Straight up or down there is none.
    const Vec2 heading = step.normalized();
    double minimum = -1e300, maximum = 1e300, so_far = 0;
    for (std::size_t to = from + 1; to < points.size() && step.norm() > 0; ++to) {
      const Vec2 run = points[to].head<2>() - points[from].head<2>();
      const double along = run.dot(heading);
      if (along <= so_far || (run - along * heading).norm() > 1e-6) break;  // a bend in the plane, or back
      so_far = along;
      const bool last = to + 1 == points.size();
      const double low = (last ? vertex(to).z() : points[to].z()) - start.z();
      minimum = std::max(minimum, low / along);
      maximum = std::min(maximum, (last ? low : points[to].z() + tolerance_mm - start.z()) / along);
      if (minimum > maximum) break;
      // As low as may be: on a hill the upper edge of the band when the door closes, on flats the lower one.
      const double z = raised(start.z() + minimum * along);
      if (z > start.z() + maximum * along + 1e-9) continue;  // no whole micrometre in the door
      best = to;
      end = {points[to].x(), points[to].y(), z};
    }
    kept.push_back(end);
  }
  return kept;
}

void run_lines(ToolpathBuilder& builder, const HeightField& tips, const std::vector<MillRun>& runs, int stepover_rows,
               double material_mm, int pass, const MillMotion& motion, HeightField& been) {
  Lines(builder, tips, motion, material_mm, pass, been).run(runs, stepover_rows);
}

}  // namespace formwright
