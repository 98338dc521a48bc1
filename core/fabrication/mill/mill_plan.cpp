// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/mill/mill_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/statistics.h"
#include "fabrication/mill/mill_lines.h"

namespace formwright {
namespace {

/// Where the tool's tip has been, seen from the nodes and from the places halfway between two of a row.
void carve_rows(HeightField& field, const HeightField& tips, const MillTool& tool, const Context& context) {
  carve(field, tips, footprint(tool, field), context);
  HeightField between = tips;
  for (int r = 0; r < tips.rows; ++r)
    for (int c = 0; c < tips.columns; ++c) {
      const bool both = c + 1 < tips.columns && tips.at(r, c) < no_tip && tips.at(r, c + 1) < no_tip;
      between.at(r, c) = both ? (tips.at(r, c) + tips.at(r, c + 1)) / 2 : no_tip;
    }
  carve(field, between, footprint(tool, field, 0.5), context);
}

/// Raises tips until places between two of a row do not cut into the surface, either: halfway, and for a V, whose
/// surface has an edge at its tip, at the quarters.
void raise_between(HeightField& tips, const HeightField& surface, const MillTool& tool, const Context& context) {
  for (const float share : {0.5f, 0.25f, 0.75f}) {
    if (share != 0.5f && tool.shape != ToolShape::v) continue;
    const HeightField minimum = lowest_tips(surface, footprint(tool, surface, static_cast<double>(share)), context);
    for (int r = 0; r < tips.rows; ++r)
      for (int c = 0; c + 1 < tips.columns; ++c) {
        float &left = tips.at(r, c), &right = tips.at(r, c + 1);
        const float lack = minimum.at(r, c) - ((1 - share) * left + share * right);
        if (lack <= 0) continue;
        // The lower one of the two bears it: it is the foot of a wall.
        if (left < right) left += lack / (1 - share);
        else right += lack / share;
      }
  }
}

HeightField bare(const HeightField& like, float z) {
  HeightField field = like;
  std::fill(field.z_mm.begin(), field.z_mm.end(), z);
  return field;
}

int stepover_nodes(double diameter_mm, double percent, double pitch_mm) {
  return std::max(1, static_cast<int>(diameter_mm * percent / 100 / pitch_mm + 1e-9));
}

/// Rows that are run: every `stepover`th and the last one.
std::vector<int> raster_rows(int rows, int stepover) {
  std::vector<int> result;
  for (int r = 0; r < rows - 1; r += stepover) result.push_back(r);
  result.push_back(rows - 1);
  return result;
}

constexpr const char *rough_job_name = "job_1_rough.gcode", *finish_job_name = "job_2_finish.gcode";

class MillPlanner {
 public:
  MillPlanner(const HeightField& surface, const MillOptions& options, Context& context)
      : surface_(surface), o_(options), context_(context), builder_(start(), options.travel_speed_mm_per_s) {
    rise();
  }

  MillPlan plan() {
    HeightField carved = bare(surface_, 0);
    const MillTool finish{o_.tool, o_.diameter_mm, o_.v_angle_degrees, o_.v_tip_mm};
    const MillTool rough{o_.rough_tool, o_.rough_diameter_mm, o_.v_angle_degrees, o_.v_tip_mm};
    check_size(finish, "diameter_mm");
    check_size(rough, "rough_diameter_mm");
    if (o_.stages != MillStages::finish) {
      const auto span = context_.span(0, 0.4, "Roughing");
      rough_out(rough, carved);
    }
    const bool other_tool = o_.rough_tool != o_.tool || o_.rough_diameter_mm != o_.diameter_mm;
    std::vector<std::pair<ToolpathStage, Toolpath>> stages;
    if (o_.stages == MillStages::both && other_tool) {
      Toolpath roughing = take_stage();
      if (std::any_of(roughing.moves.begin(), roughing.moves.end(), [](const ToolMove& move) { return move.work; }))
        stages.push_back({{"rough", rough_job_name}, std::move(roughing)});
      else plan_.notes.push_back("Nothing is deep enough for roughing: mount the finishing tool from the start.");
    }
    if (o_.stages != MillStages::rough) {
      const auto span = context_.span(0.4, 0.8, "Finishing");
      finish_off(finish, carved);
    }
    if (stages.empty()) {
      plan_.path = take_stage();
    } else {
      stages.push_back({{"finish", finish_job_name}, take_stage()});
      plan_.path = in_stages(std::move(stages));
      plan_.notes.push_back(std::string("Two tools, two jobs: run ") + rough_job_name +
                            ", mount the finishing tool, set z to 0 with it on the same place, then run " +
                            finish_job_name + ".");
    }
    for (const ToolMove& move : plan_.path.moves)
      if (move.work)
        (move.layer == "rough" ? plan_.rough_seconds : plan_.finish_seconds) +=
            move.times_s.back() - move.times_s.front();
    plan_.misfits = find_misfits(plan_.path, o_,
                                 std::max(o_.stages == MillStages::rough ? 0 : o_.diameter_mm,
                                          o_.stages == MillStages::finish ? 0 : o_.rough_diameter_mm),
                                 0);
    plan_.deviation = deviation_of(carved, surface_);
    tool_alone(finish);
    plan_.carved = std::move(carved);
    return std::move(plan_);
  }

 private:
  Vec3 start() const {
    const Vec2 origin = origin_on_bed(o_);
    return {origin.x(), origin.y(), 0};
  }

  void rise() { builder_.travel_to({builder_.at().x(), builder_.at().y(), o_.safe_height_mm}); }

  /// What was run since the last one, back over the controller's origin; the next begins there, lowered by whoever has
  /// changed the tool.
  Toolpath take_stage() {
    rise();
    builder_.travel_to({start().x(), start().y(), o_.safe_height_mm});
    Toolpath path = builder_.take();
    time_moves(path, {o_.acceleration_mm_per_s2, o_.junction_deviation_mm, o_.planner_blocks});
    builder_ = ToolpathBuilder(start(), o_.travel_speed_mm_per_s);
    rise();
    return path;
  }

  void check_size(const MillTool& tool, const char* where) const {
    const double nodes = tool.diameter_mm * tool.diameter_mm / (surface_.pitch_x_mm * surface_.pitch_y_mm);
    if (nodes > 250'000)
      throw Error(ErrorCode::invalid_input, where,
                  "The tool is over 500 grid points wide: raise the grid spacing or choose a smaller tool.");
  }

  void rough_out(const MillTool& tool, HeightField& carved) {
    HeightField tips = lowest_tips(surface_, swept_footprint(tool, surface_), context_);
    raise_between(tips, surface_, tool, context_);
    // Nothing is gained below the stock's top where the allowance reaches it.
    for (float& z : tips.z_mm) z = std::min(0.0f, z + static_cast<float>(o_.allowance_mm));
    const float deepest = *std::min_element(tips.z_mm.begin(), tips.z_mm.end());
    const int layers = static_cast<int>(std::ceil(-deepest / o_.step_down_mm - 1e-6));
    const int stepover = stepover_nodes(o_.rough_diameter_mm, o_.rough_stepover_percent, surface_.pitch_y_mm);
    const auto rows = raster_rows(surface_.rows, stepover);
    plan_.layers = layers;
    for (int layer = 1; layer <= layers; ++layer) {
      context_.progress(static_cast<double>(layer) / (layers + 1));
      const auto above = static_cast<float>(-(layer - 1) * o_.step_down_mm),
                 floor = static_cast<float>(-layer * o_.step_down_mm);
      HeightField heights = tips;
      for (float& z : heights.z_mm) z = std::max(z, floor);
      std::vector<MillRun> runs;
      HeightField been = bare(surface_, no_tip);
      bool forth = true;
      for (const int r : rows) {
        std::vector<MillRun> row_runs;
        for (int c = 0; c < surface_.columns; ++c) {
          if (tips.at(r, c) >= above - 1e-4f) continue;
          const int from = c;
          while (c + 1 < surface_.columns && tips.at(r, c + 1) < above - 1e-4f) ++c;
          row_runs.push_back({r, from, c});
        }
        if (!forth) std::reverse(row_runs.begin(), row_runs.end());
        forth = !forth;
        runs.insert(runs.end(), row_runs.begin(), row_runs.end());
      }
      if (runs.empty()) continue;
      run_lines(builder_, heights, runs, stepover, above, layer, {o_, false, "rough", o_.rough_speed_mm_per_s}, been);
      carve_rows(carved, been, tool, context_);
    }
  }

  void finish_off(const MillTool& tool, HeightField& carved) {
    const bool along_y = o_.finish_along == RasterAlong::y;
    const HeightField turned = along_y ? surface_.transposed() : surface_;
    HeightField tips = lowest_tips(turned, swept_footprint(tool, turned), context_);
    raise_between(tips, turned, tool, context_);
    const int stepover = stepover_nodes(o_.diameter_mm, o_.finish_stepover_percent, turned.pitch_y_mm);
    plan_.finish_stepover_mm = stepover * turned.pitch_y_mm;
    if (o_.diameter_mm * o_.finish_stepover_percent / 100 < 0.999 * turned.pitch_y_mm)
      plan_.notes.push_back(
          "The lines are as far apart as the grid points: lower the grid spacing to bring them closer.");
    std::vector<MillRun> runs;
    HeightField been = bare(turned, no_tip);
    for (const int r : raster_rows(turned.rows, stepover)) runs.push_back({r, 0, turned.columns - 1});
    context_.progress(0.5);
    HeightField left = along_y ? carved.transposed() : carved;
    // How high the tip would stand on what roughing has left where the first line begins.
    float material = tips.at(0, 0);
    for (const ToolFootprint::Node& node : footprint(tool, turned).nodes)
      if (node.row >= 0 && node.column >= 0 && node.row < left.rows && node.column < left.columns)
        material = std::max(material, left.at(node.row, node.column) - node.height_mm);
    run_lines(builder_, tips, runs, stepover, material, 1, {o_, along_y, "finish", o_.finish_speed_mm_per_s}, been);
    carve_rows(left, been, tool, context_);
    carved = along_y ? left.transposed() : std::move(left);
  }

  void tool_alone(const MillTool& tool) {
    const ToolFootprint foot = footprint(tool, surface_);
    if (static_cast<double>(foot.nodes.size()) * static_cast<double>(surface_.z_mm.size()) > 3e10) {
      plan_.notes.push_back(
          "The height lost to the tool's shape was not computed: the grid is too fine for so large a tool.");
      return;
    }
    context_.progress(0.85, "Comparing");
    HeightField closed = bare(surface_, 0);
    carve(closed, lowest_tips(surface_, foot, context_), foot, context_);
    plan_.of_tool = deviation_of(closed, surface_);
  }

  const HeightField& surface_;
  const MillOptions& o_;
  Context& context_;
  ToolpathBuilder builder_;
  MillPlan plan_;
};

}  // namespace

Deviation deviation_of(const HeightField& carved, const HeightField& wanted) {
  std::vector<float> over(wanted.z_mm.size());
  double sum = 0;
  for (std::size_t i = 0; i < over.size(); ++i) sum += over[i] = carved.z_mm[i] - wanted.z_mm[i];
  const auto rank = static_cast<std::size_t>(0.95 * static_cast<double>(over.size() - 1));
  Deviation deviation;
  deviation.mean_mm = sum / static_cast<double>(over.size());
  deviation.p95_mm = value_of_rank(over, rank);
  deviation.max_mm = *std::max_element(over.begin() + static_cast<std::ptrdiff_t>(rank), over.end());
  return deviation;
}

MillPlan plan_mill_job(const HeightField& surface, const MillOptions& options, Context& context) {
  read_no_go(options.no_go);
  return MillPlanner(surface, options, context).plan();
}

}  // namespace formwright
