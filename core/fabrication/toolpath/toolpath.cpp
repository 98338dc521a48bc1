// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/toolpath/toolpath.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "formats/shared/text_out.h"

namespace formwright {
namespace {

Vec3 in_micrometres(const Vec3& p) {
  return {std::round(1e3 * p.x()) / 1e3, std::round(1e3 * p.y()) / 1e3, std::round(1e3 * p.z()) / 1e3};
}

std::string millimetres(double value) { return with_decimals(std::round(10 * value) / 10 + 0.0, 1); }

/// Does the segment touch the rectangle grown by `grown_mm`? Liang and Barsky's clipping.
bool touches(const Vec2& a, const Vec2& b, const BedRectangle& zone, double grown_mm) {
  double from = 0, to = 1;
  const Vec2 low(zone.x0_mm - grown_mm, zone.y0_mm - grown_mm), high(zone.x1_mm + grown_mm, zone.y1_mm + grown_mm);
  for (int axis = 0; axis < 2; ++axis) {
    const double run = b[axis] - a[axis];
    if (run == 0) {
      if (a[axis] <= low[axis] || a[axis] >= high[axis]) return false;
      continue;
    }
    double enter = (low[axis] - a[axis]) / run, leave = (high[axis] - a[axis]) / run;
    if (enter > leave) std::swap(enter, leave);
    from = std::max(from, enter);
    to = std::min(to, leave);
  }
  return from < to;
}

}  // namespace

double Toolpath::length_mm(bool work) const {
  double sum = 0;
  for (const ToolMove& move : moves)
    if (move.work == work)
      for (std::size_t i = 1; i < move.points_mm.size(); ++i) sum += (move.points_mm[i] - move.points_mm[i - 1]).norm();
  return sum;
}

void ToolpathBuilder::travel_to(const Vec3& p) { travel_along({p}); }

void ToolpathBuilder::travel_along(const std::vector<Vec3>& points_mm) {
  ToolMove move;
  move.speed_mm_per_s = travel_speed_mm_per_s_;
  move.points_mm.push_back(at_);
  for (const Vec3& p : points_mm)
    if (const Vec3 q = in_micrometres(p); q != move.points_mm.back()) move.points_mm.push_back(q);
  if (move.points_mm.size() < 2) return;
  at_ = move.points_mm.back();
  if (!path_.moves.empty() && !path_.moves.back().work) {
    auto& before = path_.moves.back().points_mm;
    before.insert(before.end(), move.points_mm.begin() + 1, move.points_mm.end());
  } else {
    path_.moves.push_back(std::move(move));
  }
}

void ToolpathBuilder::work(ToolMove move) {
  std::vector<Vec3> points;
  for (const Vec3& p : move.points_mm)
    if (const Vec3 q = in_micrometres(p); points.empty() || q != points.back()) points.push_back(q);
  if (points.size() < 2) return;
  travel_to(points.front());
  at_ = points.back();
  move.work = true;
  move.points_mm = std::move(points);
  path_.moves.push_back(std::move(move));
}

Toolpath in_stages(std::vector<std::pair<ToolpathStage, Toolpath>> parts) {
  Toolpath whole;
  for (auto& [stage, part] : parts) {
    stage.first_move = whole.moves.size();
    stage.start_s = whole.seconds;
    for (ToolMove& move : part.moves) {
      for (double& time : move.times_s) time += whole.seconds;
      whole.moves.push_back(std::move(move));
    }
    whole.seconds += part.seconds;
    whole.stages.push_back(std::move(stage));
  }
  return whole;
}

std::vector<std::string> find_misfits(const Toolpath& path, const MachineOptions& machine, double width_mm,
                                      double edge_width_mm) {
  const auto zones = read_no_go(machine.no_go);
  double beyond[4] = {0, 0, 0, 0};
  constexpr const char* edges[4] = {"left", "right", "lower", "upper"};
  std::vector<std::string> misfits;
  std::vector<bool> noted(zones.size(), false);
  for (const ToolMove& move : path.moves) {
    const double half_mm = move.work ? width_mm / 2 : 0, edge_mm = move.work ? edge_width_mm / 2 : 0;
    for (std::size_t i = 0; i < move.points_mm.size(); ++i) {
      const Vec2 p = move.points_mm[i].head<2>();
      beyond[0] = std::max(beyond[0], edge_mm - p.x());
      beyond[1] = std::max(beyond[1], p.x() + edge_mm - machine.bed_x_mm);
      beyond[2] = std::max(beyond[2], edge_mm - p.y());
      beyond[3] = std::max(beyond[3], p.y() + edge_mm - machine.bed_y_mm);
      if (i == 0) continue;
      const Vec2 before = move.points_mm[i - 1].head<2>();
      for (std::size_t z = 0; z < zones.size(); ++z)
        if (!noted[z] && touches(before, p, zones[z], half_mm)) {
          noted[z] = true;
          const std::string who = !move.work          ? "A travel"
                                  : move.part.empty() ? "A path on layer " + move.layer
                                                      : "Part " + move.part;
          misfits.push_back(who + " crosses no-go zone " + std::to_string(z + 1) + " (" + millimetres(zones[z].x0_mm) +
                            ", " + millimetres(zones[z].y0_mm) + " to " + millimetres(zones[z].x1_mm) + ", " +
                            millimetres(zones[z].y1_mm) + " mm): move or turn the drawing.");
        }
    }
  }
  for (int side = 0; side < 4; ++side)
    if (beyond[side] > 5e-4)
      misfits.push_back(std::string("The job reaches ") + millimetres(std::max(0.1, beyond[side])) + " mm beyond the " +
                        edges[side] + " edge of the bed (" + millimetres(machine.bed_x_mm) + " x " +
                        millimetres(machine.bed_y_mm) + " mm): move, turn or shrink the drawing.");
  return misfits;
}

ToolpathBounds work_bounds(const Toolpath& path) {
  Vec2 low(1e300, 1e300), high(-1e300, -1e300);
  for (const ToolMove& move : path.moves)
    if (move.work)
      for (const Vec3& p : move.points_mm) {
        low = low.cwiseMin(p.head<2>());
        high = high.cwiseMax(p.head<2>());
      }
  if (low.x() > high.x()) return {};
  return {low.x(), low.y(), high.x(), high.y()};
}

Bytes write_toolpath_json(const Toolpath& path, const MachineOptions& machine) {
  const auto rounded = [](double value) { return std::round(1e3 * value) / 1e3; };
  TextOut out;
  out << "{\"version\":1,\"bed_mm\":[" << rounded(machine.bed_x_mm) << ',' << rounded(machine.bed_y_mm)
      << "],\"no_go_mm\":[";
  bool first = true;
  for (const BedRectangle& zone : read_no_go(machine.no_go)) {
    out << (first ? "[" : ",[") << rounded(zone.x0_mm) << ',' << rounded(zone.y0_mm) << ',' << rounded(zone.x1_mm)
        << ',' << rounded(zone.y1_mm) << ']';
    first = false;
  }
  out << "],\"seconds\":" << rounded(path.seconds);
  for (std::size_t s = 0; s < path.stages.size(); ++s) {
    const ToolpathStage& stage = path.stages[s];
    out << (s == 0 ? ",\"stages\":[" : ",") << "{\"name\":\"" << stage.name << "\",\"file\":\"" << stage.file
        << "\",\"first_path\":" << static_cast<int>(stage.first_move) << ",\"start_s\":" << rounded(stage.start_s)
        << '}' << (s + 1 == path.stages.size() ? "]" : "");
  }
  out << ",\"paths\":[";
  for (std::size_t m = 0; m < path.moves.size(); ++m) {
    const ToolMove& move = path.moves[m];
    out << (m == 0 ? "{" : ",{") << "\"kind\":\"" << (move.work ? "work" : "travel") << "\",\"layer\":\"" << move.layer
        << "\",\"part\":\"" << move.part << "\",\"pass\":" << move.pass
        << ",\"power_percent\":" << rounded(move.power_percent)
        << ",\"speed_mm_per_s\":" << rounded(move.speed_mm_per_s) << ",\"points_mm\":[";
    for (std::size_t i = 0; i < move.points_mm.size(); ++i) {
      const Vec3& p = move.points_mm[i];
      out << (i == 0 ? "" : ",") << rounded(p.x()) << ',' << rounded(p.y()) << ',' << rounded(p.z());
    }
    out << "],\"times_s\":[";
    for (std::size_t i = 0; i < move.times_s.size(); ++i) out << (i == 0 ? "" : ",") << rounded(move.times_s[i]);
    out << "],\"lines\":[";
    for (std::size_t i = 0; i < move.lines.size(); ++i) out << (i == 0 ? "" : ",") << move.lines[i];
    out << "]}";
  }
  out << "]}\n";
  return to_bytes(out.text());
}

}  // namespace formwright
