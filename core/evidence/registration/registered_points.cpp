// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/registration/registered_points.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/statistics.h"
#include "base/parallel.h"

namespace formwright {
namespace {

constexpr double pi = 3.14159265358979324;
constexpr double min_sigma_px = 0.025;      // interpolation between pixels
constexpr double max_residual_share = 0.5;  // of the pattern's variance; chance alone gives 2
constexpr double min_known_share = 0.7;     // of the area that a point is judged by
constexpr double max_foreign_share = 0.08;  // of a wider area that shows something else than the print
// The flow weighs changes of gradients too and averages noisy pictures over a wider area than reach_px says. Chosen
// on the virtual scans of tests/evidence/registration, where errors are 0.5 to 0.9 of what sigma says.
constexpr double variance_share = 0.3;
constexpr double kernel_share = 0.25;  // half the second moment, 2 l^2, over the square of the step, 2 l
constexpr double plain_margin_mm = 1;
constexpr double rim_inside_mm = 1;  // the sheet yields a little at the clamp's edge

/// Sums over a Gaussian window about a pixel.
struct Window {
  double trusted = 0, foreign = 0, xx = 0, xy = 0, yy = 0, residual_squared = 0;
};
/// `foreign_squared`: from which squared residual a pixel shows something that is not the print.
Window window_about(const FlowEvidence& e, const Flow& flow, double column, double row, double sigma_px,
                    double foreign_squared) {
  Window w;
  const int reach = static_cast<int>(std::ceil(2.5 * sigma_px));
  const int cx = static_cast<int>(std::lround(column)), cy = static_cast<int>(std::lround(row));
  for (int y = std::max(0, cy - reach); y <= std::min(flow.height - 1, cy + reach); ++y)
    for (int x = std::max(0, cx - reach); x <= std::min(flow.width - 1, cx + reach); ++x) {
      const double g = std::exp(-0.5 * ((x - column) * (x - column) + (y - row) * (y - row)) / (sigma_px * sigma_px));
      const std::size_t i = flow.index(x, y);
      const double weight = static_cast<double>(e.weight[i]), squared = static_cast<double>(e.residual_squared[i]);
      w.trusted += g * weight;
      if (squared > foreign_squared * weight) w.foreign += g * weight;
      w.xx += g * static_cast<double>(e.xx[i]);
      w.xy += g * static_cast<double>(e.xy[i]);
      w.yy += g * static_cast<double>(e.yy[i]);
      w.residual_squared += g * squared;
    }
  return w;
}

/// Medians over the pixels that were seen: of the squared residual (all channels) and of half the trace of the
/// derivatives' products.
struct Typical {
  double residual_squared = 0, information = 0;
};
Typical typical(const FlowEvidence& e) {
  std::vector<float> residuals, informations;
  for (std::size_t i = 0; i < e.weight.size(); i += 7)
    if (e.weight[i] > 0.5f) {
      residuals.push_back(e.residual_squared[i] / e.weight[i]);
      informations.push_back(0.5f * (e.xx[i] + e.yy[i]) / e.weight[i]);
    }
  return {static_cast<double>(median(std::move(residuals))), static_cast<double>(median(std::move(informations)))};
}

/// In a mark or a colour patch, where there is no noise to see.
bool is_plain(const CalibrationPattern& pattern, const Vec2& sheet_mm) {
  const auto in_mark = [&](const CornerMark& m) {
    return (sheet_mm - m.centre_mm).norm() < m.radius_mm + plain_margin_mm;
  };
  const auto in_patch = [&](const ColourPatch& p) {
    return (sheet_mm - p.centre_mm).cwiseAbs().maxCoeff() < p.side_mm / 2 + plain_margin_mm;
  };
  return std::any_of(pattern.marks.begin(), pattern.marks.end(), in_mark) ||
         std::any_of(pattern.patches.begin(), pattern.patches.end(), in_patch);
}

}  // namespace

Vec2 displacement_mm(const Flow& flow, const PlaneFrame& frame, const Vec2& place_mm) {
  const Vec2 p = frame.pixel(place_mm);
  const double x = std::clamp(p.x(), 0.0, flow.width - 1.0), y = std::clamp(p.y(), 0.0, flow.height - 1.0);
  const int x0 = std::min(static_cast<int>(x), std::max(0, flow.width - 2)),
            y0 = std::min(static_cast<int>(y), std::max(0, flow.height - 2));
  const int x1 = std::min(x0 + 1, flow.width - 1), y1 = std::min(y0 + 1, flow.height - 1);
  const auto at = [&](const std::vector<float>& values) {
    const double upper = static_cast<double>(values[flow.index(x0, y0)]) * (x0 + 1 - x) +
                         static_cast<double>(values[flow.index(x1, y0)]) * (x - x0);
    const double lower = static_cast<double>(values[flow.index(x0, y1)]) * (x0 + 1 - x) +
                         static_cast<double>(values[flow.index(x1, y1)]) * (x - x0);
    return upper * (y0 + 1 - y) + lower * (y - y0);
  };
  return frame.pixel_mm * Vec2(at(flow.u), -at(flow.v));
}

MatchStatistics match_statistics(const WeightedPicture& first, const WeightedPicture& second, const Flow& flow) {
  const int w = first.width, h = first.height;
  WeightedPicture difference(w, h);
  parallel_for(static_cast<std::size_t>(h), 32, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < w; ++x) {
        const std::size_t i = flow.index(x, y);
        const Float4 b = bicubic(second, static_cast<float>(x) + flow.u[i], static_cast<float>(y) + flow.v[i]);
        const float weight = b[3] * first.at(x, y)[3];
        difference.at(x, y) = b - first.at(x, y);
        difference.at(x, y)[3] = weight;
      }
  });
  MatchStatistics result;
  double sum[3] = {}, sum_first[3] = {}, square[3] = {}, square_first[3] = {}, both[3] = {}, seen = 0;
  for (std::size_t i = 0; i < difference.pixels.size(); ++i) {
    if (!(difference.pixels[i][3] > 0.5f)) continue;
    ++seen;
    for (int c = 0; c < 3; ++c) {
      const double a = static_cast<double>(first.pixels[i][c]) - 128,
                   b = a + static_cast<double>(difference.pixels[i][c]);
      sum_first[c] += a;
      sum[c] += b;
      square_first[c] += a * a;
      square[c] += b * b;
      both[c] += a * b;
    }
  }
  for (int c = 0; c < 3 && seen > 0; ++c) {
    const double variance =
        (square_first[c] - sum_first[c] * sum_first[c] / seen) * (square[c] - sum[c] * sum[c] / seen);
    if (variance > 0) result.similarity += (both[c] - sum_first[c] * sum[c] / seen) / std::sqrt(variance) / 3;
  }
  double squared = 0, across = 0, down = 0, pairs_across = 0, pairs_down = 0, count = 0;
  const auto product = [](const Float4& a, const Float4& b) {
    return static_cast<double>(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
  };
  // What is far off (a missing patch) is not noise.
  const auto is_noise = [](const Float4& p) {
    return p[3] > 0.5f && p[0] * p[0] + p[1] * p[1] + p[2] * p[2] < 3 * 60.0f * 60.0f;
  };
  for (int y = 0; y + 1 < h; ++y)
    for (int x = 0; x + 1 < w; ++x) {
      const Float4 &here = difference.at(x, y), &right = difference.at(x + 1, y), &below = difference.at(x, y + 1);
      if (!is_noise(here)) continue;
      squared += product(here, here);
      ++count;
      if (is_noise(right)) {
        across += product(here, right);
        ++pairs_across;
      }
      if (is_noise(below)) {
        down += product(here, below);
        ++pairs_down;
      }
    }
  if (!(squared > 0) || pairs_across < 1 || pairs_down < 1) return result;
  const double mean = squared / count;
  const auto along = [](double rho) { return (1 + std::clamp(rho, 0.0, 0.95)) / (1 - std::clamp(rho, 0.0, 0.95)); };
  result.residual_alike_px = along(across / pairs_across / mean) * along(down / pairs_down / mean);
  return result;
}

void add_points(ScanRegistration& result, const TriangleMesh& mesh, const TextureCoordinates& place_mm,
                const PlaneFrame& frame, const Flow& flow, const FlowEvidence& evidence,
                const CalibrationPattern& pattern, const ScanRegistrationOptions& options) {
  const PlaneLookup lookup(mesh.F, place_mm);
  const double pattern_variance = std::pow(255 * pattern.contrast, 2);
  const Typical usual = typical(evidence);
  const double foreign_squared = std::max(12 * usual.residual_squared, 300.0);
  // The length over which this flow averages, the same everywhere: where a place has less to tell, it is less certain.
  const double data = usual.information * (1 + 0.3 * options.gradient_weight) /
                      std::sqrt(usual.residual_squared + options.data_epsilon * options.data_epsilon);
  const double reach_px =
      std::clamp(std::sqrt(options.smoothness / options.smoothness_epsilon / std::max(data, 1e-9)), 2.0, 16.0);
  const int columns = static_cast<int>(std::floor(pattern.sheet_mm.x() / 2 / options.grid_mm)),
            rows = static_cast<int>(std::floor(pattern.sheet_mm.y() / 2 / options.grid_mm));
  const auto place_of = [&](const Vec2& s) -> std::optional<Vec3> {
    const PlaneLookup::Found at = lookup.find(s + displacement_mm(flow, frame, s));
    if (at.face < 0) return std::nullopt;
    Vec3 place = Vec3::Zero();
    for (int k = 0; k < 3; ++k) place += at.barycentric[k] * mesh.V.row(mesh.F(at.face, k)).transpose();
    return place;
  };
  for (int j = -rows; j <= rows; ++j)
    for (int i = -columns; i <= columns; ++i) {
      const Vec2 sheet(i * options.grid_mm, j * options.grid_mm), there = sheet + displacement_mm(flow, frame, sheet),
                                                                  pixel = frame.pixel(sheet);
      const PlaneLookup::Found found = lookup.find(there);
      ++result.points_without_evidence;
      if (found.face < 0 || is_plain(pattern, sheet)) continue;
      const Window near = window_about(evidence, flow, pixel.x(), pixel.y(), reach_px, foreign_squared);
      const Window around = window_about(evidence, flow, pixel.x(), pixel.y(), 4 * reach_px, foreign_squared);
      if (!(near.trusted > min_known_share * 2 * pi * reach_px * reach_px)) continue;
      if (around.foreign > max_foreign_share * around.trusted) continue;
      const double variance = near.residual_squared / near.trusted / 3;
      if (variance > max_residual_share * pattern_variance) continue;
      Eigen::Matrix2d information;
      information << near.xx, near.xy, near.xy, near.yy;
      information *= 4 * pi * reach_px * reach_px / near.trusted;
      if (!(information.determinant() > 1e-9)) continue;
      const double alike = std::min(result.residual_correlation_px, 4 * pi * reach_px * reach_px);
      Eigen::Matrix2d covariance = variance_share * variance * alike * information.inverse() +
                                   min_sigma_px * min_sigma_px * Eigen::Matrix2d::Identity();
      covariance *= frame.pixel_mm * frame.pixel_mm;
      covariance(0, 1) = covariance(1, 0) = -covariance(0, 1);  // rows run down
      // From the plane to the surface.
      const auto corner = [&](int k) { return Vec3(mesh.V.row(mesh.F(found.face, k))); };
      const auto flat = [&](int k) { return Vec2(place_mm.row(mesh.F(found.face, k))); };
      Eigen::Matrix2d edges;
      edges << flat(1) - flat(0), flat(2) - flat(0);
      Eigen::Matrix<double, 3, 2> sides;
      sides << corner(1) - corner(0), corner(2) - corner(0);
      const Eigen::Matrix<double, 3, 2> slope = sides * edges.inverse();
      // Smoothing rounds off sudden changes of stretch: half the kernel's second moment times the second derivative of
      // the map, along the surface.
      double rounded_squared = 0;
      const double step_mm = 2 * reach_px * frame.pixel_mm;
      const Vec3 outwards = slope.col(0).cross(slope.col(1)).normalized();
      for (const Vec2& step : {Vec2(step_mm, 0), Vec2(0, step_mm)}) {
        const std::optional<Vec3> before = place_of(sheet - step), here = place_of(sheet),
                                  after = place_of(sheet + step);
        if (!before || !here || !after) continue;
        const Vec3 bend = *before - 2 * *here + *after;
        rounded_squared += std::pow(kernel_share, 2) * (bend - outwards.dot(bend) * outwards).squaredNorm();
      }
      const double sigma = std::sqrt(0.5 * (slope * covariance * slope.transpose()).trace() + rounded_squared +
                                     options.scan_sigma_mm * options.scan_sigma_mm);
      if (!(sigma <= options.max_sigma_mm)) continue;
      Vec3 place = Vec3::Zero();
      for (int k = 0; k < 3; ++k) place += found.barycentric[k] * corner(k);
      result.points.push_back({sheet, place, sigma});
      --result.points_without_evidence;
    }
}

void align_by_rim(ScanRegistration& result, const CalibrationPattern& pattern, const ScanRegistrationOptions& options) {
  const Vec2 half = pattern.opening_mm / 2 + Vec2::Constant(rim_inside_mm);
  std::vector<std::size_t> rim;
  int sides = 0;
  for (std::size_t i = 0; i < result.points.size(); ++i) {
    const Vec2& s = result.points[i].sheet_mm;
    if (std::abs(s.x()) <= half.x() && std::abs(s.y()) <= half.y()) continue;
    rim.push_back(i);
    if (s.x() > half.x()) sides |= 1;
    if (s.x() < -half.x()) sides |= 2;
    if (s.y() > half.y()) sides |= 4;
    if (s.y() < -half.y()) sides |= 8;
  }
  const int seen_sides = (sides & 1) + (sides >> 1 & 1) + (sides >> 2 & 1) + (sides >> 3 & 1);
  if (rim.size() < 12 || seen_sides < 3) {
    result.notes.push_back(
        "The scan does not show the clamped rim on at least three sides, so the points keep the scan's coordinates: align them with the machine's before comparing.");
    return;
  }
  Eigen::Matrix4d move = Eigen::Matrix4d::Identity(), scaled = move;
  const auto at = [&](const Vec3& p) { return Vec3((move * p.homogeneous()).head<3>()); };
  const auto held = [&](std::size_t i) {
    const Vec2 place = (options.sheet_turned ? -1.0 : 1.0) * result.points[i].sheet_mm;
    return Vec3(place.x(), place.y(), options.clamp_height_mm + options.sheet_thickness_mm / 2);
  };
  const auto miss = [&](std::size_t i) { return (at(result.points[i].place_mm) - held(i)).norm(); };
  double squared = 0;
  for (int pass = 0; pass < 3; ++pass) {
    Eigen::Matrix3Xd from(3, rim.size()), to(3, rim.size());
    for (std::size_t i = 0; i < rim.size(); ++i) {
      from.col(static_cast<Eigen::Index>(i)) = result.points[rim[i]].place_mm;
      to.col(static_cast<Eigen::Index>(i)) = held(rim[i]);
    }
    move = Eigen::umeyama(from, to, false);
    scaled = Eigen::umeyama(from, to, true);
    squared = 0;
    for (const std::size_t i : rim) squared += miss(i) * miss(i) / static_cast<double>(rim.size());
    // Points that a wrong match has carried off would turn all the others.
    std::vector<double> misses;
    for (const std::size_t i : rim) misses.push_back(miss(i));
    const double limit = 4 * median(std::move(misses)) + 1e-9;
    if (pass < 2) std::erase_if(rim, [&](std::size_t i) { return miss(i) > limit; });
  }
  result.rim_rms_mm = std::sqrt(squared);
  result.rim_scale = scaled.block<3, 1>(0, 0).norm();
  if (options.coordinates == ScanCoordinates::scan) return;
  for (RegisteredPoint& p : result.points) p.place_mm = at(p.place_mm);
  result.in_machine_coordinates = true;
  if (std::abs(*result.rim_scale - 1) > 0.01)
    result.notes.push_back("The scanned rim is " +
                           std::to_string(static_cast<int>(std::lround(100 * std::abs(1 - 1 / *result.rim_scale)))) +
                           " % too " + (*result.rim_scale > 1 ? "small" : "large") +
                           " in the scan: correct the scale of the scan, or scan_unit_mm.");
}

}  // namespace formwright
