// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/gcode/gcode_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "machines/driver/machine_driver.h"

namespace formwright {
namespace {

using machines_detail::decimal;

constexpr double max_reach_mm = 100'000;  // no machine reaches further
constexpr double full_turn_rad = 5e-7;    // ends nearer than this make a whole turn (grbl, ARC_ANGULAR_TRAVEL_EPSILON)

/// Words whose path depends on the machine's stored state, or that no controller moves by as RS274 says.
const char* unclear_command(int tenths) {
  switch (tenths) {
    case 50:
    case 51: return "has a spline (G5): post it with lines and arcs.";
    case 70:
    case 80: return "measures diameters or radii of a lathe (G7, G8): post it for a mill.";
    case 280:
    case 281:
    case 300:
    case 301:
      return "goes to, or sets, a place that the machine keeps (G28, G30): take it out and go there with G0 X Y Z.";
    case 330:
    case 331: return "cuts a thread (G33), which needs a spindle in step: take it out.";
    case 382:
    case 383:
    case 384:
    case 385: return "probes (G38): probe by hand before the job.";
    case 410:
    case 411:
    case 420:
    case 421: return "leaves the tool's radius to the machine (G41, G42): let the program that wrote it do this.";
    case 430:
    case 431:
    case 432: return "shifts z by a tool's length (G43): take it out and set z to 0 with the tool that is mounted.";
    case 500:
    case 510: return "scales what follows (G51): post it at its size.";
    case 530:
      return "goes to a place in machine coordinates (G53): take it out and go there with G0 in work coordinates.";
    case 520:
    case 920:
    case 921:
    case 922:
    case 923:
      return "moves the origin (G52, G92 or G10), so that nobody can say where the job goes: take that line out and set "
             "the origin on the machine.";
    case 550:
    case 560:
    case 570:
    case 580:
    case 590:
    case 591:
    case 592:
    case 593:
      return "changes to another work coordinate system (G55 to G59): post the job in G54 and set the origin there.";
    case 680: return "turns what follows (G68): post it as it lies.";
    case 730:
    case 760:
    case 810:
    case 820:
    case 830:
    case 840:
    case 850:
    case 860:
    case 870:
    case 880:
    case 890: return "has a drilling cycle (G73, G81 to G89): post it with plain moves.";
    case 901: return "gives centres of arcs in absolute coordinates (G90.1): post them as offsets (G91.1).";
    case 930:
    case 950: return "gives feeds by time or by turns (G93, G95): post it with feeds a minute (G94).";
    default: return nullptr;
  }
}

const char* unclear_word(const std::vector<GcodeWord>& words) {
  bool moves_extruder = false, system = false, system_number = false, resets = false, axis = false;
  const char* unclear = nullptr;
  for (const auto& [letter, value, has_number] : words) {
    const int tenths = tenths_of(value);
    if (letter == 'G' && tenths == 920) resets = true;
    else if (letter == 'G' && unclear == nullptr) unclear = unclear_command(tenths);
    else if (letter == 'M' && (tenths == 970 || tenths == 980 || tenths == 990))
      return "calls a subprogram (M98): post it as one run of lines.";
    else if (letter == 'O') return "has a subprogram or a condition (O): post it as one run of lines.";
    else if ((letter >= 'A' && letter <= 'C') || (letter >= 'U' && letter <= 'W'))
      return "moves another axis than x, y and z (A, B, C, U, V, W): post it for three axes.";
    system = system || (letter == 'G' && tenths == 100);
    system_number = system_number || letter == 'L';
    moves_extruder = moves_extruder || letter == 'E';
    axis = axis || (letter >= 'X' && letter <= 'Z');
  }
  // An extruder's G92 E0 moves no origin; G10 without L is a printer's retraction.
  if ((resets && (axis || !moves_extruder)) || (system && system_number)) return unclear_command(920);
  return unclear;
}

struct Line {
  std::array<std::optional<double>, 3> target_mm, centre_mm;
  std::optional<double> radius_mm;
  double turns = 0;  // P of an arc: Marlin draws so many whole circles first

  bool names_axis() const { return target_mm[0] || target_mm[1] || target_mm[2]; }
};

/// Commands first, then values: units and distance mode of a line hold for all of its words.
Line take_words(const std::vector<GcodeWord>& words, GcodeState& s) {
  for (const auto& [letter, value, has_number] : words) {
    const int tenths = tenths_of(value);
    if (letter == 'G') switch (tenths) {
        case 0:
        case 10:
        case 20:
        case 30:
        case 800: s.motion = tenths / 10; break;
        case 170:
        case 180:
        case 190: s.plane = tenths / 10; break;
        case 200:
        case 210: s.inches = tenths == 200; break;
        case 540: s.work_system = 54; break;
        case 900:
        case 910: s.relative = tenths == 910; break;
        default: break;
      }
    else if (letter == 'M') switch (tenths) {
        case 30:
        case 40:
        case 50: s.spindle = tenths / 10; break;
        case 70: s.mist = true; break;
        case 80: s.flood = true; break;
        case 90: s.mist = s.flood = false; break;
        default: break;
      }
  }
  Line line;
  const double unit_mm = s.inches ? 25.4 : 1;
  for (const auto& [letter, value, has_number] : words) {
    if (!has_number) continue;
    if (letter >= 'X' && letter <= 'Z') line.target_mm[static_cast<std::size_t>(letter - 'X')] = value * unit_mm;
    if (letter >= 'I' && letter <= 'K') line.centre_mm[static_cast<std::size_t>(letter - 'I')] = value * unit_mm;
    if (letter == 'R') line.radius_mm = value * unit_mm;
    if (letter == 'F') s.feed_mm_per_min = value * unit_mm;
    if (letter == 'S') s.power = value;
    if (letter == 'P') line.turns = value;
  }
  return line;
}

/// An arc in its plane, about the origin.
struct Arc {
  double centre[2], from[2], to[2];  // `from` and `to` seen from the centre
};

std::string find_arc(const Line& line, const std::array<double, 3>& from_mm, const std::array<double, 3>& to_mm,
                     const std::array<std::size_t, 3>& axes, bool clockwise, Arc& arc) {
  const double dx = to_mm[axes[0]] - from_mm[axes[0]], dy = to_mm[axes[1]] - from_mm[axes[1]];
  double i = line.centre_mm[axes[0]].value_or(0), j = line.centre_mm[axes[1]].value_or(0);
  if (line.radius_mm) {
    const double r = *line.radius_mm, chord = std::hypot(dx, dy), beyond = 4 * r * r - chord * chord;
    if (chord == 0) return "has an arc by its radius (R) that ends where it begins: give its centre (I, J).";
    if (beyond < 0)
      return "has an arc of radius " + decimal(std::abs(r)) + " mm between places " + decimal(chord) +
             " mm apart, which cannot be: post the job again.";
    // RS274's radius form: the shorter arc for R > 0 (grbl, gcode.c, "Arc Radius Mode").
    double h = std::sqrt(beyond) / chord;
    if (clockwise == (r > 0)) h = -h;
    i = (dx - dy * h) / 2;
    j = (dy + dx * h) / 2;
  } else if (!line.centre_mm[axes[0]] && !line.centre_mm[axes[1]]) {
    return "has an arc without a centre in its plane (I, J, K) or a radius (R): post the job again.";
  }
  arc.centre[0] = from_mm[axes[0]] + i, arc.centre[1] = from_mm[axes[1]] + j;
  arc.from[0] = -i, arc.from[1] = -j;
  arc.to[0] = dx - i, arc.to[1] = dy - j;
  const double radius = std::hypot(i, j), error = std::abs(std::hypot(arc.to[0], arc.to[1]) - radius);
  // What GRBL takes (gcode.c, "Arc Center Format Offset Mode").
  if (error > 0.005 && (error > 0.5 || error > 0.001 * radius))
    return "has an arc whose ends lie at distances from its centre that differ by " + decimal(error) +
           " mm: post the job again with more decimals.";
  return "";
}

/// Where the arc crosses the directions of its plane's axes. The radius is that of its beginning (grbl, mc_arc): the
/// last piece leads to the end.
void add_bulges(const Arc& arc, const std::array<std::size_t, 3>& axes, bool clockwise, bool whole_turns,
                GcodeBounds& bounds) {
  const double radius = std::hypot(arc.from[0], arc.from[1]), start = std::atan2(arc.from[1], arc.from[0]);
  double sweep =
      std::atan2(arc.from[0] * arc.to[1] - arc.from[1] * arc.to[0], arc.from[0] * arc.to[0] + arc.from[1] * arc.to[1]);
  if (clockwise && sweep >= -full_turn_rad) sweep -= 2 * std::numbers::pi;
  if (!clockwise && sweep <= full_turn_rad) sweep += 2 * std::numbers::pi;
  if (whole_turns) sweep = 2 * std::numbers::pi;
  const double low = std::min(start, start + sweep), high = std::max(start, start + sweep);
  for (int quarter = -6; quarter <= 6; ++quarter) {
    const double angle = quarter * std::numbers::pi / 2;
    if (angle < low || angle > high) continue;
    const std::size_t across = quarter % 2 == 0 ? 0 : 1;
    const bool positive = ((quarter % 4) + 4) % 4 < 2;
    bounds.add(axes[across], arc.centre[across] + (positive ? radius : -radius));
  }
}

}  // namespace

void GcodeBounds::add(std::size_t axis, double place_mm) {
  low_mm[axis] = named[axis] ? std::min(low_mm[axis], place_mm) : place_mm;
  high_mm[axis] = named[axis] ? std::max(high_mm[axis], place_mm) : place_mm;
  named[axis] = true;
  empty = false;
}

void GcodeBounds::add(const std::array<double, 3>& point_mm) {
  for (std::size_t axis = 0; axis < 3; ++axis) add(axis, point_mm[axis]);
}

std::array<std::size_t, 3> axes_of_plane(int plane) {
  if (plane == 18) return {2, 0, 1};
  if (plane == 19) return {1, 2, 0};
  return {0, 1, 2};
}

std::string run_gcode_line(const std::vector<GcodeWord>& words, GcodeState& s, GcodeReach* reach) {
  if (const char* unclear = unclear_word(words)) return unclear;
  const Line line = take_words(words, s);
  if (reach && s.spindle != 5) reach->fires = true;
  const auto end_program = [&] {
    for (const auto& [letter, value, has_number] : words)
      if (letter == 'M' && (value == 2 || value == 30))
        s.spindle = 5, s.motion = 1, s.relative = false, s.plane = 17, s.mist = s.flood = false;
  };
  const auto axes = axes_of_plane(s.plane);
  // Marlin draws a whole circle where a line has a centre only.
  const bool arc_words = line.names_axis() || line.centre_mm[axes[0]] || line.centre_mm[axes[1]];
  const bool is_arc = (s.motion == 2 || s.motion == 3) && arc_words;
  if (s.motion == 80 || !(is_arc || line.names_axis())) {
    end_program();
    return "";
  }
  const std::array<double, 3> from = s.position_mm;
  std::array<double, 3> to = from;
  std::array<bool, 3> from_here{};  // axes that count from a place which the program has not named
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool turns = is_arc && axis != axes[2];
    from_here[axis] = !s.moved[axis] && (turns || (s.relative && line.target_mm[axis]));
    if (line.target_mm[axis]) to[axis] = s.relative ? from[axis] + *line.target_mm[axis] : *line.target_mm[axis];
    if (std::abs(to[axis]) > max_reach_mm)
      return "goes to a place " + decimal(std::abs(to[axis]) / 1000) + " m away: post the job again in mm (G21).";
  }
  Arc arc{};
  const bool clockwise = s.motion == 2;
  if (is_arc)
    if (std::string unclear = find_arc(line, from, to, axes, clockwise, arc); !unclear.empty()) return unclear;
  s.from_here = s.from_here || from_here[0] || from_here[1];
  s.position_mm = to;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool turns = is_arc && axis != axes[2];
    if (!line.target_mm[axis] && !turns) continue;
    s.moved[axis] = true;
    if (!reach) continue;
    if (from_here[axis]) reach->bounds.add(axis, from[axis]);
    reach->bounds.add(axis, to[axis]);
  }
  if (is_arc && reach) {
    add_bulges(arc, axes, clockwise, line.turns >= 1, reach->bounds);
    for (const std::size_t axis : {axes[0], axes[1]})
      if (reach->bounds.high_mm[axis] > max_reach_mm || reach->bounds.low_mm[axis] < -max_reach_mm)
        return "has an arc that reaches over 100 m away: post the job again in mm (G21).";
  }
  end_program();
  return "";
}

}  // namespace formwright
