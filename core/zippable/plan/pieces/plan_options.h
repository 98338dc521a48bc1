// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a maker chooses for the plans of a zippable: zipper, method, bed. Thesis Sec. 5.3.
#include <array>
#include <optional>
#include <string_view>
#include <tuple>

#include "base/data/parameters.h"
#include "zippable/making/making_errors.h"

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
  static constexpr std::array<std::string_view, 2> labels{"Any direction", "Along the pieces"};
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

struct PlanOptions : MakingErrors {
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

  static constexpr auto parameters = std::tuple_cat(
      std::tuple{
          parameter(
              "coil", &PlanOptions::coil, "Zipper",
              "Size of the coil zipper, which sets the widths of tape, teeth and gap. None: a paper model without a zipper.")
              .group("Zipper"),
          parameter(
              "tape_width_mm", &PlanOptions::tape_width_mm, "Tape width", unit::mm, 0, 1000,
              "Width of the fabric tape on one side of the zipper, without its teeth. Automatic: the usual width for the zipper size.")
              .slider(5, 30)
              .group("Zipper")
              .advanced(),
          parameter("teeth_width_mm", &PlanOptions::teeth_width_mm, "Teeth width", unit::mm, 0, 1000,
                    "Width of the closed row of teeth. Automatic: the usual width for the zipper size.")
              .slider(2, 12)
              .group("Zipper")
              .advanced(),
          parameter(
              "gap_mm", &PlanOptions::gap_mm, "Gap", unit::mm, 0, 1000,
              "Distance between the teeth and the fabric on each side, so that the slider can pass. Automatic: the usual distance for the zipper size.")
              .slider(0, 5)
              .group("Zipper")
              .advanced(),
          parameter(
              "method", &PlanOptions::method, "Zipper attached by",
              "Sewing moves the cut edges within the flat pattern. Gluing moves the zipper's curve sideways in space (along its binormal), which keeps both sides equally long.")
              .group("Zipper"),
          parameter(
              "marker_spacing_mm", &PlanOptions::marker_spacing_mm, "Marker spacing", unit::mm, 1, 10000,
              "Distance between numbered markers along the zipper. Automatic: 30 mm for sewing, 50 mm for gluing and on the rig.")
              .slider(10, 100)
              .group("Zipper"),
          parameter("text_height_mm", &PlanOptions::text_height_mm, "Text height", unit::mm, 0.5, 100,
                    "Height of the printed numbers and letters; smaller where the ribbon is narrow.")
              .slider(1, 10)
              .group("Sheets")
              .advanced(),
          parameter("bed_x_mm", &PlanOptions::bed_x_mm, "Sheet width", unit::mm, 20, 10000,
                    "Width of one sheet of material, or of the laser's bed if that is smaller.")
              .slider(100, 1500)
              .group("Sheets"),
          parameter("bed_y_mm", &PlanOptions::bed_y_mm, "Sheet depth", unit::mm, 20, 10000,
                    "Depth of one sheet of material, or of the laser's bed if that is smaller.")
              .slider(100, 1500)
              .group("Sheets"),
          parameter("margin_mm", &PlanOptions::margin_mm, "Margin", unit::mm, 0, 1000,
                    "Width kept free along the edges of every sheet.")
              .slider(0, 30)
              .group("Sheets"),
          parameter("spacing_mm", &PlanOptions::spacing_mm, "Spacing", unit::mm, 0.5, 1000,
                    "Smallest distance between two pieces on a sheet. More is easier to cut; less saves material.")
              .slider(0.5, 20)
              .group("Sheets"),
          parameter(
              "grain", &PlanOptions::grain, "Grain",
              "Whether the long side of each piece must lie along the grain of the material, which runs along x. Use it for cloth that stretches more in one direction.")
              .group("Sheets"),
          parameter(
              "seam_allowance_mm", &PlanOptions::seam_allowance_mm, "Seam allowance", unit::mm, 0, 1000,
              "Width added beyond both edges where the ribbon is split, so that the pieces can be joined again. 8 mm is usual for sewing.")
              .slider(0, 20)
              .group("Sheets"),
          parameter(
              "hook_and_loop_mm", &PlanOptions::hook_and_loop_mm, "Hook-and-loop tape", unit::mm, 5, 200,
              "Width of the hook-and-loop tape that closes cuts at handles. One side of each cut gets an allowance of this width.")
              .slider(10, 50)
              .group("Sheets"),
          parameter(
              "kerf_mm", &PlanOptions::kerf_mm, "Kerf", unit::mm, 0, 10,
              "Width of material that the cut removes; outlines grow by half of it so that pieces keep their size. 0.15 mm is usual for a laser. The laser job does not add it again.")
              .slider(0, 1)
              .group("Sheets"),
          parameter(
              "edges", &PlanOptions::edges, "Edges",
              "For paper models without a zipper. Plain: edges are joined edge to edge with tape. Tabs: glue tabs along one edge of every seam.")
              .group("Paper model"),
          parameter("tab_depth_mm", &PlanOptions::tab_depth_mm, "Tab depth", unit::mm, 1, 100,
                    "Distance from the fold of a glue tab to its outer edge; less where there is no room.")
              .slider(3, 15)
              .group("Paper model"),
          parameter("tab_length_mm", &PlanOptions::tab_length_mm, "Tab length", unit::mm, 4, 1000,
                    "Length of a glue tab along its fold; less where the edge is curved.")
              .slider(5, 40)
              .group("Paper model"),
          parameter(
              "rig", &PlanOptions::rig, "Fastening rig",
              "Also cuts three layers of board for every piece, which hold zipper and cloth in place while they are joined.")
              .group("Rig"),
          parameter("track_width_mm", &PlanOptions::track_width_mm, "Track width", unit::mm, 1, 20,
                    "Width of the tracks in the rig's middle layer, which take the teeth of one zipper tape.")
              .slider(2, 8)
              .group("Rig"),
          parameter(
              "slot_width_mm", &PlanOptions::slot_width_mm, "Slot width", unit::mm, 0.2, 20,
              "Width of the slots in the rig's cover through which the zipper tape comes up. Must be narrower than the track.")
              .slider(0.5, 4)
              .group("Rig")
              .advanced(),
          parameter("rig_opening_mm", &PlanOptions::rig_opening_mm, "Opening diameter", unit::mm, 2, 60,
                    "Diameter of the holes in the rig where a zipper tape is slid into its track.")
              .slider(6, 20)
              .group("Rig")
              .advanced(),
          parameter(
              "screw_mm", &PlanOptions::screw_mm, "Screw hole diameter", unit::mm, 0.5, 20,
              "Diameter of the holes along the rim of the rig for the screws that hold its layers together. 3.2 mm fits M3 screws.")
              .slider(2, 6)
              .group("Rig")
              .advanced(),
          parameter("paper", &PlanOptions::paper, "Paper",
                    "Paper size of the printed tape template and assembly sheet.")
              .group("Sheets")},
      inherit_parameters<PlanOptions>(MakingErrors::parameters));
};

}  // namespace formwright
