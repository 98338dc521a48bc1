// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/laser/laser_plan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "base/format.h"
#include "fabrication/sheet/contours.h"
#include "fabrication/laser/hatching.h"

namespace formwright {
namespace {

std::string counted(std::size_t count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

/// The drawing on the bed: mirrored, turned, its page's lower left corner at the place.
void place(std::vector<CutPath>& paths, const CutSheet& sheet, const LaserOptions& options) {
  const double angle = options.turn_degrees * std::numbers::pi / 180;
  const auto rounded = [](double v) { return std::round(1e12 * v) / 1e12; };  // quarter turns are exact
  const double c = rounded(std::cos(angle)), s = rounded(std::sin(angle));
  const auto turned = [&](const Vec2& p) {
    const double x = options.mirrored ? sheet.width_mm - p.x() : p.x();
    return Vec2(c * x - s * p.y(), s * x + c * p.y());
  };
  Vec2 low(1e300, 1e300);
  for (const Vec2& corner :
       {Vec2(0, 0), Vec2(sheet.width_mm, 0), Vec2(0, sheet.height_mm), Vec2(sheet.width_mm, sheet.height_mm)})
    low = low.cwiseMin(turned(corner));
  const Vec2 shift = Vec2(options.x_mm, options.y_mm) - low;
  for (CutPath& path : paths)
    for (Vec2& p : path.points_mm) p = turned(p) + shift;
}

struct LayerSettings {
  bool enabled;
  double power_percent, speed_mm_per_s;
  int passes;
};

LayerSettings settings_of(CutLayer layer, const LaserOptions& o) {
  if (layer == CutLayer::cut) return {o.cut_enabled, o.cut_power_percent, o.cut_speed_mm_per_s, o.cut_passes};
  if (layer == CutLayer::mark) return {o.mark_enabled, o.mark_power_percent, o.mark_speed_mm_per_s, o.mark_passes};
  return {o.engrave_enabled, o.engrave_power_percent, o.engrave_speed_mm_per_s, o.engrave_passes};
}

class LaserPlanner {
 public:
  LaserPlanner(std::vector<CutPath> paths, double drawn_kerf_mm, const LaserOptions& options, Context& context)
      : paths_(std::move(paths)), options_(options), context_(context) {
    if (options.kerf_side != KerfSide::centre && options.kerf_mm > 0)
      outward_mm_ = (options.kerf_side == KerfSide::parts ? options.kerf_mm : -options.kerf_mm) / 2 - drawn_kerf_mm / 2;
    std::vector<int> closed_cuts;
    for (std::size_t i = 0; i < paths_.size(); ++i)
      if (paths_[i].layer == CutLayer::cut && paths_[i].closed) closed_cuts.push_back(static_cast<int>(i));
    inside_of_ = containing_contours(paths_, closed_cuts, context);
    int unnamed = 0;
    for (const int i : closed_cuts)
      if (inside_of_[i] < 0 && paths_[i].name.empty()) paths_[i].name = "P" + std::to_string(++unnamed);
  }

  std::vector<LaserStroke> strokes(CutLayer layer) {
    std::vector<LaserStroke> result;
    const LayerSettings settings = settings_of(layer, options_);
    if (!settings.enabled) return result;
    if (layer == CutLayer::engrave && options_.engrave_fill) fill(settings, result);
    std::map<int, int> stroke_of;             // the last one of a path
    std::vector<std::pair<int, int>> wanted;  // stroke, the path that comes after it
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      const CutPath& path = paths_[i];
      if (path.layer != layer || (layer == CutLayer::engrave && options_.engrave_fill && path.closed)) continue;
      const Shaped shape = shaped(static_cast<int>(i));
      const auto run = [&](const std::vector<Vec2>& points, bool outline, int inside_of) {
        LaserStroke stroke = made(path.layer, part_of(static_cast<int>(i)), settings, points, path.closed);
        if (layer == CutLayer::cut) {
          stroke.step_down_mm = options_.cut_step_down_mm;
          stroke.overcut_mm = options_.overcut_mm;
          if (outline && path.closed && depth(static_cast<int>(i)) % 2 == 0) stroke.tabs = options_.tabs_count;
          stroke.tab_gap_mm = options_.tab_width_mm + options_.kerf_mm;
        }
        wanted.emplace_back(static_cast<int>(result.size()), inside_of);
        result.push_back(std::move(stroke));
      };
      for (const std::vector<Vec2>& points : shape.outlines) {
        stroke_of[static_cast<int>(i)] = static_cast<int>(result.size());
        run(points, true, inside_of_[i]);
      }
      for (const std::vector<Vec2>& points : shape.closed_off) run(points, false, static_cast<int>(i));
    }
    if (layer == CutLayer::cut && options_.inner_first)
      for (const auto& [stroke, after] : wanted)
        for (int p = after; p >= 0; p = inside_of_[p])
          if (const auto found = stroke_of.find(p); found != stroke_of.end()) {
            result[static_cast<std::size_t>(stroke)].inside_of = found->second;
            break;
          }
    return result;
  }

  int too_small = 0, broken_up = 0, mouths_closed = 0;

 private:
  struct Shaped {
    std::vector<Polygon> outlines, closed_off;  // what lies behind a mouth that the kerf closes is cut of its own
  };

  static LaserStroke made(CutLayer layer, std::string part, const LayerSettings& settings, std::vector<Vec2> points,
                          bool closed) {
    LaserStroke stroke;
    stroke.layer = cut_layer_styles[static_cast<int>(layer)].name;
    stroke.part = std::move(part);
    stroke.points_mm = std::move(points);
    stroke.closed = closed;
    stroke.power_percent = settings.power_percent;
    stroke.speed_mm_per_s = settings.speed_mm_per_s;
    stroke.passes = settings.passes;
    return stroke;
  }

  int depth(int i) const {
    int levels = 0;
    for (int p = inside_of_[i]; p >= 0; p = inside_of_[p]) ++levels;
    return levels;
  }

  /// The outline that the path belongs to: openings belong to the part around them, what lies in an opening is a part
  /// of its own.
  std::string part_of(int i) const {
    int root = i;
    if (paths_[i].layer != CutLayer::cut || !paths_[i].closed) root = inside_of_[i];
    while (root >= 0 && depth(root) % 2 == 1) root = inside_of_[root];
    return root >= 0 && !paths_[root].name.empty() ? paths_[root].name : paths_[i].name;
  }

  /// Where the beam's middle goes.
  Shaped shaped(int i) {
    const CutPath& path = paths_[i];
    if (!path.closed || path.layer != CutLayer::cut) return {{path.points_mm}, {}};
    const bool opening = depth(i) % 2 == 1;
    Shaped shape;
    if (std::abs(outward_mm_) < 1e-9) {
      shape.outlines = {path.points_mm};
      if (signed_area_mm2(path.points_mm) < 0) std::reverse(shape.outlines[0].begin() + 1, shape.outlines[0].end());
    } else {
      for (Polygon& one : offset_polygon(path.points_mm, opening ? -outward_mm_ : outward_mm_))
        (signed_area_mm2(one) > 0 ? shape.outlines : shape.closed_off).push_back(std::move(one));
      if (shape.outlines.empty()) {
        ++too_small;
        shape.outlines = {path.points_mm};
      }
      if (shape.outlines.size() > 1) ++broken_up;
      if (!shape.closed_off.empty()) ++mouths_closed;
    }
    // The part lies to the left of the beam: outlines counter-clockwise, openings clockwise; both keep their start.
    if (opening)
      for (auto* polygons : {&shape.outlines, &shape.closed_off})
        for (Polygon& one : *polygons) std::reverse(one.begin() + 1, one.end());
    return shape;
  }

  void fill(const LayerSettings& settings, std::vector<LaserStroke>& result) {
    std::vector<int> closed;
    for (std::size_t i = 0; i < paths_.size(); ++i)
      if (paths_[i].layer == CutLayer::engrave && paths_[i].closed) closed.push_back(static_cast<int>(i));
    const std::vector<int> around = containing_contours(paths_, closed, context_);
    std::map<int, std::vector<Polygon>> shapes;  // by the outermost one
    for (const int i : closed) {
      int root = i;
      while (around[root] >= 0) root = around[root];
      shapes[root].push_back(paths_[i].points_mm);
    }
    for (const auto& [root, polygons] : shapes)
      for (auto& line : hatch(polygons, options_.engrave_line_mm, context_))
        result.push_back(made(CutLayer::engrave, part_of(root), settings, std::move(line), false));
  }

  std::vector<CutPath> paths_;
  const LaserOptions& options_;
  Context& context_;
  std::vector<int> inside_of_;
  double outward_mm_ = 0;  // of outlines; openings move inwards
};

}  // namespace

LaserPlan run_strokes(const std::vector<std::vector<LaserStroke>>& layers, const LaserMachineOptions& machine,
                      double kerf_mm, bool free_start, Context& context) {
  LaserPlan plan;
  const Vec2 origin = origin_on_bed(machine);
  ToolpathBuilder builder({origin.x(), origin.y(), 0}, machine.travel_speed_mm_per_s);
  for (std::size_t l = 0; l < layers.size(); ++l) {
    context.progress(static_cast<double>(l) / static_cast<double>(layers.size()), "Shortening the way");
    if (layers[l].empty()) continue;
    for (const StrokeRun& run : order_strokes(layers[l], builder.at().head<2>(), free_start, context))
      run_stroke(builder, layers[l][static_cast<std::size_t>(run.stroke)], run.first);
    plan.layers.push_back({layers[l].front().layer, static_cast<int>(layers[l].size()), 0, 0});
  }
  builder.travel_to({origin.x(), origin.y(), 0});
  plan.path = builder.take();
  time_moves(plan.path, {machine.acceleration_mm_per_s2, machine.junction_deviation_mm, machine.planner_blocks});
  for (const ToolMove& move : plan.path.moves)
    for (LayerSummary& layer : plan.layers)
      if (move.work && move.layer == layer.layer) {
        layer.seconds += move.times_s.back() - move.times_s.front();
        for (std::size_t i = 1; i < move.points_mm.size(); ++i)
          layer.length_mm += (move.points_mm[i] - move.points_mm[i - 1]).norm();
      }
  plan.misfits = find_misfits(plan.path, machine, kerf_mm, kerf_mm);
  return plan;
}

LaserPlan plan_laser_job(const CutSheet& sheet, const LaserOptions& options, Context& context) {
  context.progress(0, "Joining lines");
  read_no_go(options.no_go);  // refused before the work
  CutSheet drawn = sheet;
  std::erase_if(drawn.paths,
                [](const CutPath& path) { return path.layer == CutLayer::note || path.points_mm.size() < 2; });
  if (options.take_as != TakeAs::as_drawn)
    for (CutPath& path : drawn.paths) path.layer = static_cast<CutLayer>(static_cast<int>(options.take_as) - 1);
  TidiedPaths tidied = tidy_paths(drawn.paths, options.join_mm, context);
  place(tidied.paths, sheet, options);
  context.progress(0.1, "Moving the cuts for the kerf");
  LaserPlanner planner(std::move(tidied.paths), sheet.kerf_mm, options, context);
  std::vector<std::vector<LaserStroke>> layers;
  bool any = false;
  for (const CutLayer layer : {CutLayer::engrave, CutLayer::mark, CutLayer::cut}) {
    layers.push_back(planner.strokes(layer));
    any = any || !layers.back().empty();
  }
  if (!any)
    throw Error(
        ErrorCode::invalid_input, "drawing",
        "Nothing in the drawing is on a layer that is run: colour its lines red to cut, blue to mark, black to engrave, or set take_as.");
  LaserPlan plan;
  {
    const auto span = context.span(0.2, 1, "Shortening the way");
    plan = run_strokes(layers, options, options.kerf_mm, options.free_start, context);
  }
  const auto note = [&](int count, const std::string& one, const std::string& many) {
    if (count > 0) plan.notes.push_back(counted(static_cast<std::size_t>(count), one, many));
  };
  note(tidied.doubles_dropped, "path lay exactly on another one and is run once.",
       "paths lay exactly on others and are run once.");
  note(tidied.ends_joined, "pair of ends was joined.", "pairs of ends were joined.");
  note(planner.too_small, "opening is narrower than the kerf and is cut on its line.",
       "openings are narrower than the kerf and are cut on their lines.");
  note(planner.broken_up, "outline falls apart at places narrower than the kerf.",
       "outlines fall apart at places narrower than the kerf.");
  note(planner.mouths_closed, "outline has a mouth narrower than the kerf; what lies behind it is cut by itself.",
       "outlines have mouths narrower than the kerf; what lies behind them is cut by itself.");
  if (sheet.kerf_mm > 0 && options.kerf_mm > 0 && options.kerf_side != KerfSide::centre) {
    plan.notes.push_back("The drawing's cuts are already moved for a kerf of " + with_digits(sheet.kerf_mm, 3) +
                         " mm; they are moved by the difference only.");
  }
  return plan;
}

}  // namespace formwright
