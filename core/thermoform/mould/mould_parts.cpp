// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/mould/mould_parts.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "geometry/mesh/measures.h"
#include "thermoform/mould/registration_keys.h"

namespace formwright {
namespace {

constexpr int max_parts = 64;
constexpr double gap_mm = 5;  // between parts on the bed

using Counts = std::array<int, 3>;
constexpr std::array<const char*, 3> printer_names{"printer_x_mm", "printer_y_mm", "printer_z_mm"};

/// Slabs along each axis; pins stick out of a part by `pin_mm` once there are two.
Counts slab_counts(const Vec3& size, const Vec3& printer, double pin_mm) {
  Counts counts{1, 1, 1};
  for (int k = 0; k < 3; ++k) {
    if (printer[k] == 0 || size[k] <= printer[k]) continue;
    const double usable = printer[k] - pin_mm;
    const double count = usable > 0 ? std::ceil(size[k] / usable - 1e-9) : 1e9;
    if (count > max_parts)
      throw Error(ErrorCode::invalid_input, printer_names.at(static_cast<std::size_t>(k)),
                  "The printer is far too small for this mould: it would take more than 64 parts; make the model "
                  "smaller (size_mm).");
    counts.at(static_cast<std::size_t>(k)) = static_cast<int>(count);
  }
  return counts;
}

int product(const Counts& c) { return c[0] * c[1] * c[2]; }

/// From machine coordinates to the bed: a negative stands on its head, and the bed may be turned.
TriangleMesh on_bed(TriangleMesh mesh, bool upside_down, bool turned) {
  if (upside_down) mesh.V.rightCols<2>() *= -1;
  if (turned) {
    const Eigen::VectorXd x = mesh.V.col(0);
    mesh.V.col(0) = -mesh.V.col(1);
    mesh.V.col(1) = x;
  }
  return mesh;
}

/// Rows of parts, as square as it gets, centred on the bed's origin.
void lay_out(std::vector<MouldPart>& parts) {
  double area = 0, widest = 0;
  for (const MouldPart& part : parts) {
    area += (part.size_mm.x() + gap_mm) * (part.size_mm.y() + gap_mm);
    widest = std::max(widest, part.size_mm.x());
  }
  const double row_mm = std::max(widest, std::sqrt(area));
  double x = 0, y = 0, depth = 0;
  BoundingBox all;
  for (MouldPart& part : parts) {
    if (x > 0 && x + part.size_mm.x() > row_mm * (1 + 1e-9)) x = 0, y += depth + gap_mm, depth = 0;
    const Vec3 shift = Vec3(x, y, 0) - bounding_box(part.mesh).lower;
    part.mesh.V.rowwise() += shift.transpose();
    x += part.size_mm.x() + gap_mm;
    depth = std::max(depth, part.size_mm.y());
    const BoundingBox box = bounding_box(part.mesh);
    all.add(box.lower), all.add(box.upper);
  }
  for (MouldPart& part : parts) part.mesh.V.leftCols<2>().rowwise() -= all.centre().head<2>().transpose();
}

}  // namespace

MouldParts split_mould(const ExactSolid& solid, const ThermoformMouldOptions& options, Context& context) {
  MouldParts result;
  const TriangleMesh whole = solid.mesh();
  const BoundingBox box = bounding_box(whole);
  const Vec3 size = box.size(), printer(options.printer_x_mm, options.printer_y_mm, options.printer_z_mm),
             across(printer.y(), printer.x(), printer.z());
  const double pin_mm = pin_length_mm(options.key_diameter_mm);
  result.cells = slab_counts(size, printer, pin_mm);
  bool turned = false;
  if (const Counts other = slab_counts(size, across, pin_mm); product(other) < product(result.cells))
    result.cells = other, turned = true;
  if (product(result.cells) > max_parts)
    throw Error(ErrorCode::invalid_input, "printer_x_mm",
                "The printer is far too small for this mould: it would take more than 64 parts; make the model smaller "
                "(size_mm).");

  const Counts& cells = result.cells;
  const auto plane = [&](int axis, int i) {
    return box.lower[axis] + size[axis] * i / cells.at(static_cast<std::size_t>(axis));
  };
  const auto keys = find_keys(whole, box, cells, options.key_diameter_mm, options.key_clearance_mm,
                              options.kind == MouldKind::negative, context);
  result.keys = static_cast<int>(keys.size());

  // Along each axis, one slab after the other off what is left.
  int done = 0;
  ExactSolid rest_z = solid;
  for (int iz = 0; iz < cells[2]; ++iz) {
    const bool last_z = iz + 1 == cells[2];
    ExactSolid rest_y = last_z ? rest_z : rest_z.half(2, plane(2, iz + 1), false, context);
    if (!last_z) rest_z = rest_z.half(2, plane(2, iz + 1), true, context);
    for (int iy = 0; iy < cells[1]; ++iy) {
      const bool last_y = iy + 1 == cells[1];
      ExactSolid rest_x = last_y ? rest_y : rest_y.half(1, plane(1, iy + 1), false, context);
      if (!last_y) rest_y = rest_y.half(1, plane(1, iy + 1), true, context);
      for (int ix = 0; ix < cells[0]; ++ix) {
        const bool last_x = ix + 1 == cells[0];
        ExactSolid piece = last_x ? rest_x : rest_x.half(0, plane(0, ix + 1), false, context);
        if (!last_x) rest_x = rest_x.half(0, plane(0, ix + 1), true, context);
        const auto span = context.span(static_cast<double>(done) / product(cells), (done + 1.0) / product(cells),
                                       "Cutting into parts");
        ++done;
        if (piece.empty()) continue;
        MouldPart part;
        part.cell = {ix, iy, iz};
        piece = with_keys(piece, part.cell, keys, options.key_clearance_mm, part.pins, part.sockets, context);
        part.mesh = on_bed(piece.mesh(), options.kind == MouldKind::negative, turned);
        part.volume_mm3 = signed_volume(part.mesh);
        part.size_mm = bounding_box(part.mesh).size();
        result.parts.push_back(std::move(part));
      }
    }
  }
  lay_out(result.parts);
  if (result.parts.size() > 1) {
    result.sentences.push_back("The mould is larger than the printer: it is cut into " +
                               std::to_string(result.parts.size()) + " parts, with " + std::to_string(result.keys) +
                               (result.keys == 1 ? " pin" : " pins") +
                               " to line them up; glue or tape the seams from outside before pouring.");
    if (result.keys == 0 && options.key_diameter_mm > 0)
      result.sentences.emplace_back("The cut faces are too narrow for pins: line the parts up by their outsides.");
  }
  return result;
}

}  // namespace formwright
