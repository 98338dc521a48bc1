// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/photographs/bundle.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/index.h"
#include "base/statistics.h"

namespace formwright {
namespace {

constexpr double unseen_distance = 1e6;        // whitened, of what lies behind its camera
constexpr double gauge_sigma_mm = 1e-3;        // how exactly the strips' mean shift is held at 0
constexpr double median_of_rayleigh = 1.1774;  // median length of a vector of two standard normals
constexpr int shared_max = Lens::unknowns + Pose::unknowns + StripPlace::unknowns;

using SharedRow = Eigen::Matrix<double, 2, shared_max>;

/// Where the unknowns of each part stand in the vector of all that are not points.
struct Layout {
  std::array<int, 4> strip{};
  int lens_begin = 0, camera_begin = 0, size = 0;

  explicit Layout(const Bundle& b) {
    std::array<bool, 4> seen{};
    for (const BundleObservation& o : b.observations)
      if (o.used && o.strip >= 0) seen[index(o.strip)] = true;
    for (std::size_t k = 0; k < 4; ++k) {
      strip[k] = seen[k] ? size : -1;
      if (seen[k]) size += StripPlace::unknowns;
    }
    lens_begin = size;
    size += Lens::unknowns * static_cast<int>(b.lenses.size());
    camera_begin = size;
    size += Pose::unknowns * static_cast<int>(b.cameras.size());
  }
  int lens(int i) const { return lens_begin + Lens::unknowns * i; }
  int camera(int i) const { return camera_begin + Pose::unknowns * i; }
};

Vec2 turned_by(const Vec2& p, double angle) {
  return {std::cos(angle) * p.x() - std::sin(angle) * p.y(), std::sin(angle) * p.x() + std::cos(angle) * p.y()};
}

/// One observation, whitened: residual and derivatives.
struct Row {
  Vec2 residual{0, 0};
  SharedRow shared = SharedRow::Zero();
  Eigen::Matrix<double, 2, 3> point = Eigen::Matrix<double, 2, 3>::Zero();
  std::array<int, shared_max> column{};
  int columns = 0;
};

Eigen::Matrix2d whitening(const Eigen::Matrix2d& covariance) {
  const Eigen::LLT<Eigen::Matrix2d> llt(covariance);
  return llt.matrixL().solve(Eigen::Matrix2d::Identity());
}

std::optional<Row> row_of(const Bundle& b, const Layout& layout, const BundleObservation& o, bool with_derivatives) {
  const BundleCamera& camera = b.cameras[index(o.camera)];
  const Lens& lens = b.lenses[index(camera.lens)];
  ProjectionDerivatives d;
  const auto at = project(lens, camera.pose, b.place_mm(o), with_derivatives ? &d : nullptr);
  if (!at) return std::nullopt;
  const Eigen::Matrix2d whiten = whitening(o.covariance_px2);
  Row row;
  row.residual = whiten * (*at - o.picture_px);
  if (!with_derivatives) return row;
  const auto append = [&](int first, const auto& block) {
    for (int k = 0; k < block.cols(); ++k) {
      row.shared.col(row.columns) = whiten * block.col(k);
      row.column[index(row.columns++)] = first + k;
    }
  };
  append(layout.lens(camera.lens), d.lens);
  append(layout.camera(o.camera), d.pose);
  if (o.strip >= 0) {
    const StripPlace& s = b.strips[index(o.strip)];
    const Vec2 p = turned_by(o.from_origin_mm, s.turn_rad);
    Eigen::Matrix<double, 2, 3> block;
    block << d.point.col(0), d.point.col(1), d.point.leftCols<2>() * Vec2(-p.y(), p.x());
    append(layout.strip[index(o.strip)], block);
  } else {
    row.point = whiten * d.point;
  }
  return row;
}

/// Normal equations with the points eliminated.
struct Normal {
  Eigen::MatrixXd shared;
  Eigen::VectorXd right;
  std::vector<Eigen::Matrix3d> point;  // sum of Jp^T Jp
  std::vector<Vec3> point_right;
  double cost = 0;
};

class Adjustment {
 public:
  Adjustment(Bundle& bundle, const Context& context) : b_(bundle), context_(context), layout_(bundle) {
    of_point_.resize(bundle.points.size());
    for (std::size_t i = 0; i < bundle.observations.size(); ++i)
      if (bundle.observations[i].used && bundle.observations[i].point >= 0)
        of_point_[index(bundle.observations[i].point)].push_back(i);
  }

  /// The loss of a squared whitened distance, and its derivative by it.
  double loss(double squared, double* weight) const {
    if (scale_ <= 0) {
      if (weight) *weight = 1;
      return squared;
    }
    const double c2 = scale_ * scale_ * 6;  // 2.4 usual distances
    if (weight) *weight = 1 / (1 + squared / c2);
    return c2 * std::log1p(squared / c2);
  }

  void set_scale(double scale) { scale_ = scale; }

  std::optional<double> cost() const {
    double sum = 0;
    for (const BundleObservation& o : b_.observations) {
      if (!o.used) continue;
      const auto row = row_of(b_, layout_, o, false);
      sum += loss(row ? row->residual.squaredNorm() : unseen_distance * unseen_distance, nullptr);
    }
    sum += priors(nullptr);
    if (!std::isfinite(sum)) return std::nullopt;
    return sum;
  }

  void linearise() {
    const int n = layout_.size;
    normal_.shared.setZero(n, n);
    normal_.right.setZero(n);
    normal_.point.assign(b_.points.size(), Eigen::Matrix3d::Zero());
    normal_.point_right.assign(b_.points.size(), Vec3::Zero());
    rows_.assign(b_.observations.size(), std::nullopt);
    normal_.cost = 0;
    for (std::size_t i = 0; i < b_.observations.size(); ++i) {
      if (i % 512 == 0) context_.check_cancelled();
      const BundleObservation& o = b_.observations[i];
      if (!o.used) continue;
      auto row = row_of(b_, layout_, o, true);
      double weight = 1;
      normal_.cost += loss(row ? row->residual.squaredNorm() : unseen_distance * unseen_distance, &weight);
      if (!row) continue;
      const double root = std::sqrt(weight);
      row->residual *= root;
      row->shared *= root;
      row->point *= root;
      for (int k = 0; k < row->columns; ++k) {
        normal_.right[row->column[index(k)]] += row->shared.col(k).dot(row->residual);
        for (int l = 0; l < row->columns; ++l)
          normal_.shared(row->column[index(k)], row->column[index(l)]) += row->shared.col(k).dot(row->shared.col(l));
      }
      if (o.point >= 0) {
        normal_.point[index(o.point)] += row->point.transpose() * row->point;
        normal_.point_right[index(o.point)] += row->point.transpose() * row->residual;
      }
      rows_[i] = std::move(row);
    }
    normal_.cost += priors(&normal_);
  }

  /// The shared part after the elimination of the points, damped; the inverse of each point's block is kept.
  bool reduce(double damping, Eigen::MatrixXd& s, Eigen::VectorXd& g) {
    s = normal_.shared;
    for (int i = 0; i < layout_.size; ++i) s(i, i) *= 1 + damping;
    g = normal_.right;
    inverse_.resize(b_.points.size());
    for (std::size_t p = 0; p < b_.points.size(); ++p) {
      if (p % 64 == 0) context_.check_cancelled();
      Eigen::Matrix3d e = normal_.point[p];
      e.diagonal() *= 1 + damping;
      if (e.isZero(0)) {
        inverse_[p].setZero();  // a point that is not seen stays
        continue;
      }
      const double size = e.trace();
      const Eigen::LDLT<Eigen::Matrix3d> solver(e);
      if (!(solver.vectorD().minCoeff() > 1e-15 * size)) return false;
      inverse_[p] = solver.solve(Eigen::Matrix3d::Identity());
      const std::vector<Eigen::Matrix<double, shared_max, 3>> c = couplings(p);
      for (std::size_t i = 0; i < c.size(); ++i) {
        const Row* ri = row(of_point_[p][i]);
        if (!ri) continue;
        const Eigen::Matrix<double, shared_max, 3> ci = c[i] * inverse_[p];
        const Eigen::Matrix<double, shared_max, 1> gi = ci * normal_.point_right[p];
        for (int k = 0; k < ri->columns; ++k) g[ri->column[index(k)]] -= gi[k];
        for (std::size_t j = 0; j < c.size(); ++j) {
          const Row* rj = row(of_point_[p][j]);
          if (!rj) continue;
          const Eigen::Matrix<double, shared_max, shared_max> block = ci * c[j].transpose();
          for (int k = 0; k < ri->columns; ++k)
            for (int l = 0; l < rj->columns; ++l) s(ri->column[index(k)], rj->column[index(l)]) -= block(k, l);
        }
      }
    }
    return s.allFinite() && g.allFinite();
  }

  /// One damped step; false where the equations are singular.
  bool step(double damping) {
    Eigen::MatrixXd s;
    Eigen::VectorXd g;
    if (!reduce(damping, s, g)) return false;
    const Eigen::VectorXd size = s.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
    const Eigen::LDLT<Eigen::MatrixXd> solver(size.asDiagonal() * s * size.asDiagonal());
    if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > 0)) return false;
    const Eigen::VectorXd x = -(size.asDiagonal() * solver.solve(size.asDiagonal() * g));
    if (!x.allFinite()) return false;
    for (std::size_t k = 0; k < 4; ++k)
      if (layout_.strip[k] >= 0) {
        b_.strips[k].shift_mm += x.segment<2>(layout_.strip[k]);
        b_.strips[k].turn_rad += x[layout_.strip[k] + 2];
      }
    for (std::size_t i = 0; i < b_.lenses.size(); ++i)
      b_.lenses[i].add(x.segment<Lens::unknowns>(layout_.lens(static_cast<int>(i))));
    for (std::size_t i = 0; i < b_.cameras.size(); ++i)
      b_.cameras[i].pose.add(x.segment<Pose::unknowns>(layout_.camera(static_cast<int>(i))));
    for (std::size_t p = 0; p < b_.points.size(); ++p) {
      Vec3 right = normal_.point_right[p];
      for (const std::size_t o : of_point_[p])
        if (const Row* r = row(o))
          for (int k = 0; k < r->columns; ++k)
            right += r->point.transpose() * r->shared.col(k) * x[r->column[index(k)]];
      b_.points[p] -= inverse_[p] * right;
    }
    return true;
  }

  /// Covariance of every point, the normal equations' inverse without the factor of the noise.
  std::vector<Eigen::Matrix3d> covariances() {
    linearise();
    Eigen::MatrixXd s;
    Eigen::VectorXd g;
    if (!reduce(0, s, g)) return {};
    const Eigen::VectorXd size = s.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
    const Eigen::LDLT<Eigen::MatrixXd> solver(size.asDiagonal() * s * size.asDiagonal());
    if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > 1e-14)) return {};
    const Eigen::MatrixXd inverse =
        size.asDiagonal() * solver.solve(Eigen::MatrixXd::Identity(layout_.size, layout_.size)) * size.asDiagonal();
    std::vector<Eigen::Matrix3d> result(b_.points.size(), Eigen::Matrix3d::Zero());
    for (std::size_t p = 0; p < b_.points.size(); ++p) {
      if (p % 16 == 0) context_.check_cancelled();
      const std::vector<Eigen::Matrix<double, shared_max, 3>> c = couplings(p);
      Eigen::Matrix3d middle = Eigen::Matrix3d::Zero();
      for (std::size_t i = 0; i < c.size(); ++i)
        for (std::size_t j = 0; j < c.size(); ++j) {
          const Row *ri = row(of_point_[p][i]), *rj = row(of_point_[p][j]);
          if (!ri || !rj) continue;
          for (int k = 0; k < ri->columns; ++k)
            for (int l = 0; l < rj->columns; ++l)
              middle += inverse(ri->column[index(k)], rj->column[index(l)]) * c[i].row(k).transpose() * c[j].row(l);
        }
      result[p] = inverse_[p] + inverse_[p] * middle * inverse_[p];
      if (!result[p].allFinite()) return {};
    }
    return result;
  }

  /// Equations less unknowns.
  double freedom() const {
    double count = -layout_.size;
    for (const BundleObservation& o : b_.observations) count += o.used ? 2 : 0;
    for (const auto& list : of_point_) count -= list.empty() ? 0 : 3;
    for (std::size_t i = 0; i < b_.lenses.size(); ++i)
      count += (b_.centre_prior > 0 ? 2 : 0) + (b_.k_prior > 0 ? 2 : 0);
    return count + 3;  // the strips' mean is held
  }

 private:
  const Row* row(std::size_t observation) const { return rows_[observation] ? &*rows_[observation] : nullptr; }
  std::vector<Eigen::Matrix<double, shared_max, 3>> couplings(std::size_t p) const {
    std::vector<Eigen::Matrix<double, shared_max, 3>> c;
    for (const std::size_t o : of_point_[p]) {
      const Row* r = row(o);
      c.push_back(r ? Eigen::Matrix<double, shared_max, 3>(r->shared.transpose() * r->point)
                    : Eigen::Matrix<double, shared_max, 3>::Zero());
    }
    return c;
  }

  /// Cost of what is assumed beforehand; with `into` its part of the normal equations.
  double priors(Normal* into) const {
    double sum = 0;
    const auto add = [&](int column, double value, double sigma) {
      if (!(sigma > 0)) return;
      sum += value * value / (sigma * sigma);
      if (into) {
        into->shared(column, column) += 1 / (sigma * sigma);
        into->right[column] += value / (sigma * sigma);
      }
    };
    for (std::size_t i = 0; i < b_.lenses.size(); ++i) {
      const Lens& lens = b_.lenses[i];
      const int at = layout_.lens(static_cast<int>(i));
      const Vec2 centre = (lens.centre_px - 0.5 * Vec2(lens.width, lens.height)) / lens.scale_px();
      add(at + 1, centre.x(), b_.centre_prior);
      add(at + 2, centre.y(), b_.centre_prior);
      add(at + 3, lens.k1, b_.k_prior);
      add(at + 4, lens.k2, b_.k_prior);
    }
    // The strips' mean shift and turn about the machine's origin are 0: three rows over all strips.
    Eigen::Matrix<double, 3, Eigen::Dynamic> rows = Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, layout_.size);
    Vec3 value = Vec3::Zero();
    double count = 0, lever = 0;
    Vec2 middle(0, 0);
    for (std::size_t k = 0; k < 4; ++k)
      if (layout_.strip[k] >= 0) {
        middle += b_.strip_origin_mm[k];
        count += 1;
      }
    if (count == 0) return sum;
    middle /= count;
    for (std::size_t k = 0; k < 4; ++k)
      if (layout_.strip[k] >= 0) lever += (b_.strip_origin_mm[k] - middle).squaredNorm() / count;
    lever = std::max(1.0, std::sqrt(lever));
    for (std::size_t k = 0; k < 4; ++k) {
      const int at = layout_.strip[k];
      if (at < 0) continue;
      const Vec2 arm = (b_.strip_origin_mm[k] - middle) / lever;
      const StripPlace& s = b_.strips[k];
      value += Vec3(s.shift_mm.x(), s.shift_mm.y(),
                    arm.x() * s.shift_mm.y() - arm.y() * s.shift_mm.x() + lever * s.turn_rad) /
               count;
      rows(0, at) += 1 / count;
      rows(1, at + 1) += 1 / count;
      rows(2, at) -= arm.y() / count;
      rows(2, at + 1) += arm.x() / count;
      rows(2, at + 2) += lever / count;
    }
    const double weight = 1 / (gauge_sigma_mm * gauge_sigma_mm);
    sum += weight * value.squaredNorm();
    if (into) {
      into->shared += weight * rows.transpose() * rows;
      into->right += weight * rows.transpose() * value;
    }
    return sum;
  }

  Bundle& b_;
  const Context& context_;
  Layout layout_;
  std::vector<std::vector<std::size_t>> of_point_;
  std::vector<std::optional<Row>> rows_;
  std::vector<Eigen::Matrix3d> inverse_;
  Normal normal_;
  double scale_ = 0;  // of Cauchy's loss; 0: plain squares
};

double robust_noise(const Bundle& bundle) {
  std::vector<double> distance;
  for (const BundleObservation& o : bundle.observations)
    if (o.used) distance.push_back(whitened_distance(bundle, o));
  return median(distance) / median_of_rayleigh;
}

}  // namespace

Vec3 Bundle::place_mm(const BundleObservation& o) const {
  if (o.strip < 0) return points[index(o.point)];
  const StripPlace& s = strips[index(o.strip)];
  const Vec2 p = strip_origin_mm[index(o.strip)] + s.shift_mm + turned_by(o.from_origin_mm, s.turn_rad);
  return {p.x(), p.y(), board_z_mm};
}

double whitened_distance(const Bundle& bundle, const BundleObservation& o) {
  const BundleCamera& camera = bundle.cameras[index(o.camera)];
  const auto at = project(bundle.lenses[index(camera.lens)], camera.pose, bundle.place_mm(o));
  if (!at) return unseen_distance;
  return std::min(unseen_distance, (whitening(o.covariance_px2) * (*at - o.picture_px)).norm());
}

BundleFit adjust_bundle(Bundle& bundle, bool robust, bool with_covariance, int max_iterations, const Context& context) {
  const Error not_solved(ErrorCode::could_not_solve, "",
                         "The photographs do not determine the cameras: take more of them, from more sides, "
                         "with all four strips in view.");
  BundleFit fit;
  Adjustment adjustment(bundle, context);
  double damping = 1e-3;
  const int rounds = robust ? 4 : 1;
  for (int round = 0; round < rounds; ++round) {
    if (robust) adjustment.set_scale(std::max(1e-9, robust_noise(bundle)));
    auto cost = adjustment.cost();
    if (!cost) throw not_solved;
    bool done = false;
    for (int i = 0; i < max_iterations && !done; ++i) {
      context.check_cancelled();
      adjustment.linearise();
      ++fit.iterations;
      bool better = false;
      for (int attempt = 0; attempt < 12 && !better; ++attempt) {
        const Bundle before = bundle;
        const bool stepped = adjustment.step(damping);
        const auto now = stepped ? adjustment.cost() : std::nullopt;
        if (now && *now <= *cost) {
          done = *cost - *now <= 1e-12 * *cost;
          cost = now;
          damping = std::max(1e-12, damping / 8);
          better = true;
        } else {
          bundle = before;
          damping = std::min(1e8, std::max(damping, 1e-8) * 6);
        }
      }
      if (!better) done = true;  // no step helps any more: at round-off
    }
    fit.converged = done;
  }
  double squares = 0, squares_px = 0, count = 0;
  for (const BundleObservation& o : bundle.observations) {
    if (!o.used) continue;
    const double distance = whitened_distance(bundle, o);
    squares += distance * distance;
    const BundleCamera& camera = bundle.cameras[index(o.camera)];
    if (const auto at = project(bundle.lenses[index(camera.lens)], camera.pose, bundle.place_mm(o)))
      squares_px += (*at - o.picture_px).squaredNorm();
    count += 1;
  }
  fit.rms_px = count > 0 ? std::sqrt(squares_px / (2 * count)) : 0;
  const double freedom = adjustment.freedom();
  fit.noise = robust ? robust_noise(bundle) : std::sqrt(squares / std::max(1.0, freedom));
  if (with_covariance) {
    adjustment.set_scale(0);
    fit.covariance_mm2 = adjustment.covariances();
    if (fit.covariance_mm2.size() != bundle.points.size()) throw not_solved;
    for (Eigen::Matrix3d& c : fit.covariance_mm2) c *= fit.noise * fit.noise;
  }
  return fit;
}

}  // namespace formwright
