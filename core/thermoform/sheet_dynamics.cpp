// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/sheet_dynamics.h"

#include <Eigen/Dense>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace formwright {
namespace {

constexpr double cg_tolerance = 0.1;  // of Newton's directions: the next iteration corrects the rest
constexpr int max_cg_iterations = 400;
constexpr int max_newton_iterations = 12;
constexpr int max_sliding_iterations = 5;
constexpr double min_point_radius = 0.1;  // of half a thickness: points must not pass through
constexpr double settled_share = 0.05;    // of the step's limit: an increment this small ends the iteration
constexpr double wrinkle_share =
    0.2;  // so much a few vertices may go on moving: squeezed triangles buckle back and forth

constexpr std::size_t vertex_grain = 512;
constexpr int faces_per_strip = 512;

MembraneMaterial material_of(const ThermoformOptions& o) {
  return {o.elastic_law,   o.yield_rule,   o.young_modulus_pa * 1e-6,
          o.poisson_ratio, o.creep_per_s,  o.yield_strain,
          o.viscosity_s,   o.flow_stop_mm, o.anisotropy,
          o.network_share};
}

/// Stiffness and thickness at the triangles' middles.
SheetVariation variation_of(const SheetMesh& sheet, const ThermoformOptions& o) {
  SheetVariation variation;
  for (Eigen::Index f = 0; f < sheet.F.rows(); ++f) {
    const Vec2 middle =
        (sheet.flat_mm.row(sheet.F(f, 0)) + sheet.flat_mm.row(sheet.F(f, 1)) + sheet.flat_mm.row(sheet.F(f, 2)))
            .transpose() /
        3;
    const double xi = 2 * middle.x() / o.clamp_opening_x_mm, eta = 2 * middle.y() / o.clamp_opening_y_mm;
    variation.stiffness.push_back(stiffness_factor(o, xi, eta));
    variation.thickness.push_back(thickness_factor(o, xi, eta));
  }
  return variation;
}

double shortest_edge(const SheetMesh& sheet) {
  const Vec2 a = sheet.flat_mm.row(sheet.F(0, 0)), b = sheet.flat_mm.row(sheet.F(0, 1)),
             c = sheet.flat_mm.row(sheet.F(0, 2));
  return std::min({(a - b).norm(), (b - c).norm(), (c - a).norm()});
}

BlockMatrix make_matrix(const SheetMesh& sheet, const HingeBending* bending) {
  const int n = static_cast<int>(sheet.flat_mm.rows());
  if (bending) return {n, bending->vertices(), 4};
  return {n, std::span(sheet.F.data(), static_cast<std::size_t>(sheet.F.size())), 3};
}

std::vector<Vec3> sharp_points(const MouldContact* contact, double edge_mm, double slip) {
  if (!contact) return {};
  constexpr double allowed_mm = 0.1;
  return contact->sharp_points(edge_mm, std::max(allowed_mm, point_reach(slip).rounded_edges * edge_mm), 0.5 * edge_mm);
}

}  // namespace

SheetDynamics::SheetDynamics(const SheetMesh& sheet, const ThermoformOptions& options, double height_mm,
                             std::shared_ptr<const MouldContact> contact)
    : sheet_(sheet),
      options_(options),
      contact_(std::move(contact)),
      membrane_(sheet.flat_mm, sheet.F, options.sheet_thickness_mm, material_of(options), variation_of(sheet, options)),
      strips_(sheet.F, faces_per_strip),
      points_(sharp_points(contact_.get(), shortest_edge(sheet), options.slip), shortest_edge(sheet),
              50 * options.young_modulus_pa * 1e-6 * options.sheet_thickness_mm),
      cg_(static_cast<int>(sheet.flat_mm.rows())),
      edge_mm_(shortest_edge(sheet)),
      step_limit_mm_(options.step_mm.value_or(std::max(1.0, 0.3 * shortest_edge(sheet)))) {
  const Eigen::Index n = sheet.flat_mm.rows();
  if (options.bending)
    bending_ = std::make_unique<HingeBending>(sheet.F, static_cast<int>(n), options.young_modulus_pa * 1e-6,
                                              options.poisson_ratio, options.viscosity_s);
  matrix_ = make_matrix(sheet, bending_.get());
  membrane_.use_matrix(matrix_);
  x_.resize(n, 3);
  x_.leftCols(2) = sheet.flat_mm;
  x_.col(2).setConstant(height_mm);
  v_ = Positions::Zero(n, 3);
  mass_.assign(static_cast<std::size_t>(n), 0);
  for (int f = 0; f < membrane_.face_count(); ++f)
    for (int k = 0; k < 3; ++k)
      mass_[static_cast<std::size_t>(sheet.F(f, k))] +=
          options.density_kg_per_m3 * 1e-12 * membrane_.volume_mm3()[static_cast<std::size_t>(f)] / 3;
  for (const double m : mass_) mass_total_ += m;
  held_ = sheet.clamped;
  contact_time_.assign(static_cast<std::size_t>(n), -1);
  for (std::size_t i = 0; i < held_.size(); ++i)
    if (held_[i]) contact_time_[i] = 0;
  known_.resize(static_cast<std::size_t>(n));
  if (options.cooling > 0) chill_ = std::make_unique<ContactChill>(sheet, options.cooling);
  if (options.slip > 0 && contact_)
    friction_ = std::make_unique<SheetFriction>(sheet, 1 / options.slip,
                                                options.young_modulus_pa * 1e-6 * options.sheet_thickness_mm);
  if (options.clamp_slip_mm > 0)
    clamp_slip_ = std::make_unique<ClampSlip>(sheet, Vec2(options.clamp_opening_x_mm, options.clamp_opening_y_mm));
  none_held_.assign(held_.size(), moves_freely);
  if (contact_)
    parallel_for(known_.size(), vertex_grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        known_[i] = contact_->survey(x_.row(static_cast<Eigen::Index>(i)).transpose());
    });
  collect_free();
}

void SheetDynamics::collect_free() {
  free_.clear();
  for (std::size_t i = 0; i < held_.size(); ++i)
    if (held_[i] == moves_freely || held_[i] == sliding) free_.push_back(static_cast<int>(i));
}

int SheetDynamics::free_count() const { return static_cast<int>(std::count(held_.begin(), held_.end(), moves_freely)); }

void SheetDynamics::begin_membrane_step() {
  // Where nothing ever slides, triangles held at every corner have no say.
  membrane_.begin_step(x_, friction_ ? none_held_ : held_);
  if (bending_) bending_->begin_step(x_, membrane_.thickness_mm(), membrane_.stiffness_factors());
}

void SheetDynamics::add_velocity(const Vec3& mm_per_s) {
  for (const int i : free_)
    if (held_[static_cast<std::size_t>(i)] == moves_freely) v_.row(i) += mm_per_s.transpose();
}

std::vector<double> SheetDynamics::vertex_thickness_mm(const Positions& x) const {
  std::vector<double> volume(held_.size()), area(held_.size());
  for (int f = 0; f < membrane_.face_count(); ++f) {
    const Vec3 a = x.row(sheet_.F(f, 0)), b = x.row(sheet_.F(f, 1)), c = x.row(sheet_.F(f, 2));
    const double face_area = 0.5 * (b - a).cross(c - a).norm();
    for (int k = 0; k < 3; ++k) {
      volume[static_cast<std::size_t>(sheet_.F(f, k))] += membrane_.volume_mm3()[static_cast<std::size_t>(f)];
      area[static_cast<std::size_t>(sheet_.F(f, k))] += face_area;
    }
  }
  for (std::size_t i = 0; i < volume.size(); ++i) volume[i] /= std::max(area[i], 1e-12);
  return volume;
}

void SheetDynamics::assemble(const Positions& x, double dt_s, const StepLoad& load, Positions& force,
                             BlockMatrix* matrix) {
  const auto n = static_cast<std::size_t>(x.rows());
  parallel_for(n, vertex_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      force.row(static_cast<Eigen::Index>(i)) << 0, 0, -mass_[i] * load.gravity_mm_per_s2;
  });
  if (matrix)
    parallel_for(free_.size(), vertex_grain, [&](std::size_t begin, std::size_t end) {
      matrix->set_zero(std::span<const int>(free_).subspan(begin, end - begin));
    });
  strips_.for_each([&](int first_face, int end_face) {
    membrane_.add_forces_of(first_face, end_face, x, dt_s, force, matrix);
    if (load.pressure_mpa == 0) return;
    for (int f = first_face; f < end_face; ++f) {
      // The gradient of the volume under the face: a third of its area vector for each corner.
      const int a = sheet_.F(f, 0), b = sheet_.F(f, 1), c = sheet_.F(f, 2);
      if (!friction_ && held_[static_cast<std::size_t>(a)] && held_[static_cast<std::size_t>(b)] &&
          held_[static_cast<std::size_t>(c)])
        continue;
      const Vec3 pa = x.row(a), pb = x.row(b), pc = x.row(c);
      const Vec3 push = -load.pressure_mpa / 6 * (pb - pa).cross(pc - pa);
      force.row(a) += push.transpose();
      force.row(b) += push.transpose();
      force.row(c) += push.transpose();
    }
  });
  if (bending_) bending_->add_forces(x, dt_s, force, matrix);
  points_.add_forces(sheet_.F, x, force, matrix);
}

Positions SheetDynamics::forces(const Positions& x, double dt_s, const StepLoad& load, BlockMatrix* matrix) {
  Positions force(x.rows(), 3);
  begin_membrane_step();
  if (matrix) matrix->set_zero();
  assemble(x, dt_s, load, force, matrix);
  return force;
}

int SheetDynamics::find_contacts(const Positions& from, Positions& to, const std::vector<double>& radius_mm) {
  if (!contact_) return 0;
  int found = 0;
  // A face that a sharp point catches stops there: its corners can only touch what they met before.
  std::vector<double>& until = until_;
  until.assign(held_.size(), 1);
  const std::size_t before = points_.contacts().size();
  found += points_.find(sheet_.F, from, to, point_radius_mm_, held_, contact_->tolerance_mm(),
                        [&](int v) { return known_[static_cast<std::size_t>(v)].at(from.row(v).transpose()); });
  for (std::size_t c = before; c < points_.contacts().size(); ++c)
    for (int k = 0; k < 3; ++k) {
      double& limit = until[static_cast<std::size_t>(sheet_.F(points_.contacts()[c].face, k))];
      limit = std::min(limit, points_.contacts()[c].fraction);
    }
  std::atomic<int> touched{0};
  parallel_for(free_.size(), vertex_grain / 2, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const int i = free_[k];
      const auto v = static_cast<std::size_t>(i);
      if (held_[v] != moves_freely) continue;
      const Vec3 a = from.row(i), b = to.row(i);
      const auto touch = contact_->first_touch(a, b, radius_mm[v], known_[v]);
      if (!touch || *touch > until[v]) continue;
      to.row(i) = (a + *touch * (b - a)).transpose();
      held_[v] = stuck_in_this_step;
      ++touched;
    }
  });
  found += touched;
  return found;
}

Vec3 SheetDynamics::slide(int vertex, const Vec3& from, const Vec3& wanted, double radius_mm) {
  // No farther at once than the normal may be trusted.
  const double max_mm = 0.25 * edge_mm_;
  Vec3 to = from + (wanted.norm() > max_mm ? Vec3(max_mm / wanted.norm() * wanted) : wanted);
  Vec3& normal = friction_->normal(vertex);
  if (contact_->slide(from, to, normal, radius_mm)) normal = contact_->normal(to, radius_mm);
  else held_[static_cast<std::size_t>(vertex)] = moves_freely;
  return to - from;
}

SheetDynamics::Outcome SheetDynamics::step(double dt_s, const StepLoad& load, double max_move_mm, Context& context) {
  const std::size_t points_before = points_.contacts().size();
  Stopwatch watch;
  begin_membrane_step();
  std::vector<double> radius = vertex_thickness_mm(x_);
  for (double& r : radius) r *= 0.5;
  point_radius_mm_ = membrane_.thickness_mm();
  const double reach_mm = point_reach(options_.slip).sharp_edges * edge_mm_;
  for (double& r : point_radius_mm_) r = std::max(min_point_radius * 0.5 * r, 0.5 * r - reach_mm);
  const Positions from = x_;
  const HeldVertices held_before = friction_ ? held_ : HeldVertices{};
  const std::optional<SheetFriction> friction_before = friction_ ? std::optional(*friction_) : std::nullopt;
  Positions x = x_, force(x_.rows(), 3);
  BlockVector right_side(held_.size()), direction(held_.size());
  const bool has_guess = guess_.rows() == x_.rows();
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    if (sheet_.clamped[static_cast<std::size_t>(i)]) {
      x.row(i) += load.clamp_shift.transpose();
      if (load.clamp_slip_mm > 0)
        x.row(i).head<2>() += load.clamp_slip_mm * clamp_slip_->movement(static_cast<int>(i)).transpose();
    } else if (!held_[static_cast<std::size_t>(i)]) {
      if (has_guess) x.row(i) = guess_.row(i);
      else x.row(i) += dt_s * v_.row(i);
    }
  }
  guess_.resize(0, 3);
  const double inertia = load.quasi_static ? 0 : 1 / (dt_s * dt_s);
  statistics_.seconds_assembly += watch.lap();

  const auto give_up = [&](Outcome outcome) {
    points_.roll_back(points_before);
    for (char& held : held_)
      if (held == stuck_in_this_step) held = moves_freely;
    if (friction_) {
      held_ = held_before;
      *friction_ = *friction_before;
    }
    collect_free();
    ++statistics_.rejected_steps;
    return outcome;
  };
  double moved = 0;
  bool settled = free_.empty();
  for (int iteration = 0; !settled; ++iteration) {
    context.check_cancelled();
    if (iteration == max_newton_iterations) {
      last_iterate_ = std::move(x);
      return give_up(Outcome::not_converged);
    }
    watch.lap();
    assemble(x, dt_s, load, force, &matrix_);
    for (const int i : free_) {
      const auto v = static_cast<std::size_t>(i);
      const double m = mass_[v] * inertia;
      Vec3 residual = force.row(i).transpose() - m * (x.row(i) - from.row(i) - dt_s * v_.row(i)).transpose();
      auto& diagonal = matrix_.block(matrix_.diagonal_slot(i));
      for (std::size_t k = 0; k < 3; ++k) diagonal[k][k] += static_cast<float>(m);
      if (held_[v] == sliding) friction_->constrain(i, (x.row(i) - from.row(i)).transpose(), dt_s, residual, diagonal);
      right_side[v] = Float4{static_cast<float>(residual.x()), static_cast<float>(residual.y()),
                             static_cast<float>(residual.z()), 0};
    }
    statistics_.seconds_assembly += watch.lap();
    statistics_.cg_iterations += cg_.solve(matrix_, right_side, free_, cg_tolerance, max_cg_iterations, direction);
    ++statistics_.newton_iterations;
    statistics_.seconds_linear += watch.lap();

    double increment_squared = 0, moved_squared = 0, sum_squared = 0;
    int cornered = 0;
    for (const int i : free_) {
      const Float4& d = direction[static_cast<std::size_t>(i)];
      Vec3 delta(d[0], d[1], d[2]);
      if (held_[static_cast<std::size_t>(i)] == sliding) {
        delta = slide(i, x.row(i).transpose(), delta, radius[static_cast<std::size_t>(i)]);
        // One that still goes to and fro, as between the plate and the model, is done for this step.
        if (iteration >= max_sliding_iterations && held_[static_cast<std::size_t>(i)] == sliding &&
            delta.norm() > settled_share * step_limit_mm_) {
          held_[static_cast<std::size_t>(i)] = stuck;
          ++cornered;
        }
      }
      x.row(i) += delta.transpose();
      increment_squared = std::max(increment_squared, delta.squaredNorm());
      sum_squared += delta.squaredNorm();
      moved_squared =
          std::max(moved_squared, (x.row(i).transpose() - from.row(i).transpose() - load.clamp_shift).squaredNorm());
    }
    moved = std::sqrt(moved_squared);
    if (!std::isfinite(increment_squared)) return give_up(Outcome::not_converged);
    if (moved > 1.5 * max_move_mm) return give_up(Outcome::moved_too_far);
    const double mean_squared = sum_squared / std::max<double>(1, static_cast<double>(free_.size()));
    settled = std::sqrt(increment_squared) < settled_share * step_limit_mm_ ||
              (iteration >= 2 && std::sqrt(increment_squared) < wrinkle_share * step_limit_mm_ &&
               std::sqrt(mean_squared) < 0.2 * settled_share * step_limit_mm_);
    const int touched = find_contacts(from, x, radius) + cornered;
    statistics_.seconds_contact += watch.lap();
    if (touched > 0) {
      collect_free();
      settled = free_.empty();
    }
  }
  // Accepted.
  for (std::size_t i = 0; i < held_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    if (held_[i] == stuck_in_this_step) {
      held_[i] = stuck;
      contact_time_[i] = time_ + dt_s;
      v_.row(row).setZero();
      if (friction_) friction_->normal(static_cast<int>(i)) = contact_->normal(x.row(row).transpose(), radius[i]);
    } else if (held_[i] == moves_freely) {
      v_.row(row) = (x.row(row) - from.row(row)) / dt_s;
      contact_time_[i] = -1;  // also of one that has slid off the mould
    }
  }
  if (chill_) chill_->advance(dt_s, held_);
  membrane_.end_step(x, dt_s,
                     chill_ ? std::span<const double>(chill_->stiffness_factors()) : std::span<const double>());
  x_ = std::move(x);
  if (clamp_slip_ && !free_.empty()) clamp_slip_->feel(force);
  if (friction_) {
    begin_membrane_step();
    assemble(x_, std::numeric_limits<double>::infinity(), load, force, nullptr);
    points_.let_go(sheet_.F, x_, friction_->coefficient(),
                   [&](int face) { return friction_->carried_by_corners(sheet_.F, face, held_); });
    points_.slide(sheet_.F, x_, friction_->coefficient(), friction_->faces_of());
    friction_->decide(force, x_ - from, load.settling, held_);
    collect_free();
  }
  time_ += dt_s;
  last_move_ = moved;
  last_step_ = dt_s;
  ++statistics_.steps;
  return Outcome::done;
}

}  // namespace formwright
