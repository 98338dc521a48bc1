// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/zippable/zippable_model.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "evidence/models/zippable/zipper_place.h"
#include "zippable/zipping/made_pattern.h"

namespace formwright {
namespace {

constexpr Eigen::Index max_scan_points = 1500;
constexpr double finer_edge = 0.5;  // of the ribbon's width
/// What the simulation is known to be off by without any fault, of the object's size.
constexpr double known_misfit_share = 0.003;

bool has_scan(const MeasuredZippable& object) { return object.scan_mm.rows() > 0; }

}  // namespace

ZippableModel::ZippableModel(std::vector<MeasuredZippable> objects, Context& context, TuckedLimbs tucked_limbs)
    : objects_(std::move(objects)) {
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const MeasuredZippable& object = objects_[i];
    const auto span = context.span(static_cast<double>(i) / static_cast<double>(objects_.size()),
                                   (static_cast<double>(i) + 1) / static_cast<double>(objects_.size()),
                                   "Simulating the zipped shape");
    PreparedObject prepared;
    prepared.pattern[0] = pattern_of(object.design, object.setup.edge_mm, context);
    const double coarse = prepared.pattern[0].width_mm, edge = object.setup.edge_mm;
    prepared.pattern[1] = pattern_of(object.design, edge > 0 ? finer_edge * edge : finer_edge * coarse, context);
    for (std::size_t k = 0; k < 2; ++k)
      prepared.start[k] =
          zipped_at_rest(prepared.pattern[k], object.setup, prepared.pattern[k].predicted_mm, context).x;
    known_misfit_mm_ = std::max(known_misfit_mm_, known_misfit_share * prepared.pattern[0].size_mm);
    if (has_scan(object)) {
      prepared.scan_mm = evenly_chosen(object.scan_mm, max_scan_points);
      const ScannedShape shape(cloth_mesh(prepared.pattern[0], prepared.start[0]), object.scan_offset_mm());
      prepared.scan_motion =
          shape.aligned(prepared.scan_mm, shape.found(prepared.scan_mm, context), rounds_of_alignment, context);
    }
    prepared_.push_back(std::move(prepared));
    if (tucked_limbs == TuckedLimbs::are_causes) find_tuckable(static_cast<int>(i), context);
  }
  declare_zippable_parameters(objects_, prepared_.front().pattern[0], tuckable_, parameters_, causes_);
  for (int i = 0; i < static_cast<int>(objects_.size()); ++i) {
    if (!objects_[static_cast<std::size_t>(i)].lengths.empty()) add_lengths(i);
    if (has_scan(objects_[static_cast<std::size_t>(i)])) add_scan(i, context);
  }
}

double ZippableModel::value(const char* name, const Eigen::VectorXd& u) const {
  for (std::size_t p = 0; p < parameters_.size(); ++p)
    if (parameters_[p].name == name) return parameters_[p].value(u[static_cast<Eigen::Index>(p)]);
  return 0;
}

bool ZippableModel::finer_at(const Eigen::VectorXd& u) const { return value("finer_cloth", u) > 0.5; }

ZippingOptions ZippableModel::options_at(int object, const Eigen::VectorXd& u) const {
  const MeasuredZippable& own = objects_[static_cast<std::size_t>(object)];
  Json values = write_parameters(own.setup);
  values["bending_n_mm"] = bending_of(own.setup);
  for (std::size_t p = 0; p < parameters_.size(); ++p) {
    const ModelParameter& parameter = parameters_[p];
    if (!values.contains(parameter.name)) continue;
    // Where objects were set up differently, what is found comes on top of what each set-up says.
    const double at = parameter.value(u[static_cast<Eigen::Index>(p)]), set_up = values[parameter.name].get<double>();
    values[parameter.name] = parameter.logarithmic ? set_up * at / parameter.nominal : set_up + at - parameter.nominal;
  }
  ZippingOptions options = read_parameters<ZippingOptions>(values);
  if (value("half_as_stiff", u) > 0.5) options.stretch_n_per_mm *= 0.5;
  return options;
}

ZippableModel::Rest ZippableModel::at_rest(int object, const Eigen::VectorXd& u, const Context& context) const {
  const ZippingOptions options = options_at(object, u);
  const bool finer = finer_at(u);
  const std::string key = std::to_string(object) + (finer ? " finer " : " ") + write_parameters(options).dump();
  std::promise<Rest> promise;
  std::shared_future<Rest> known;
  {
    const std::scoped_lock lock(mutex_);
    if (const auto found = rests_.find(key); found != rests_.end()) known = found->second;
    else rests_.emplace(key, promise.get_future().share());
  }
  if (known.valid()) return known.get();
  try {
    const PreparedObject& prepared = prepared_[static_cast<std::size_t>(object)];
    const std::size_t k = finer ? 1 : 0;
    Context own = context;
    const auto quiet = own.span(0, 0, "");
    auto rest =
        std::make_shared<const Positions>(zipped_at_rest(prepared.pattern[k], options, prepared.start[k], own).x);
    promise.set_value(rest);
    return rest;
  } catch (...) {
    promise.set_exception(std::current_exception());
    const std::scoped_lock lock(mutex_);
    rests_.erase(key);
    throw;
  }
}

Eigen::MatrixXd ZippableModel::lengths_of(int object, std::size_t which, const Positions& x,
                                          const Eigen::VectorXd& u) const {
  const MeasuredZippable& own = objects_[static_cast<std::size_t>(object)];
  const RibbonPattern& pattern = prepared_[static_cast<std::size_t>(object)].pattern[which];
  // Nothing is sewn yet where pieces lie flat.
  MakingErrors cut = options_at(object, u);
  cut.more_gap_mm = cut.seam_take_up_mm = 0;
  const RibbonPattern flat = made_pattern(pattern, cut);
  std::vector<int> triangle_of(static_cast<std::size_t>(pattern.flat.vertex_count()), 0);
  // The first triangle at a vertex, as piece_turn() has it.
  for (int f = pattern.flat.face_count(); f-- > 0;)
    for (int k = 0; k < 3; ++k) triangle_of[static_cast<std::size_t>(pattern.flat.F(f, k))] = f;
  const double farther = 1 + value("marks_scale", u), larger = 1 + value("tape_scale", u);
  Eigen::MatrixXd lengths(static_cast<Eigen::Index>(own.lengths.size()), 1);
  for (Eigen::Index i = 0; i < lengths.rows(); ++i) {
    const MeasuredLength& length = own.lengths[static_cast<std::size_t>(i)];
    const auto between = [&](const ZipperMark& mark, const auto& at) {
      return zipper_place(pattern, farther * mark.number * own.marker_spacing_mm).interpolate(pattern, at);
    };
    if (length.flat) {
      const auto on_side = [&](const ZipperMark& mark) {
        return between(mark, [&](const SeamPair& pair) {
          return Vec3(flat.flat.V.row(mark.left ? pair.left : pair.right).transpose());
        });
      };
      const Vec2 across = (on_side(length.to) - on_side(length.from)).head<2>();
      const ZipperPlace place = zipper_place(pattern, length.from.number * own.marker_spacing_mm);
      const SeamPair& pair = pattern.seams[static_cast<std::size_t>(place.pair[0])];
      const auto triangle =
          static_cast<std::size_t>(triangle_of[static_cast<std::size_t>(length.from.left ? pair.left : pair.right)]);
      lengths(i, 0) = flat.cloth_change.empty() ? across.norm() : (flat.cloth_change[triangle] * across).norm();
    } else {
      const auto zipped = [&](const ZipperMark& mark) {
        return between(
            mark, [&](const SeamPair& pair) { return Vec3(0.5 * (x.row(pair.left) + x.row(pair.right)).transpose()); });
      };
      lengths(i, 0) = (zipped(length.to) - zipped(length.from)).norm();
    }
  }
  return larger * lengths;
}

Eigen::MatrixXd ZippableModel::distances_at(int object, const Eigen::VectorXd& u, const Context& context) const {
  const MeasuredZippable& own = objects_[static_cast<std::size_t>(object)];
  const PreparedObject& prepared = prepared_[static_cast<std::size_t>(object)];
  const Rest rest = at_rest(object, u, context);
  const double larger = 1 + value("tape_scale", u);
  const ScannedShape shape(cloth_mesh(prepared.pattern[finer_at(u) ? 1 : 0], larger * *rest), own.scan_offset_mm());
  const RigidMotion motion = shape.aligned(prepared.scan_mm, prepared.scan_motion, rounds_of_alignment, context);
  // The scan's distances from the shape: a prediction is what a point that was measured at 0 is off by, the other way.
  return -shape.distances_mm(prepared.scan_mm, motion);
}

Eigen::MatrixXd ZippableModel::predict(int measurement, const Eigen::VectorXd& u, const Context& context) const {
  const Source& source = sources_[static_cast<std::size_t>(measurement)];
  Eigen::MatrixXd result = source.scan
                               ? distances_at(source.object, u, context)
                               : lengths_of(source.object, finer_at(u) ? 1 : 0, *at_rest(source.object, u, context), u);
  result += tucked_change(source, u, context);
  if (!result.allFinite()) throw Error(ErrorCode::could_not_solve, "", "The zipped cloth has no finite place there.");
  return result;
}

std::string ZippableModel::in_words(int cause, const std::vector<double>& values) const {
  const Cause& own = causes_[static_cast<std::size_t>(cause)];
  for (const TuckableLimb& limb : tuckable_)
    if (limb.parameter == own.parameters.front()) return "The part " + limb.place + " is turned inside out.";
  return zippable_cause_in_words(own.name, values);
}

MakingProfile ZippableModel::profile_at(const Eigen::VectorXd& u) const {
  MakingProfile profile;
  for (const ParameterInfo& info : describe_parameters<MakingErrors>())
    if (const double at = value(info.name.c_str(), u); at != 0) profile.parameters[info.name] = at;
  for (const MeasuredZippable& object : objects_) profile.from.push_back(object.name);
  return profile;
}

}  // namespace formwright
