// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/chart/parameterisation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/planar/plane.h"
#include "base/error.h"
#include "base/parallel.h"
#include "geometry/operators/intrinsic_delaunay.h"
#include "zippable/chart/newton_system.h"

namespace formwright {
namespace {

constexpr std::size_t grain = 1024;

std::array<Vec2, 3> corners_of(const CornerCoordinates& uv, std::size_t f) {
  const auto row = static_cast<Eigen::Index>(3 * f);
  return {uv.row(row).transpose(), uv.row(row + 1).transpose(), uv.row(row + 2).transpose()};
}

/// Sum of body(f) over all faces, in chunks that do not depend on the number of threads.
template <class Body>
double sum_over_faces(std::size_t count, const Body& body) {
  std::vector<double> part((count + grain - 1) / grain, 0.0);
  parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t f = begin; f < end; ++f) sum += body(f);
    part[begin / grain] = sum;
  });
  double total = 0;
  for (const double p : part) total += p;
  return total;
}

class Solver {
 public:
  Solver(const Segmentation& s, const ParameterisationOptions& options, Context& context)
      : s_(s), options_(options), context_(context), chart_(s), system_(chart_, context) {
    // Lengths corrected where a triangle is flat to rounding, so that every reference has an area.
    const IntrinsicTriangulation intrinsic = intrinsic_triangulation(s.mesh);
    const std::size_t m = s.mesh.face_count();
    reference_.resize(m);
    for (std::size_t f = 0; f < m; ++f)
      reference_[f] =
          reference_triangle(intrinsic.length[3 * f], intrinsic.length[3 * f + 1], intrinsic.length[3 * f + 2]);
    total_area_ = sum_over_faces(m, [&](std::size_t f) { return reference_[f].area; });
  }

  Parameterisation run() {
    Stopwatch watch;
    start();
    result_.seconds_start = watch.lap();
    iterate();
    result_.seconds_newton = watch.lap();
    finish();
    return std::move(result_);
  }

 private:
  void start() {
    local_ = Eigen::VectorXd::Zero(chart_.local_count());
    shared_ = Eigen::VectorXd::Zero(chart_.shared_count());
    // Interfaces keep their lengths; every rectangle is as high as it is long.
    if (s_.part_count() == 1) {
      shared_[chart_.length_of(0)] = 0.5 * (walk_length_mm(s_.mesh, s_.segments[0].bottom.vertices, true) +
                                            walk_length_mm(s_.mesh, s_.segments[0].top.vertices, true));
    } else {
      for (int i = 0; i < static_cast<int>(s_.interfaces.size()); ++i)
        shared_[chart_.length_of(i)] = walk_length_mm(s_.mesh, s_.interfaces[i].vertices, false);
    }
    for (int part = 0; part < s_.part_count(); ++part)
      shared_[chart_.height_of(part)] = chart_.period_mm(part, shared_);
    for (const auto& [interface, place, local] : chart_.interface_variables()) {
      const auto& walk = s_.interfaces[interface].vertices;
      local_[local] = walk_length_mm(s_.mesh, {walk.begin(), walk.begin() + place + 1}, false);
    }
    // Tutte: half a spring a side and triangle, so that a side on a line counts half of one inside. That is the
    // embedding of the surface doubled along its free lines, a torus.
    const CornerCoordinates uv = chart_.corners(local_, shared_);
    system_.assemble([&](int f) {
      DirichletTerms t;
      t.gradient.setZero();
      t.hessian.setZero();
      for (int k = 0; k < 3; ++k)
        for (int axis = 0; axis < 2; ++axis) {
          const int i = 2 * k + axis, j = 2 * ((k + 1) % 3) + axis;
          t.hessian(i, i) += 0.5, t.hessian(j, j) += 0.5;
          t.hessian(i, j) -= 0.5, t.hessian(j, i) -= 0.5;
          const double pull = 0.5 * (uv(3 * f + k, axis) - uv(3 * f + (k + 1) % 3, axis));
          t.gradient[i] += pull, t.gradient[j] -= pull;
        }
      return t;
    });
    for (const auto& variable : chart_.interface_variables()) system_.hold(variable.local);
    system_.hold_shared();
    NewtonStep step;
    if (!system_.solve(step, 0, context_))
      throw Error(ErrorCode::could_not_solve, "mesh",
                  "The parts could not be laid flat: repair or subdivide the model.");
    local_ += step.local;
    const CornerCoordinates embedded = chart_.corners(local_, shared_);
    for (std::size_t f = 0; f < reference_.size(); ++f)
      if (!(jacobian(reference_[f], corners_of(embedded, f)).determinant() > 0))
        throw Error(
            ErrorCode::could_not_solve, "mesh",
            "A part folds over itself when laid flat: make the holes at the tips larger, or divide the model into other parts.");
    rescale(embedded);
    result_.energy_start = energy(chart_.corners(local_, shared_)) / 4;
  }

  /// The best scale along x for all parts together and along y for each, in closed form: with rows r1, r2 of J, the
  /// energy under (a, b) is a^2 |r1|^2 + b^2 |r2|^2 + |r2|^2 / (a det)^2 + |r1|^2 / (b det)^2.
  void rescale(const CornerCoordinates& uv) {
    const auto scales = [&](int part) {
      Eigen::Array4d sums = Eigen::Array4d::Zero();
      for (std::size_t f = 0; f < reference_.size(); ++f) {
        if (part >= 0 && s_.face_segment[f] != part) continue;
        const Eigen::Matrix2d J = jacobian(reference_[f], corners_of(uv, f));
        const double det = J.determinant(), weight = reference_[f].area, r1 = J.row(0).squaredNorm(),
                     r2 = J.row(1).squaredNorm();
        sums += weight * Eigen::Array4d(r1, r2, r2 / (det * det), r1 / (det * det));
      }
      return Vec2(std::pow(sums[2] / sums[0], 0.25), std::pow(sums[3] / sums[1], 0.25));
    };
    const double a = scales(-1).x();
    std::vector<double> b(s_.part_count());
    for (int part = 0; part < s_.part_count(); ++part) b[part] = scales(part).y();
    std::vector<double> factor(chart_.local_count(), a);
    for (int f = 0; f < chart_.face_count(); ++f)
      for (int corner = 3 * f; corner < 3 * f + 3; ++corner)
        if (const int local = chart_.coordinate(corner, 1).local; local >= 0) factor[local] = b[s_.face_segment[f]];
    for (int i = 0; i < chart_.local_count(); ++i) local_[i] *= factor[i];
    for (int part = 0; part < s_.part_count(); ++part) shared_[chart_.height_of(part)] *= b[part];
    shared_.tail(chart_.shared_count() - s_.part_count()) *= a;
  }

  double energy(const CornerCoordinates& uv) const {
    return sum_over_faces(reference_.size(),
                          [&](std::size_t f) {
                            return reference_[f].area * symmetric_dirichlet(jacobian(reference_[f], corners_of(uv, f)));
                          }) /
           total_area_;
  }

  void assemble(const CornerCoordinates& uv, bool convex) {
    system_.assemble([&](int f) {
      DirichletTerms t = symmetric_dirichlet_terms(reference_[f], corners_of(uv, f), convex);
      const double weight = reference_[f].area / total_area_;
      t.energy *= weight, t.gradient *= weight, t.hessian *= weight;
      return t;
    });
  }

  /// The longest step before a triangle loses its area: the least positive root of a quadratic each.
  double longest_step(const CornerCoordinates& uv, const CornerCoordinates& along) const {
    std::vector<double> minimum((reference_.size() + grain - 1) / grain, std::numeric_limits<double>::infinity());
    parallel_for(reference_.size(), grain, [&](std::size_t begin, std::size_t end) {
      double shortest = std::numeric_limits<double>::infinity();
      for (std::size_t f = begin; f < end; ++f) {
        const auto p = corners_of(uv, f), d = corners_of(along, f);
        const Vec2 e1 = p[1] - p[0], e2 = p[2] - p[0], d1 = d[1] - d[0], d2 = d[2] - d[0];
        const double c = cross(e1, e2), b = cross(e1, d2) + cross(d1, e2), a = cross(d1, d2);
        const double root = b * b - 4 * a * c;
        if (root < 0) continue;
        // 2 c over these are the roots, also where a = 0; c > 0.
        for (const double denominator : {-b + std::sqrt(root), -b - std::sqrt(root)})
          if (denominator > 0) shortest = std::min(shortest, 2 * c / denominator);
      }
      minimum[begin / grain] = shortest;
    });
    return *std::min_element(minimum.begin(), minimum.end());
  }

  /// Moves along the step as far as pays, also beyond its length; false when nothing is gained.
  bool search(const NewtonStep& step, CornerCoordinates& uv, double& value) {
    const CornerCoordinates along = chart_.corners(step.local, step.shared);
    const double limit = 0.9 * longest_step(uv, along);
    double length = std::min(1.0, limit);
    const auto at = [&](double t) { return energy(uv + t * along); };
    double reached = at(length);
    while (!(reached <= value + 1e-4 * length * step.slope)) {
      length *= 0.5;
      if (length < 1e-12) return false;
      reached = at(length);
    }
    while (-step.slope > 1e-4 && 1.4 * length < limit) {
      const double further = at(1.4 * length);
      if (further >= reached) break;
      length *= 1.4, reached = further;
    }
    local_ += length * step.local;
    shared_ += length * step.shared;
    uv = chart_.corners(local_, shared_);
    value = energy(uv);
    return true;
  }

  bool solve_damped(NewtonStep& step);
  double iterations_passed(double energy) const;
  void iterate();
  void finish();

  const Segmentation& s_;
  const ParameterisationOptions& options_;
  Context& context_;
  SeamlessChart chart_;
  NewtonSystem system_;
  std::vector<ReferenceTriangle> reference_;
  double total_area_ = 0;
  Eigen::VectorXd local_, shared_;
  Parameterisation result_;
};

constexpr const char* not_unrolled =
    "The parts could not be unrolled: one of them may have limbs of its own, or a very narrow opening. "
    "Draw a border around each limb, or make the openings larger.";

/// A tube squeezed to a millionth of its size is so much stiffer than the rest that rounding makes the matrix look
/// singular.
bool Solver::solve_damped(NewtonStep& step) {
  for (const double damping : {0.0, 1e-12, 1e-10, 1e-8, 1e-6})
    if (system_.solve(step, damping, context_) && step.slope < 0) return true;
  return false;
}

/// The share of the iterations that are done. On the samples, which take 7 to 33, an iteration lowers the energy by a
/// quarter of a decade while triangles are crumpled, and later the decrement by half a decade.
double Solver::iterations_passed(double energy) const {
  constexpr double smooth_energy = 8, energy_decades = 0.23, decrement_decades = 0.5;
  const double decrement = result_.iterations > 0 ? result_.decrement / energy : 1;
  const double left = std::max(0.0, std::log10(energy / smooth_energy)) / energy_decades +
                      std::max(0.0, std::log10(decrement / options_.tolerance)) / decrement_decades;
  return result_.iterations / (result_.iterations + left + 1);
}

void Solver::iterate() {
  CornerCoordinates uv = chart_.corners(local_, shared_);
  double value = energy(uv);
  bool try_true = false;
  for (result_.iterations = 0; result_.iterations < options_.iterations_max;) {
    context_.progress(ordering_share + (1 - ordering_share) * iterations_passed(value), "Parameterising");
    NewtonStep step;
    bool solved = false;
    if (try_true) {
      assemble(uv, false);
      solved = system_.solve(step, 0, context_);
      if (solved) ++result_.true_hessians;
    }
    if (!solved) {
      assemble(uv, true);
      if (!solve_damped(step)) throw Error(ErrorCode::could_not_solve, "mesh", not_unrolled);
    }
    ++result_.iterations;
    result_.decrement = -step.slope;
    if (-step.slope <= options_.tolerance * value) {
      search(step, uv, value);
      return;
    }
    const double before = value;
    if (!search(step, uv, value)) return;
    try_true = before - value < 0.01 * before;
  }
  throw Error(ErrorCode::could_not_solve, "mesh", not_unrolled);
}

void Solver::finish() {
  result_.corners_mm = chart_.corners(local_, shared_);
  for (int part = 0; part < s_.part_count(); ++part) {
    result_.period_mm.push_back(chart_.period_mm(part, shared_));
    result_.height_mm.push_back(shared_[chart_.height_of(part)]);
  }
  for (int i = 0; i < static_cast<int>(s_.interfaces.size()); ++i)
    result_.interface_length_mm.push_back(shared_[chart_.length_of(i)]);
  result_.face_distortion.resize(reference_.size());
  double sum = 0;
  for (std::size_t f = 0; f < reference_.size(); ++f) {
    const double distortion = symmetric_dirichlet(jacobian(reference_[f], corners_of(result_.corners_mm, f))) / 4;
    result_.face_distortion[f] = distortion;
    result_.distortion_max = std::max(result_.distortion_max, distortion);
    sum += reference_[f].area * distortion;
  }
  result_.distortion_mean = sum / total_area_;
}

}  // namespace

Parameterisation parameterise(const Segmentation& segmentation, const ParameterisationOptions& options,
                              Context& context) {
  for (int part = 0; part < segmentation.part_count(); ++part)
    if (!segmentation.problems[part].empty())
      throw Error(ErrorCode::invalid_input, "mesh",
                  "Part " + std::to_string(part + 1) + " is not a cylinder. " + segmentation.problems[part]);
  return Solver(segmentation, options, context).run();
}

double constraint_residual_mm(const Segmentation& s, const Parameterisation& p) {
  const Adjacency adjacency(s.mesh);
  double worst = 0;
  const auto corner = [&](int h) { return Vec2(p.corners_mm.row(h).transpose()); };
  for (int h = 0; h < 3 * s.mesh.face_count(); ++h) {
    const int o = adjacency.opposite(h);
    const Vec2 side = corner(next_halfedge(h)) - corner(h);
    if (o < 0) {
      worst = std::max(worst, std::abs(side.y()));
      continue;
    }
    const Vec2 other = corner(o) - corner(next_halfedge(o));
    const bool across = s.face_segment[h / 3] != s.face_segment[o / 3];
    worst = std::max(worst, (across ? Vec2(side + other) : Vec2(side - other)).cwiseAbs().maxCoeff());
    if (across) worst = std::max(worst, std::abs(side.y()));
  }
  return worst;
}

}  // namespace formwright
