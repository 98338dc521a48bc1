// SPDX-License-Identifier: GPL-3.0-or-later
// bench_thermoform_print [rounds]: best of some rounds, a sheet of 240 x 260 mm with its stages, files and sizes.
#include <algorithm>
#include <cstdlib>
#include <iostream>

#include "base/data/json.h"
#include "base/parallel.h"
#include "geometry/samples/samples.h"
#include "imaging/picture/png_writer.h"
#include "thermoform/print/formed_sheets.h"
#include "thermoform/print/print_pages.h"
#include "thermoform/print/texture_print.h"

int main(int argc, char** argv) {
  using namespace formwright;
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 3;
  Context context;
  Json all = Json::array();
  struct Case {
    const char* sample;
    double size_mm, dots_per_inch;
  };
  for (const Case& c : {Case{"cat", 100, 300}, Case{"mountain", 200, 300}, Case{"mountain", 200, 600}}) {
    const Model model = make_sample(c.sample, 40000, context);
    ThermoformPrintOptions options;
    options.size_mm = c.size_mm;
    options.dots_per_inch = c.dots_per_inch;
    options.paper = Paper::a4;
    const TriangleMesh placed = place(model.mesh, options, clamp_opening_mm(options))(model.mesh);
    const FormedSheet sheet = test::dropped_sheet(placed, options.clamp_opening_x_mm, 70, 0.5);
    Json best;
    for (int round = 0; round < rounds; ++round) {
      Stopwatch watch;
      const TexturePrint print = make_texture_print(model, placed, sheet, std::nullopt, options, context);
      const double whole = watch.lap();
      const Bytes png = write_png(with_marks(print.picture, print.grid, options), print.grid.per_metre, context);
      const double seconds_png = watch.lap();
      const Bytes pdf =
          write_print_pdf(print.picture, print.grid, page_layout(options), options, "Thermoforming print", context);
      const double seconds_pdf = watch.lap();
      const Bytes glb = formed_picture(sheet, print, 2048, context);
      const double seconds_glb = watch.lap();
      if (!best.is_null() && best["seconds"] < whole) continue;
      best = {{"sample", c.sample},
              {"dots_per_inch", c.dots_per_inch},
              {"threads", thread_count()},
              {"triangles", print.surface.mesh.face_count()},
              {"pixels", {print.grid.width, print.grid.height}},
              {"area_coloured_mm2", print.area_mm2[0]},
              {"uncoloured_percent", 100 * print.uncoloured_share()},
              {"gap_mean_mm", print.gap_mean_mm},
              {"seconds", whole},
              {"seconds_refine", print.seconds_refine},
              {"seconds_project", print.seconds_project},
              {"seconds_colours", print.seconds_colours},
              {"seconds_render", print.seconds_render},
              {"seconds_bleed", print.seconds_bleed},
              {"seconds_png", seconds_png},
              {"seconds_pdf", seconds_pdf},
              {"seconds_glb", seconds_glb},
              {"png_mb", static_cast<double>(png.size()) * 1e-6},
              {"pdf_mb", static_cast<double>(pdf.size()) * 1e-6},
              {"glb_mb", static_cast<double>(glb.size()) * 1e-6}};
    }
    all.push_back(best);
  }
  std::cout << all.dump(2) << "\n";
  return 0;
}
