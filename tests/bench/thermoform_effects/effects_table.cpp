// SPDX-License-Identifier: GPL-3.0-or-later
// How far each effect moves the points of the formed sample pyramid, how straight it does, and which effects look
// alike.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include "geometry/samples/samples.h"
#include "thermoform/forming.h"
#include "thermoform/measured/measured_object.h"

namespace {

using namespace formwright;

struct Effect {
  const char* name;
  double strength;
  std::function<void(ThermoformOptions&, MeasurementEffects&, double)> apply;
};

std::vector<Effect> effects() {
  using O = ThermoformOptions;
  using M = MeasurementEffects;
  return {{"heating_gradient_x", 0.4, [](O& o, M&, double s) { o.heating_gradient_x = s; }},
          {"heating_centre", 0.4, [](O& o, M&, double s) { o.heating_centre = s; }},
          {"thickness_wedge_x", 0.4, [](O& o, M&, double s) { o.thickness_wedge_x = s; }},
          {"anisotropy", 0.5, [](O& o, M&, double s) { o.anisotropy = s; }},
          {"slip", 2, [](O& o, M&, double s) { o.slip = s; }},
          {"cooling", 1, [](O& o, M&, double s) { o.cooling = s; }},
          {"weak_vacuum", 0.5, [](O& o, M&, double s) { o.weak_vacuum = s; }},
          {"clamp_slip_mm", 2, [](O& o, M&, double s) { o.clamp_slip_mm = s; }},
          {"mould_shift_x_mm", 2, [](O& o, M&, double s) { o.mould_shift_x_mm = s; }},
          {"mould_rotation_deg", 5, [](O& o, M&, double s) { o.mould_rotation_deg = s; }},
          {"mould_scale", 0.03, [](O& o, M&, double s) { o.mould_scale = s; }},
          {"print_scale", 0.015, [](O&, M& m, double s) { m.print_scale = s; }},
          {"print_stretch_x", 0.02, [](O&, M& m, double s) { m.print_stretch_x = s; }},
          {"print_stretch_y", 0.02, [](O&, M& m, double s) { m.print_stretch_y = s; }},
          {"scan_scale", 0.01, [](O&, M& m, double s) { m.scan_scale = s; }},
          {"scan_stretch_x", 0.02, [](O&, M& m, double s) { m.scan_stretch_x = s; }},
          {"scan_stretch_y", 0.02, [](O&, M& m, double s) { m.scan_stretch_y = s; }},
          {"scan_stretch_z", 0.02, [](O&, M& m, double s) { m.scan_stretch_z = s; }},
          {"scan_turn_x_deg", 1, [](O&, M& m, double s) { m.scan_turn_x_deg = s; }},
          {"scan_turn_z_deg", 1, [](O&, M& m, double s) { m.scan_turn_z_deg = s; }},
          {"scan_shift_x_mm", 1, [](O&, M& m, double s) { m.scan_shift_x_mm = s; }}};
}

}  // namespace

int main(int count, char** words) {
  Context context;
  const std::string sample = count > 2 ? words[2] : "pyramid";
  const TriangleMesh mesh = make_sample(sample, 2000, context).mesh;
  const auto shape = std::make_shared<const MouldShape>(mesh);
  ThermoformOptions base;
  base.triangles = count > 1 ? std::atoi(words[1]) : 2500;
  if (sample == "pyramid") base.size_mm = 100;
  if (count > 4) base.step_mm = std::atof(words[4]);
  const Placement placement = place(mesh, base, clamp_opening_mm(base));
  // A grid of points over the opening, the rim left out.
  const int side = 60;
  TextureCoordinates places(side * side, 2);
  for (int i = 0; i < side * side; ++i)
    places.row(i) << base.clamp_opening_x_mm * ((i % side + 0.5) / side - 0.5) * 0.97,
        base.clamp_opening_y_mm * ((i / side + 0.5) / side - 0.5) * 0.97;
  const auto measured = [&](const Effect* effect, double share, double& seconds, int& steps) {
    ThermoformOptions o = base;
    MeasurementEffects m;
    if (effect) effect->apply(o, m, share * effect->strength);
    const FormedResult result = form_sheet(shape, placement, o, context);
    seconds = result.seconds;
    steps = result.statistics.steps;
    return predict_measured(result.sheet, places, MeasuredSurface::mid, o.clamp_height_mm, o.sheet_thickness_mm, m);
  };
  double seconds = 0;
  int steps = 0;
  const Positions nominal = measured(nullptr, 0, seconds, steps);
  std::printf("base %.2f s, %d steps\n", seconds, steps);
  const auto cosine = [](const Positions& a, const Positions& b) {
    return a.cwiseProduct(b).sum() / std::max(1e-30, a.norm() * b.norm());
  };
  std::vector<Positions> fields;
  std::vector<std::string> names;
  std::printf("%-20s %8s %8s %8s %8s %8s %8s\n", "effect", "strength", "rms mm", "max mm", "half/full", "cosine", "s");
  for (const Effect& effect : effects()) {
    if (count > 3 && std::string(words[3]) != "all" && std::string(words[3]) != effect.name) continue;
    const Positions half = measured(&effect, 0.5, seconds, steps) - nominal,
                    full = measured(&effect, 1, seconds, steps) - nominal;
    std::printf("%-20s %8.3g %8.3f %8.3f %8.3f %8.3f %8.2f %d\n", effect.name, effect.strength,
                std::sqrt(full.squaredNorm() / static_cast<double>(full.rows())),
                std::sqrt(full.rowwise().squaredNorm().maxCoeff()), half.norm() / full.norm(), cosine(half, full),
                seconds, steps);
    fields.push_back(full);
    names.emplace_back(effect.name);
  }
  for (std::size_t a = 0; a < fields.size(); ++a) {
    std::printf("%-20s", names[a].c_str());
    for (std::size_t b = 0; b <= a; ++b) std::printf(" %6.2f", cosine(fields[a], fields[b]));
    std::printf("\n");
  }
  return 0;
}
