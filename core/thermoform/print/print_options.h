// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What thermoform-texture takes beside the simulation's own parameters.
#include "thermoform/thermoform_options.h"

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
  static constexpr std::array<std::string_view, 6> labels{"As the sheet", "A4", "A3", "A2", "Letter", "Tabloid"};
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
  double gap_mm = 1.5;
  SheetProjectionMethod projection = SheetProjectionMethod::nearest;
  double map_edge_mm = 0.7;

  static constexpr auto parameters = std::tuple_cat(
      inherit_parameters<ThermoformPrintOptions>(ThermoformOptions::parameters),
      std::tuple{
          parameter(
              "colours", &ThermoformPrintOptions::colours, "Colours",
              "Where the colours come from. Automatic: the model's picture, else the colours of its vertices, else of its materials, else a checker.")
              .group("Print"),
          parameter("pattern_mm", &ThermoformPrintOptions::pattern_mm, "Pattern size", unit::mm, 0.5, 500,
                    "Side of the checker's cubes, or height between two lines.")
              .group("Print")
              .slider(2, 40),
          parameter("dots_per_inch", &ThermoformPrintOptions::dots_per_inch, "Resolution", unit::dots_per_inch, 36,
                    1200, "Dots per inch of the print. 300 is as fine as transfer paper holds.")
              .group("Print")
              .slider(100, 600),
          parameter("mirror", &ThermoformPrintOptions::mirror, "Mirror",
                    "For transfer paper, and for printing on the back of a clear sheet: everything left to right.")
              .group("Print"),
          parameter(
              "bleed_mm", &ThermoformPrintOptions::bleed_mm, "Bleed", unit::mm, 0, 50,
              "How far the colours go on beyond the model's edge, so that a print that lands a little off shows no white.")
              .group("Print")
              .slider(0, 10),
          parameter(
              "marks", &ThermoformPrintOptions::marks, "Registration marks",
              "Numbered crosses on the clamped rim, to lay the sheet into the frame by; page 2 shows where they are on the frame.")
              .group("Print"),
          parameter("outlines", &ThermoformPrintOptions::outlines, "Outlines",
                    "Thin lines along the sheet's edge and the clamp's opening.")
              .group("Print"),
          parameter(
              "paper", &ThermoformPrintOptions::paper, "Paper",
              "Of the PDF. On paper that is smaller than the sheet the print goes over several pages, to be joined.")
              .group("Paper"),
          parameter("paper_margin_mm", &ThermoformPrintOptions::paper_margin_mm, "Margin", unit::mm, 0, 50,
                    "White rim that the printer cannot print on. Not used when the paper is as the sheet.")
              .group("Paper")
              .slider(0, 15),
          parameter("overlap_mm", &ThermoformPrintOptions::overlap_mm, "Overlap", unit::mm, 0, 50,
                    "How much neighbouring pages have in common, to be joined by.")
              .group("Paper")
              .slider(0, 30),
          parameter(
              "gap_mm", &ThermoformPrintOptions::gap_mm, "Gap allowed", unit::mm, 0, 20,
              "Where the formed sheet spans a corner, the model's colours still go onto it across a gap up to this wide.")
              .group("Print accuracy")
              .slider(0, 5),
          parameter(
              "projection", &ThermoformPrintOptions::projection, "Projection",
              "How a point of the model finds its point of the sheet: the nearest one, or the one along the model's normal, as rays would (thesis 4.2.4).")
              .group("Print accuracy")
              .advanced(),
          parameter(
              "map_edge_mm", &ThermoformPrintOptions::map_edge_mm, "Map triangles", unit::mm, 0.1, 20,
              "The model is divided until its edges are at most this long; each corner is carried to the sheet on its own.")
              .group("Print accuracy")
              .slider(0.3, 3)
              .advanced()});
};

}  // namespace formwright
