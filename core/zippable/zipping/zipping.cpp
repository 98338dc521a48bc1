// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/zipping/zipping.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "geometry/queries/crossings.h"
#include "base/random.h"
#include "zippable/zipping/made_pattern.h"

namespace formwright {
namespace {

constexpr double poisson_ratio = 0.3;
/// Seams are this much stiffer than the cloth beside them: a zipper does not give.
constexpr double seam_to_cloth = 50;
/// How fast threads shorten: at most this share of the ribbon's width in a step.
constexpr double shortening = 0.1;
/// The slider waits where threads are longer than this share of the width.
constexpr double slack = 0.3;
constexpr int newton_steps = 3;  // of the slider's step
constexpr int newton_steps_of_rest = 10;
constexpr int pressing_rounds = 60;  // most of them; a dozen is usual
constexpr int settling_rounds = 100;
/// Where each of them ends, of a course's time and of its animation.
constexpr double passed_share = 0.8, closed_share = 0.85, settled_share = 0.9, pressed_share = 0.95;
/// The pull back to where a place was a step before, over the cloth's stiffness and width: it keeps the free end from
/// flying about.
constexpr double anchor = 1e-3;
/// As near as the cloth that was put into the shape, and that itself not too far off, in tolerances.
constexpr double max_over_rest = 1.25, mostly_its_own = 3;

ClothMaterial material_of(const ZippingOptions& options) {
  ClothMaterial material;
  material.stretch_n_per_mm = options.stretch_n_per_mm;
  material.poisson_ratio = poisson_ratio;
  material.bending_n_mm = bending_of(options);
  material.zipper_bending_n_mm2 = options.zipper_bending_n_mm2;
  return material;
}

/// The course from flat to zipped.
class Zipping {
 public:
  Zipping(const RibbonPattern& pattern, const ZippingOptions& options, double hold_open_percent, Context& context)
      : pattern_(pattern),
        options_(options),
        held_percent_(hold_open_percent),
        context_(context),
        system_(pattern, material_of(options), context),
        x_(pattern.flat.V) {
    Random random(static_cast<std::uint64_t>(options.seed));
    for (Eigen::Index i = 0; i < x_.rows(); ++i) x_(i, 2) = 1e-3 * pattern.width_mm * random.uniform(-1, 1);
    stiffness_ = seam_to_cloth * options.stretch_n_per_mm / pattern.width_mm;
    energy_unit_ = options.stretch_n_per_mm * pattern.width_mm * pattern.width_mm;
    under_pressure_.assign(static_cast<std::size_t>(pattern.flat.face_count()), 0);
  }

  const ZippingSystem& system() const { return system_; }
  const Positions& x() const { return x_; }
  std::vector<std::pair<double, Positions>> frames;
  bool settled = false;
  int rounds = 0;

  /// From a shape instead, all seams closed: whether it stays there.
  void rest_from(const Positions& shape, bool whole_hessian) {
    x_ = shape;
    system_.whole_hessian = whole_hessian;
    for (std::size_t i = 0; i < system_.pairs().size(); ++i) begin_thread(i), system_.threads[i].length_mm = 0;
    system_.anchor_n_per_mm3 =
        (whole_hessian ? 1e-2 : 1.0) * anchor * options_.stretch_n_per_mm / (pattern_.width_mm * pattern_.width_mm);
    settle(0, 1);
  }

  void run() {
    record(0);
    const double advance = pattern_.zipper_mm / options_.steps;
    double slider = 0;
    std::size_t passed = 0;
    system_.anchor_n_per_mm3 = anchor * options_.stretch_n_per_mm / (pattern_.width_mm * pattern_.width_mm);
    bool all_short = true;
    while (passed < pattern_.seams.size() || !all_short) {
      if (all_short) {
        slider += advance;
        for (; passed < pattern_.seams.size() && pattern_.seams[passed].along_mm <= slider; ++passed)
          begin_thread(passed);
      }
      for (std::size_t f = 0; f < under_pressure_.size(); ++f) under_pressure_[f] = pattern_.closed_at_mm[f] <= slider;
      all_short = shorten(passed);
      move(newton_steps, 1e-7);
      const double share = passed == pattern_.seams.size() ? 1 : std::min(slider / pattern_.zipper_mm, 1.0);
      reached(passed_share * share);
    }
    close_by_hand();
    settle(closed_share, settled_share);
    record(1);
  }

  /// As a maker does: corners and limbs that were tucked in while zipping come out, and stay out.
  void press_out() {
    held_percent_ = options_.press_out_percent;
    bool still = false;
    for (int round = 0; round < pressing_rounds && !still; ++round) {
      const auto progress = move(newton_steps_of_rest, 1e-9);
      still = progress.settled && progress.iterations == 1;
      context_.progress(settled_share + (pressed_share - settled_share) * round / pressing_rounds);
    }
    settle(pressed_share, 1);
    record(1);
  }

 private:
  void begin_thread(std::size_t i) {
    const ZippingSystem::Pair& pair = system_.pairs()[i];
    system_.threads[i] = {stiffness_ * std::max(pair.length_mm, 0.1 * pattern_.width_mm),
                          (x_.row(pair.left) - x_.row(pair.right)).norm()};
  }

  /// Hook-and-loop tape along cut handles comes last, and a maker turns the ends towards each other first.
  void close_by_hand() {
    const std::size_t seams = pattern_.seams.size(), all = system_.pairs().size();
    if (all == seams) return;
    for (std::size_t i = seams; i < all; ++i) begin_thread(i);
    const auto longest = [&] {
      double length = 0;
      for (std::size_t i = seams; i < all; ++i) length = std::max(length, system_.threads[i].length_mm);
      return length;
    };
    const double at_first = std::max(longest(), 1e-9 * pattern_.width_mm);
    for (bool all_short = false; !all_short;) {
      all_short = shorten(all);
      move(newton_steps, 1e-7);
      reached(passed_share + (closed_share - passed_share) * (1 - longest() / at_first));
    }
  }

  bool shorten(std::size_t passed) {
    bool all_short = true;
    for (std::size_t i = 0; i < passed; ++i) {
      double& length = system_.threads[i].length_mm;
      length = std::max(0.0, length - std::max(shortening * pattern_.width_mm, 0.05 * length));
      all_short = all_short && length <= (passed >= pattern_.seams.size() ? 0 : slack * pattern_.width_mm);
    }
    return all_short;
  }

  /// Nobody knows before which side of the flat cloth will be the inside: negative where the normals point into what is
  /// closed.
  double enclosed_mm3() const {
    Vec3 centre = Vec3::Zero();
    double area = 0, six_volumes = 0;
    for (std::size_t f = 0; f < under_pressure_.size(); ++f) {
      if (!under_pressure_[f]) continue;
      const ClothTriangle& t = system_.triangles()[f];
      for (const int v : t.vertex) centre += t.area_mm2 / 3 * x_.row(v).transpose();
      area += t.area_mm2;
    }
    if (area > 0) centre /= area;
    for (std::size_t f = 0; f < under_pressure_.size(); ++f) {
      if (!under_pressure_[f]) continue;
      const auto& v = system_.triangles()[f].vertex;
      const Vec3 a = x_.row(v[0]).transpose() - centre, b = x_.row(v[1]).transpose() - centre,
                 c = x_.row(v[2]).transpose() - centre;
      six_volumes += a.dot(b.cross(c));
    }
    return six_volumes / 6;
  }

  void press() {
    const double pressure_mpa = 1e-6 * options_.stuffing_pressure_pa + 0.01 * held_percent_ *
                                                                           options_.stretch_n_per_mm /
                                                                           std::sqrt(system_.vertex_area_mm2().sum());
    system_.outer_force_n.setZero();
    if (pressure_mpa > 0) {
      system_.outer_force_n =
          pressure_force_n(pattern_.flat.F, x_, under_pressure_, enclosed_mm3() >= 0 ? pressure_mpa : -pressure_mpa);
      // On the way the pull back to where everything was holds it.
      if (passed_) balance(system_.outer_force_n, x_, system_.vertex_area_mm2());
    }
    if (passed_ && options_.weight_g_per_m2 > 0 && !pattern_.seams.empty()) hang();
  }

  /// What hangs turns until its centre of mass is below the hand. So down is where that is, and weight and hand turn
  /// nothing.
  void hang() {
    constexpr double newton_per_gram = 9.81e-3, m2_per_mm2 = 1e-6;
    const auto hand =
        std::min_element(pattern_.seams.begin(), pattern_.seams.end(), [&](const SeamPair& a, const SeamPair& b) {
          return std::abs(a.along_mm - options_.hung_at_mm) < std::abs(b.along_mm - options_.hung_at_mm);
        });
    const Eigen::VectorXd& area = system_.vertex_area_mm2();
    const Eigen::RowVector3d place = 0.5 * (x_.row(hand->left) + x_.row(hand->right)),
                             down = area.transpose() * x_ / area.sum() - place;
    if (!(down.norm() > 0)) return;
    const Eigen::RowVector3d weight = newton_per_gram * m2_per_mm2 * options_.weight_g_per_m2 * down.normalized();
    system_.outer_force_n += area * weight;
    for (const int v : {hand->left, hand->right}) system_.outer_force_n.row(v) -= 0.5 * area.sum() * weight;
  }

  ZippingSystem::Progress move(int iterations, double tolerance) {
    press();
    system_.anchor_mm = x_;
    return system_.minimise(x_, iterations, tolerance * energy_unit_, context_);
  }

  void settle(double from_share, double to_share) {
    held_percent_ = 0;
    settled = false;
    passed_ = true;
    std::fill(under_pressure_.begin(), under_pressure_.end(), 1);
    for (int round = 0; round < settling_rounds && !settled; ++round) {
      const auto progress = move(newton_steps_of_rest, 1e-11);
      settled = progress.settled && progress.iterations == 1;
      ++rounds;
      context_.progress(from_share + (to_share - from_share) * round / settling_rounds);
    }
  }

  void reached(double share) {
    context_.progress(share);
    record(share);
  }

  void record(double share) {
    if (frames.empty() || share >= 1 || share * (options_.frames - 1) >= static_cast<double>(frames.size()))
      frames.emplace_back(share, x_);
  }

  const RibbonPattern& pattern_;
  const ZippingOptions& options_;
  double held_percent_;  // now, of stretch stiffness over size
  Context& context_;
  ZippingSystem system_;
  Positions x_;
  double stiffness_ = 0, energy_unit_ = 1;
  std::vector<char> under_pressure_;
  bool passed_ = false;  // by the slider, all of it
};

/// Vertices that are one place when all is closed have one number.
std::vector<int> places(const RibbonPattern& pattern, const std::vector<ZippingSystem::Pair>& pairs) {
  std::vector<int> place(static_cast<std::size_t>(pattern.flat.vertex_count()));
  for (std::size_t i = 0; i < place.size(); ++i) place[i] = static_cast<int>(i);
  const auto root = [&](int v) {
    while (place[static_cast<std::size_t>(v)] != v) v = place[static_cast<std::size_t>(v)];
    return v;
  };
  for (const ZippingSystem::Pair& pair : pairs) place[static_cast<std::size_t>(root(pair.right))] = root(pair.left);
  for (std::size_t i = 0; i < place.size(); ++i) place[i] = root(static_cast<int>(i));
  return place;
}

/// One course as it ended, before what only the best one of them is asked for.
struct Attempt {
  ZippingResult result;
  Positions x;
  std::vector<std::pair<double, Positions>> frames;
};

Attempt as_it_is(const RibbonPattern& pattern, const Zipping& zipping) {
  Attempt attempt{{}, zipping.x(), zipping.frames};
  ZippingResult& result = attempt.result;
  result.pattern = pattern;
  const ZippingSystem& system = zipping.system();
  result.energies = system.energies(zipping.x());
  result.settled = zipping.settled;
  result.newton_iterations = system.iterations();
  result.comparison = compare_shapes(zipping.x(), pattern.predicted_mm, system.vertex_area_mm2());
  result.gap_allowed_mm = 0.01 * pattern.width_mm;
  for (const ZippingSystem::Pair& pair : system.pairs()) {
    const double gap = (zipping.x().row(pair.left) - zipping.x().row(pair.right)).norm();
    result.gap_max_mm = std::max(result.gap_max_mm, gap);
    result.open_seams += gap > result.gap_allowed_mm;
  }
  double area = 0;
  for (const ClothTriangle& t : system.triangles()) {
    const double strain = largest_strain(t, zipping.x());
    result.strain_mean += t.area_mm2 * strain;
    result.strain_max = std::max(result.strain_max, strain);
    area += t.area_mm2;
  }
  result.strain_mean /= area;
  return attempt;
}

/// With its animation and where it runs through itself.
ZippingResult whole(const Attempt& attempt, const RibbonPattern& pattern, const ZippingSystem& system,
                    Context& context) {
  ZippingResult result = attempt.result;
  result.zipped_mm = result.comparison.motion(attempt.x);
  // Nothing holds the cloth in its place on the way: each frame is turned onto the next one, the last onto the
  // prediction.
  Positions next = result.zipped_mm;
  for (auto frame = attempt.frames.rbegin(); frame != attempt.frames.rend(); ++frame) {
    next = best_motion(frame->second, next, system.vertex_area_mm2(), result.comparison.mirrored)(frame->second);
    result.frames.push_back({next.cast<float>(), frame->first});
  }
  std::reverse(result.frames.begin(), result.frames.end());
  result.crossings = count_crossings({attempt.x, pattern.flat.F}, places(pattern, system.pairs()), context);
  return result;
}

bool fits(const ZippingResult& result, double tolerance_percent) {
  const ZippingOutcome outcome = zipping_outcome(result, tolerance_percent);
  return outcome == ZippingOutcome::takes_shape || outcome == ZippingOutcome::as_the_cloth_does;
}

bool better(const ZippingResult& a, const ZippingResult& b) {
  if (a.closed() != b.closed()) return a.closed();
  if (a.settled != b.settled) return a.settled;
  return a.comparison.percentile_95_mm < b.comparison.percentile_95_mm;
}

}  // namespace

double bending_of(const ZippingOptions& options) {
  return options.bending_n_mm.value_or(options.stretch_n_per_mm * options.thickness_mm * options.thickness_mm /
                                       (12 * (1 - poisson_ratio * poisson_ratio)));
}

ZippingOutcome zipping_outcome(const ZippingResult& result, double tolerance_percent) {
  if (!result.closed()) return ZippingOutcome::open_seams;
  // A shape that still moves where it should lie has not been shown to stay there.
  if (!result.settled) return ZippingOutcome::not_settled;
  const double tolerance_mm = 0.01 * tolerance_percent * result.pattern.size_mm;
  const double off_mm = result.comparison.percentile_95_mm, own_mm = result.rest.percentile_95_mm;
  if (off_mm <= tolerance_mm) return ZippingOutcome::takes_shape;
  // Zipping cannot do better than the cloth does that was put there.
  return off_mm <= max_over_rest * own_mm && own_mm <= mostly_its_own * tolerance_mm ? ZippingOutcome::as_the_cloth_does
                                                                                     : ZippingOutcome::another_shape;
}

ZippedAtRest zipped_at_rest(const RibbonPattern& designed, const ZippingOptions& options, const Positions& start,
                            Context& context) {
  const RibbonPattern pattern = made_pattern(designed, options);
  Zipping zipping(pattern, options, 0, context);
  zipping.rest_from(start, true);
  if (!zipping.x().allFinite())
    throw Error(ErrorCode::could_not_solve, "", "The zipped cloth has no finite place there.");
  return {zipping.x(), zipping.settled, zipping.rounds, zipping.system().iterations(),
          zipping.system().energies(zipping.x())};
}

ZippingResult simulate_zipping(const RibbonDesign& design, const ZippingOptions& options, Context& context) {
  Stopwatch watch;
  context.progress(0, "Cutting the cloth");
  const RibbonPattern pattern = made_pattern(pattern_of(design, options.edge_mm, context), options);
  Zipping at_rest(pattern, options, 0, context);
  {
    const auto span = context.span(0, 0.1, "Simulating the zipped shape at rest");
    at_rest.rest_from(pattern.predicted_mm, false);
  }
  const ShapeComparison rest = compare_shapes(at_rest.x(), pattern.predicted_mm, at_rest.system().vertex_area_mm2());
  const std::vector<double> holds =
      options.hold_open_percent ? std::vector{*options.hold_open_percent} : std::vector{40.0, 0.0, 15.0};
  std::optional<Attempt> nearest;
  int attempts = 0;
  const auto tried = [&](const Zipping& zipping, double held_open_percent, bool pressed_out) {
    Attempt attempt = as_it_is(pattern, zipping);
    attempt.result.held_open_percent = held_open_percent;
    attempt.result.pressed_out = pressed_out;
    attempt.result.rest = rest;
    if (!nearest || better(attempt.result, nearest->result)) nearest = std::move(attempt);
    return fits(nearest->result, options.tolerance_percent);
  };
  for (std::size_t k = 0; k < holds.size(); ++k) {
    const double part = 0.9 / static_cast<double>(holds.size()), before = 0.1 + part * static_cast<double>(k);
    const auto span = context.span(before, before + part, k == 0 ? "Zipping" : "Zipping with another pressure");
    Zipping zipping(pattern, options, holds[k], context);
    zipping.run();
    ++attempts;
    if (tried(zipping, holds[k], false)) break;
    if (options.press_out_percent <= 0 || pattern.seams.empty()) continue;
    zipping.press_out();
    if (tried(zipping, holds[k], true)) break;
  }
  ZippingResult best = whole(*nearest, pattern, at_rest.system(), context);
  best.rest_energies = at_rest.system().energies(at_rest.x());
  best.attempts = attempts;
  best.seconds = watch.seconds();
  return best;
}

}  // namespace formwright
