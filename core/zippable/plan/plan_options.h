// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a maker chooses for the plans of a zippable: zipper, method, bed. Thesis Sec. 5.3.
#include <array>
#include <optional>
#include <string_view>
#include <tuple>

#include "base/parameters.h"

namespace formwright {

enum class ZipperCoil { none, coil_3, coil_5, coil_8 };
template <>
struct EnumNames<ZipperCoil> {
  static constexpr std::array<std::string_view, 4> names{"none", "3", "5", "8"};
  static constexpr std::array<std::string_view, 4> labels{"None (paper)", "Coil 3", "Coil 5", "Coil 8"};
};

enum class ZipperOffset { sewing, gluing };
template <>
struct EnumNames<ZipperOffset> {
  static constexpr std::array<std::string_view, 2> names{"sewing", "gluing"};
  static constexpr std::array<std::string_view, 2> labels{"Sewing", "Gluing"};
};

enum class GrainDirection { free, along_pieces };
template <>
struct EnumNames<GrainDirection> {
  static constexpr std::array<std::string_view, 2> names{"free", "along_pieces"};
  static constexpr std::array<std::string_view, 2> labels{"No matter", "Along the pieces"};
};

enum class InstructionPaper { a4, letter };
template <>
struct EnumNames<InstructionPaper> {
  static constexpr std::array<std::string_view, 2> names{"a4", "letter"};
  static constexpr std::array<std::string_view, 2> labels{"A4", "Letter"};
};

enum class PaperEdges { plain, tabs };
template <>
struct EnumNames<PaperEdges> {
  static constexpr std::array<std::string_view, 2> names{"plain", "tabs"};
  static constexpr std::array<std::string_view, 2> labels{"Plain", "Tabs"};
};

struct PlanOptions {
  ZipperCoil coil = ZipperCoil::coil_3;
  std::optional<double> tape_width_mm, teeth_width_mm, gap_mm;
  ZipperOffset method = ZipperOffset::sewing;
  std::optional<double> marker_spacing_mm;
  double text_height_mm = 3;
  double bed_x_mm = 600, bed_y_mm = 300, margin_mm = 5, spacing_mm = 2;
  GrainDirection grain = GrainDirection::free;
  double seam_allowance_mm = 8;
  double hook_and_loop_mm = 20;
  double kerf_mm = 0.15;
  PaperEdges edges = PaperEdges::plain;
  double tab_depth_mm = 5, tab_length_mm = 15;
  bool rig = false;
  double track_width_mm = 4, slot_width_mm = 1.6, rig_opening_mm = 10, screw_mm = 3.2;
  InstructionPaper paper = InstructionPaper::a4;

  static constexpr auto parameters = std::tuple{
      parameter("coil", &PlanOptions::coil, "Zipper",
                "Size of the coil zipper, which sets tape, teeth and gap; none for paper.")
          .group("Zipper"),
      parameter("tape_width_mm", &PlanOptions::tape_width_mm, "Tape", unit::mm, 0, 1000,
                "Width of the fabric tape of one side, without teeth; automatic: of the coil's size.")
          .slider(5, 30)
          .group("Zipper")
          .advanced(),
      parameter("teeth_width_mm", &PlanOptions::teeth_width_mm, "Teeth", unit::mm, 0, 1000,
                "Width of the closed row of teeth; automatic: of the coil's size.")
          .slider(2, 12)
          .group("Zipper")
          .advanced(),
      parameter("gap_mm", &PlanOptions::gap_mm, "Gap", unit::mm, 0, 1000,
                "Between teeth and fabric, on each side, for the slider to pass; automatic: of the coil's size.")
          .slider(0, 5)
          .group("Zipper")
          .advanced(),
      parameter(
          "method", &PlanOptions::method, "Zipper attached by",
          "Sewing moves the edges in the plane; gluing along the curve's binormal, which keeps both sides as long as each other.")
          .group("Zipper"),
      parameter("marker_spacing_mm", &PlanOptions::marker_spacing_mm, "Markers every", unit::mm, 1, 10000,
                "Along the zipper; automatic: 30 mm for sewing, 50 mm for gluing and on the rig.")
          .slider(10, 100)
          .group("Zipper"),
      parameter("text_height_mm", &PlanOptions::text_height_mm, "Text", unit::mm, 0.5, 100,
                "Height of numbers and letters; smaller where the ribbon is narrow.")
          .slider(1, 10)
          .group("Sheets")
          .advanced(),
      parameter("bed_x_mm", &PlanOptions::bed_x_mm, "Bed, x", unit::mm, 20, 10000, "Width of one sheet of material.")
          .slider(100, 1500)
          .group("Sheets"),
      parameter("bed_y_mm", &PlanOptions::bed_y_mm, "Bed, y", unit::mm, 20, 10000, "Depth of one sheet of material.")
          .slider(100, 1500)
          .group("Sheets"),
      parameter("margin_mm", &PlanOptions::margin_mm, "Margin", unit::mm, 0, 1000,
                "Kept free along the edges of a sheet.")
          .slider(0, 30)
          .group("Sheets"),
      parameter("spacing_mm", &PlanOptions::spacing_mm, "Spacing", unit::mm, 0.5, 1000,
                "Between pieces on a sheet, at least.")
          .slider(0.5, 20)
          .group("Sheets"),
      parameter("grain", &PlanOptions::grain, "Grain",
                "Whether pieces lie with their long side along the material's grain, which runs along x.")
          .group("Sheets"),
      parameter("seam_allowance_mm", &PlanOptions::seam_allowance_mm, "Seam allowance", unit::mm, 0, 1000,
                "Added beyond both edges where the ribbon is split, to join them again.")
          .slider(0, 20)
          .group("Sheets"),
      parameter("hook_and_loop_mm", &PlanOptions::hook_and_loop_mm, "Hook-and-loop tape", unit::mm, 5, 200,
                "Width of the tape that closes cut handles; one of their sides gets an allowance as wide.")
          .slider(10, 50)
          .group("Sheets"),
      parameter("kerf_mm", &PlanOptions::kerf_mm, "Kerf", unit::mm, 0, 10,
                "Width of what the cut takes away: outlines grow by half. Laser jobs do not add it again.")
          .slider(0, 1)
          .group("Sheets"),
      parameter(
          "edges", &PlanOptions::edges, "Edges",
          "Of paper, without a zipper: plain, to be joined edge to edge, or with tabs along one edge of every seam.")
          .group("Paper model"),
      parameter("tab_depth_mm", &PlanOptions::tab_depth_mm, "Depth of tabs", unit::mm, 1, 100,
                "From fold to outer edge; less where there is no room.")
          .slider(3, 15)
          .group("Paper model"),
      parameter("tab_length_mm", &PlanOptions::tab_length_mm, "Length of tabs", unit::mm, 4, 1000,
                "Along the fold; less where the edge is curved.")
          .slider(5, 40)
          .group("Paper model"),
      parameter(
          "rig", &PlanOptions::rig, "Fastening rig",
          "Also three layers of board for every piece, which hold zipper and cloth in place while they are joined.")
          .group("Rig"),
      parameter("track_width_mm", &PlanOptions::track_width_mm, "Track", unit::mm, 1, 20,
                "Width of the tracks in the middle layer, which take the teeth of one tape.")
          .slider(2, 8)
          .group("Rig"),
      parameter("slot_width_mm", &PlanOptions::slot_width_mm, "Slot", unit::mm, 0.2, 20,
                "Width of the slots in the cover, through which the tape comes up; narrower than the track.")
          .slider(0.5, 4)
          .group("Rig")
          .advanced(),
      parameter("rig_opening_mm", &PlanOptions::rig_opening_mm, "Openings", unit::mm, 2, 60,
                "Diameter of the holes where a tape is slid in.")
          .slider(6, 20)
          .group("Rig")
          .advanced(),
      parameter("screw_mm", &PlanOptions::screw_mm, "Screw holes", unit::mm, 0.5, 20,
                "Diameter; the rig is screwed together along its rim.")
          .slider(2, 6)
          .group("Rig")
          .advanced(),
      parameter("paper", &PlanOptions::paper, "Paper",
                "On which the tape's template and the assembly sheet are printed.")
          .group("Sheets")};
};

}  // namespace formwright
