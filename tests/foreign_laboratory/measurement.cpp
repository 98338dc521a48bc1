// SPDX-License-Identifier: GPL-3.0-or-later
#include "foreign_laboratory/measurement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <stdexcept>

namespace formwright::foreign_laboratory {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;
using Json = nlohmann::ordered_json;

struct SurfacePoint {
  Vector3d place, outward;
  double thickness_mm;
};

/// Bilinear between the nodes; places beside the opening count as its rim.
SurfacePoint point_of(const FormedSheet& sheet, const Vector2d& flat_mm) {
  const Grid& grid = sheet.grid;
  const double x = std::clamp((flat_mm.x() / grid.width_mm + 0.5) * grid.cells_x, 0.0, 1.0 * grid.cells_x);
  const double y = std::clamp((flat_mm.y() / grid.length_mm + 0.5) * grid.cells_y, 0.0, 1.0 * grid.cells_y);
  const int i = std::min(static_cast<int>(x), grid.cells_x - 1), j = std::min(static_cast<int>(y), grid.cells_y - 1);
  const double u = x - i, v = y - j;
  SurfacePoint point{Vector3d::Zero(), Vector3d::Zero(), 0};
  const auto add = [&](int node, double weight) {
    point.place += weight * sheet.place_mm.col(node);
    point.outward += weight * sheet.outward.col(node);
    point.thickness_mm += weight * sheet.thickness_mm[node];
  };
  add(grid.node(i, j), (1 - u) * (1 - v));
  add(grid.node(i + 1, j), u * (1 - v));
  add(grid.node(i + 1, j + 1), u * v);
  add(grid.node(i, j + 1), (1 - u) * v);
  point.outward.normalize();
  return point;
}

SurfacePoint marked_point(const FormedSheet& sheet, const Vector2d& mark, const Faults& faults) {
  const double scale = 1 + faults.print_scale;
  const double x = (1 + faults.print_stretch_x) * mark.x() + faults.print_skew * mark.y();
  return point_of(sheet, {scale * x, scale * (1 + faults.print_stretch_y) * mark.y()});
}

Vector3d scanned(const SurfacePoint& point, const Faults& faults) {
  Vector3d place = point.place + 0.5 * point.thickness_mm * point.outward;
  place.z() -= faults.scan_bow_mm * place.head<2>().squaredNorm() / (100.0 * 100.0);
  place = (1 + faults.scan_scale) * Vector3d(1 + faults.scan_stretch_x, 1, 1).cwiseProduct(place);
  constexpr double per_degree = std::numbers::pi / 180;
  const auto turn = Eigen::AngleAxisd(per_degree * faults.scan_turn_z_deg, Vector3d::UnitZ()) *
                    Eigen::AngleAxisd(per_degree * faults.scan_turn_y_deg, Vector3d::UnitY()) *
                    Eigen::AngleAxisd(per_degree * faults.scan_turn_x_deg, Vector3d::UnitX());
  return turn * place + Vector3d(faults.scan_shift_x_mm, faults.scan_shift_y_mm, faults.scan_shift_z_mm);
}

std::string setup_json(const Machine& m, const Polymer& polymer) {
  constexpr double kg_per_m3 = 1e12;  // a tonne/mm^3
  const Json json = {{"sheet_mm", {m.sheet_x_mm, m.sheet_y_mm}},
                     {"sheet_thickness_mm", m.thickness_mm},
                     {"clamp_opening_mm", {m.opening_x_mm, m.opening_y_mm}},
                     {"clamp_height_mm", m.clamp_z_mm},
                     {"base_plate_start_z_mm", m.plate_start_z_mm},
                     {"base_plate_end_z_mm", 0},
                     {"mould_speed_mm_per_s", m.mould_speed_mm_per_s},
                     {"relaxation_s", m.sag_s},
                     {"vacuum_kpa", m.vacuum_kpa},
                     {"density_kg_per_m3", std::round(polymer.density_t_per_mm3 * kg_per_m3)},
                     {"measured_surface", "outer"}};
  return json.dump(1) + "\n";
}

std::string measured_csv(const std::vector<MeasuredPoint>& points) {
  std::string text = "sheet_x_mm,sheet_y_mm,x_mm,y_mm,z_mm,sigma_mm\n";
  char line[160];
  for (const MeasuredPoint& p : points) {
    std::snprintf(line, sizeof line, "%.4f,%.4f,%.4f,%.4f,%.4f,%.4f\n", p.sheet_mm.x(), p.sheet_mm.y(), p.place_mm.x(),
                  p.place_mm.y(), p.place_mm.z(), p.sigma_mm);
    text += line;
  }
  return text;
}

Json figures_of(const FormedSheet& sheet) {
  return {{"cells", sheet.grid.cells_x},
          {"steps", sheet.steps},
          {"thickness_min_mm", sheet.thickness_mm.minCoeff()},
          {"thickness_max_mm", sheet.thickness_mm.maxCoeff()},
          {"clamp_feed_mm", sheet.clamp_feed_mm},
          {"inside_node_mm", sheet.inside_node_mm},
          {"inside_cell_mm", sheet.inside_cell_mm},
          {"spring_back_strain", sheet.spring_back_strain}};
}

Json world_json(const World& world) {
  return {{"lasting_modulus_mpa", world.polymer.lasting_modulus_mpa},
          {"relaxing_modulus_mpa", world.polymer.relaxing_modulus_mpa},
          {"relaxation_s", world.polymer.relaxation_s},
          {"young_modulus_at_1_s_mpa", relaxation_modulus_mpa(world.polymer, 1, world.polymer.forming_temperature_k)},
          {"pump_s", world.pump_s},
          {"dead_volume_mm3", world.dead_volume_mm3},
          {"hold_s", world.hold_s},
          {"warmer_k", world.warmer_k},
          {"thicker", world.thicker}};
}

}  // namespace

std::vector<Vector2d> draw_marks(const Machine& machine, int points, std::mt19937_64& random) {
  if (points < 1 || points > 1000000) throw std::invalid_argument("points: give a number from 1 to 1,000,000");
  constexpr double used_share = 0.96;
  const double width = used_share * machine.opening_x_mm, length = used_share * machine.opening_y_mm;
  const int columns = std::max(1, static_cast<int>(std::lround(std::sqrt(points * width / length))));
  const int rows = (points + columns - 1) / columns;
  std::vector<Vector2d> marks;
  for (int k = 0; k < points; ++k) {
    const double x = (k % columns + uniform(random, 0, 1)) / columns - 0.5;
    const double y = (k / columns + uniform(random, 0, 1)) / rows - 0.5;
    marks.emplace_back(x * width, y * length);
  }
  return marks;
}

Points marked_places(const FormedSheet& sheet, const std::vector<Vector2d>& marks, const Faults& faults) {
  Points places(3, static_cast<Eigen::Index>(marks.size()));
  for (std::size_t k = 0; k < marks.size(); ++k)
    places.col(static_cast<Eigen::Index>(k)) = scanned(marked_point(sheet, marks[k], faults), faults);
  return places;
}

std::vector<MeasuredPoint> scan(const FormedSheet& sheet, const std::vector<Vector2d>& marks, const Faults& faults,
                                const Scan& settings, std::mt19937_64& random) {
  if (!(settings.noise_mm >= 0 && settings.noise_mm <= 100) ||
      !(settings.outlier_share >= 0 && settings.outlier_share <= 0.5))
    throw std::invalid_argument("noise: give 0 to 100 mm, and at most half of the points as outliers");
  std::vector<MeasuredPoint> measured;
  for (const Vector2d& mark : marks) {
    const double sigma = settings.noise_mm * (2 - marked_point(sheet, mark, faults).outward.z());
    const bool mistaken = uniform(random, 0, 1) < settings.outlier_share;
    const double away = uniform(random, 5, 15), angle = uniform(random, 0, 2 * std::numbers::pi);
    const Vector2d seen = mistaken ? Vector2d(mark + away * Vector2d(std::cos(angle), std::sin(angle))) : mark;
    Vector3d place = scanned(marked_point(sheet, seen, faults), faults);
    for (Eigen::Index k = 0; k < 3; ++k) place[k] += sigma * normal(random);
    measured.push_back({mark, place, sigma});
  }
  return measured;
}

std::map<std::string, std::string> make_object(const Request& request) {
  // A stream of random numbers for each purpose: the sheet without fault has the same world, marks and noise.
  const auto stream = [](unsigned seed, unsigned purpose) { return std::mt19937_64(8ULL * seed + purpose); };
  auto of_world = stream(request.world_seed.value_or(request.seed), 0), of_faults = stream(request.seed, 1),
       of_marks = stream(request.seed, 2), of_noise = stream(request.seed, 3);
  const Machine machine;
  World world = draw_world(of_world);
  if (request.day_seed) {
    auto of_day = stream(*request.day_seed, 4);
    world = on_another_day(world, of_day);
  }
  const Faults faults = draw_faults(request.cause, request.level, of_faults);
  const std::vector<Vector2d> marks = draw_marks(machine, request.scan.points, of_marks);

  const FormedSheet clean = form_sheet(request.mould, machine, world, Faults{}, request.forming);
  std::optional<FormedSheet> faulty;
  if (request.cause != "none" && !acts_on_measurement(request.cause))
    faulty = form_sheet(request.mould, machine, world, faults, request.forming);
  const FormedSheet& sheet = faulty ? *faulty : clean;
  const Eigen::VectorXd moved =
      (marked_places(sheet, marks, faults) - marked_places(clean, marks, Faults{})).colwise().norm();

  Json truth = {{"laboratory", "foreign"},
                {"seed", request.seed},
                {"mould", mould_names[static_cast<std::size_t>(request.mould)]},
                {"cause", request.cause},
                {"in_the_list", is_in_the_list(request.cause)},
                {"level", request.level},
                {"values", Json::object()},
                {"movement_mean_mm", moved.mean()},
                {"movement_max_mm", moved.maxCoeff()},
                {"noise_mm", request.scan.noise_mm},
                {"points", request.scan.points},
                {"sheet", figures_of(sheet)},
                {"world", world_json(world)}};
  for (const auto& [name, value] : values_of(faults)) truth["values"][name] = value;
  const double colder_k = std::hypot(faults.colder_right_k, faults.colder_back_k) + std::abs(faults.colder_corners_k);
  if (colder_k > 0)
    truth["stiffness_ratios"] = {stiffness_ratio(world.polymer, world.polymer.forming_temperature_k - colder_k),
                                 stiffness_ratio(world.polymer, world.polymer.forming_temperature_k + colder_k)};
  return {{"mould.obj", write_obj(triangulate(request.mould))},
          {"setup.json", setup_json(machine, world.polymer)},
          {"measured.csv", measured_csv(scan(sheet, marks, faults, request.scan, of_noise))},
          {"truth.json", truth.dump(1) + "\n"}};
}

}  // namespace formwright::foreign_laboratory
