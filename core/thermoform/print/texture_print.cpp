// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/print/texture_print.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "base/parallel.h"
#include "formats/mesh_io.h"
#include "geometry/mesh/measures.h"
#include "imaging/colour/nearest_colour.h"
#include "imaging/picture/png_writer.h"
#include "thermoform/print/print_marks.h"

namespace formwright {
namespace {

constexpr int max_triangles = 3'000'000;
constexpr double pale_stretch = 4;  // ink this thin is visibly paler

/// White paper wherever nothing is.
void flatten(Image& image) {
  parallel_for(image.pixels.size(), 1 << 18, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (image.pixels[i][3] == 0) image.pixels[i] = {255, 255, 255, 255};
  });
}

void measure(TexturePrint& print) {
  const Eigen::VectorXd areas = face_areas(print.surface.mesh);
  double coloured = 0;
  for (std::size_t f = 0; f < print.projected.face.size(); ++f) {
    const auto row = static_cast<Eigen::Index>(f);
    const Coverage coverage = print.projected.face[f];
    print.area_mm2[static_cast<std::size_t>(coverage)] += areas[row];
    if (coverage != Coverage::coloured) continue;
    for (int k = 0; k < 3; ++k) {
      const int v = print.surface.mesh.F(row, k);
      const double gap = print.projected.gap_mm[v], stretch = print.projected.stretch[v];
      print.gap_mean_mm += gap * areas[row] / 3;
      print.stretch_mean += stretch * areas[row] / 3;
      print.gap_max_mm = std::max(print.gap_max_mm, gap);
      print.stretch_max = std::max(print.stretch_max, stretch);
    }
    coloured += areas[row];
  }
  if (coloured > 0) {
    print.gap_mean_mm /= coloured;
    print.stretch_mean /= coloured;
  }
}

void say(TexturePrint& print, const ThermoformPrintOptions& options) {
  const auto area = [&](Coverage c) { return print.area_mm2[static_cast<std::size_t>(c)]; };
  const auto add = [&](const std::string& sentence) { print.sentences.push_back(sentence); };
  if (area(Coverage::coloured) <= 0)
    add("No part of the model touches the sheet, so the print is white: check size and position of the model.");
  const double total = area(Coverage::coloured) + print.uncoloured_mm2();
  const auto share = [&](Coverage c, const char* what) {
    if (area(c) > 1e-3 * total)
      add(with_decimals(100 * area(c) / total, 1) + " % of the surface above the plate " + what);
  };
  share(Coverage::hidden, "is hidden from the sheet (undercuts) and stays without colour.");
  share(
      Coverage::not_touched,
      "lies where the sheet spans a corner and stays without colour: allow a wider gap, or make the corner less deep.");
  share(Coverage::outside, "lies outside of the clamp's opening: make the model smaller.");
  if (print.surface.edge_mm > 1.001 * options.map_edge_mm)
    add("The model was divided to edges of " + with_decimals(print.surface.edge_mm, 2) +
        " mm only, to stay below 3 million triangles.");
  if (print.stretch_max > pale_stretch)
    add("The print is stretched up to " + with_decimals(print.stretch_max, 1) +
        " times in area: colours look paler there.");
  if (options.marks && registration_marks(options).empty())
    add("The clamped rim is narrower than " + with_decimals(narrowest_rim_mm, 0) +
        " mm, which leaves no room for registration marks.");
}

}  // namespace

double TexturePrint::uncoloured_mm2() const {
  double sum = 0;
  for (const Coverage c : {Coverage::hidden, Coverage::not_touched, Coverage::outside})
    sum += area_mm2[static_cast<std::size_t>(c)];
  return sum;
}

double TexturePrint::uncoloured_share() const {
  const double total = uncoloured_mm2() + area_mm2[static_cast<std::size_t>(Coverage::coloured)];
  return total > 0 ? uncoloured_mm2() / total : 0;
}

TexturePrint make_texture_print(const Model& model, const TriangleMesh& placed, const FormedSheet& sheet,
                                const std::optional<Image>& own_picture, const ThermoformPrintOptions& options,
                                Context& context) {
  TexturePrint print;
  print.grid = print_grid(options);
  Stopwatch watch;
  context.progress(0, "Dividing the model");
  print.surface = refine_above_plate(placed, options.map_edge_mm, max_triangles, context);
  print.seconds_refine = watch.lap();
  {
    const auto span = context.span(0.1, 0.5, "Projecting the surface onto the sheet");
    print.projected = project_onto_sheet(print.surface, sheet, options, context);
  }
  print.seconds_project = watch.lap();
  context.progress(0.5, "Reading the colours");
  const ModelColours colours(model, placed, own_picture, options, context);
  print.colours = colours.kind();
  print.sentences = colours.notes();
  print.seconds_colours = watch.lap();
  {
    const auto span = context.span(0.6, 0.9, "Drawing the print");
    print.picture = render_print(print.surface, print.projected, colours, print.grid, context);
  }
  print.seconds_render = watch.lap();
  context.progress(0.9, "Spreading the colours");
  spread_colours(print.picture, options.bleed_mm / print.grid.pixel_mm(), context);
  flatten(print.picture);
  print.seconds_bleed = watch.lap();
  measure(print);
  say(print, options);
  return print;
}

Bytes formed_picture(const FormedSheet& sheet, const TexturePrint& print, int longest_px, Context& context) {
  const int side = std::max(1, (std::max(print.grid.width, print.grid.height) + longest_px - 1) / longest_px);
  const Image small = shrunk(print.picture, side, context);
  Model model;
  model.mesh = sheet.mesh;
  model.mesh.V.col(1) = sheet.mesh.V.col(2);
  model.mesh.V.col(2) = -sheet.mesh.V.col(1);
  model.UV.resize(sheet.sheet_mm.rows(), 2);
  for (Eigen::Index i = 0; i < model.UV.rows(); ++i) {
    const Vec2 pixel = print.grid.pixel(sheet.sheet_mm.row(i)) / side;
    model.UV.row(i) << pixel.x() / small.width, 1 - pixel.y() / small.height;
  }
  model.FT = model.mesh.F;
  model.materials.push_back({"print", Vec3(1, 1, 1), 0});
  model.face_material.assign(static_cast<std::size_t>(model.mesh.face_count()), 0);
  model.textures.push_back({"print.png", "image/png", write_png(small, 0, context)});
  WriteOptions write;
  write.name = "formed sheet";
  return write_model(model, MeshFormat::glb, write, context);
}

}  // namespace formwright
