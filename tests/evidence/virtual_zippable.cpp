// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/virtual_zippable.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "evidence/models/zippable/tucked_limbs.h"
#include "zippable/zipping/made_pattern.h"

namespace formwright::virtual_lab {
namespace {

constexpr double finer = 0.4;  // longest edge, of the ribbon's width
constexpr double marker_spacing_mm = 30;

struct Zipped {
  RibbonPattern designed, cut;  // `cut`: as it lies flat before it is sewn
  Positions x;
};

int chosen_limb(const std::vector<RibbonLimb>& limbs, const HiddenMaking& making) {
  const int count = static_cast<int>(limbs.size());
  return making.tucked_limb ? std::min(count, 1 + static_cast<int>(*making.tucked_limb * count)) : 0;
}

RibbonPattern pattern_of_laboratory(const FlatDesign& design, Context& context) {
  const RibbonDesign ribbon = ribbon_of(design);
  return pattern_of(ribbon, finer * pattern_of(ribbon, 0, context).width_mm, context);
}

Zipped zip_up(const FlatDesign& design, const HiddenMaking& making, Context& context) {
  Zipped zipped;
  zipped.designed = pattern_of_laboratory(design, context);
  Positions start = zipped.designed.predicted_mm;
  const std::vector<RibbonLimb> limbs = limbs_of(zipped.designed, context);
  if (const int number = chosen_limb(limbs, making); number > 0)
    start = tucked_in(start, limbs[static_cast<std::size_t>(number) - 1].limb);
  zipped.x = zipped_at_rest(zipped.designed, making.options, start, context).x;
  MakingErrors before_sewing = making.options;
  before_sewing.more_gap_mm = before_sewing.seam_take_up_mm = 0;
  zipped.cut = made_pattern(zipped.designed, before_sewing);
  return zipped;
}

/// Places of one side, or the middle of both, at a length along the zipper.
template <class At>
Vec3 at_length(const std::vector<SeamPair>& seams, double along_mm, const At& at) {
  std::size_t after = 1;
  while (after + 1 < seams.size() &&
         (seams[after].along_mm < along_mm || seams[after].along_mm <= seams[after - 1].along_mm))
    ++after;
  const SeamPair &a = seams[after - 1], &b = seams[after];
  const double share =
      b.along_mm > a.along_mm ? std::clamp((along_mm - a.along_mm) / (b.along_mm - a.along_mm), 0.0, 1.0) : 0;
  return (1 - share) * at(a) + share * at(b);
}

}  // namespace

ZippingOptions usual_cloth() {
  ZippingOptions cloth;
  cloth.thickness_mm = 0.5;
  cloth.stretch_n_per_mm = 10;
  cloth.bending_n_mm = 0.05;
  return cloth;
}

std::vector<std::string> zippable_cause_names() {
  return {"plan_scale", "cloth_stretch", "cloth_bias",  "kerf",       "zipper_gap",   "seam_take_up",
          "stuffing",   "gravity",       "marks_scale", "tape_scale", "stiff_zipper", "tucked_limb"};
}

void hide_cause(const std::string& cause, double level, double size_mm, double width_mm, std::mt19937& random,
                HiddenMaking& making) {
  const double sign = std::uniform_int_distribution<int>(0, 1)(random) ? 1 : -1;
  const double some = level * std::uniform_real_distribution<double>(0.8, 1.2)(random);
  ZippingOptions& o = making.options;
  if (cause == "plan_scale") o.plan_scale += 0.02 * sign * some;
  else if (cause == "cloth_stretch")
    o.cloth_stretch_along += 0.04 * sign * some, o.cloth_stretch_across -= 0.02 * sign * some;
  else if (cause == "cloth_bias") o.cloth_bias += 0.04 * sign * some;
  else if (cause == "kerf") o.more_kerf_mm += 1.2 * some;
  else if (cause == "zipper_gap") o.more_gap_mm += 1.5 * some;
  else if (cause == "seam_take_up") o.seam_take_up_mm += 0.8 * some;
  else if (cause == "stuffing") o.stuffing_pressure_pa += 3 * 0.04e6 * o.stretch_n_per_mm / size_mm * some;
  else if (cause == "gravity") o.weight_g_per_m2 += 400 * some;
  else if (cause == "marks_scale") making.marks_scale += 0.02 * sign * some;
  else if (cause == "tape_scale") making.tape_scale += 0.02 * sign * some;
  else if (cause == "stiff_zipper") o.zipper_bending_n_mm2 += 3 * 2 * bending_of(o) * width_mm * some;
  else if (cause == "tucked_limb") making.tucked_limb = std::uniform_real_distribution<double>(0, 1)(random);
  else throw std::invalid_argument("no such cause: " + cause);
}

int hidden_limb(const FlatDesign& design, const HiddenMaking& making) {
  Context context;
  return making.tucked_limb ? chosen_limb(limbs_of(pattern_of_laboratory(design, context), context), making) : 0;
}

HiddenMaking draw_making(std::mt19937& random) {
  HiddenMaking making;
  making.options = usual_cloth();
  std::normal_distribution<double> normal(0, 1);
  making.options.bending_n_mm = *making.options.bending_n_mm * std::exp(0.5 * normal(random));
  making.options.stretch_n_per_mm *= std::exp(0.3 * normal(random));
  return making;
}

MeasuredZippable make_zippable(const std::string& name, const FlatDesign& design, const HiddenMaking& making,
                               const ZippableObservation& observation, std::mt19937& random) {
  Context context;
  const Zipped zipped = zip_up(design, making, context);
  const std::vector<SeamPair>& seams = zipped.designed.seams;
  std::normal_distribution<double> normal(0, 1);
  MeasuredZippable object;
  object.name = name;
  object.design = ribbon_of(design);
  object.setup = usual_cloth();
  object.hangs = observation.hangs;
  object.setup.hung_at_mm = making.options.hung_at_mm;
  object.marker_spacing_mm = marker_spacing_mm;
  object.scan_sigma_mm = observation.scan_sigma_mm;
  const int marks = static_cast<int>(0.97 * design.zipper_mm / marker_spacing_mm);
  std::uniform_int_distribution<int> mark(0, marks);
  const auto along = [&](int number) { return (1 + making.marks_scale) * number * marker_spacing_mm; };
  const auto add = [&](MeasuredLength length, double true_mm) {
    length.sigma_mm = observation.tape_sigma_mm;
    length.length_mm = (1 + making.tape_scale) * true_mm + length.sigma_mm * normal(random);
    if (length.length_mm > 0) object.lengths.push_back(length);
  };
  for (int i = 0; i < observation.zipped_lengths; ++i) {
    MeasuredLength length{{mark(random), true}, {mark(random), true}};
    if (length.from.number == length.to.number) length.to.number = (length.from.number + marks / 2) % (marks + 1);
    const auto middle = [&](const SeamPair& pair) {
      return Vec3(0.5 * (zipped.x.row(pair.left) + zipped.x.row(pair.right)).transpose());
    };
    add(length,
        (at_length(seams, along(length.from.number), middle) - at_length(seams, along(length.to.number), middle))
            .norm());
  }
  const auto side = [&](bool left) {
    return [&, left](const SeamPair& pair) {
      return Vec3(zipped.cut.flat.V.row(left ? pair.left : pair.right).transpose());
    };
  };
  for (int i = 0; i < observation.flat_lengths; ++i) {
    // By turns across the ribbon, from one side to the nearest mark of the other, and along one side.
    MeasuredLength length{{mark(random), true}, {0, false}, true};
    const Vec3 from = at_length(seams, along(length.from.number), side(true));
    double nearest = 1e300;
    for (int k = 0; k <= marks; ++k)
      if (const double d = (at_length(seams, along(k), side(false)) - from).norm(); d < nearest)
        nearest = d, length.to.number = k;
    if (i % 2) length.to = {std::min(marks, length.from.number + 4), true};
    if (length.to.left && length.to.number == length.from.number) continue;
    const Vec2 across = (at_length(seams, along(length.to.number), side(length.to.left)) - from).head<2>();
    add(length, zipped.cut.cloth_change.empty() ? across.norm() : (zipped.cut.cloth_change.front() * across).norm());
  }
  if (observation.scan_points == 0) return object;
  // The outside, from anywhere, as a scanner sees it.
  object.scan_mm.resize(observation.scan_points, 3);
  const Eigen::Quaterniond turn(
      Eigen::Vector4d(normal(random), normal(random), normal(random), normal(random)).normalized());
  const Triangles& F = zipped.designed.flat.F;
  std::vector<double> areas;
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    const Vec3 a = zipped.x.row(F(f, 1)) - zipped.x.row(F(f, 0)), b = zipped.x.row(F(f, 2)) - zipped.x.row(F(f, 0));
    areas.push_back(a.cross(b).norm());
  }
  std::discrete_distribution<int> face(areas.begin(), areas.end());
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < observation.scan_points; ++i) {
    const int f = face(random);
    double s = uniform(random), t = uniform(random);
    if (s + t > 1) s = 1 - s, t = 1 - t;
    const Vec3 p = zipped.x.row(F(f, 0)), a = zipped.x.row(F(f, 1)).transpose() - p,
               b = zipped.x.row(F(f, 2)).transpose() - p, n = a.cross(b).normalized();
    const Vec3 seen =
        p + s * a + t * b + (0.5 * object.setup.thickness_mm + observation.scan_sigma_mm * normal(random)) * n;
    object.scan_mm.row(i) = ((1 + making.tape_scale) * (turn * seen) + Vec3(100, -50, 20)).transpose();
  }
  return object;
}

}  // namespace formwright::virtual_lab
