// SPDX-License-Identifier: GPL-3.0-or-later
// Limbs turned inside out, as part of the forward model.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/statistics.h"
#include "evidence/models/zippable/tucked_limbs.h"
#include "evidence/models/zippable/zippable_model.h"
#include "evidence/models/zippable/zipper_place.h"

namespace formwright {
namespace {

constexpr std::size_t smaller_triangles = 1;  // of PreparedObject::pattern: large ones cannot follow the fold
constexpr double stays_in = 0.5;              // of the way that it was put in by: at least so far is it inside at rest
constexpr double clearly_worse = 1.5;         // times the lengths' errors: a limb that makes it so is not simulated
constexpr double clearly_nearer = 0.8;        // of the distance: a scan is laid anew only where that fits better

double typical_distance(const ScannedShape& shape, const Positions& scan_mm, const RigidMotion& motion) {
  const Eigen::VectorXd off = shape.distances_mm(scan_mm, motion).cwiseAbs();
  return median(std::vector<double>(off.begin(), off.end()));
}

}  // namespace

void ZippableModel::find_tuckable(int object, Context& context) {
  const MeasuredZippable& own = objects_[static_cast<std::size_t>(object)];
  const PreparedObject& prepared = prepared_[static_cast<std::size_t>(object)];
  const RibbonPattern& pattern = prepared.pattern[smaller_triangles];
  const Positions& usual = prepared.start[smaller_triangles];
  const bool has_scan = own.scan_mm.rows() > 0;
  if (!has_scan && std::all_of(own.lengths.begin(), own.lengths.end(), [](const auto& l) { return l.flat; })) return;
  const std::vector<RibbonLimb> limbs = limbs_of(pattern, context);
  const auto sum_of_errors = [&](const Positions& x) {
    const Eigen::MatrixXd lengths = lengths_of(object, smaller_triangles, x, {});
    double sum = 0;
    for (std::size_t i = 0; i < own.lengths.size(); ++i)
      sum += std::abs(lengths(static_cast<Eigen::Index>(i), 0) - own.lengths[i].length_mm);
    return sum;
  };
  const double usual_error = has_scan ? 0 : sum_of_errors(usual);
  std::vector<Positions> moved(limbs.size());
  parallel_for(limbs.size(), 1, [&](std::size_t begin, std::size_t end) {
    Context quiet = context;
    const auto span = quiet.span(0, 0, "");
    for (std::size_t i = begin; i < end; ++i) {
      const Limb& limb = limbs[i].limb;
      const Positions put_in = tucked_in(pattern.predicted_mm, limb);
      const Positions mirrored = put_in - pattern.predicted_mm;
      if (!has_scan && sum_of_errors(usual + mirrored) > clearly_worse * usual_error) {
        moved[i] = mirrored;
        continue;
      }
      try {
        const Positions x = zipped_at_rest(pattern, own.setup, put_in, quiet).x;
        const Eigen::VectorXd rest_of_it = (limb.distance_mm.array() > limb.length_mm).cast<double>();
        const Positions change = best_motion(x, usual, rest_of_it, false)(x) - usual;
        if (change.rowwise().norm().maxCoeff() >= stays_in * mirrored.rowwise().norm().maxCoeff()) moved[i] = change;
      } catch (const Error& error) {
        if (error.code() != ErrorCode::could_not_solve) throw;
      }
    }
  });
  for (std::size_t i = 0; i < limbs.size(); ++i)
    if (moved[i].rows() > 0)
      tuckable_.push_back(
          {object, static_cast<int>(i) + 1, limb_place(limbs[i], own.marker_spacing_mm), std::move(moved[i])});
}

Positions ZippableModel::shape_with_tucked(int object, const TuckedSet& tucked) const {
  // Limbs share nothing: what each moves adds up.
  Positions x = prepared_[static_cast<std::size_t>(object)].start[smaller_triangles];
  for (const int k : tucked) x += tuckable_[static_cast<std::size_t>(k)].moved_mm;
  return x;
}

Eigen::MatrixXd ZippableModel::distances_with_tucked(int object, const TuckedSet& tucked,
                                                     const Context& context) const {
  const std::pair key(object, tucked);
  std::promise<Eigen::MatrixXd> promise;
  std::shared_future<Eigen::MatrixXd> known;
  {
    const std::scoped_lock lock(mutex_);
    if (const auto found = tucked_distances_.find(key); found != tucked_distances_.end()) known = found->second;
    else tucked_distances_.emplace(key, promise.get_future().share());
  }
  if (known.valid()) return known.get();
  try {
    const PreparedObject& prepared = prepared_[static_cast<std::size_t>(object)];
    // Points of a limb that is inside lie near no certain place of the usual shape: what other triangles change there
    // must not be taken for the limb.
    const ScannedShape shape(tucked.empty()
                                 ? cloth_mesh(prepared.pattern[0], prepared.start[0])
                                 : cloth_mesh(prepared.pattern[smaller_triangles], shape_with_tucked(object, tucked)),
                             objects_[static_cast<std::size_t>(object)].scan_offset_mm());
    RigidMotion motion = shape.aligned(prepared.scan_mm, prepared.scan_motion, rounds_of_alignment, context);
    if (!tucked.empty()) {
      // Without the limb, a shape with several alike was laid onto any of them.
      const RigidMotion anew =
          shape.aligned(prepared.scan_mm, shape.found(prepared.scan_mm, context), rounds_of_alignment, context);
      if (typical_distance(shape, prepared.scan_mm, anew) <
          clearly_nearer * typical_distance(shape, prepared.scan_mm, motion))
        motion = anew;
    }
    Eigen::MatrixXd distances = -shape.distances_mm(prepared.scan_mm, motion);
    promise.set_value(distances);
    return distances;
  } catch (...) {
    promise.set_exception(std::current_exception());
    const std::scoped_lock lock(mutex_);
    tucked_distances_.erase(key);
    throw;
  }
}

Eigen::MatrixXd ZippableModel::tucked_change(const Source& source, const Eigen::VectorXd& u,
                                             const Context& context) const {
  const MeasuredZippable& own = objects_[static_cast<std::size_t>(source.object)];
  TuckedSet some;
  std::vector<double> shares;
  for (std::size_t k = 0; k < tuckable_.size(); ++k) {
    const double share = u[tuckable_[k].parameter];
    if (tuckable_[k].object != source.object || share == 0) continue;
    some.push_back(static_cast<int>(k));
    shares.push_back(share);
  }
  const auto predicted = [&](const TuckedSet& tucked) -> Eigen::MatrixXd {
    if (source.scan) return distances_with_tucked(source.object, tucked, context);
    return lengths_of(source.object, smaller_triangles, shape_with_tucked(source.object, tucked), u);
  };
  const Eigen::Index rows = source.scan ? prepared_[static_cast<std::size_t>(source.object)].scan_mm.rows()
                                        : static_cast<Eigen::Index>(own.lengths.size());
  Eigen::MatrixXd change = Eigen::MatrixXd::Zero(rows, 1);
  if (some.empty()) return change;
  const Eigen::MatrixXd usual = predicted({});
  for (std::size_t mask = 1; mask < std::size_t{1} << some.size(); ++mask) {
    TuckedSet tucked;
    double weight = 1;
    for (std::size_t k = 0; k < some.size(); ++k) {
      const bool in = (mask >> k & 1) != 0;
      weight *= in ? shares[k] : 1 - shares[k];
      if (in) tucked.push_back(some[k]);
    }
    if (weight != 0) change += weight * (predicted(tucked) - usual);
  }
  return change;
}

}  // namespace formwright
