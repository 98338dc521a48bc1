// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/photographs/mark_edges.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/statistics.h"
#include "evidence/photographs/mark_code.h"

namespace formwright {
namespace {

constexpr double used_share = 0.88;  // of an edge's length: at its ends the other edge's blur bends it
constexpr int max_profiles = 64;     // along an edge
constexpr int min_profiles = 8;
constexpr double reach_cells = 0.5;  // of a profile, to each side: a cell inside of the edge other cells begin
constexpr double max_reach_px = 12;
constexpr double profile_ends = 11.0 / 12;  // of the reach: three places there, on the average, show black and white
constexpr double dark_share = 0.2;          // of an edge's profiles, that end beside a black cell
constexpr double min_contrast = 1500;       // of 65535 of light between black and white
constexpr double min_kept = 0.6;            // of an edge's profiles, for the edge to count
constexpr double floor_px = 0.02;           // least scatter of an edge that is believed
constexpr double own_error_px = 0.06;       // of a corner: pixels, compression and blur that no scatter shows
constexpr double shared_error_px = 0.04;    // the same that all photographs share: blur acts alike on the same mark
constexpr double sharp_cells = 0.3;     // standard deviation of blur, up to which these two hold; then with its square
constexpr double alike_profiles = 2.0;  // neighbouring profiles share pixels and blur: so many count as one

/// offset(s) = c0 + c1 s + c2 s^2 across the chord, s from -1 to 1 along it.
struct Edge {
  Vec2 middle, half, normal;  // of the chord; the normal points out of the square
  Vec3 coefficients;
  Eigen::Matrix3d covariance;
  double blur_px = 0;  // across the edge, standard deviation

  Vec2 at(double s) const { return middle + s * half + offset(s) * normal; }
  double offset(double s) const { return coefficients.dot(Vec3(1, s, s * s)); }
  Vec2 tangent(double s) const { return half + (coefficients[1] + 2 * coefficients[2] * s) * normal; }
  double variance(double s) const {
    const Vec3 row(1, s, s * s);
    return row.dot(covariance * row);
  }
};

/// Where a profile crosses a level and how steeply, and the light at its ends.
struct Crossing {
  double offset = 0, inner = 0, outer = 0, slope_per_px = 0;
};

/// The profile through `foot` along `normal`: where it is halfway between its inner and its outer end, or at `level`.
std::optional<Crossing> crossing(const LightPicture& picture, const Vec2& foot, const Vec2& normal, double reach,
                                 std::optional<double> common_level) {
  double centre = 0;
  Crossing found;
  for (int round = 0; round < 3; ++round) {
    constexpr int half_count = 12;
    std::array<double, 2 * half_count + 1> value;
    const double step = reach / half_count;
    for (int i = -half_count; i <= half_count; ++i)
      value[static_cast<std::size_t>(i + half_count)] = picture.bilinear(foot + (centre + i * step) * normal);
    found.inner = (value[0] + value[1] + value[2]) / 3;
    found.outer = (value[2 * half_count] + value[2 * half_count - 1] + value[2 * half_count - 2]) / 3;
    if (found.outer - found.inner < min_contrast) return std::nullopt;
    const double level = common_level.value_or(0.5 * (found.inner + found.outer));
    double best = 2 * reach;
    for (int i = -half_count; i < half_count; ++i) {
      const double a = value[static_cast<std::size_t>(i + half_count)],
                   b = value[static_cast<std::size_t>(i + half_count + 1)];
      if (!(a < level && b >= level)) continue;
      const double t = (i + (level - a) / (b - a)) * step;
      if (std::abs(t) < std::abs(best)) best = t, found.slope_per_px = (b - a) / step;
    }
    if (std::abs(best) > reach) return std::nullopt;
    centre += best;
    if (std::abs(centre) > 1.5 * reach) return std::nullopt;
    if (std::abs(best) < 0.01) break;
  }
  found.offset = centre;
  return found;
}

/// Standard deviation sigma of a Gaussian that blurs a step, from the light's difference between `end` before and
/// behind it over its slope there: difference / slope = sqrt(2 pi) sigma erf(end / (sqrt(2) sigma)), which tends to 2
/// end.
double blur_of(double difference_over_slope, double end) {
  double low = 0, high = 3 * end;
  for (int round = 0; round < 30; ++round) {
    const double sigma = 0.5 * (low + high);
    const double would_be = std::sqrt(2 * std::numbers::pi) * sigma * std::erf(end / (std::numbers::sqrt2 * sigma));
    (would_be < difference_over_slope ? low : high) = sigma;
  }
  return 0.5 * (low + high);
}

std::optional<Edge> fit_edge(const LightPicture& picture, const Vec2& from, const Vec2& to, double reach) {
  Edge edge;
  edge.middle = 0.5 * (from + to);
  edge.half = 0.5 * (to - from);
  const double length = 2 * edge.half.norm();
  if (!(length > 6)) return std::nullopt;
  edge.normal = Vec2(edge.half.y(), -edge.half.x()).normalized();  // clockwise, y down: outwards
  const int count = std::clamp(static_cast<int>(used_share * length), min_profiles, max_profiles);
  const double least = std::max<double>(min_profiles - 2, min_kept * count);
  std::vector<Vec2> places;  // s, offset
  std::optional<double> level;
  for (int pass = 0; pass < 2; ++pass) {
    places.clear();
    std::vector<double> inner, outer, slope;
    for (int i = 0; i < count; ++i) {
      const double s = used_share * (2 * (i + 0.5) / count - 1);
      const auto found = crossing(picture, edge.middle + s * edge.half, edge.normal, reach, level);
      if (!found) continue;
      places.emplace_back(s, found->offset);
      inner.push_back(found->inner);
      outer.push_back(found->outer);
      slope.push_back(found->slope_per_px);
    }
    if (static_cast<double>(places.size()) < least) return std::nullopt;
    // White cells behind the border shine through it where the picture is blurred: the darkest fifth shows black.
    const double black = quantile(inner, dark_share), white = median(outer);
    level = 0.5 * (black + white);
    edge.blur_px = blur_of((white - black) / std::max(median(slope), 1e-9), profile_ends * reach);
  }
  std::vector<double> weight(places.size(), 1.0);
  double sigma = 0, kept = 0;
  for (int round = 0; round < 5; ++round) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Vec3 right = Vec3::Zero();
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Vec3 row(1, places[i].x(), places[i].x() * places[i].x());
      normal += weight[i] * row * row.transpose();
      right += weight[i] * places[i].y() * row;
    }
    const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
    if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > 1e-9)) return std::nullopt;
    edge.coefficients = solver.solve(right);
    edge.covariance = solver.solve(Eigen::Matrix3d::Identity());
    std::vector<double> distance(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) distance[i] = std::abs(places[i].y() - edge.offset(places[i].x()));
    sigma = std::max(floor_px, 1.4826 * median(distance));
    kept = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double share = distance[i] / (4 * sigma);
      weight[i] = share < 1 ? (1 - share * share) * (1 - share * share) : 0;  // Tukey's biweight
      kept += share < 0.75 ? 1 : 0;
    }
  }
  if (kept < least || !edge.coefficients.allFinite()) return std::nullopt;
  edge.covariance *= sigma * sigma * alike_profiles;
  return edge;
}

/// Where edge `a` ends and edge `b` begins.
std::optional<Vec2> intersection(const Edge& a, const Edge& b, double& s_a, double& s_b) {
  s_a = 1;
  s_b = -1;
  for (int round = 0; round < 8; ++round) {
    const Vec2 gap = b.at(s_b) - a.at(s_a);
    Eigen::Matrix2d m;
    m << a.tangent(s_a), -b.tangent(s_b);
    if (!(std::abs(m.determinant()) > 0.1 * a.half.norm() * b.half.norm())) return std::nullopt;
    const Vec2 step = m.inverse() * gap;
    s_a += step.x();
    s_b += step.y();
    if (!(std::abs(s_a - 1) < 0.6 && std::abs(s_b + 1) < 0.6)) return std::nullopt;
  }
  return a.at(s_a);
}

std::optional<SquareCorners> refine_once(const LightPicture& picture, const std::array<Vec2, 4>& first) {
  const double area = 0.5 * std::abs((first[2] - first[0]).x() * (first[3] - first[1]).y() -
                                     (first[2] - first[0]).y() * (first[3] - first[1]).x());
  std::array<Edge, 4> edges;
  std::array<double, 4> error_by_blur;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec2 &from = first[k], &to = first[(k + 1) % 4];
    const double cell = area / std::max(1.0, (to - from).norm()) / mark_cells;
    const auto edge = fit_edge(picture, from, to, std::clamp(reach_cells * cell, 1.5, max_reach_px));
    if (!edge) return std::nullopt;
    edges[k] = *edge;
    error_by_blur[k] = std::max(1.0, std::pow(edge->blur_px / (sharp_cells * cell), 2));
  }
  SquareCorners result;
  for (std::size_t k = 0; k < 4; ++k) {
    const Edge &a = edges[(k + 3) % 4], &b = edges[k];
    double s_a = 0, s_b = 0;
    const auto corner = intersection(a, b, s_a, s_b);
    if (!corner) return std::nullopt;
    result.corner_px[k] = *corner;
    // Each edge holds the corner across itself; errors of both make the corner's.
    const Vec2 along_a = a.tangent(s_a).normalized(), along_b = b.tangent(s_b).normalized();
    Eigen::Matrix2d across;
    across << along_a.y(), -along_a.x(), along_b.y(), -along_b.x();
    const Eigen::Matrix2d back = across.inverse();
    const double by_blur = std::hypot(error_by_blur[(k + 3) % 4], error_by_blur[k]) / std::sqrt(2.0);
    result.shared_px[k] = by_blur * shared_error_px;
    result.covariance_px2[k] = back * Vec2(a.variance(s_a), b.variance(s_b)).asDiagonal() * back.transpose() +
                               std::pow(by_blur * own_error_px, 2) * Eigen::Matrix2d::Identity();
    if (!result.covariance_px2[k].allFinite()) return std::nullopt;
  }
  return result;
}

}  // namespace

std::optional<SquareCorners> refine_square(const LightPicture& picture, const std::array<Vec2, 4>& first_px) {
  const auto once = refine_once(picture, first_px);
  if (!once) return std::nullopt;
  return refine_once(picture, once->corner_px);
}

}  // namespace formwright
