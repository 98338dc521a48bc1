// SPDX-License-Identifier: GPL-3.0-or-later
// What was measured, as the engine wants it.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "evidence/models/zippable/zippable_model.h"
#include "evidence/models/zippable/zipper_place.h"

namespace formwright {

void ZippableModel::add_lengths(int object) {
  const MeasuredZippable& own = objects_[static_cast<std::size_t>(object)];
  const RibbonPattern& pattern = prepared_[static_cast<std::size_t>(object)].pattern[0];
  Measurement m;
  m.name = own.name;
  m.extent_mm = pattern.zipper_mm;
  const auto n = static_cast<Eigen::Index>(own.lengths.size());
  m.place.resize(n, 2);
  m.measured.resize(n, 1);
  m.sigma.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const MeasuredLength& length = own.lengths[static_cast<std::size_t>(i)];
    // Lengths between neighbouring places are neighbours.
    const int low = std::min(length.from.number, length.to.number),
              high = std::max(length.from.number, length.to.number);
    m.place.row(i) << low * own.marker_spacing_mm / pattern.zipper_mm, high * own.marker_spacing_mm / pattern.zipper_mm;
    m.measured(i, 0) = length.length_mm;
    m.sigma[i] = length.sigma_mm;
    if (length.flat && std::abs(piece_turn(pattern, length.from, own.marker_spacing_mm) -
                                piece_turn(pattern, length.to, own.marker_spacing_mm)) > 1e-6)
      throw Error(ErrorCode::invalid_input, "object",
                  own.name + ": lengths.csv: the flat length from mark " + std::to_string(length.from.number) + " to " +
                      std::to_string(length.to.number) + " goes from one piece to another: measure within one piece.");
  }
  measurements_.push_back(std::move(m));
  sources_.push_back({object, false});
}

void ZippableModel::add_scan(int object, const Context& context) {
  const MeasuredZippable& own = objects_[static_cast<std::size_t>(object)];
  const PreparedObject& prepared = prepared_[static_cast<std::size_t>(object)];
  const RibbonPattern& pattern = prepared.pattern[0];
  const Positions moved = prepared.scan_motion(prepared.scan_mm);
  const PointDistance nearest(cloth_mesh(pattern, prepared.start[0]));
  Measurement m;
  m.name = own.name + (own.lengths.empty() ? "" : ", scan");
  const Eigen::RowVector3d low = pattern.flat.V.colwise().minCoeff();
  m.extent_mm = (pattern.flat.V.colwise().maxCoeff() - low).maxCoeff();
  m.place.resize(moved.rows(), 2);
  m.measured = Eigen::MatrixXd::Zero(moved.rows(), 1);
  m.sigma = Eigen::VectorXd::Constant(moved.rows(), own.scan_sigma_mm);
  for (Eigen::Index i = 0; i < moved.rows(); ++i) {
    if (i % 256 == 0) context.check_cancelled();
    const NearestPoint near = *nearest.nearest(moved.row(i).transpose());
    Eigen::RowVector3d flat = Eigen::RowVector3d::Zero();
    for (int k = 0; k < 3; ++k) flat += near.barycentric[k] * pattern.flat.V.row(pattern.flat.F(near.face, k));
    m.place.row(i) = (flat - low).head<2>() / m.extent_mm;
  }
  measurements_.push_back(std::move(m));
  sources_.push_back({object, true});
}

}  // namespace formwright
