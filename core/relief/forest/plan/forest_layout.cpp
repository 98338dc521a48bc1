// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/forest/plan/forest_layout.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/error.h"
#include "base/format.h"
#include "base/random.h"

namespace formwright {
namespace {

constexpr int tries_a_pillar = 400, tries_a_layout = 60;
constexpr double overlap_share = 0.08;  // of a column: by so much its pillar is wider on each side

/// To numbers that a maker can read, and that are the same on every machine.
double rounded(double value) {
  constexpr double steps = 1000;
  return std::round(steps * value) / steps;
}

/// Of a width from side to side, as seen by whom `turn_deg` faces.
Pillar pillar_at(PillarShape shape, const Vec2& centre, double width_mm, double turn_deg, double height_mm) {
  PillarForm form{PillarForm::Shape::round, {rounded(centre.x()), rounded(centre.y())}, rounded(width_mm), 0};
  if (shape == PillarShape::square) form.shape = PillarForm::Shape::square;
  if (shape == PillarShape::hexagon) form.shape = PillarForm::Shape::hexagon;
  if (form.shape != PillarForm::Shape::round) form.turn_deg = rounded(turn_deg);
  return pillar_of(form, height_mm);
}

PillarShape shape_of(PillarShape shape, std::size_t index) {
  constexpr PillarShape turns[] = {PillarShape::square, PillarShape::round, PillarShape::hexagon};
  return shape == PillarShape::mixed ? turns[index % 3] : shape;
}

bool has_room(const Outline& outline, const std::vector<Pillar>& pillars, double gap_mm) {
  return std::ranges::all_of(
      pillars, [&](const Pillar& other) { return distance_between(outline, other.outline_mm, gap_mm) >= gap_mm; });
}

/// Whether any part of it lies within the rays of a viewpoint as far as its own screen, widened by `margin_mm`.
bool is_in_rays(const Outline& outline, const PlanView& view, double inner_mm, double margin_mm) {
  double from = INFINITY, to = -INFINITY;
  for (const Vec2& p : outline) {
    const double ahead = view.ahead(p);
    if (ahead <= 0 || ahead > view.distance_mm - inner_mm + margin_mm) continue;
    from = std::min(from, (view.aside(p) - margin_mm) / ahead);
    to = std::max(to, (view.aside(p) + margin_mm) / ahead);
  }
  return from < view.to && to > view.from;
}

/// Columns of rays, each as wide as a pillar in the middle of the screen.
int columns_of(const PlanView& view, double outer_mm, double inner_mm, const PillarKind& kind) {
  const double middle = view.distance_mm - 0.5 * (outer_mm + inner_mm),
               columns = std::round((view.to - view.from) * middle / kind.width_mm);
  if (columns > max_pillars)
    throw Error(ErrorCode::invalid_input, "pillar_width_mm",
                "A screen would need more than " + std::to_string(max_pillars) + " pillars: make them wider.");
  return std::max(1, static_cast<int>(columns));
}

/// One pillar a column of rays, as wide as the column where it stands.
bool add_screen(std::size_t own, std::span<const PlanView> views, double outer_mm, double inner_mm,
                const PillarKind& kind, Random& random, std::vector<Pillar>& pillars) {
  const PlanView& view = views[own];
  const double near_mm = view.distance_mm - outer_mm, far_mm = view.distance_mm - inner_mm;
  const double range = view.to - view.from;
  const int columns = columns_of(view, outer_mm, inner_mm, kind);
  const double turn_deg = std::atan2(view.forward.y(), view.forward.x()) * 180 / std::numbers::pi - 90;
  for (int k = 0; k < columns; ++k) {
    bool placed = false;
    for (int attempt = 0; attempt < tries_a_pillar && !placed; ++attempt) {
      const double b = random.uniform(near_mm, far_mm), t = view.from + range * (k + 0.5) / columns;
      const PillarShape shape = shape_of(kind.shape, pillars.size());
      const double width = range / columns * (1 + 2 * overlap_share) * b;
      const Pillar pillar = pillar_at(shape, view.at(t, b), width, turn_deg, kind.height_mm);
      placed = has_room(pillar.outline_mm, pillars, kind.gap_mm);
      for (std::size_t v = 0; v < views.size() && placed; ++v)
        placed = v == own || !is_in_rays(pillar.outline_mm, views[v], inner_mm, kind.gap_mm);
      if (placed) pillars.push_back(pillar);
    }
    if (!placed) return false;
  }
  return true;
}

}  // namespace

std::vector<Pillar> grid_of_pillars(const FloorArea& area, int columns, int rows, double turn_deg,
                                    const PillarKind& kind) {
  const double angle = turn_deg * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
  const auto place = [](double size, int k, int count) {
    return count == 1 ? 0.0 : size * (static_cast<double>(k) / (count - 1) - 0.5);
  };
  if (columns > max_pillars / rows)
    throw Error(ErrorCode::invalid_input, "grid_columns",
                "The grid would have " + std::to_string(columns * rows) + " pillars: at most " +
                    std::to_string(max_pillars) + " can be computed.");
  std::vector<Pillar> pillars;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const double x = place(area.width_mm, column, columns), y = place(area.depth_mm, row, rows);
      const Vec2 centre = area.centre + Vec2(c * x - s * y, s * x + c * y);
      const Pillar pillar =
          pillar_at(shape_of(kind.shape, pillars.size()), centre, kind.width_mm, turn_deg, kind.height_mm);
      if (!has_room(pillar.outline_mm, pillars, kind.gap_mm))
        throw Error(ErrorCode::invalid_input, "pillar_width_mm",
                    "Pillars of the grid would stand closer than " + with_digits(kind.gap_mm, 3) +
                        " mm: make them narrower, fewer, or the area larger.");
      pillars.push_back(pillar);
    }
  return pillars;
}

std::vector<Pillar> random_pillars(const FloorArea& area, int count, const PillarKind& kind, std::uint64_t seed) {
  Random random(seed);
  std::vector<Pillar> pillars;
  for (int k = 0; k < count; ++k) {
    bool placed = false;
    for (int attempt = 0; attempt < tries_a_pillar && !placed; ++attempt) {
      const double x = random.uniform(-0.5, 0.5), y = random.uniform(-0.5, 0.5), turn_deg = random.uniform(0, 90);
      const Vec2 centre = area.centre + Vec2(x * area.width_mm, y * area.depth_mm);
      const Pillar pillar =
          pillar_at(shape_of(kind.shape, pillars.size()), centre, kind.width_mm, turn_deg, kind.height_mm);
      placed = has_room(pillar.outline_mm, pillars, kind.gap_mm);
      if (placed) pillars.push_back(pillar);
    }
    if (!placed)
      throw Error(ErrorCode::invalid_input, "pillar_count",
                  "After " + std::to_string(k) + " of " + std::to_string(count) +
                      " pillars no room was left at random places: ask for fewer or narrower ones, or a larger area.");
  }
  return pillars;
}

std::vector<Pillar> screens_of_pillars(std::span<const PlanView> views, double outer_mm, double inner_mm,
                                       const PillarKind& kind, std::uint64_t seed) {
  for (const PlanView& view : views)
    if (view.distance_mm - outer_mm < kind.width_mm)
      throw Error(ErrorCode::invalid_input, "screen_outer_mm",
                  "The pillars would reach the viewpoints: begin the screens nearer to what is looked at, or move the "
                  "viewpoints away.");
  Random random(seed);
  for (int attempt = 0; attempt < tries_a_layout; ++attempt) {
    std::vector<Pillar> pillars;
    bool complete = true;
    for (std::size_t v = 0; v < views.size() && complete; ++v)
      complete = add_screen(v, views, outer_mm, inner_mm, kind, random, pillars);
    if (complete) return pillars;
  }
  throw Error(ErrorCode::invalid_input, "screen_outer_mm",
              "No room was found for pillars that stop all lines of sight of every viewpoint without standing in those "
              "of another: give the screens more depth or distance, or make models or pillars narrower.");
}

}  // namespace formwright
