// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/base/base_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "base/format.h"
#include "relief/base/base_strips.h"

namespace formwright {
namespace {

constexpr int cylinder_steps = 2048, steps_a_wave = 512, max_waves = 128;

/// The shape across its direction: position t over the plate and depth z behind its front, t ascending.
struct Profile {
  std::vector<double> t, z;
  void add(double at, double depth) {
    t.push_back(at);
    z.push_back(depth);
  }
  Profile shifted(double by) && {
    for (double& at : t) at += by;
    return std::move(*this);
  }
};

/// All lengths normalised. `reach`: half the width that the profile must have; `half_plate`: half the plate's.
Profile cylinder(double depth, double reach, double half_plate) {
  Profile p;
  // The circle through the middle of the plate's front and its edges, which lie `depth` behind.
  const double radius = (half_plate * half_plate + depth * depth) / (2 * depth);
  const double slope = half_plate / (radius - depth);
  p.add(-reach, depth + (reach - half_plate) * slope);
  for (int k = 0; k <= cylinder_steps; ++k) {
    const double t = half_plate * (2.0 * k / cylinder_steps - 1);
    p.add(t, t * t / (radius + std::sqrt(radius * radius - t * t)));
  }
  p.add(reach, depth + (reach - half_plate) * slope);
  return p;
}

Profile wave(double depth, double reach, double pitch) {
  Profile p;
  const int steps = static_cast<int>(std::ceil(2 * reach / pitch * steps_a_wave));
  for (int k = 0; k <= steps; ++k) {
    const double t = reach * (2.0 * k / steps - 1);
    p.add(t, 0.5 * depth * (1 - std::cos(2 * std::numbers::pi * t / pitch)));
  }
  return p;
}

Profile groove(double depth, double reach, double pitch) {
  Profile p;
  const double edge = 0.5 * pitch;
  if (edge < reach) p.add(-reach, 0), p.add(-edge, 0);
  else p.add(-reach, depth * (1 - reach / edge));
  p.add(0, depth);
  if (edge < reach) p.add(edge, 0), p.add(reach, 0);
  else p.add(reach, depth * (1 - reach / edge));
  return p;
}

TriangleMesh swept(const Profile& profile, double reach, double turn_deg) {
  const double angle = turn_deg * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
  const auto n = static_cast<Eigen::Index>(profile.t.size());
  TriangleMesh mesh;
  mesh.V.resize(2 * n, 3);
  mesh.F.resize(2 * (n - 1), 3);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double t = profile.t[static_cast<std::size_t>(k)], z = profile.z[static_cast<std::size_t>(k)];
    for (const int end : {0, 1}) {
      const double along = end == 0 ? -reach : reach;
      mesh.V.row(2 * k + end) << c * t - s * along, s * t + c * along, z;
    }
    if (k + 1 == n) continue;
    const int first = static_cast<int>(2 * k);
    mesh.F.row(2 * k) << first, first + 1, first + 2;
    mesh.F.row(2 * k + 1) << first + 1, first + 3, first + 2;
  }
  return mesh;
}

/// Of the direction across the shape, from x towards y: stairs rise upwards, the other shapes change from left to
/// right.
double turn_of(const ReliefOptions& options) {
  return options.base_turn_deg + (options.base == BaseShape::stairs ? 90 : 0);
}

/// What the shape has to cover when it is not shifted, how wide the plate is across it, and by how much it is shifted;
/// normalised.
struct Extent {
  double depth, reach, half_across, shift;
};

/// A shape that is shifted off its plate would be another one, and steps would be missing.
double shift_of(const ReliefOptions& options, double half_across) {
  if (options.base == BaseShape::strips) return 0;
  const double size = options.width_mm, shift = options.base_shift_mm / size;
  const bool stairs = options.base == BaseShape::stairs;
  const double max_shift = stairs ? 2 * half_across / options.base_steps : half_across;
  if (std::abs(shift) < max_shift) return shift;
  throw Error(ErrorCode::invalid_input, "base_shift_mm",
              std::string("The base is shifted by more than ") + (stairs ? "one step" : "half the plate") +
                  ": shift it by less than " + with_digits(max_shift * size, 4) + " mm.");
}

Extent extent_of(const ReliefOptions& options, const ViewFrame& frame) {
  const double size = options.width_mm, depth = options.base_depth_mm / size;
  const double half_x = 0.5 + options.margin_mm / size, half_y = 0.5 * frame.image_height + options.margin_mm / size;
  // Rays spread behind the plate's front.
  const double spread = 1 + frame.kappa * (depth + options.carve_depth_mm / size);
  const double angle = turn_of(options) * std::numbers::pi / 180;
  const double half_across = std::abs(std::cos(angle)) * half_x + std::abs(std::sin(angle)) * half_y;
  const double shift = shift_of(options, half_across);
  return {depth, 1.01 * spread * std::hypot(half_x, half_y) + std::abs(shift), half_across, shift};
}

Profile stairs(const BaseBands& bands, double reach) {
  Profile p;
  p.add(-reach, bands.depth(0));
  for (int k = 0; k + 1 < bands.count(); ++k) {
    const double t = bands.border()[static_cast<std::size_t>(k)];
    p.add(t, bands.depth(k));
    p.add(t, bands.depth(k + 1));
  }
  p.add(reach, bands.depth(bands.count() - 1));
  return p;
}

/// The outer strips go on beyond their ends.
Profile strips(const BaseStrips& strips, double reach) {
  Profile p;
  const auto at = [&](double t, int band) { p.add(t, strips.bands.depth(band, t)); };
  const int last = strips.bands.count() - 1;
  if (-reach < strips.t.front()) at(-reach, 0);
  for (std::size_t k = 0; k < strips.t.size(); ++k) p.add(strips.t[k], strips.z[k]);
  if (reach > strips.t.back()) at(reach, last);
  return p;
}

}  // namespace

std::optional<BaseBands> base_bands(const ReliefOptions& options, const ViewFrame& frame) {
  if (options.base == BaseShape::strips)
    return base_strips(options, frame, extent_of(options, frame).half_across, turn_of(options)).bands;
  if (options.base != BaseShape::stairs) return std::nullopt;
  const Extent extent = extent_of(options, frame);
  std::vector<double> depth, border;
  for (int k = 0; k < options.base_steps; ++k) {
    depth.push_back(extent.depth * k / (options.base_steps - 1));
    if (k > 0) border.push_back(extent.half_across * (2.0 * k / options.base_steps - 1) + extent.shift);
  }
  return BaseBands(depth, border, turn_of(options));
}

TriangleMesh base_shape(const ReliefOptions& options, const ViewFrame& frame) {
  const double size = options.width_mm;
  const auto [depth, reach, half_across, shift] = extent_of(options, frame);
  const double pitch = options.base_pitch_mm ? *options.base_pitch_mm / size : 2 * half_across;
  switch (options.base) {
    case BaseShape::cylinder:
      if (depth >= half_across)
        throw Error(ErrorCode::invalid_input, "base_depth_mm",
                    "The cylinder would have to be deeper than half its width: make the base's depth less than " +
                        with_digits(std::floor(half_across * size), 4) + " mm, or the relief wider.");
      return swept(cylinder(depth, reach, half_across).shifted(shift), reach, turn_of(options));
    case BaseShape::wave:
      if (pitch * max_waves < 2 * reach)
        throw Error(ErrorCode::invalid_input, "base_pitch_mm",
                    "The waves are too short for this width: make them at least " +
                        with_decimals(2 * reach * size / max_waves + 0.05, 1) + " mm long.");
      return swept(wave(depth, reach, pitch).shifted(shift), reach, turn_of(options));
    case BaseShape::strips: {
      const BaseStrips folded = base_strips(options, frame, half_across, turn_of(options));
      const double spread = 1 + frame.kappa * *std::ranges::max_element(folded.z);
      return swept(strips(folded, reach * spread), reach * spread, turn_of(options));
    }
    case BaseShape::stairs: return swept(stairs(*base_bands(options, frame), reach), reach, turn_of(options));
    default: return swept(groove(depth, reach, pitch).shifted(shift), reach, turn_of(options));
  }
}

TriangleMesh base_from_file(const TriangleMesh& mesh, const ReliefOptions& options) {
  if (mesh.F.rows() == 0)
    throw Error(ErrorCode::invalid_input, "base_mesh", "The base has no triangles: choose another file.");
  TriangleMesh base = mesh;
  if (options.base_mesh_turn_deg != 0) {
    const double turn = options.base_mesh_turn_deg * std::numbers::pi / 180;
    const Eigen::VectorXd x = base.V.col(0), y = base.V.col(1);
    base.V.col(0) = std::cos(turn) * x - std::sin(turn) * y;
    base.V.col(1) = std::sin(turn) * x + std::cos(turn) * y;
  }
  base.V.rowwise() += Eigen::RowVector3d(options.base_mesh_x_mm, options.base_mesh_y_mm, options.base_mesh_z_mm);
  base.V /= options.width_mm;
  base.V.col(2) *= -1;  // away from the viewer
  return base;
}

}  // namespace formwright
