// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Thesis 4.2.4: from a textured model and the sheet formed over it to the picture to print on the flat sheet.
#include "thermoform/print/print_render.h"

namespace formwright {

struct TexturePrint {
  RefinedSurface surface;
  ProjectedSurface projected;
  PrintGrid grid;
  Image picture;  // the whole sheet, opaque, white where nothing is; seen from outside, no marks
  PrintColours colours = PrintColours::checker;   // where they came from
  std::array<double, coverage_kinds> area_mm2{};  // of the model's surface, by Coverage
  double gap_mean_mm = 0, gap_max_mm = 0;         // from coloured points to the sheet's inner surface
  double stretch_mean = 0, stretch_max = 0;       // of the print, area formed over area printed; mean by formed area
  double seconds_refine = 0, seconds_project = 0, seconds_colours = 0, seconds_render = 0, seconds_bleed = 0;
  std::vector<std::string> sentences;  // what the maker should know

  double uncoloured_mm2() const;    // above the plate
  double uncoloured_share() const;  // 0 to 1, of the surface above the plate
};

/// `placed`: the model's mesh in machine coordinates, `sheet`: as it forms over it. `own_picture` takes the place of
/// the model's own. The same bytes at any number of threads.
/// Throws Error: invalid_input (see project_onto_sheet, ModelColours, print_grid), cancelled.
TexturePrint make_texture_print(const Model& model, const TriangleMesh& placed, const FormedSheet& sheet,
                                const std::optional<Image>& own_picture, const ThermoformPrintOptions& options,
                                Context& context);

/// GLB of the formed sheet with the print on it, to look at: upright (y up, as glTF wants it; the machine's front
/// towards +z). `longest_px`: the longer side of its texture at most.
Bytes formed_picture(const FormedSheet& sheet, const TexturePrint& print, int longest_px, Context& context);

}  // namespace formwright
