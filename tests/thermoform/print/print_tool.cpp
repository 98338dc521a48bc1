// SPDX-License-Identifier: GPL-3.0-or-later
// print_tool FOLDER PAPER MIRROR(0|1): writes print.png, print.pdf, picture.png (without marks, as printed) and
// formed.glb of a made-up print, and on standard output what another program must find in them.
#include <cstdlib>
#include <fstream>
#include <iostream>

#include "base/data/json.h"
#include "imaging/picture/png_writer.h"
#include "thermoform/print/formed_sheets.h"
#include "thermoform/print/print_pages.h"
#include "thermoform/print/texture_print.h"

namespace {

void save(const std::string& path, const formwright::Bytes& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace

int main(int argc, char** argv) {
  using namespace formwright;
  if (argc != 7) return 2;
  const std::string folder = argv[1], paper = argv[2];
  ThermoformPrintOptions options;
  options.mirror = std::atoi(argv[3]) != 0;
  options.print_scale = std::atof(argv[4]);
  options.print_stretch_x = std::atof(argv[5]);
  options.print_stretch_y = std::atof(argv[6]);
  for (std::size_t i = 0; i < EnumNames<Paper>::names.size(); ++i)
    if (EnumNames<Paper>::names[i] == paper) options.paper = static_cast<Paper>(i);
  options.dots_per_inch = 150;
  Context context;
  const test::Cone cone;
  Model model;
  model.mesh = cone.mesh(1, 64);
  const FormedSheet sheet = cone.sheet(30, 64);
  const TexturePrint print = make_texture_print(model, model.mesh, sheet, std::nullopt, options, context);
  const PageLayout layout = page_layout(options);
  save(folder + "/print.png",
       write_png(with_marks(print.picture, print.grid, options), sent_per_metre(print.grid, options), context));
  save(folder + "/print.pdf",
       write_print_pdf(print.picture, print.grid, layout, options, "Thermoforming print", context));
  save(folder + "/formed.glb", formed_picture(sheet, print, 512, context));
  Image picture = print.picture;
  if (options.mirror) mirror_left_right(picture);
  save(folder + "/picture.png", write_png(picture, print.grid.per_metre, context));
  Json tiles = Json::array(), marks = Json::array();
  for (const Tile& tile : layout.tiles) {
    const Vec2 origin = layout.origin_mm(tile);
    tiles.push_back({{"name", tile.name},
                     {"lower_mm", {tile.lower_mm.x(), tile.lower_mm.y()}},
                     {"upper_mm", {tile.upper_mm.x(), tile.upper_mm.y()}},
                     {"origin_mm", {origin.x(), origin.y()}}});
  }
  for (const RegistrationMark& mark : registration_marks(options))
    marks.push_back({{"name", mark.name}, {"place_mm", {mark.place_mm.x(), mark.place_mm.y()}}});
  std::cout << Json({{"pixels", {print.grid.width, print.grid.height}},
                     {"per_metre", print.grid.per_metre},
                     {"sheet_mm", {options.sheet_x_mm, options.sheet_y_mm}},
                     {"page_mm", {layout.width_mm, layout.height_mm}},
                     {"tiles", tiles},
                     {"marks", marks},
                     {"print_factors",
                      {(1 + options.print_scale) * (1 + options.print_stretch_x),
                       (1 + options.print_scale) * (1 + options.print_stretch_y)}},
                     {"mirrored", options.mirror}})
            << "\n";
  return 0;
}
