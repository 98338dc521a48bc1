// SPDX-License-Identifier: GPL-3.0-or-later
// Figs. 3.4 to 3.6 of the thesis: the energy of eq. (3.9) beside the forms that it rejects; JSON on standard output.
//   compare_energies [--pictures FOLDER]
// --pictures writes scale.png, linearised.png and curvature.png: above the model and its reliefs under one light, below
// the angles between their normals.
#include <cstdio>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/data/json.h"
#include "base/parallel.h"
#include "bench/relief/energy_scene.h"
#include "bench/relief/picture_sheet.h"
#include "bench/relief/rounded_box.h"
#include "geometry/samples/samples.h"

namespace {
using namespace formwright;
using namespace formwright::test;

constexpr const char *scale_figure = "3.4", *linearised_figure = "3.5", *curvature_figure = "3.6";
constexpr int picture_vertices = 20'000, box_squares = 16;
constexpr double picture_percent = 5, box_percent = 20;
constexpr double near_pixel_factor = 7.1, far_pixel_factor = 4;  // of eye_grid: 304 pixels across
constexpr double max_angle_deg = 60;                             // of the colours
constexpr double no_damping = 1, half_damping = 0.5;
constexpr double small_floor = 1e-2, tiny_floor = 1e-6;  // of the mean |H|

struct Output {
  std::string folder;  // of the pictures; empty: none
  Json rows = Json::array();
  Context context;

  void picture(const EnergyScene& scene, const std::string& name, const std::vector<const SolvedForm*>& shown,
               double pixel_factor, bool faceted = false) {
    if (!folder.empty()) write_sheet(scene.sheet(shown, pixel_factor, max_angle_deg, faceted), folder, name, context);
  }
  void add(const EnergyScene& scene, const char* figure, const SolvedForm& solved) {
    rows.push_back(scene.row(figure, solved));
  }
};

ReliefOptions view_of(Projection projection, double thickness_percent) {
  ReliefOptions options;
  options.width_mm = 100;
  options.thickness_mm = thickness_percent;
  options.projection = projection;
  return options;
}

/// From near, because far away lambda / lambda0 is 1 and the forms are equal.
void compare_scale(Output& out) {
  ReliefOptions options = view_of(Projection::perspective, picture_percent);
  options.field_of_view_deg = 35;
  const EnergyScene scene("bust", make_sample("bust", picture_vertices, out.context).mesh, options, out.context);
  const LeastSquares without = scene.forms().scale_dependent();
  const SolvedForm here = scene.solve("without lambda / lambda0", without),
                   half = scene.solve("without, slab scaled by 0.5", without, 0.5),
                   twice = scene.solve("without, slab scaled by 2", without, 2),
                   ours = scene.solve("eq. (3.9)", scene.forms().proposed()),
                   ours_twice = scene.solve("eq. (3.9), slab scaled by 2", scene.forms().proposed(), 2);
  for (const SolvedForm* solved : {&here, &half, &twice, &ours, &ours_twice}) out.add(scene, scale_figure, *solved);
  out.picture(scene, "scale", {&here, &twice, &ours}, near_pixel_factor);
}

void compare_linearised(Output& out) {
  struct View {
    Projection projection;
    double percent;
    bool shown;
  };
  for (const View& view :
       {View{Projection::orthographic, box_percent / 2, false}, View{Projection::orthographic, box_percent, true},
        View{Projection::orthographic, 2 * box_percent, false}, View{Projection::perspective, box_percent, false}}) {
    ReliefOptions options = view_of(view.projection, view.percent);
    options.direction = {-0.55, -0.5, -1};
    const bool near = view.projection == Projection::perspective;
    const EnergyScene scene(near ? "box near" : "box", rounded_box(box_squares, 0), options, out.context);
    const EnergyForms& forms = scene.forms();
    const auto laplacian = [&](const Eigen::VectorXd& u) { return forms.updated(u); };
    const auto normals = [&](const Eigen::VectorXd& u) { return forms.updated_normals(u, small_floor); };
    const SolvedForm updated = scene.iterated("eq. (3.9), L and A updated", laplacian, no_damping),
                     damped = scene.iterated("the same, damped", laplacian, half_damping),
                     of_normals = scene.iterated("eq. (3.6), L, A and H updated, damped", normals, half_damping),
                     ours = scene.solve("eq. (3.9)", forms.proposed());
    for (const SolvedForm* solved : {&updated, &damped, &of_normals, &ours}) out.add(scene, linearised_figure, *solved);
    if (view.shown) out.picture(scene, "linearised", {&of_normals, &updated, &ours}, far_pixel_factor, true);
  }
  const EnergyScene bust("bust", make_sample("bust", 1500, out.context).mesh,
                         view_of(Projection::orthographic, box_percent), out.context);
  const auto laplacian = [&](const Eigen::VectorXd& u) { return bust.forms().updated(u); };
  out.add(bust, linearised_figure, bust.iterated("eq. (3.9), L and A updated", laplacian, no_damping));
  out.add(bust, linearised_figure, bust.iterated("the same, damped", laplacian, half_damping));
  out.add(bust, linearised_figure, bust.solve("eq. (3.9)", bust.forms().proposed()));
}

void compare_curvature(Output& out) {
  for (const char* sample : {"bust", "octopus"}) {
    const EnergyScene scene(sample, make_sample(sample, picture_vertices, out.context).mesh,
                            view_of(Projection::orthographic, picture_percent), out.context);
    const EnergyForms& forms = scene.forms();
    const SolvedForm divided = scene.solve("eq. (3.7), floor of H0 1e-2", forms.curvature_divided(small_floor)),
                     hardly_bounded = scene.solve("eq. (3.7), floor of H0 1e-6", forms.curvature_divided(tiny_floor)),
                     ours = scene.solve("eq. (3.9)", forms.proposed());
    for (const SolvedForm* solved : {&divided, &hardly_bounded, &ours}) out.add(scene, curvature_figure, *solved);
    out.rows.back()["curvature_range"] = forms.curvature_range(small_floor);
    if (std::strcmp(sample, "bust") == 0)
      out.picture(scene, "curvature", {&divided, &hardly_bounded, &ours}, far_pixel_factor);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    Output out;
    if (argc == 3 && std::strcmp(argv[1], "--pictures") == 0) out.folder = argv[2];
    else if (argc != 1) throw std::runtime_error("only --pictures FOLDER is known");
    compare_scale(out);
    compare_linearised(out);
    compare_curvature(out);
    const Json result = {{"bench", "relief_energies"}, {"threads", thread_count()}, {"rows", out.rows}};
    std::printf("%s\n", result.dump(1).c_str());
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "compare_energies: %s\n", error.what());
    return 1;
  }
}
