// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What thermoform-texture takes beside the simulation's own parameters.
#include "thermoform/measured/measurement_effects.h"
#include "thermoform/sheet/thermoform_options.h"

namespace formwright {

enum class PrintColours { automatic, picture, vertex_colours, material_colours, checker, contours };
template <>
struct EnumNames<PrintColours> {
  static constexpr std::array<std::string_view, 6> names{
      "automatic", "picture", "vertex_colours", "material_colours", "procedural_checker", "procedural_contours"};
  static constexpr std::array<std::string_view, 6> labels{"Automatic",        "Picture", "Vertex colours",
                                                          "Material colours", "Checker", "Height lines"};
};

enum class Paper { sheet, a4, a3, a2, letter, tabloid };
template <>
struct EnumNames<Paper> {
  static constexpr std::array<std::string_view, 6> names{"sheet", "a4", "a3", "a2", "letter", "tabloid"};
  static constexpr std::array<std::string_view, 6> labels{"Size of the sheet", "A4", "A3", "A2", "Letter", "Tabloid"};
};

enum class SheetProjectionMethod { nearest, along_normal };
template <>
struct EnumNames<SheetProjectionMethod> {
  static constexpr std::array<std::string_view, 2> names{"nearest", "along_normal"};
  static constexpr std::array<std::string_view, 2> labels{"Nearest point", "Along the normal"};
};

struct ThermoformPrintOptions : ThermoformOptions {
  PrintColours colours = PrintColours::automatic;
  double pattern_mm = 10;
  double dots_per_inch = 300;
  double bleed_mm = 3;
  bool mirror = false;
  bool marks = true;
  bool outlines = true;
  Paper paper = Paper::sheet;
  double paper_margin_mm = 5;
  double overlap_mm = 10;
  double print_scale = 0;
  double print_stretch_x = 0;
  double print_stretch_y = 0;
  double gap_mm = 1.5;
  SheetProjectionMethod projection = SheetProjectionMethod::nearest;
  double map_edge_mm = 0.7;

  static constexpr auto parameters = std::tuple_cat(
      inherit_parameters<ThermoformPrintOptions>(ThermoformOptions::parameters),
      std::tuple{
          parameter(
              "colours", &ThermoformPrintOptions::colours, "Colours",
              "Where the colours of the print come from. Automatic takes the first that the model has: its picture, the colours of its vertices, the colours of its materials; otherwise a checker.")
              .group("Print"),
          parameter("pattern_mm", &ThermoformPrintOptions::pattern_mm, "Pattern size", unit::mm, 0.5, 500,
                    "Edge length of the checker's cubes, or height between two of the height lines.")
              .group("Print")
              .slider(2, 40),
          parameter("dots_per_inch", &ThermoformPrintOptions::dots_per_inch, "Resolution", unit::dots_per_inch, 36,
                    1200,
                    "Dots per inch of the print. 300 is as fine as transfer paper can hold; more makes larger files.")
              .group("Print")
              .slider(100, 600),
          parameter(
              "mirror", &ThermoformPrintOptions::mirror, "Mirror horizontally",
              "Swaps left and right in the print. Needed for transfer paper and for printing on the back of a clear sheet.")
              .group("Print"),
          parameter(
              "bleed_mm", &ThermoformPrintOptions::bleed_mm, "Bleed", unit::mm, 0, 50,
              "How far the colours continue beyond the model's edge, so that no white shows if the print is slightly misplaced. 3 mm is usual.")
              .group("Print")
              .slider(0, 10),
          parameter(
              "marks", &ThermoformPrintOptions::marks, "Registration marks",
              "Prints numbered crosses on the clamped rim to align the sheet in the frame; the page after the print shows where they belong on the frame.")
              .group("Print"),
          parameter("outlines", &ThermoformPrintOptions::outlines, "Outlines",
                    "Prints thin lines along the edge of the sheet and the clamp's opening.")
              .group("Print"),
          parameter(
              "paper", &ThermoformPrintOptions::paper, "Paper",
              "Paper size of the PDF. If the paper is smaller than the sheet, the print is split over several pages to be joined.")
              .group("Paper"),
          parameter("paper_margin_mm", &ThermoformPrintOptions::paper_margin_mm, "Paper margin", unit::mm, 0, 50,
                    "White rim that the printer cannot print on. Not used if the paper is the size of the sheet.")
              .group("Paper")
              .slider(0, 15),
          parameter(
              "overlap_mm", &ThermoformPrintOptions::overlap_mm, "Overlap", unit::mm, 0, 50,
              "Width of the strip that neighbouring pages share, so that they can be glued together. 10 mm is usual.")
              .group("Paper")
              .slider(0, 30),
          print_scale_parameter(&ThermoformPrintOptions::print_scale, "Paper")},
      print_stretch_parameters(&ThermoformPrintOptions::print_stretch_x, &ThermoformPrintOptions::print_stretch_y,
                               "Paper"),
      std::tuple{
          parameter(
              "gap_mm", &ThermoformPrintOptions::gap_mm, "Largest gap to colour", unit::mm, 0, 20,
              "Widest gap between model and formed sheet across which colours are still transferred, as in corners that the sheet spans. Larger leaves fewer white places and is less exact.")
              .group("Print accuracy")
              .slider(0, 5),
          parameter(
              "projection", &ThermoformPrintOptions::projection, "Projection",
              "How each point of the model finds its place on the formed sheet: the nearest point, or the one straight out along the model's surface normal.")
              .group("Print accuracy")
              .advanced(),
          parameter(
              "map_edge_mm", &ThermoformPrintOptions::map_edge_mm, "Longest map edge", unit::mm, 0.1, 20,
              "The model is subdivided until no edge is longer than this, so that its colours follow the sheet closely. Smaller is more exact and slower.")
              .group("Print accuracy")
              .slider(0.3, 3)
              .advanced()});

  /// What is sent to the printer along x and y, as a multiple of what is to lie on the sheet.
  Vec2 sent_scale() const { return print_factors(print_scale, print_stretch_x, print_stretch_y).cwiseInverse(); }
};

}  // namespace formwright
