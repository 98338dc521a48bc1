// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/curve/crease_alignment.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/mesh/measures.h"
#include "geometry/operators/nonnegative_laplacian.h"

namespace formwright {
namespace {

/// A vertex of a crease, and what takes it to the nearest line.
struct Pull {
  int vertex = 0, corner = 0, part = 0;
  double shift_mm = 0, spacing_mm = 0;
  bool released = false;  // too far off
};

class Aligner {
 public:
  Aligner(const Segmentation& s, const Parameterisation& p, CreaseSystem& system, const FeatureLines& features,
          const std::vector<SpiralLine>& lines, const CreaseAlignmentOptions& options)
      : s_(s),
        p_(p),
        system_(system),
        features_(features),
        lines_(lines),
        options_(options),
        adjacency_(system.adjacency()),
        edge_mm_(mean_edge_length(s.mesh)) {}

  std::vector<Pull> pulls() const {
    std::vector<Pull> result;
    for (const FeaturePoint& point : features_.points) {
      const auto around = adjacency_.outgoing(point.vertex);
      if (system_.on_a_line(point.vertex) || around.empty()) continue;
      Pull pull;
      pull.vertex = point.vertex, pull.corner = around.front(), pull.part = s_.face_segment[around.front() / 3];
      if (nearest_line(pull, point)) result.push_back(pull);
    }
    return result;
  }

  /// D per vertex.
  Eigen::VectorXd field(const std::vector<Pull>& pulls, Context& context) const {
    std::vector<CreaseSystem::Pull> springs;
    for (const Pull& pull : pulls)
      if (!pull.released) springs.push_back({pull.vertex, 20 * edge_mm_ / pull.spacing_mm, pull.shift_mm});
    return system_.field(springs, context);
  }

  /// 1 + dD/dy of a triangle: how much closer together lines come, and its area's change.
  double closeness(int face, const Eigen::VectorXd& d) const {
    const auto area = [&](const auto& y) {
      const double x0 = p_.corners_mm(3 * face, 0), x1 = p_.corners_mm(3 * face + 1, 0) - x0,
                   x2 = p_.corners_mm(3 * face + 2, 0) - x0;
      return x1 * (y(2) - y(0)) - x2 * (y(1) - y(0));
    };
    const double before = area([&](int k) { return p_.corners_mm(3 * face + k, 1); });
    return before > 0 ? 1 + area([&](int k) { return d[s_.mesh.F(face, k)]; }) / before : 1;
  }

  bool too_close(double closeness) const {
    return !(closeness <= 1 / options_.min_spacing && closeness >= options_.min_spacing);
  }

 private:
  /// The chart's image of a tangent at a vertex, averaged over its triangles.
  Vec2 in_chart(int v, const Vec3& along) const {
    Vec2 image = Vec2::Zero();
    for (const int h : adjacency_.outgoing(v)) {
      const int a = h, b = next_halfedge(h), c = previous_halfedge(h);
      const auto place = [&](int corner) { return Vec3(s_.mesh.V.row(s_.mesh.F(corner / 3, corner % 3)).transpose()); };
      const auto chart = [&](int corner) { return Vec2(p_.corners_mm(corner, 0), p_.corners_mm(corner, 1)); };
      Eigen::Matrix<double, 3, 2> sides;
      sides << place(b) - place(a), place(c) - place(a);
      const Vec2 share = sides.colPivHouseholderQr().solve(along);
      if (share.allFinite()) image += share.x() * (chart(b) - chart(a)) + share.y() * (chart(c) - chart(a));
    }
    return image;
  }

  bool nearest_line(Pull& pull, const FeaturePoint& point) const {
    const double x = p_.corners_mm(pull.corner, 0), y = p_.corners_mm(pull.corner, 1), period = p_.period_mm[pull.part],
                 height = p_.height_mm[pull.part];
    const Vec2 direction = in_chart(pull.vertex, point.along);
    double best = 1e300;
    int count = 0;
    for (const SpiralLine& line : lines_) {
      if (line.part != pull.part) continue;
      ++count;
      const double slope = height / (line.x_high_mm - line.x_low_mm);
      const double angle = std::abs(std::atan2(direction.y(), direction.x()) - std::atan(slope));
      if (std::min(std::fmod(angle, std::numbers::pi), std::numbers::pi - std::fmod(angle, std::numbers::pi)) >
          options_.steepest_rad)
        return false;
      const double off = x - line.x_low_mm - y / slope, nearest = off - period * std::round(off / period);
      const double shift = slope * nearest;
      pull.spacing_mm = slope * period;
      // Lines end where the part does.
      if (y + shift > 0.02 * height && y + shift < 0.98 * height && std::abs(shift) < std::abs(best)) best = shift;
    }
    if (best > 1e299) return false;
    pull.spacing_mm /= count;
    pull.shift_mm = best;
    const double release = std::min(options_.release, 0.5 - pull.spacing_mm / period);
    pull.released = release < 0.1 || std::abs(best) > release * pull.spacing_mm;
    return true;
  }

  const Segmentation& s_;
  const Parameterisation& p_;
  CreaseSystem& system_;
  const FeatureLines& features_;
  const std::vector<SpiralLine>& lines_;
  const CreaseAlignmentOptions& options_;
  const Adjacency& adjacency_;
  double edge_mm_;
};

}  // namespace

CreaseSystem::CreaseSystem(const Segmentation& s, Context& context) : adjacency_(s.mesh) {
  const int n = s.mesh.vertex_count();
  SparseMatrix system = nonnegative_laplacian(s.mesh, adjacency_);
  for (int v = 0; v < n; ++v) {
    const auto around = adjacency_.outgoing(v);
    on_a_line_.push_back(adjacency_.is_boundary_vertex(v) || std::any_of(around.begin(), around.end(), [&](int h) {
                           return s.face_segment[h / 3] != s.face_segment[around.front() / 3];
                         }));
    system.coeffRef(v, v) += on_a_line_.back() ? 1e8 : 1e-9;
  }
  lower_ = system.triangularView<Eigen::Lower>();
  cholesky_.analyze(lower_, s.mesh.V, context);
}

Eigen::VectorXd CreaseSystem::field(const std::vector<Pull>& pulls, Context& context) {
  const std::scoped_lock lock(mutex_);
  SparseMatrix system = lower_;
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(system.rows(), 1);
  for (const Pull& pull : pulls) {
    system.coeffRef(pull.vertex, pull.vertex) += pull.spring;
    d(pull.vertex, 0) += pull.spring * pull.value_mm;
  }
  cholesky_.factorize(system, context);
  cholesky_.solve(d);
  for (int v = 0; v < d.rows(); ++v)
    if (on_a_line(v)) d(v, 0) = 0;
  return d.col(0);
}

CreaseAlignment align_to_creases(const Segmentation& s, const Parameterisation& p, CreaseSystem& system,
                                 const FeatureLines& features, const std::vector<SpiralLine>& lines,
                                 const CreaseAlignmentOptions& options, Context& context) {
  CreaseAlignment result;
  result.parameterisation = p;
  const Aligner aligner(s, p, system, features, lines, options);
  std::vector<Pull> pulls = aligner.pulls();
  if (pulls.empty()) return result;
  const double edge_mm = mean_edge_length(s.mesh);
  Eigen::VectorXd d;
  // Creases too close to each other, or to a border, would crowd the lines: what pulls there is let go.
  for (int round = 0; round < 4; ++round) {
    context.check_cancelled();
    d = aligner.field(pulls, context);
    std::vector<char> crowded(s.mesh.vertex_count(), 0);
    bool any = false;
    for (int f = 0; f < s.mesh.face_count(); ++f)
      if (aligner.too_close(aligner.closeness(f, d)))
        for (int k = 0; k < 3; ++k) crowded[s.mesh.F(f, k)] = 1;
    for (Pull& pull : pulls)
      if (!pull.released && crowded[pull.vertex]) pull.released = any = true;
    if (!any) break;
  }
  // What is still too close, part by part, by a smaller change.
  std::vector<double> share(s.part_count(), 1);
  for (int f = 0; f < s.mesh.face_count(); ++f) {
    const double change = aligner.closeness(f, d) - 1;
    double& t = share[s.face_segment[f]];
    if (change > 0) t = std::min(t, (1 / options.min_spacing - 1) / change);
    if (change < 0) t = std::min(t, (1 - options.min_spacing) / -change);
  }
  for (int f = 0; f < s.mesh.face_count(); ++f) {
    const double t = share[s.face_segment[f]], closeness = 1 + t * (aligner.closeness(f, d) - 1);
    result.min_spacing = std::min(result.min_spacing, 1 / closeness),
    result.max_spacing = std::max(result.max_spacing, 1 / closeness);
    for (int k = 0; k < 3; ++k) result.parameterisation.corners_mm(3 * f + k, 1) += t * d[s.mesh.F(f, k)];
  }
  result.crease_mm = edge_mm * static_cast<double>(pulls.size());
  for (const Pull& pull : pulls) {
    result.off_before_mm += std::abs(pull.shift_mm) / static_cast<double>(pulls.size());
    // Past the middle between two lines it is the other one.
    const double off = std::abs(share[pull.part] * d[pull.vertex] - pull.shift_mm);
    result.off_after_mm += std::min(off, std::abs(pull.spacing_mm - off)) / static_cast<double>(pulls.size());
  }
  return result;
}

}  // namespace formwright
