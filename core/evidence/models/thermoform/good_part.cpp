// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/thermoform/good_part.h"

#include <algorithm>

#include "base/error.h"
#include "evidence/calibration.h"
#include "numerics/local_kriging.h"

namespace formwright {
namespace {

constexpr double same_place_mm = 0.2;
constexpr Eigen::Index max_compared = 500;

bool lies_on(const TriangleMesh& mesh, const MouldShape& other) {
  const Eigen::Index n = mesh.V.rows(), stride = std::max<Eigen::Index>(1, n / max_compared);
  for (Eigen::Index i = 0; i < n; i += stride)
    if (!other.distance.nearest(mesh.V.row(i).transpose(), same_place_mm)) return false;
  return true;
}

}  // namespace

bool same_mould(const FormedObject& a, const FormedObject& b) {
  return a.key == b.key || (lies_on(a.mould->mesh, *b.mould) && lies_on(b.mould->mesh, *a.mould));
}

MachineInOrder machine_in_order(const std::vector<FormedObject>& good_parts, const ThermoformModelOptions& options,
                                Context& context) {
  // Nothing was wrong with these parts, so no cause may stand in for what the simulation leaves out.
  ThermoformModelOptions in_order = options;
  in_order.without = thermoform_cause_names();
  const ThermoformModel usual(good_parts, std::move(in_order));
  MachineInOrder result;
  {
    const auto span = context.span(0, 0.8, "Choosing the simulation");
    result.choice = choose_simulation(usual.for_choosing(), context);
  }
  const ThermoformModel& model = usual.extended_by(result.choice.taken());
  SimulationBag bag(model);
  const auto span = context.span(0.8, 1, "Calibrating to the good part");
  const Calibration calibration = calibrate_quickly(bag, context, result.choice.u);
  result.profile = model.profile_at(calibration.u);
  result.error_mm = calibration.error;
  return result;
}

void check_good_parts(const std::vector<FormedObject>& good_parts, const std::vector<FormedObject>& objects) {
  for (const FormedObject& part : good_parts)
    if (std::none_of(objects.begin(), objects.end(), [&](const FormedObject& o) { return same_mould(o, part); }))
      throw Error(
          ErrorCode::invalid_input, "good",
          part.name +
              ": this good part was formed over another mould than the measured objects, or it stood elsewhere: give one over the same mould in the same place, or leave it out.");
}

int ThermoformModel::measurement_like(const Measurement& other, int object) const {
  for (int m = 0; m < static_cast<int>(measurements_.size()); ++m) {
    const Measurement& own = measurements_[static_cast<std::size_t>(m)];
    if ((own.is_place() ? m : own.places_index) == object && own.is_place() == other.is_place() &&
        own.scale == other.scale)
      return m;
  }
  return -1;
}

const Eigen::MatrixXd& ThermoformModel::beside_simulation(int measurement, const Eigen::VectorXd& u,
                                                          const Context& context) const {
  // An equally good simulation misses something else of a good part. Only what it makes of the change is uncertain.
  Eigen::VectorXd in_order = nominal();
  std::vector<int> discrepancies;
  for (const int p : parameters_with(ParameterRole::discrepancy))
    if (u[p] >= 0.5) {
      in_order[p] = 1;
      discrepancies.push_back(p);
    }
  const std::scoped_lock lock(beside_mutex_);
  const auto [known, is_new] = beside_.try_emplace({measurement, discrepancies});
  Eigen::MatrixXd& beside = known->second;
  if (!is_new) return beside;
  const Measurement& measured = measurements_[static_cast<std::size_t>(measurement)];
  const FormedObject& own =
      objects_[static_cast<std::size_t>(measured.is_place() ? measurement : measured.places_index)];
  beside = Eigen::MatrixXd::Zero(measured.measured.rows(), measured.measured.cols());
  // The rim is not simulated: what one sheet's rim has beside the set-up, another's has not.
  if (is_of_the_rim(measurement)) return beside;
  int count = 0;
  try {
    for (int part = 0; part < static_cast<int>(in_order_->objects().size()); ++part) {
      if (!same_mould(in_order_->objects()[static_cast<std::size_t>(part)], own)) continue;
      const int like = in_order_->measurement_like(measured, part);
      if (like < 0) continue;
      const Eigen::MatrixXd left = in_order_->measurements()[static_cast<std::size_t>(like)].measured -
                                   in_order_->predict(like, in_order, context);
      beside += LocalKriging(in_order_->places_in_clamp(like), left).read(places_in_clamp(measurement));
      ++count;
    }
  } catch (...) {
    beside_.erase(known);
    throw;
  }
  // What differs among several is no fault of the simulation.
  return beside /= std::max(1, count);
}

}  // namespace formwright
