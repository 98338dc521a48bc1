// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A ribbon that is cut, sewn and zipped up as a forward model: from cloth and errors of making to lengths between marks
// and to the distances of a scan's points.
#include <array>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "evidence/fit/forward_model.h"
#include "evidence/models/zippable/measured_zippable.h"
#include "evidence/models/zippable/scan_alignment.h"
#include "zippable/making/making_profile.h"

namespace formwright {

/// Left out where an object is only predicted: a limb is turned inside out on one object, not on the next.
enum class TuckedLimbs { are_causes, are_left_out };

/// A limb that stays inside once it is turned inside out.
struct TuckableLimb {
  int object = 0, number = 1;  // number: of those of the object, along the zipper
  std::string place;           // in words: limb_place()
  Positions moved_mm;          // per vertex of the smaller triangles, from the usual shape at rest to where it rests
                               // then; only mirrored, where lengths speak clearly against it
  int parameter = 0;           // of the model
};

/// The base model is the cloth at rest, zipped up as the plan wants it (zipped_at_rest); unknown is how stiffly it
/// bends. Every object has one measurement of its lengths, where it has any, and one of its scan: the distances of its
/// points from the simulated outside, the scan's place in space being eliminated. Causes: plan_scale, cloth_stretch,
/// cloth_bias, kerf, zipper_gap, seam_take_up, stuffing, gravity (where the set-up says from where it hangs),
/// marks_scale, tape_scale, stiff_zipper, and tucked_in_1, tucked_in_2... for every limb that stays inside once it is
/// turned inside out. What such a limb changes is simulated once, with the smaller triangles and the cloth of the
/// set-up: how far it is in (0 to 1) multiplies that.
class ZippableModel : public ForwardModel {
 public:
  /// `objects`: at least one, as read. Each is simulated once, and once for each limb. Throws Error: invalid_input
  /// ("object"): a length between two pieces that lie flat; could_not_solve, cancelled.
  ZippableModel(std::vector<MeasuredZippable> objects, Context& context,
                TuckedLimbs tucked_limbs = TuckedLimbs::are_causes);

  const std::vector<ModelParameter>& parameters() const override { return parameters_; }
  const std::vector<Cause>& causes() const override { return causes_; }
  const std::vector<Measurement>& measurements() const override { return measurements_; }
  Eigen::MatrixXd predict(int measurement, const Eigen::VectorXd& u, const Context& context) const override;
  double known_misfit() const override { return known_misfit_mm_; }
  std::string in_words(int cause, const std::vector<double>& values) const override;

  const std::vector<MeasuredZippable>& objects() const { return objects_; }
  /// What a plan can make up for at u.
  MakingProfile profile_at(const Eigen::VectorXd& u) const;

 private:
  struct PreparedObject {
    std::array<RibbonPattern, 2> pattern;  // triangles as designed, and finer ones
    std::array<Positions, 2> start;        // at rest as the set-up says
    Positions scan_mm;
    RigidMotion scan_motion;  // onto start[0]
  };
  using TuckedSet = std::vector<int>;  // indices into tuckable_, ascending
  struct Source {
    int object = 0;
    bool scan = false;
  };
  using Rest = std::shared_ptr<const Positions>;

  ZippingOptions options_at(int object, const Eigen::VectorXd& u) const;
  bool finer_at(const Eigen::VectorXd& u) const;
  double value(const char* name, const Eigen::VectorXd& u) const;
  Rest at_rest(int object, const Eigen::VectorXd& u, const Context& context) const;
  /// Of the cloth with these places. `which`: of PreparedObject::pattern.
  Eigen::MatrixXd lengths_of(int object, std::size_t which, const Positions& x, const Eigen::VectorXd& u) const;
  Eigen::MatrixXd distances_at(int object, const Eigen::VectorXd& u, const Context& context) const;
  /// What limbs that are turned inside out change of a measurement: exact where each is in or out, multilinear between.
  Eigen::MatrixXd tucked_change(const Source& source, const Eigen::VectorXd& u, const Context& context) const;
  Eigen::MatrixXd distances_with_tucked(int object, const TuckedSet& tucked, const Context& context) const;
  Positions shape_with_tucked(int object, const TuckedSet& tucked) const;
  void find_tuckable(int object, Context& context);
  void add_lengths(int object);
  void add_scan(int object, const Context& context);

  std::vector<MeasuredZippable> objects_;
  std::vector<PreparedObject> prepared_;
  std::vector<ModelParameter> parameters_;
  std::vector<Cause> causes_;
  std::vector<Measurement> measurements_;
  std::vector<Source> sources_;  // of the measurements
  double known_misfit_mm_ = 0;
  mutable std::mutex mutex_;
  mutable std::map<std::string, std::shared_future<Rest>> rests_;
  std::vector<TuckableLimb> tuckable_;
  mutable std::map<std::pair<int, TuckedSet>, std::shared_future<Eigen::MatrixXd>> tucked_distances_;  // by object
};

/// The parameters that a diagnosis of these objects varies, base first, and the causes they belong to. `pattern`: of
/// the first object. Sets `parameter` of tuckable limbs.
void declare_zippable_parameters(const std::vector<MeasuredZippable>& objects, const RibbonPattern& pattern,
                                 std::vector<TuckableLimb>& tuckable, std::vector<ModelParameter>& parameters,
                                 std::vector<Cause>& causes);

/// What happened, in a sentence.
std::string zippable_cause_in_words(std::string_view cause, std::span<const double> values);

}  // namespace formwright
