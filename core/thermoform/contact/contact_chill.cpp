// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/contact/contact_chill.h"

#include <Eigen/Dense>
#include <algorithm>

#include "geometry/planar/plane.h"

namespace formwright {
namespace {

constexpr int max_sweeps = 200;
constexpr double settled_change = 1e-5;  // of a sweep's largest change

}  // namespace

ContactChill::ContactChill(const SheetMesh& sheet, double strength)
    : sheet_(sheet),
      strength_(strength),
      area_mm2_(static_cast<std::size_t>(sheet.flat_mm.rows())),
      chill_(static_cast<std::size_t>(sheet.flat_mm.rows())),
      factors_(static_cast<std::size_t>(sheet.F.rows()), 1) {
  // Cotangent weights, one entry a triangle's edge: two triangles' entries of the same edge add up by themselves.
  for (Eigen::Index f = 0; f < sheet.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = sheet.F(f, k), b = sheet.F(f, (k + 1) % 3), c = sheet.F(f, (k + 2) % 3);
      const Vec2 u = (sheet.flat_mm.row(a) - sheet.flat_mm.row(c)).transpose(),
                 v = (sheet.flat_mm.row(b) - sheet.flat_mm.row(c)).transpose();
      const double doubled_area = std::abs(cross(u, v));
      area_mm2_[static_cast<std::size_t>(c)] += doubled_area / 6;
      // A negative weight (an obtuse corner) would make chill out of nothing.
      if (const double weight = 0.5 * u.dot(v) / doubled_area; weight > 0) edges_.push_back({{a, b}, weight});
    }
}

void ContactChill::advance(double dt_s, const HeldVertices& held) {
  const std::size_t n = chill_.size();
  std::vector<double> source(n), diagonal(n, 1);
  bool any = false;
  for (std::size_t i = 0; i < n; ++i) {
    const bool touches = held[i] != 0 && !sheet_.clamped[i];
    any |= touches || chill_[i] > 0;
    source[i] = chill_[i] + (touches ? dt_s / chill_time_s : 0);
    if (touches) diagonal[i] += dt_s / chill_time_s;
  }
  if (!any) return;
  const double spread = dt_s * chill_reach_mm * chill_reach_mm / chill_time_s;
  for (const Edge& edge : edges_)
    for (const int v : edge.vertex)
      diagonal[static_cast<std::size_t>(v)] += spread * edge.weight / area_mm2_[static_cast<std::size_t>(v)];
  // Implicit Euler by Jacobi's sweeps, which treat mirrored vertices alike and keep chill between 0 and 1.
  std::vector<double> now = chill_, inflow(n);
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    std::fill(inflow.begin(), inflow.end(), 0);
    for (const Edge& edge : edges_) {
      const auto a = static_cast<std::size_t>(edge.vertex[0]), b = static_cast<std::size_t>(edge.vertex[1]);
      inflow[a] += edge.weight * now[b];
      inflow[b] += edge.weight * now[a];
    }
    double change = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double next = (source[i] + spread * inflow[i] / area_mm2_[i]) / diagonal[i];
      change = std::max(change, std::abs(next - now[i]));
      now[i] = next;
    }
    if (change < settled_change) break;
  }
  chill_ = std::move(now);
  for (Eigen::Index f = 0; f < sheet_.F.rows(); ++f) {
    double mean = 0;
    for (int k = 0; k < 3; ++k) mean += chill_[static_cast<std::size_t>(sheet_.F(f, k))] / 3;
    factors_[static_cast<std::size_t>(f)] = 1 + chilled_stiffness * strength_ * mean;
  }
}

}  // namespace formwright
