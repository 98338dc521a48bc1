// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/forming.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "geometry/mesh/measures.h"
#include "geometry/queries/ray_caster.h"
#include "thermoform/frame_recorder.h"

namespace formwright {
namespace {

constexpr double contact_tolerance_mm = 0.01;
constexpr double longest_step_s = 0.02;  // creep is solved within a step: thickness holds up to here
constexpr double shortest_step_s = 1e-8;
constexpr double longest_free_step_s = 0.1;  // while the platform comes up and nothing touches
constexpr double rest_speed_mm_per_s = 0.5;
constexpr double min_drawing_s = 0.05;  // before what slides is brought to rest
constexpr int max_steps = 20000;

std::string millimetres(double value) { return with_digits(value, 4) + " mm"; }

void check_options(const ThermoformOptions& o) {
  if (o.clamp_opening_x_mm > o.sheet_x_mm)
    throw Error(ErrorCode::invalid_input, "clamp_opening_x_mm",
                "The clamp opening is wider than the sheet: make it at most " + millimetres(o.sheet_x_mm) + ".");
  if (o.clamp_opening_y_mm > o.sheet_y_mm)
    throw Error(ErrorCode::invalid_input, "clamp_opening_y_mm",
                "The clamp opening is longer than the sheet: make it at most " + millimetres(o.sheet_y_mm) + ".");
  const double max_slip_mm = 0.15 * std::min(o.clamp_opening_x_mm, o.clamp_opening_y_mm);
  if (o.clamp_slip_mm > max_slip_mm)
    throw Error(ErrorCode::invalid_input, "clamp_slip_mm",
                "The sheet slips too far for this clamp opening: set clamp_slip_mm to at most " +
                    millimetres(max_slip_mm) + ".");
  check_effects(o);
}

/// The model must stand within the opening, above the plate, and below the sagging sheet when all begins.
void check_placement(const MouldShape& shape, const Placement& placement, const ThermoformOptions& o) {
  BoundingBox box;
  for (Eigen::Index i = 0; i < shape.mesh.V.rows(); ++i) {
    const Vec3 p = placement(shape.mesh.V.row(i).transpose());
    if (p.z() >= 0) box.add(p);
  }
  if (box.empty())
    throw Error(ErrorCode::invalid_input, "sink_mm",
                "Nothing of the model stands above the base plate: lower it less into the plate (sink_mm).");
  const double x = std::max(-box.lower.x(), box.upper.x()), y = std::max(-box.lower.y(), box.upper.y());
  // The rim that slips out of the clamp must not meet the model either.
  const double room_x = 0.5 * o.clamp_opening_x_mm - o.clamp_slip_mm,
               room_y = 0.5 * o.clamp_opening_y_mm - o.clamp_slip_mm;
  if (x > room_x || y > room_y) {
    const bool wide = x - room_x > y - room_y;
    throw Error(ErrorCode::invalid_input, "size_mm",
                "The model reaches " + millimetres(wide ? x - room_x : y - room_y) + " beyond the clamp opening in " +
                    (wide ? "x" : "y") + ": make it smaller, or move or turn it.");
  }
  const double room = o.platform_travel_mm + o.clamp_height_mm;
  if (box.upper.z() > room - o.sheet_thickness_mm)
    throw Error(ErrorCode::invalid_input, "size_mm",
                "The model is " + millimetres(box.upper.z()) + " high, but the box below the sheet is only " +
                    millimetres(room) + " deep: make it smaller, sink it, or use a deeper box.");
}

/// Drives SheetDynamics with steps as long as the sheet's movement allows.
class Driver {
 public:
  Driver(SheetDynamics& dynamics, FrameRecorder& recorder, Context& context)
      : dynamics_(dynamics), recorder_(recorder), context_(context) {}

  /// Steps over `duration_s`, or until `stop` says so. `load(t, dt)` is what acts in the step that ends at t from the
  /// phase's start.
  template <class Load, class Stop>
  void run(FormingPhase phase, double duration_s, double first_step_s, double longest_s, double max_move_mm,
           Load&& load, Stop&& stop, const char* stage) {
    double t = 0, dt = std::min(first_step_s, duration_s);
    while (t < duration_s * (1 - 1e-12)) {
      dt = std::min({dt, longest_s, duration_s - t});
      const bool last = t + dt >= duration_s * (1 - 1e-9);
      const SheetDynamics::Outcome outcome = dynamics_.step(dt, load(t + dt, dt), max_move_mm, context_);
      if (outcome != SheetDynamics::Outcome::done) {
        dt *= outcome == SheetDynamics::Outcome::moved_too_far ? 0.5 : 0.4;
        if (dt < shortest_step_s)
          throw Error(
              ErrorCode::could_not_solve, "triangles",
              "The simulated sheet tears apart: raise the yield strain or the creep rate, lower the vacuum, or change the number of triangles.");
        continue;
      }
      if (dynamics_.statistics().steps > max_steps)
        throw Error(ErrorCode::could_not_solve, "step_mm",
                    "The simulation took more than 20000 steps: use longer steps or a lower vacuum.");
      t = last ? duration_s : t + dt;
      recorder_.record(dynamics_, phase);
      context_.progress(t / duration_s, stage);
      const double wanted = dynamics_.last_move_mm() > 0 ? 0.9 * max_move_mm / dynamics_.last_move_mm() : 2.0;
      dt *= std::clamp(wanted, 0.3, 2.0);
      if (stop(dt)) break;
    }
  }

 private:
  SheetDynamics& dynamics_;
  FrameRecorder& recorder_;
  Context& context_;
};

/// The same bits on every target, which the libraries' own cube roots do not give.
double cube_root(double value) {
  double root = std::max(value, 1.0);
  for (int i = 0; i < 200; ++i) {
    const double next = root - (root - value / (root * root)) / 3;
    if (!(next < root)) break;
    root = next;
  }
  return root;
}

/// By how much a sheet that does not flow sags: Hencky's circular membrane of the shorter side, w0 = 0.65 (q a^4 / (E
/// h))^(1/3).
double elastic_sag_mm(const ThermoformOptions& o) {
  const double a = 0.5 * std::min(o.clamp_opening_x_mm, o.clamp_opening_y_mm);
  const double q = o.density_kg_per_m3 * 1e-12 * 9806.65 * o.sheet_thickness_mm;
  return 0.65 * cube_root(q * a * a * a * a / (o.young_modulus_pa * 1e-6 * o.sheet_thickness_mm));
}

/// A first guess at the sag: the shape of a square membrane under its own weight, w = w0 (1 - x^2)(1 - y^2).
Positions sagging_guess(const SheetDynamics& dynamics, const ThermoformOptions& o) {
  const double w0 = elastic_sag_mm(o);
  Positions x = dynamics.x();
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    const double u = 2 * dynamics.sheet().flat_mm(i, 0) / o.clamp_opening_x_mm,
                 v = 2 * dynamics.sheet().flat_mm(i, 1) / o.clamp_opening_y_mm;
    x(i, 2) -= w0 * (1 - u * u) * (1 - v * v);
  }
  return x;
}

void measure(const SheetDynamics& dynamics, const MouldContact& contact, const ThermoformOptions& o,
             FormedResult& result) {
  const Positions& x = dynamics.x();
  const Triangles& F = dynamics.sheet().F;
  FormedSheet& sheet = result.sheet;
  sheet.mesh = {x, F};
  sheet.sheet_mm = dynamics.sheet().flat_mm;
  const Eigen::Index n = x.rows();
  const std::vector<double> thickness = dynamics.vertex_thickness_mm(x);
  sheet.thickness_mm = Eigen::Map<const Eigen::VectorXd>(thickness.data(), n);
  sheet.stretch = o.sheet_thickness_mm * sheet.thickness_mm.cwiseInverse();
  for (Eigen::Index i = 0; i < n; ++i)
    sheet.stretch[i] *= thickness_factor(o, 2 * sheet.sheet_mm(i, 0) / o.clamp_opening_x_mm,
                                         2 * sheet.sheet_mm(i, 1) / o.clamp_opening_y_mm);
  sheet.contact_s = Eigen::Map<const Eigen::VectorXd>(dynamics.contact_time_s().data(), n);

  double volume = 0, flat_volume = 0;
  result.min_thickness_mm = o.sheet_thickness_mm;
  for (int f = 0; f < F.rows(); ++f) {
    const Vec3 a = x.row(F(f, 0)), b = x.row(F(f, 1)), c = x.row(F(f, 2));
    const double area = 0.5 * (b - a).cross(c - a).norm(),
                 h = dynamics.membrane().volume_mm3()[static_cast<std::size_t>(f)] / std::max(area, 1e-12);
    volume += area * h;
    flat_volume += dynamics.membrane().volume_mm3()[static_cast<std::size_t>(f)];
    result.min_thickness_mm = std::min(result.min_thickness_mm, h);
    bool touches = true;
    for (int k = 0; k < 3; ++k) touches &= dynamics.held()[static_cast<std::size_t>(F(f, k))] != 0;
    (touches ? result.formed_area_mm2 : result.unformed_area_mm2) += area;
    // Principal stretches against the flat sheet.
    const Vec2 u1 = (sheet.sheet_mm.row(F(f, 1)) - sheet.sheet_mm.row(F(f, 0))).transpose(),
               u2 = (sheet.sheet_mm.row(F(f, 2)) - sheet.sheet_mm.row(F(f, 0))).transpose();
    Eigen::Matrix2d edges, metric;
    edges << u1, u2;
    metric << (b - a).squaredNorm(), (b - a).dot(c - a), (b - a).dot(c - a), (c - a).squaredNorm();
    const Eigen::Matrix2d C = edges.inverse().transpose() * metric * edges.inverse();
    const double middle = 0.5 * C.trace(), radius = std::sqrt(std::max(0.0, middle * middle - C.determinant()));
    if (std::sqrt(std::max(0.0, middle - radius)) < 0.9) result.webbing_area_mm2 += area;
  }
  result.volume_drift = std::abs(volume - flat_volume) / flat_volume;
  result.elastic_energy_mj = dynamics.membrane().energy(x, std::numeric_limits<double>::infinity());
  result.statistics = dynamics.statistics();
  result.point_contacts = static_cast<int>(dynamics.point_contacts().contacts().size());

  // How far vertices and sharp points got where they must not.
  result.vertex_distance_min_mm = o.sheet_thickness_mm;
  Eigen::Index movable = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (dynamics.sheet().clamped[static_cast<std::size_t>(i)]) continue;
    ++movable;
    const double so_far = result.vertex_distance_min_mm;
    result.vertex_distance_min_mm =
        std::min({so_far, x(i, 2), contact.distance_mm(x.row(i).transpose(), so_far).value_or(so_far)});
  }
  result.touching_share =
      movable > 0 ? 1 - static_cast<double>(dynamics.free_count()) / static_cast<double>(movable) : 1;
  result.mean_thickness_mm = volume / (result.formed_area_mm2 + result.unformed_area_mm2);
  if (dynamics.point_contacts().point_count() > 0) {
    const PointDistance surface(sheet.mesh);
    const RayCaster rays(sheet.mesh);
    for (const Vec3& p : dynamics.point_contacts().points()) {
      // Straight up from a point below the sheet one meets it an odd number of times, however it is folded. A ray
      // through an edge counts twice: hits at the same place are one.
      int crossings = 0;
      double last = -1;
      for (const RayHit& hit : rays.all_hits(p, Vec3::UnitZ(), 0, 1e6)) {
        if (hit.distance > last + 1e-9) ++crossings;
        last = hit.distance;
      }
      const auto nearest = surface.nearest(p, 20);
      if (!nearest) continue;
      double half = 0;
      for (int k = 0; k < 3; ++k) half += 0.5 * nearest->barycentric[k] * sheet.thickness_mm[F(nearest->face, k)];
      result.mould_edge_penetration_mm = std::max(result.mould_edge_penetration_mm,
                                                  half + (crossings % 2 == 1 ? -nearest->distance : nearest->distance));
    }
  }
}

}  // namespace

FormedResult form_sheet(std::shared_ptr<const MouldShape> shape, const Placement& nominal, const ThermoformOptions& o,
                        Context& context) {
  Stopwatch watch;
  check_options(o);
  const Placement placement = displaced(nominal, o);
  check_placement(*shape, placement, o);
  const auto contact =
      std::make_shared<const MouldContact>(std::move(shape), placement, clamp_opening_mm(o), contact_tolerance_mm);
  const SheetMesh mesh = make_sheet_mesh(clamp_opening_mm(o), o.triangles);
  const double start_z = -o.platform_travel_mm;
  // From the platform the sheet lies high above at first.
  SheetDynamics dynamics(mesh, o, o.clamp_height_mm - start_z, contact);
  FormedResult result;
  result.placement = placement;
  FrameRecorder recorder(o, start_z);
  recorder.record(dynamics, FormingPhase::relax);
  Driver driver(dynamics, recorder, context);
  const auto go_on = [](double) { return false; };

  {
    // The weight alone: the sheet comes to rest long before the platform moves, so a few long steps do.
    const auto span = context.span(0, 0.08, "Sagging under its weight");
    dynamics.guess(sagging_guess(dynamics, o));
    // Newton's iteration may overshoot on the way; beyond this it has lost its way, and what it meets there is not
    // there.
    const double max_sag_mm = std::max(3 * elastic_sag_mm(o), 20.0);
    driver.run(
        FormingPhase::relax, o.relaxation_s, o.relaxation_s / 4, o.relaxation_s / 2, max_sag_mm,
        [](double, double) { return StepLoad{}; }, go_on, "Sagging under its weight");
    result.sag_mm = o.clamp_height_mm - start_z - dynamics.x().col(2).minCoeff();
    result.phase_end_s[0] = dynamics.time_s();
  }
  {
    const auto span = context.span(0.08, 0.45, "Raising the model");
    const double duration = o.platform_travel_mm / o.mould_speed_mm_per_s;
    dynamics.add_velocity(Vec3(0, 0, -o.mould_speed_mm_per_s));
    driver.run(
        FormingPhase::raise, duration, 0.01, longest_free_step_s, dynamics.step_limit_mm(),
        [&](double, double dt) {
          StepLoad load;
          load.clamp_shift = Vec3(0, 0, -o.mould_speed_mm_per_s * dt);
          // The rim is pulled hardest while the model pushes into the sheet.
          load.clamp_slip_mm = o.clamp_slip_mm * dt / duration;
          return load;
        },
        go_on, "Raising the model");
    dynamics.add_velocity(Vec3(0, 0, o.mould_speed_mm_per_s));
    result.phase_end_s[1] = dynamics.time_s();
  }
  {
    const auto span = context.span(0.45, 0.98, "Drawing the vacuum");
    const double full = o.vacuum_kpa * 1e-3 * (1 - o.weak_vacuum);
    const auto pressure = [&](double t) {
      return o.vacuum_ramp_s > 0 ? full * std::min(1.0, t / o.vacuum_ramp_s) : full;
    };
    double t_end = 0;
    driver.run(
        FormingPhase::vacuum, o.time_limit_s, 5e-4, longest_step_s, dynamics.step_limit_mm(),
        [&](double t, double) {
          StepLoad load;
          t_end = t;
          load.pressure_mpa = pressure(t);
          load.settling = t > std::max(o.vacuum_ramp_s, min_drawing_s);
          return load;
        },
        [&](double) {
          if (dynamics.all_stuck()) return true;
          return t_end >= o.vacuum_ramp_s && dynamics.last_step_s() > 0.5 * longest_step_s &&
                 dynamics.last_move_mm() < rest_speed_mm_per_s * dynamics.last_step_s();
        },
        "Drawing the vacuum");
    result.reached_time_limit = t_end >= o.time_limit_s * (1 - 1e-9);
    result.pressure_end_kpa = pressure(t_end) * 1e3;
    result.phase_end_s[2] = dynamics.time_s();
  }
  // Nothing lifts the sheet: what is above model and clamp has been blown out like a bubble and folded over.
  // Sharp parts between the vertices of a coarse sheet may push single ones up, by far less.
  const double max_lift_mm = 0.25 * std::min(o.clamp_opening_x_mm, o.clamp_opening_y_mm);
  if (dynamics.x().col(2).maxCoeff() >
      std::max(o.clamp_height_mm, contact->top_mm()) + o.sheet_thickness_mm + max_lift_mm)
    throw Error(
        ErrorCode::could_not_solve, "young_modulus_pa",
        "The sheet is too soft for this vacuum, which blows it out like a bubble: raise Young's modulus or the yield strain, or lower the vacuum.");
  const auto span = context.span(0.98, 1, "Measuring");
  measure(dynamics, *contact, o, result);
  result.frames = recorder.finish(dynamics);
  result.seconds = watch.seconds();
  return result;
}

}  // namespace formwright
