// SPDX-License-Identifier: GPL-3.0-or-later
#include "foreign_laboratory/forming.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "foreign_laboratory/air.h"
#include "foreign_laboratory/contact.h"
#include "foreign_laboratory/sheet/sheet_motion.h"

namespace formwright::foreign_laboratory {
namespace {

using Eigen::Vector3d;

constexpr double damping_per_s = 30;

double mould_volume_mm3(Mould mould) {
  const Triangulation mesh = triangulate(mould, 0.5);
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto at = [&](int k) { return mesh.vertices[static_cast<std::size_t>(k)]; };
    volume += at(a).dot(at(b).cross(at(c))) / 6;
  }
  return volume;
}

class Forming {
 public:
  Forming(Mould mould, const Machine& machine, const World& world, const Faults& faults, const FormingOptions& options)
      : machine_(machine),
        world_(world),
        faults_(faults),
        obstacle_(mould, faults),
        mould_volume_mm3_(mould_volume_mm3(mould)),
        motion_(make_motion(options)) {
    if (mould_height_mm(mould) * (1 + faults.mould_scale) > machine.clamp_z_mm - machine.plate_start_z_mm - 20)
      throw std::invalid_argument("plate_start_z_mm: the mould does not fit below the sheet; lower the plate");
    const Grid& grid = motion_.membrane().grid();
    const auto count = static_cast<std::size_t>(grid.node_count());
    clearance_.assign(count, 0);
    touched_.assign(count, 0);
    raised_.assign(count, 0);
    kelvin_.resize(count);
    for (int node = 0; node < grid.node_count(); ++node) {
      const double xi = 2 * grid.flat_mm(node).x() / grid.width_mm, eta = 2 * grid.flat_mm(node).y() / grid.length_mm;
      kelvin_[static_cast<std::size_t>(node)] = world.polymer.forming_temperature_k + world.warmer_k -
                                                faults.colder_right_k * xi - faults.colder_back_k * eta -
                                                faults.colder_corners_k * (xi * xi + eta * eta - 1);
    }
    motion_.membrane().set_temperatures(kelvin_);
    thickness_ = motion_.membrane().thickness_mm(motion_.place());
  }

  FormedSheet run() {
    const double travel_s = -machine_.plate_start_z_mm / machine_.mould_speed_mm_per_s;
    plate_ = {0, machine_.plate_start_z_mm, 0};
    while (motion_.time_s() < machine_.sag_s) step(0);
    plate_.plate_mm_per_s = machine_.mould_speed_mm_per_s;
    for (const double start = motion_.time_s(); motion_.time_s() < start + travel_s;) step(0);
    plate_ = {0, 0, 0};
    const auto air_mm3 = [&] {
      return std::max(motion_.membrane().enclosed_mm3() - mould_volume_mm3_, 0.0) + world_.dead_volume_mm3;
    };
    Air air(air_mm3(), 1e-3 * machine_.vacuum_kpa * (1 - faults_.vacuum_lost), world_.pump_s);
    double pressure = 0;
    for (const double start = motion_.time_s(); motion_.time_s() < start + world_.hold_s;) {
      step(pressure);
      pressure = air.step(air_mm3(), motion_.step_s());
    }
    return result();
  }

 private:
  SheetMotion make_motion(const FormingOptions& options) const {
    if (options.cells < 4 || options.cells > 400) throw std::invalid_argument("cells: give a number from 4 to 400");
    Grid grid{options.cells, options.cells, machine_.opening_x_mm, machine_.opening_y_mm};
    FlatSheet flat;
    flat.anisotropy = faults_.anisotropy;
    flat.thickness_mm = [this](double x, double y) {
      return machine_.thickness_mm * (1 + world_.thicker) *
             (1 + faults_.thicker_right * 2 * x / machine_.opening_x_mm +
              faults_.thicker_back * 2 * y / machine_.opening_y_mm);
    };
    std::vector<char> held(static_cast<std::size_t>(grid.node_count()));
    for (int node = 0; node < grid.node_count(); ++node) held[static_cast<std::size_t>(node)] = grid.on_rim(node);
    return {Membrane(grid, world_.polymer, flat), held, machine_.clamp_z_mm,
            MotionSettings{options.mass_scale, damping_per_s, gravity_mm_per_s2, options.step_share}};
  }

  void step(double pressure_mpa) {
    constexpr int steps_between_states = 10;  // in which the sheet moves by hundredths of a millimetre
    if (steps_++ % steps_between_states == 0) update_states();
    feed_from_clamp();
    plate_.seconds = motion_.step_s();
    plate_.plate_z_mm = std::min(0.0, plate_.plate_z_mm + plate_.seconds * plate_.plate_mm_per_s);
    motion_.step(pressure_mpa, [&](int node, const Vector3d& place, Vector3d& velocity) {
      const auto n = static_cast<std::size_t>(node);
      // Far from the mould a lower bound of the distance is enough: it falls by at most what sheet and plate move.
      clearance_[n] -= plate_.seconds * (velocity.norm() + plate_.plate_mm_per_s);
      if (clearance_[n] > 0) return;
      clearance_[n] = obstacle_.constrain(place, 0.5 * thickness_[node] + raised_[n], plate_, velocity);
      if (clearance_[n] == 0) touched_[n] = 1;
    });
  }

  /// Thickness, and the heat that the mould has taken from what touched it since the last time.
  void update_states() {
    thickness_ = motion_.membrane().thickness_mm(motion_.place());
    raise_nodes();
    const double seconds = motion_.time_s() - heat_time_s_;
    heat_time_s_ = motion_.time_s();
    bool any = false;
    for (std::size_t n = 0; n < kelvin_.size(); ++n) {
      if (!touched_[n]) continue;
      const double capacity = world_.polymer.heat_capacity_mj_per_mm3_k * thickness_[static_cast<Eigen::Index>(n)];
      const auto cool_towards = [&](double mould_k, double w_per_m2_k) {
        constexpr double mj_per_mm2 = 1e-3;  // a J/m^2
        kelvin_[n] += (mould_k - kelvin_[n]) * -std::expm1(-seconds * mj_per_mm2 * w_per_m2_k / capacity);
      };
      cool_towards(world_.mould_k, world_.contact_w_per_m2_k);
      if (faults_.contact_w_per_m2_k > 0) cool_towards(world_.cold_mould_k, faults_.contact_w_per_m2_k);
      touched_[n] = 0;
      any = true;
    }
    if (any) motion_.membrane().set_temperatures(kelvin_);
  }

  /// How far the inner face is inside of the mould in the middles of a cell and of its sides, from 0.
  double inside_of_cell(int cell, const Points& place, const Eigen::VectorXd& thickness) const {
    const std::array<int, 4> k = motion_.membrane().grid().corners(cell);
    const auto middle = [&](std::initializer_list<int> nodes) {
      Vector3d sum = Vector3d::Zero();
      double sum_thickness = 0;
      for (const int node : nodes) sum += place.col(node), sum_thickness += thickness[node];
      const auto count = static_cast<double>(nodes.size());
      return 0.5 * sum_thickness / count - obstacle_.distance_from(sum / count, plate_.plate_z_mm).mm;
    };
    return std::max({0.0, middle({k[0], k[1]}), middle({k[1], k[2]}), middle({k[2], k[3]}), middle({k[3], k[0]}),
                     middle({k[0], k[1], k[2], k[3]})});
  }

  /// Cells over an edge of the mould cut into it between their nodes. What touches is held off by half of that, so that
  /// the sheet is as much outside as inside.
  void raise_nodes() {
    const Grid& grid = motion_.membrane().grid();
    std::vector<double> inside(touched_.size(), 0);
    for (int cell = 0; cell < grid.cell_count(); ++cell) {
      const std::array<int, 4> corners = grid.corners(cell);
      const auto touched = [&](int node) { return touched_[static_cast<std::size_t>(node)] != 0; };
      if (std::none_of(corners.begin(), corners.end(), touched)) continue;
      const double mm = inside_of_cell(cell, motion_.place(), thickness_);
      for (const int node : corners)
        inside[static_cast<std::size_t>(node)] = std::max(inside[static_cast<std::size_t>(node)], mm);
    }
    for (std::size_t n = 0; n < inside.size(); ++n) raised_[n] = touched_[n] ? 0.5 * (raised_[n] + inside[n]) : 0;
  }

  /// A loose clamp: the rim comes in at a speed that grows with the pull beyond what the clamp holds.
  void feed_from_clamp() {
    if (faults_.clamp_mm2_per_n_s <= 0) return;
    constexpr double holds_n_per_mm = 0.02;
    const Grid& grid = motion_.membrane().grid();
    const double margin_x = 0.5 * (machine_.sheet_x_mm - machine_.opening_x_mm);
    const double margin_y = 0.5 * (machine_.sheet_y_mm - machine_.opening_y_mm);
    for (int node = 0; node < grid.node_count(); ++node) {
      if (!grid.on_rim(node)) continue;
      const Eigen::Vector2d flat = grid.flat_mm(node);
      const auto feed = [&](Eigen::Index axis, double half_length, double spacing, double margin) {
        if (std::abs(flat[axis]) < half_length - 1e-9) return;
        const double inwards = flat[axis] > 0 ? -1 : 1;
        const double fed_mm = inwards * (motion_.place()(axis, node) - flat[axis]);
        const double pull = inwards * motion_.force()(axis, node) / spacing;
        const double speed = fed_mm < margin ? faults_.clamp_mm2_per_n_s * std::max(0.0, pull - holds_n_per_mm) : 0;
        motion_.velocity()(axis, node) = inwards * speed;
      };
      feed(0, 0.5 * grid.width_mm, grid.spacing_y_mm(), margin_x);
      feed(1, 0.5 * grid.length_mm, grid.spacing_x_mm(), margin_y);
    }
  }

  FormedSheet result() const {
    const Membrane& membrane = motion_.membrane();
    FormedSheet sheet;
    sheet.grid = membrane.grid();
    const Grid& grid = sheet.grid;
    sheet.place_mm = motion_.place();
    if (!sheet.place_mm.allFinite()) throw std::runtime_error("The sheet's shape is no longer finite.");
    sheet.thickness_mm = membrane.thickness_mm(sheet.place_mm);
    sheet.spring_back_strain = membrane.mean_stress_mpa(sheet.place_mm) / world_.polymer.set_young_modulus_mpa;
    sheet.steps = steps_;
    sheet.outward = Points::Zero(3, grid.node_count());
    for (int cell = 0; cell < grid.cell_count(); ++cell) {
      const std::array<int, 4> k = grid.corners(cell);
      const Vector3d area = (sheet.place_mm.col(k[2]) - sheet.place_mm.col(k[0]))
                                .cross(Vector3d(sheet.place_mm.col(k[3]) - sheet.place_mm.col(k[1])));
      for (const int node : k) sheet.outward.col(node) += area;
    }
    sheet.outward.colwise().normalize();
    const auto inside = [&](const Vector3d& place, double thickness) {
      return 0.5 * thickness - obstacle_.distance_from(place, 0).mm;
    };
    double feed = 0;
    int rim = 0;
    for (int node = 0; node < grid.node_count(); ++node) {
      if (!grid.on_rim(node)) {
        const double mm = inside(sheet.place_mm.col(node), sheet.thickness_mm[node]);
        sheet.inside_node_mm = std::max(sheet.inside_node_mm, mm);
        continue;
      }
      feed += (sheet.place_mm.col(node).head<2>() - grid.flat_mm(node)).norm();
      ++rim;
    }
    sheet.clamp_feed_mm = feed / rim;
    for (int cell = 0; cell < grid.cell_count(); ++cell)
      sheet.inside_cell_mm = std::max(sheet.inside_cell_mm, inside_of_cell(cell, sheet.place_mm, sheet.thickness_mm));
    return sheet;
  }

  Machine machine_;
  World world_;
  Faults faults_;
  MouldOnPlate obstacle_;
  double mould_volume_mm3_;
  SheetMotion motion_;
  MouldOnPlate::Step plate_{};
  std::vector<double> clearance_, raised_, kelvin_;
  std::vector<char> touched_;
  Eigen::VectorXd thickness_;
  double heat_time_s_ = 0;
  long steps_ = 0;
};

}  // namespace

World draw_world(std::mt19937_64& random) {
  World world;
  const auto factor = [&](double spread) { return std::exp(uniform(random, -spread, spread)); };
  const double stiffer = factor(0.3);
  world.polymer.lasting_modulus_mpa *= stiffer * factor(0.2);
  for (double& modulus : world.polymer.relaxing_modulus_mpa) modulus *= stiffer * factor(0.2);
  for (double& seconds : world.polymer.relaxation_s) seconds *= factor(0.3);
  world.pump_s *= factor(0.3);
  world.dead_volume_mm3 *= factor(0.3);
  world.hold_s *= factor(0.2);
  return world;
}

World on_another_day(World world, std::mt19937_64& random) {
  world.warmer_k = 2 * normal(random);
  world.thicker = 0.01 * normal(random);
  world.pump_s *= std::exp(0.05 * normal(random));
  world.hold_s *= std::exp(0.02 * normal(random));
  world.contact_w_per_m2_k *= std::exp(0.1 * normal(random));
  return world;
}

FormedSheet form_sheet(Mould mould, const Machine& machine, const World& world, const Faults& faults,
                       const FormingOptions& options) {
  return Forming(mould, machine, world, faults, options).run();
}

}  // namespace formwright::foreign_laboratory
