// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/sheet/clamp_slip.h"

#include <algorithm>
#include <cmath>

namespace formwright {
namespace {

/// Of the shorter side: how far the average along the rim reaches either way, with the weights (1 - t^2)^2.
constexpr double average_reach = 0.15;

/// Way along the rim, from the front left corner, counter-clockwise.
double way_along_rim(const Vec2& at, const Vec2& opening) {
  const Vec2 from_corner = at + 0.5 * opening;
  const Vec2 to_corner = opening - from_corner;
  const double nearest = std::min({from_corner.y(), to_corner.x(), to_corner.y(), from_corner.x()});
  if (nearest == from_corner.y()) return from_corner.x();
  if (nearest == to_corner.x()) return opening.x() + from_corner.y();
  if (nearest == to_corner.y()) return opening.x() + opening.y() + to_corner.x();
  return 2 * opening.x() + opening.y() + to_corner.y();
}

/// Into the opening, of length 1; at a corner along its bisector.
Vec2 inward_normal(const Vec2& at, const Vec2& opening) {
  constexpr double on_side = 1 - 1e-9;
  const Vec2 share = 2 * at.cwiseQuotient(opening);
  const auto component = [&](double t) { return std::abs(t) < on_side ? 0.0 : (t > 0 ? -1.0 : 1.0); };
  return Vec2(component(share.x()), component(share.y())).normalized();
}

}  // namespace

ClampSlip::ClampSlip(const SheetMesh& sheet, const Vec2& opening_mm)
    : share_(sheet.clamped.size(), 0.0), inward_(sheet.clamped.size(), Vec2::Zero()) {
  std::vector<double> way(sheet.clamped.size());
  for (std::size_t v = 0; v < sheet.clamped.size(); ++v) {
    if (!sheet.clamped[v]) continue;
    const Vec2 at = sheet.flat_mm.row(static_cast<Eigen::Index>(v));
    const Vec2 share = 2 * at.cwiseQuotient(opening_mm);
    share_[v] = 1;
    inward_[v] = -share.cwiseProduct(share).cwiseProduct(share);
    way[v] = way_along_rim(at, opening_mm);
    rim_.push_back(static_cast<int>(v));
  }
  std::sort(rim_.begin(), rim_.end(),
            [&](int a, int b) { return way[static_cast<std::size_t>(a)] < way[static_cast<std::size_t>(b)]; });
  const double around = 2 * opening_mm.sum(), reach_mm = average_reach * opening_mm.minCoeff();
  const auto way_of = [&](std::size_t k) { return way[static_cast<std::size_t>(rim_[k % rim_.size()])]; };
  const auto apart = [&](std::size_t a, std::size_t b) {
    const double d = std::abs(way_of(a) - way_of(b));
    return std::min(d, around - d);
  };
  std::vector<double> length(rim_.size());
  for (std::size_t k = 0; k < rim_.size(); ++k) {
    length[k] = 0.5 * (apart(k, k + rim_.size() - 1) + apart(k, k + 1));
    normal_per_mm_.push_back(inward_normal(sheet.flat_mm.row(static_cast<Eigen::Index>(rim_[k])), opening_mm) /
                             length[k]);
  }
  averaged_.resize(rim_.size());
  for (std::size_t k = 0; k < rim_.size(); ++k) {
    double sum = 0;
    for (std::size_t j = 0; j < rim_.size(); ++j) {
      const double t = apart(k, j) / reach_mm, inside = 1 - t * t;
      if (!(inside > 0)) continue;
      averaged_[k].push_back({static_cast<int>(j), length[j] * inside * inside});
      sum += averaged_[k].back().weight;
    }
    for (Neighbour& neighbour : averaged_[k]) neighbour.weight /= sum;
  }
}

void ClampSlip::feel(const Positions& force) {
  std::vector<double> pull(rim_.size()), mean(rim_.size());
  for (std::size_t k = 0; k < rim_.size(); ++k)
    pull[k] = std::max(0.0, normal_per_mm_[k].dot(force.row(rim_[k]).head<2>().transpose()));
  for (std::size_t k = 0; k < rim_.size(); ++k)
    for (const Neighbour& neighbour : averaged_[k])
      mean[k] += neighbour.weight * pull[static_cast<std::size_t>(neighbour.vertex)];
  const double largest = *std::max_element(mean.begin(), mean.end());
  for (std::size_t k = 0; k < rim_.size(); ++k)
    share_[static_cast<std::size_t>(rim_[k])] = largest > 0 ? mean[k] * mean[k] / (largest * largest) : 1;
}

}  // namespace formwright
