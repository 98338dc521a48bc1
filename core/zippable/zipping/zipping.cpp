// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/zipping/zipping.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/random.h"

namespace formwright {
namespace {

constexpr double poisson_ratio = 0.3;
constexpr double automatic_triangles = 4000;
/// Seams are this much stiffer than the cloth beside them: a zipper does not give.
constexpr double seam_to_cloth = 50;
/// How fast threads shorten: at most this share of the ribbon's width in a step.
constexpr double shortening = 0.1;
/// The slider waits where threads are longer than this share of the width.
constexpr double slack = 0.3;

ClothMaterial material_of(const ZippingOptions& options) {
  ClothMaterial material;
  material.stretch_n_per_mm = options.stretch_n_per_mm;
  material.poisson_ratio = poisson_ratio;
  material.bending_n_mm = options.bending_n_mm.value_or(options.stretch_n_per_mm * options.thickness_mm * options.thickness_mm /
                                                        (12 * (1 - poisson_ratio * poisson_ratio)));
  return material;
}

/// The course from flat to zipped.
class Zipping {
 public:
  Zipping(const RibbonPattern& pattern, const ZippingOptions& options, Context& context)
      : pattern_(pattern), options_(options), context_(context), system_(pattern, material_of(options), context), x_(pattern.flat.V) {
    Random random(static_cast<std::uint64_t>(options.seed));
    for (Eigen::Index i = 0; i < x_.rows(); ++i) x_(i, 2) = 1e-3 * pattern.width_mm * random.uniform(-1, 1);
    stiffness_ = seam_to_cloth * options.stretch_n_per_mm / pattern.width_mm;
    energy_unit_ = options.stretch_n_per_mm * pattern.width_mm * pattern.width_mm;
    under_pressure_.assign(static_cast<std::size_t>(pattern.flat.face_count()), 0);
  }

  ZippingSystem& system() { return system_; }
  const Positions& x() const { return x_; }
  std::vector<std::pair<double, Positions>> frames;
  bool settled = false;

  void run() {
    record(0);
    const double advance = pattern_.zipper_mm / options_.steps;
    double slider = 0;
    std::size_t passed = 0;
    system_.anchor_n_per_mm3 = 1e-5 * options_.stretch_n_per_mm / (pattern_.width_mm * pattern_.width_mm);
    bool all_short = true;
    while (passed < pattern_.seams.size() || !all_short) {
      if (all_short) {
        slider += advance;
        for (; passed < pattern_.seams.size() && pattern_.seams[passed].along_mm <= slider; ++passed) begin_thread(passed);
      }
      all_short = shorten(passed);
      move(3, 1e-7);
      const double share = passed == pattern_.seams.size() ? 1 : std::min(slider / pattern_.zipper_mm, 1.0);
      context_.progress(0.9 * share);
      record(0.9 * share);
    }
    settle();
    record(1);
  }

 private:
  void begin_thread(std::size_t i) {
    const SeamPair& seam = pattern_.seams[i];
    system_.threads[i] = {stiffness_ * std::max(seam.length_mm, 1e-3 * pattern_.width_mm), (x_.row(seam.left) - x_.row(seam.right)).norm()};
  }

  bool shorten(std::size_t passed) {
    bool all_short = true;
    for (std::size_t i = 0; i < passed; ++i) {
      double& length = system_.threads[i].length_mm;
      length = std::max(0.0, length - std::max(shortening * pattern_.width_mm, 0.05 * length));
      all_short = all_short && length <= slack * pattern_.width_mm;
    }
    return all_short;
  }

  void mark_pressure() {
    if (options_.stuffing_pressure_pa <= 0) return;
    system_.outer_force_n = pressure_force_n(pattern_.flat.F, x_, under_pressure_, 1e-6 * options_.stuffing_pressure_pa);
  }

  ZippingSystem::Progress move(int iterations, double tolerance) {
    mark_pressure();
    system_.anchor_mm = x_;
    return system_.minimise(x_, iterations, tolerance * energy_unit_, context_);
  }

  void settle() {
    std::fill(under_pressure_.begin(), under_pressure_.end(), 1);
    for (int round = 0; round < 100 && !settled; ++round) {
      const auto progress = move(10, 1e-11);
      settled = progress.settled && progress.iterations == 1;
      context_.progress(0.9 + 0.1 * round / 100);
    }
  }

  void record(double share) {
    if (frames.empty() || share >= 1 || share * (options_.frames - 1) >= static_cast<double>(frames.size())) frames.emplace_back(share, x_);
  }

  const RibbonPattern& pattern_;
  const ZippingOptions& options_;
  Context& context_;
  ZippingSystem system_;
  Positions x_;
  double stiffness_ = 0, energy_unit_ = 1;
  std::vector<char> under_pressure_;
};

std::vector<int> places(const RibbonPattern& pattern) {
  std::vector<int> place(static_cast<std::size_t>(pattern.flat.vertex_count()));
  for (std::size_t i = 0; i < place.size(); ++i) place[i] = static_cast<int>(i);
  for (const SeamPair& seam : pattern.seams) place[static_cast<std::size_t>(seam.right)] = seam.left;
  return place;
}

}  // namespace

double automatic_edge_mm(const RibbonPattern& pattern) {
  // Halving leaves edges between half of the longest and all of it.
  return std::sqrt(2 * pattern.zipper_mm * pattern.width_mm / (0.433 * automatic_triangles));
}

ZippingResult simulate_zipping(const RibbonDesign& design, const ZippingOptions& options, Context& context) {
  Stopwatch watch;
  ZippingResult result;
  context.progress(0, "Cutting the cloth");
  result.pattern = make_ribbon_pattern(design.places, design.triangles, 0, context);
  const double edge_mm = options.edge_mm.value_or(automatic_edge_mm(result.pattern));
  if (edge_mm > 0) result.pattern = make_ribbon_pattern(design.places, design.triangles, edge_mm, context);
  const RibbonPattern& pattern = result.pattern;
  Zipping zipping(pattern, options, context);
  context.progress(0, "Zipping");
  zipping.run();
  const ZippingSystem& system = zipping.system();
  result.energies = system.energies(zipping.x());
  result.settled = zipping.settled;
  result.newton_iterations = system.iterations();
  result.comparison = compare_shapes(zipping.x(), pattern.predicted_mm, system.vertex_area_mm2());
  result.zipped_mm = result.comparison.motion(zipping.x());
  for (const auto& [share, x] : zipping.frames) result.frames.push_back({result.comparison.motion(x).cast<float>(), share});
  result.gap_allowed_mm = 0.01 * pattern.width_mm;
  for (const SeamPair& seam : pattern.seams) {
    const double gap = (zipping.x().row(seam.left) - zipping.x().row(seam.right)).norm();
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
  result.crossings = count_crossings({zipping.x(), pattern.flat.F}, places(pattern), context);
  result.seconds = watch.seconds();
  return result;
}

}  // namespace formwright
