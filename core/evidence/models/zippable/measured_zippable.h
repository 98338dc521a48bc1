// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What was measured of a ribbon that was cut, sewn and zipped up: lengths between the numbered marks of its zipper, and
// a scan of the finished object.
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/context.h"
#include "zippable/zipping/zipping.h"

namespace formwright {

/// A numbered mark of the plan. Zipped up, both sides of one number are one place.
struct ZipperMark {
  int number = 0;
  bool left = true;
};

struct MeasuredLength {
  ZipperMark from, to;
  bool flat = false;  // on the piece as it was cut, lying flat; else straight through the zipped object
  double length_mm = 0, sigma_mm = 0;
};

struct MeasuredZippable {
  std::string name;
  RibbonDesign design;
  ZippingOptions setup;
  bool hangs = false;  // the set-up says where
  double marker_spacing_mm = 30;
  std::vector<MeasuredLength> lengths;
  Positions scan_mm;  // points of the outside of the zipped object, in coordinates of their own; may be empty
  double scan_sigma_mm = 0.3;
  bool scan_is_outside = true;  // else the cloth's middle surface, as simulations write it

  /// How far outside of the middle surface a scan sees the cloth.
  double scan_offset_mm() const { return scan_is_outside ? 0.5 * setup.thickness_mm : 0; }
};

/// "12"; "12L" or "12R" on the flat pieces: as lengths.csv has it.
std::string mark_text(const ZipperMark& mark, bool flat);

/// CSV with the header from,to,state,length_mm,sigma_mm: marks as "12", or "12L" and "12R" for one side of the flat
/// ribbon; the state is zipped or flat; without sigma 0.5 mm. Rows without a length are passed over. Throws
/// Error{invalid_input, "object"}, naming the line.
std::vector<MeasuredLength> read_measured_lengths(ByteView csv);

/// The files of a folder: design.json; plan.json, setup.json, lengths.csv, scan.obj (or .ply, .stl, .glb) where there
/// are any. Throws Error{invalid_input, "object"}: neither lengths nor a scan, a mark beyond the zipper, what a file
/// is not, cancelled.
MeasuredZippable read_measured_zippable(const std::string& name, const std::map<std::string, Bytes>& files,
                                        Context& context);

}  // namespace formwright
