// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/test_grid.h"

#include <cmath>

#include "base/format.h"
#include "fabrication/laser/hatching.h"
#include "fabrication/sheet/word_paths.h"

namespace formwright {
namespace {

class Grid {
 public:
  Grid(const TestGridOptions& options, const Context& context)
      : o_(options), context_(context), corner_(options.x_mm, options.y_mm) {}

  TestGrid make() {
    if (o_.kind == GridKind::power_speed) squares();
    if (o_.kind == GridKind::kerf) kerf();
    if (o_.kind == GridKind::focus) focus();
    grid_.drawing.title = "Test";
    grid_.drawing.width_mm = o_.bed_x_mm;
    grid_.drawing.height_mm = o_.bed_y_mm;
    for (const auto* strokes : {&grid_.labels, &grid_.strokes})
      for (const LaserStroke& stroke : *strokes)
        grid_.drawing.paths.push_back({stroke.layer == "cut"    ? CutLayer::cut
                                       : stroke.layer == "mark" ? CutLayer::mark
                                                                : CutLayer::engrave,
                                       stroke.points_mm, stroke.closed, ""});
    return std::move(grid_);
  }

 private:
  static double spread(double from, double to, int i, int count) {
    return count > 1 ? from + (to - from) * i / (count - 1) : from;
  }

  void label(const std::string& words, const Vec2& centre, const Vec2& along = Vec2(1, 0)) {
    for (CutPath& path : word_paths(words, centre, along, o_.label_mm, CutLayer::mark)) mark(std::move(path.points_mm));
  }

  void mark(std::vector<Vec2> points) {
    LaserStroke stroke;
    stroke.layer = "mark";
    stroke.part = "numbers";
    stroke.points_mm = std::move(points);
    stroke.power_percent = o_.label_power_percent;
    stroke.speed_mm_per_s = o_.label_speed_mm_per_s;
    grid_.labels.push_back(std::move(stroke));
  }

  LaserStroke stroke(const std::string& name, std::vector<Vec2> points, bool closed, double power, double speed) const {
    LaserStroke result;
    result.layer = o_.kind == GridKind::focus || (o_.kind == GridKind::power_speed && o_.work == GridWork::engrave)
                       ? "engrave"
                       : "cut";
    result.part = name;
    result.points_mm = std::move(points);
    result.closed = closed;
    result.power_percent = power;
    result.speed_mm_per_s = speed;
    result.passes = o_.passes;
    return result;
  }

  void squares() {
    const double h = o_.label_mm, step = o_.cell_mm + o_.gap_mm;
    const Vec2 first = corner_ + Vec2(2.5 * h + words_width_mm("0000", h), 0);  // right of a title and four digits
    for (int r = 0; r < o_.rows; ++r) {
      const double speed = spread(o_.speed_from_mm_per_s, o_.speed_to_mm_per_s, r, o_.rows);
      const std::string words = with_max_decimals(speed, speed < 10 ? 1 : 0);
      const double middle = first.y() + r * step + o_.cell_mm / 2;
      label(words, {first.x() - h - words_width_mm(words, h) / 2, middle});
      for (int c = 0; c < o_.columns; ++c) {
        const double power = spread(o_.power_from_percent, o_.power_to_percent, c, o_.columns);
        const Vec2 low = first + Vec2(c * step, r * step), side(o_.cell_mm, o_.cell_mm);
        const std::string name = "R" + std::to_string(r + 1) + "C" + std::to_string(c + 1);
        const std::vector<Vec2> square{
            low, {low.x() + o_.cell_mm, low.y()}, low + side, {low.x(), low.y() + o_.cell_mm}};
        if (o_.work == GridWork::cut) {
          grid_.strokes.push_back(stroke(name, square, true, power, speed));
        } else {
          for (auto& line : hatch({square}, o_.line_mm, context_))
            grid_.strokes.push_back(stroke(name, std::move(line), false, power, speed));
        }
        grid_.cells.push_back({name, power, speed, 0, low.x(), low.y()});
      }
    }
    const double top = first.y() + o_.rows * step - o_.gap_mm + h;
    for (int c = 0; c < o_.columns; ++c) {
      const std::string words = with_max_decimals(spread(o_.power_from_percent, o_.power_to_percent, c, o_.columns), 0);
      // Side by side where they fit, turned where they do not.
      const bool turned = words_width_mm(words, h) > step - h / 3;
      label(words, {first.x() + c * step + o_.cell_mm / 2, top + (turned ? words_width_mm("000", h) : h) / 2},
            turned ? Vec2(0, 1) : Vec2(1, 0));
    }
    label("POWER", {first.x() + (o_.columns * step - o_.gap_mm) / 2, top + words_width_mm("000", h) + h});
    label("MM/S", {corner_.x() + h / 2, first.y() + (o_.rows * step - o_.gap_mm) / 2}, {0, 1});
  }

  void kerf() {
    constexpr int pieces = 10;
    const double length = o_.kerf_length_mm, height = 2 * o_.cell_mm;
    const Vec2 low = corner_;
    for (int i = 1; i < pieces; ++i) {
      const double x = low.x() + length * i / pieces;
      LaserStroke line =
          stroke("pieces", {{x, low.y()}, {x, low.y() + height}}, false, o_.power_percent, o_.speed_mm_per_s);
      line.inside_of = pieces - 1;  // the slot comes last, so that nothing moves before
      grid_.strokes.push_back(std::move(line));
    }
    grid_.strokes.push_back(stroke(
        "slot", {low, {low.x() + length, low.y()}, {low.x() + length, low.y() + height}, {low.x(), low.y() + height}},
        true, o_.power_percent, o_.speed_mm_per_s));
    grid_.cells.push_back({"slot", o_.power_percent, o_.speed_mm_per_s, 0, low.x(), low.y()});
    // The slot's left edge stands half a kerf to the left of its line; ten pieces are ten kerfs shorter than ten tenths
    // of it.
    const double edge = low.y() + height + 1;
    for (int i = 0; i <= 10; ++i) {
      const double kerf_mm = 0.05 * i, x = low.x() + length - 10.5 * kerf_mm;
      mark({{x, edge}, {x, edge + (i % 5 == 0 ? 1.2 : i % 2 == 0 ? 0.8 : 0.5) * o_.label_mm}});
      // The ends only, outwards: a millimetre on the scale is a tenth of one.
      const std::string words = with_max_decimals(kerf_mm, 2);
      if (i == 0 || i == 10)
        label(words, {x + (i == 0 ? 0.5 : -0.5) * words_width_mm(words, o_.label_mm), edge + 2 * o_.label_mm});
    }
    label("KERF MM", {low.x() + length / 3, edge + 2 * o_.label_mm});
  }

  void focus() {
    const double h = o_.label_mm, step = o_.gap_mm + h;
    for (int i = 0; i < o_.columns; ++i) {
      const double z = spread(-o_.focus_range_mm, o_.focus_range_mm, i, o_.columns), y = corner_.y() + i * step + h / 2;
      const std::string words = with_max_decimals(z, 2), name = "Z" + std::to_string(i + 1);
      const double x = corner_.x() + words_width_mm("-00.00", h) + h;
      label(words, {x - h - words_width_mm(words, h) / 2, y});
      LaserStroke line = stroke(name, {{x, y}, {x + 3 * o_.cell_mm, y}}, false, o_.power_percent, o_.speed_mm_per_s);
      line.z_mm = z;
      grid_.strokes.push_back(std::move(line));
      grid_.cells.push_back({name, o_.power_percent, o_.speed_mm_per_s, z, x, y});
    }
    label("Z MM", {corner_.x() + words_width_mm("Z MM", h) / 2, corner_.y() + o_.columns * step + h});
  }

  const TestGridOptions& o_;
  const Context& context_;
  Vec2 corner_;
  TestGrid grid_;
};

}  // namespace

TestGrid make_test_grid(const TestGridOptions& options, const Context& context) {
  return Grid(options, context).make();
}

}  // namespace formwright
