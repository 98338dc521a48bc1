// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/virtual_lab.h"

#include <cmath>
#include <numbers>

namespace formwright::virtual_lab {
namespace {

double uniform(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// A prism over a polygon, tapered: the top is the polygon scaled about `centre` by `taper`, at height `height`.
TriangleMesh frustum(const std::vector<Vec2>& polygon, const Vec2& centre, double taper, double height) {
  const auto n = static_cast<int>(polygon.size());
  TriangleMesh mesh;
  mesh.V.resize(2 * n + 1, 3);
  mesh.F.resize(3 * n, 3);
  for (int i = 0; i < n; ++i) {
    const Vec2 top = centre + taper * (polygon[static_cast<std::size_t>(i)] - centre);
    mesh.V.row(i) << polygon[static_cast<std::size_t>(i)].x(), polygon[static_cast<std::size_t>(i)].y(), 0;
    mesh.V.row(n + i) << top.x(), top.y(), height;
    const int next = (i + 1) % n;
    mesh.F.row(3 * i) << i, next, n + next;
    mesh.F.row(3 * i + 1) << i, n + next, n + i;
    mesh.F.row(3 * i + 2) << n + i, n + next, 2 * n;
  }
  mesh.V.row(2 * n) << centre.x(), centre.y(), height;
  return mesh;
}

/// Half an ellipsoid over the plate, its axes not along the plate's.
TriangleMesh dome(double radius, double height) {
  constexpr int around = 48, up = 16;
  TriangleMesh mesh;
  mesh.V.resize(around * up + 1, 3);
  mesh.F.resize(around * (2 * up - 1), 3);
  for (int j = 0; j < up; ++j)
    for (int i = 0; i < around; ++i) {
      const double polar = 0.5 * std::numbers::pi * j / up, angle = 2 * std::numbers::pi * i / around;
      const double x = radius * std::cos(polar) * std::cos(angle), y = 0.8 * radius * std::cos(polar) * std::sin(angle);
      mesh.V.row(j * around + i) << 0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y, height * std::sin(polar);
    }
  mesh.V.row(around * up) << 0, 0, height;
  Eigen::Index f = 0;
  for (int j = 0; j < up; ++j)
    for (int i = 0; i < around; ++i) {
      const int own = j * around + i, next = j * around + (i + 1) % around;
      if (j + 1 == up) mesh.F.row(f++) << own, next, around * up;
      else {
        mesh.F.row(f++) << own, next, next + around;
        mesh.F.row(f++) << own, next + around, own + around;
      }
    }
  return mesh;
}

}  // namespace

TriangleMesh make_mould(Mould mould) {
  switch (mould) {
    case Mould::pyramid: return frustum({{-50, -50}, {50, -50}, {50, 50}, {-50, 50}}, {0, 0}, 0.02, 60);
    case Mould::box: return frustum({{-45, -35}, {45, -35}, {45, 35}, {-45, 35}}, {0, 0}, 0.85, 45);
    case Mould::ridge: return frustum({{-60, -30}, {60, -30}, {60, 30}, {-60, 30}}, {10, 5}, 0.3, 50);
    case Mould::cross:
      return frustum({{-20, -60},
                      {20, -60},
                      {20, -20},
                      {60, -20},
                      {60, 20},
                      {20, 20},
                      {20, 60},
                      {-20, 60},
                      {-20, 20},
                      {-60, 20},
                      {-60, -20},
                      {-20, -20}},
                     {0, 0}, 0.7, 45);
    case Mould::dome: return dome(55, 45);
  }
  return {};
}

std::vector<std::string> cause_names() {
  std::vector<ModelParameter> parameters;
  std::vector<Cause> causes;
  declare_thermoform_parameters(Json::object(), {}, parameters, causes);
  std::vector<std::string> names;
  for (const Cause& cause : causes) names.push_back(cause.name);
  return names;
}

HiddenEffect draw_effect(const std::string& cause, double level, std::mt19937& random) {
  HiddenEffect effect{cause};
  const double sign = uniform(random, 0, 1) < 0.5 ? -1 : 1;
  const double size = level * uniform(random, 0.85, 1.15);
  const auto directed = [&](const char* x, const char* y, double strong) {
    const double angle = uniform(random, 0, 2 * std::numbers::pi);
    effect.values[x] = strong * size * std::cos(angle);
    effect.values[y] = strong * size * std::sin(angle);
  };
  if (cause == "heating_gradient") directed("heating_gradient_x", "heating_gradient_y", 0.5);
  else if (cause == "thickness_wedge") directed("thickness_wedge_x", "thickness_wedge_y", 0.4);
  else if (cause == "mould_shift") directed("mould_shift_x_mm", "mould_shift_y_mm", 2);
  else if (cause == "scan_shift") {
    directed("scan_shift_x_mm", "scan_shift_y_mm", 0.9);
    effect.values["scan_shift_z_mm"] = sign * 0.4 * size;
  } else if (cause == "heating_centre") effect.values["heating_centre"] = sign * 0.5 * size;
  else if (cause == "anisotropy") effect.values["anisotropy"] = sign * 0.5 * size;
  else if (cause == "slip") effect.values["slip"] = 3 * size;
  else if (cause == "cooling") effect.values["cooling"] = 2 * size;
  else if (cause == "weak_vacuum") effect.values["weak_vacuum"] = 0.6 * size;
  else if (cause == "clamp_slip") effect.values["clamp_slip_mm"] = 3 * size;
  else if (cause == "mould_rotation") effect.values["mould_rotation_deg"] = sign * 5 * size;
  else if (cause == "mould_scale") effect.values["mould_scale"] = sign * 0.03 * size;
  else if (cause == "print_scale") effect.values["print_scale"] = sign * 0.015 * size;
  else if (cause == "print_stretch_x" || cause == "print_stretch_y") effect.values[cause] = sign * 0.02 * size;
  else if (cause.starts_with("scan_stretch_")) effect.values[cause] = sign * 0.02 * size;
  else if (cause == "scan_rotation") {
    directed("scan_turn_x_deg", "scan_turn_y_deg", 0.8);
    effect.values["scan_turn_z_deg"] = sign * 0.4 * size;
  } else if (cause == "lasting_network") effect.values["network_share"] = 0.2 * size;
  else if (cause == "scan_scale") effect.values["scan_scale"] = sign * 0.01 * size;
  return effect;
}

HiddenWorld draw_world(std::mt19937& random) {
  HiddenWorld world;
  world.young_factor = std::exp(uniform(random, -0.35, 0.35));
  world.creep_factor = std::exp(uniform(random, -0.4, 0.4));
  world.yield_strain = uniform(random, 0.07, 0.13);
  world.vacuum_ramp_s = uniform(random, 0.15, 0.35);
  world.elastic_law = uniform(random, 0, 1) < 0.5 ? ElasticLaw::stable_neo_hookean : ElasticLaw::st_venant_kirchhoff;
  world.step_mm = uniform(random, 0.5, 0.9);
  world.triangles = 5000 + static_cast<int>(uniform(random, 0, 4000));
  return world;
}

ObjectSetup usual_setup() {
  return read_object_setup(as_bytes(std::string_view(
      R"({"sheet_mm": [240, 260], "sheet_thickness_mm": 1, "clamp_opening_mm": [220, 240], "clamp_height_mm": 1,
    "base_plate_start_z_mm": -120, "base_plate_end_z_mm": 0, "mould_speed_mm_per_s": 100, "relaxation_s": 1, "vacuum_kpa": 80,
    "density_kg_per_m3": 1330, "poisson_ratio": 0.35, "measured_surface": "outer"})")));
}

FormedObject make_object(Mould mould, const HiddenWorld& world, const std::vector<HiddenEffect>& effects,
                         const Observation& observation, std::mt19937& random) {
  FormedObject object;
  object.name = mould_names[static_cast<std::size_t>(mould)];
  object.key = object.name;
  object.setup = usual_setup();
  object.mould = std::make_shared<const MouldShape>(make_mould(mould));
  Json values = object.setup.parameters;
  Json measurement = write_parameters(MeasurementEffects{});
  for (const HiddenEffect& effect : effects)
    for (const auto& [name, value] : effect.values.items())
      (measurement.contains(name) ? measurement : values)[name] = value;
  auto o = read_parameters<ThermoformOptions>(values);
  o.young_modulus_pa *= world.young_factor;
  o.creep_per_s *= world.creep_factor;
  o.yield_strain = world.yield_strain;
  o.vacuum_ramp_s = world.vacuum_ramp_s;
  o.elastic_law = world.elastic_law;
  o.step_mm = world.step_mm;
  o.triangles = world.triangles;
  o.frames = 2;
  Context context;
  const FormedResult formed = form_sheet(object.mould, Placement{}, o, context);
  TextureCoordinates places(observation.points, 2);
  for (Eigen::Index i = 0; i < places.rows(); ++i)
    places.row(i) << uniform(random, -0.49, 0.49) * o.clamp_opening_x_mm,
        uniform(random, -0.49, 0.49) * o.clamp_opening_y_mm;
  const Positions measured =
      predict_measured(formed.sheet, places, object.setup.measured_surface, o.clamp_height_mm, o.sheet_thickness_mm,
                       read_parameters<MeasurementEffects>(measurement), 0);
  std::normal_distribution<double> noise(0, 1);
  for (Eigen::Index i = 0; i < places.rows(); ++i) {
    Vec3 place = measured.row(i).transpose();
    // Points are not equally good, and their stated uncertainty says so.
    const double sigma = observation.sigma_mm * uniform(random, 0.7, 1.4);
    for (int k = 0; k < 3; ++k) place[k] += sigma * noise(random);
    if (uniform(random, 0, 1) < observation.outlier_share)
      for (int k = 0; k < 3; ++k) place[k] += 4 * noise(random);
    object.points.push_back({places.row(i).transpose(), place, sigma});
  }
  return object;
}

}  // namespace formwright::virtual_lab
