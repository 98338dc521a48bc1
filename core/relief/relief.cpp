// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/relief.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>

#include "base/sha256.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/queries/ray_caster.h"
#include "relief/appearance_energy.h"
#include "relief/balanced_relief.h"
#include "relief/base/depth_bounds.h"
#include "relief/base/cut_into_parts.h"
#include "relief/baselines.h"
#include "relief/view/outline.h"

namespace formwright {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Of the slab: an order row between surfaces that are held where they touch is decided by round-off.
constexpr double painted_row_room = 1e-6;
constexpr double balanced_hidden_weight = 0.01;  // at most: hidden parts only have to give way
// About 3.9 kB a vertex: 6 GB natively, and what fits into the 4 GB that WASM can have.
constexpr int max_vertices = sizeof(void*) > 4 ? 1'500'000 : 600'000;

/// nearest <= z <= farthest for every bounded vertex, up to the common scale mu = 1 + kappa m of eq. (3.11):
///   1 + kappa u in mu [1 + kappa l, 1 + kappa h]   <=>   l + (1 + kappa l) m <= u <= h + (1 + kappa h) m.
/// Without rows.
BoundedQpConstraints constraints_of(const ViewFrame& frame, const DepthBounds& bounds) {
  const Eigen::Index n = frame.P.rows();
  BoundedQpConstraints c;
  c.lower = Eigen::VectorXd::Constant(n, -infinity);
  c.upper = Eigen::VectorXd::Constant(n, infinity);
  c.lower_slope = c.upper_slope = Eigen::VectorXd::Ones(n);
  c.group = bounds.group;
  c.group_count = bounds.groups;
  c.gauge = Eigen::VectorXd::Constant(n, 1.0 / static_cast<double>(n));
  for (int i = 0; i < n; ++i) {
    if (!bounds.bounded[static_cast<std::size_t>(i)]) continue;
    c.lower[i] = frame.u_for_depth(i, bounds.nearest_allowed(i));
    c.upper[i] = frame.u_for_depth(i, bounds.farthest[i]);
    c.lower_slope[i] = 1 + frame.kappa * c.lower[i];
    c.upper_slope[i] = 1 + frame.kappa * c.upper[i];
  }
  return c;
}

/// Linear compression as the point where the solution starts. The scale of each group brings its bounded vertices, on
/// the mean, to where compression on a flat base would have them, so that neighbouring groups meet there.
void set_start(const ViewFrame& frame, const DepthBounds& bounds, BoundedQpConstraints& c) {
  const Eigen::Index n = frame.P.rows();
  double low = infinity, high = -infinity, depth = 0, room = 0;
  int bounded = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!bounds.bounded[static_cast<std::size_t>(i)]) continue;
    low = std::min(low, frame.P(i, 2));
    high = std::max(high, frame.P(i, 2));
    depth += frame.P(i, 2);
    room += bounds.farthest[i] - bounds.nearest[i];
    ++bounded;
  }
  if (bounded == 0) return;
  const double middle = depth / bounded, compression = high > low ? room / bounded / (high - low) : 1;
  const Eigen::VectorXd compressed = linear_compression(frame, bounds);
  c.start_u.resize(n);
  Eigen::VectorXd flat = Eigen::VectorXd::Zero(c.group_count), own = flat, count = flat;
  for (int i = 0; i < n; ++i) {
    c.start_u[i] = frame.u_for_depth(i, middle + (frame.P(i, 2) - middle) * compression);
    if (!bounds.bounded[static_cast<std::size_t>(i)]) continue;
    const int g = c.group[static_cast<std::size_t>(i)];
    flat[g] += c.start_u[i];
    own[g] += compressed[i];
    count[g] += 1;
  }
  c.start_m = Eigen::VectorXd::Zero(c.group_count);
  for (int g = 0; g < c.group_count; ++g)
    if (count[g] > 0) c.start_m[g] = (flat[g] - own[g]) / (count[g] + frame.kappa * own[g]);
  // What is not bounded and has no base behind it stays where the flat base would have it.
  for (Eigen::Index i = 0; i < n; ++i)
    if (bounds.farthest[i] > bounds.nearest[i])
      c.start_u[i] =
          compressed[i] + (1 + frame.kappa * compressed[i]) * c.start_m[c.group[static_cast<std::size_t>(i)]];
}

/// The scale of each group, eq. (3.11), as m with mu = 1 + kappa m. Where the bounds leave it free, the relief is put
/// back against its base: the smallest m, as the term alpha |mu|^2 of eq. (3.14) would choose.
Eigen::VectorXd scales(const BoundedQpConstraints& c, const BoundedQpSolution& qp) {
  Eigen::VectorXd minimum = Eigen::VectorXd::Constant(c.group_count, -infinity), maximum = -minimum;
  for (Eigen::Index i = 0; i < qp.u.size(); ++i) {
    if (std::isinf(c.upper[i])) continue;
    const int g = c.group[static_cast<std::size_t>(i)];
    minimum[g] = std::max(minimum[g], (qp.u[i] - c.upper[i]) / c.upper_slope[i]);
    maximum[g] = std::min(maximum[g], (qp.u[i] - c.lower[i]) / c.lower_slope[i]);
  }
  Eigen::VectorXd m = Eigen::VectorXd::Zero(c.group_count);
  for (int g = 0; g < c.group_count; ++g)
    if (std::isfinite(minimum[g])) m[g] = minimum[g] < maximum[g] ? minimum[g] : 0.5 * (minimum[g] + maximum[g]);
  return m;
}

/// Divides the scales out again: eq. (3.11) at mu = 1.
Eigen::VectorXd settled(const ViewFrame& frame, const BoundedQpConstraints& c, const Eigen::VectorXd& joint,
                        const Eigen::VectorXd& m) {
  Eigen::VectorXd u(joint.size());
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const double own = m[c.group[static_cast<std::size_t>(i)]];
    u[i] = (joint[i] - own) / (1 + frame.kappa * own);
  }
  return u.cwiseMax(c.lower).cwiseMin(c.upper);
}

/// Whether a depth-order row can hold within the bounds. Over a triangle the base may bend by more than the relief is
/// thick: a row that is interpolated there may contradict the bounds, which count more. On steps the rows within one
/// step stay: their bounds are one slab. `room`, in units of u: what a row needs to have to spare.
bool can_hold(const InequalityRow& row, const DepthBounds& bounds, const BoundedQpConstraints& c, double room) {
  double best = 0;
  for (std::size_t k = 0; k < row.index.size(); ++k) {
    const int i = row.index[k];
    const auto at = static_cast<std::size_t>(i);
    if (bounds.group[at] != bounds.group[static_cast<std::size_t>(row.index.front())]) return false;
    best += row.coefficient[k] * (row.coefficient[k] > 0 ? c.upper[i] : c.lower[i]);
  }
  return !(best < row.bound + room);
}

/// Whether what is in front in a row has a vertex that is held at one depth, and what is behind has no room behind
/// that: such rows do not contradict the limits one by one, but many of them do together, which takes long to find out.
bool is_held_in_front(const InequalityRow& row, const DepthBounds& bounds, double room) {
  if (!bounds.painted()) return false;
  double farthest_behind = -infinity, nearest_held = infinity;
  for (std::size_t k = 0; k < row.index.size(); ++k) {
    const int i = row.index[k];
    if (row.coefficient[k] > 0) farthest_behind = std::max(farthest_behind, bounds.farthest[i]);
    else if (bounds.reach[i] == bounds.farthest[i]) nearest_held = std::min(nearest_held, bounds.farthest[i]);
  }
  return farthest_behind <= nearest_held + room && nearest_held < infinity;
}

/// Whether a row has a vertex that is painted with limits closer than the usual ones.
bool is_pressed(const InequalityRow& row, const DepthBounds& bounds) {
  return bounds.painted() && std::ranges::any_of(row.index, [&](int i) {
           return bounds.above_of[i] < bounds.above || bounds.below_of[i] < bounds.below;
         });
}

/// w_i of eq. (3.13). `painted`: n factors, or none.
Eigen::VectorXd vertex_weights(const Visibility& visibility, double hidden_weight, const Eigen::VectorXd& painted) {
  Eigen::VectorXd weights(static_cast<Eigen::Index>(visibility.vertex.size()));
  for (Eigen::Index i = 0; i < weights.size(); ++i)
    weights[i] = visibility.vertex[static_cast<std::size_t>(i)] ? 1.0 : hidden_weight;
  return painted.size() > 0 ? weights.cwiseProduct(painted) : weights;
}

double order_violation(const std::vector<InequalityRow>& rows, const Eigen::VectorXd& u) {
  double worst = 0;
  for (const InequalityRow& row : rows) {
    double value = -row.bound;
    for (std::size_t k = 0; k < row.index.size(); ++k) value += row.coefficient[k] * u[row.index[k]];
    worst = std::max(worst, -value);
  }
  return worst;
}

/// Distance from the viewpoint, or straight on from the plane one width in front of the model.
Eigen::VectorXd ray_lengths(const ViewFrame& frame, const Eigen::VectorXd& u) {
  if (frame.kappa == 0) return frame.P.col(2) + u - Eigen::VectorXd::Constant(u.size(), frame.P.col(2).minCoeff() - 1);
  Eigen::VectorXd lambda(u.size());
  const Vec3 viewpoint(0, 0, -1 / frame.kappa);
  for (Eigen::Index i = 0; i < u.size(); ++i)
    lambda[i] = (frame.P.row(i).transpose() - viewpoint).norm() * (1 + frame.kappa * u[i]);
  return lambda;
}

}  // namespace

ReliefSolver::~ReliefSolver() = default;

std::string ReliefSolver::key(const ReliefOptions& options, const Eigen::VectorXd& painted_weight) {
  // The viewing distance counts in units of the width; everything else here is free of the size.
  Json key = {write_parameters(options).at("projection"), options.direction, options.up, options.hidden_weight,
              options.depth_order};
  if (options.projection == Projection::perspective) {
    if (options.distance_mm) key.push_back(*options.distance_mm / options.width_mm);
    else key.push_back(Json{options.field_of_view_deg});
  }
  if (painted_weight.size() > 0)
    key.push_back(
        sha256_hex(std::as_bytes(std::span(painted_weight.data(), static_cast<std::size_t>(painted_weight.size())))));
  return key.dump();
}

ReliefSolver::ReliefSolver(const TriangleMesh& mesh, const ReliefOptions& options, Context& context,
                           Eigen::VectorXd painted_weight)
    : F_(mesh.F), painted_weight_(std::move(painted_weight)) {
  if (mesh.vertex_count() > max_vertices) {
    throw Error(ErrorCode::invalid_input, "mesh",
                "The model has " + std::to_string(mesh.vertex_count()) +
                    " vertices, and a relief is solved for at most " + std::to_string(max_vertices) +
                    " here: simplify it first; 300000 show all that can be printed.");
  }
  Stopwatch watch;
  context.progress(0, "Finding the visible surface");
  const Adjacency adjacency(mesh);
  std::vector<int> component = vertex_components(adjacency).of;
  frame_ = make_view_frame(mesh, options);
  {
    const RayCaster caster(TriangleMesh{frame_.P, F_});
    visibility_ = find_visibility(frame_, F_, caster, context);
    visibility_.outline = find_outline(frame_, F_, adjacency, component, caster, context);
    if (options.depth_order) order_rows_ = depth_order_rows(frame_, F_, caster, context);
  }
  if (visibility_.visible_vertices == 0)
    throw Error(ErrorCode::invalid_input, "direction",
                "Nothing of the model is visible from this viewpoint: choose another looking direction.");
  context.progress(0.25, "Measuring the surface");
  energy_ = std::make_unique<AppearanceEnergy>(frame_, F_,
                                               vertex_weights(visibility_, options.hidden_weight, painted_weight_));
  SparseMatrix Q = energy_->lower_hessian(context);
  // The mean curvature scale of the mesh sits in Q; a unit diagonal keeps every tolerance below free of it.
  Q *= 1 / Q.diagonal().mean();
  seconds_setup_ = watch.lap();
  const auto span = context.span(0.35, 1, "Factorising");
  qp_.set_energy(Q, std::move(component), frame_.P, context);
  seconds_factorise_ = watch.seconds();
}

/// Rows that contradict the bounds only together are left out where these are not the same everywhere: first those of
/// painted places, then all.
BoundedQpSolution ReliefSolver::solve_on_base(BoundedQpConstraints& constraints, const DepthBounds& bounds,
                                              const BoundedQpOptions& options, Context& context) {
  if (bounds.painted() && constraints.lower == constraints.upper) {
    // Every vertex is held where it is painted.
    constraints.rows.clear();
    BoundedQpSolution held;
    held.u = constraints.lower;
    held.m = Eigen::VectorXd::Zero(constraints.group_count);
    return held;
  }
  for (;;) {
    try {
      return qp_.solve(constraints, options, context);
    } catch (const Error& error) {
      if (bounds.even || constraints.rows.empty() || error.code() != ErrorCode::could_not_solve) throw;
    }
    if (std::erase_if(constraints.rows, [&](const InequalityRow& row) { return is_pressed(row, bounds); }) == 0)
      constraints.rows.clear();
  }
}

int ReliefSolver::balance(const ReliefOptions& options, const DepthBounds& bounds,
                          const BoundedQpConstraints& constraints, Eigen::VectorXd& u, Context& context) {
  if (!balanced_) {
    const AppearanceEnergy energy(
        frame_, F_,
        vertex_weights(visibility_, std::min(balanced_hidden_weight, options.hidden_weight), painted_weight_));
    balanced_ = std::make_unique<BalancedSolver>(frame_, F_, visibility_, energy.lower_hessian(context), context,
                                                 painted_weight_);
  }
  const BalancedResult balanced = balanced_relief(
      *balanced_,
      {frame_, visibility_, bounds, bounds.even, (options.thickness_mm + options.carve_depth_mm) / options.width_mm,
       constraints.lower, constraints.upper, constraints.rows},
      u, BalancedSettings{}, context);
  u = balanced.u;
  return balanced.steps;
}

Relief ReliefSolver::solve(const ReliefOptions& options, const BaseSurface& base, Context& context,
                           const Painting& painting) {
  const DepthBounds bounds = depth_bounds(frame_, visibility_, base, options, context, painting);
  if (const BaseParts* const parts = base.parts())
    return solve_within(
        options, bounds,
        [&](const Eigen::VectorXd& u, const Eigen::VectorXd& m) {
          return cut_into_parts(frame_, F_, u, m, bounds, *parts, context);
        },
        context);
  if (bounds.groups == 1) return solve_within(options, bounds, nullptr, context);
  return solve(options, bounds, BandBorders(frame_, *base.bands(), bounds), context);
}

Relief ReliefSolver::solve(const ReliefOptions& options, const DepthBounds& bounds, const GroupBorders& borders,
                           Context& context) {
  return solve_within(
      options, bounds,
      [&](const Eigen::VectorXd& u, const Eigen::VectorXd& m) {
        return cut_into_bands(frame_, F_, u, m, bounds, borders, context);
      },
      context);
}

Relief ReliefSolver::solve_within(const ReliefOptions& options, const DepthBounds& bounds, const Cut& cut,
                                  Context& context) {
  BoundedQpConstraints constraints = constraints_of(frame_, bounds);
  const double slab = (options.thickness_mm + options.carve_depth_mm) / options.width_mm;
  if (options.appearance != Appearance::detail && cut != nullptr)
    throw Error(
        ErrorCode::invalid_input, "appearance",
        "On a base in steps, strips or parts the relief is made with the appearance \"detail\" only: choose it, take the parts as one surface, or choose another base.");
  // On a plate lent, not copied: at 300k vertices the rows are tens of megabytes.
  const bool lent = bounds.even;
  struct Lent {
    std::vector<InequalityRow>&from, &to;
    bool lent;
    Lent(std::vector<InequalityRow>& rows, std::vector<InequalityRow>& borrower, bool is_lent)
        : from(rows), to(borrower), lent(is_lent) {
      if (lent) from.swap(to);
    }
    ~Lent() {
      if (lent) from.swap(to);
    }
  } rows(order_rows_, constraints.rows, lent);
  if (!lent)
    std::ranges::copy_if(order_rows_, std::back_inserter(constraints.rows), [&](const InequalityRow& row) {
      const double room = bounds.painted() ? painted_row_room * slab : 0;
      return can_hold(row, bounds, constraints, room) && !is_held_in_front(row, bounds, room);
    });

  Relief relief;
  set_start(frame_, bounds, constraints);
  // On a curved base linear compression need not keep the order.
  constraints.start_satisfies_rows = lent;
  BoundedQpOptions qp_options;
  qp_options.method = options.method;
  qp_options.violation_tolerance = 1e-9 * slab;
  Eigen::VectorXd m;  // scales of the parts that move by themselves
  if (options.appearance == Appearance::squashed) {
    relief.u = linear_compression(frame_, bounds).cwiseMax(constraints.lower).cwiseMin(constraints.upper);
  } else {
    const auto span =
        context.span(0, options.appearance == Appearance::detail ? 0.9 : 0.4, "Fitting into the thickness");
    relief.qp = solve_on_base(constraints, bounds, qp_options, context);
    m = scales(constraints, relief.qp);
    relief.u = settled(frame_, constraints, relief.qp.u, m);
  }
  if (options.appearance == Appearance::balanced) {
    const auto span = context.span(0.4, 0.9, "Restoring broad forms");
    relief.balanced_steps = balance(options, bounds, constraints, relief.u, context);
  }
  context.progress(0.9, "Comparing normals");
  relief.moved = frame_.moved(relief.u);
  // In steps, the parts look from the viewpoint as the surface does in one piece.
  const bool in_steps = cut != nullptr;
  const Eigen::VectorXd& looked_at = in_steps ? relief.qp.u : relief.u;
  relief.energy = (*energy_)(looked_at);
  relief.seen = in_steps ? frame_.moved(looked_at) : relief.moved;
  relief.normal_error = normal_error(frame_, F_, visibility_, relief.seen);
  if (in_steps) relief.pieces = cut(relief.qp.u, m);
  const bool own_bounds = in_steps || bounds.painted();
  ReliefOptions even = options;  // the baseline fills the thickness, whatever is free here
  even.only_outline = false;
  const Eigen::VectorXd linear =
      linear_compression(frame_, own_bounds ? depth_bounds(frame_, visibility_, BaseSurface(), even, context) : bounds);
  relief.energy_linear = (*energy_)(linear);
  relief.seen_linear = frame_.moved(linear);
  relief.normal_error_linear = normal_error(frame_, F_, visibility_, relief.seen_linear);

  const double size = options.width_mm;
  relief.lambda_mm = size * ray_lengths(frame_, relief.u);
  relief.lambda_min_mm = Eigen::VectorXd::Zero(relief.u.size());
  relief.lambda_max_mm = Eigen::VectorXd::Constant(relief.u.size(), infinity);
  const Eigen::VectorXd lowest = ray_lengths(frame_, constraints.lower),
                        highest = ray_lengths(frame_, constraints.upper);
  for (Eigen::Index i = 0; i < relief.u.size(); ++i) {
    if (!bounds.bounded[static_cast<std::size_t>(i)]) continue;
    relief.lambda_min_mm[i] = size * lowest[i];
    relief.lambda_max_mm[i] = size * highest[i];
    relief.bound_violation_max_mm =
        std::max({relief.bound_violation_max_mm, relief.lambda_min_mm[i] - relief.lambda_mm[i],
                  relief.lambda_mm[i] - relief.lambda_max_mm[i]});
  }
  relief.vertices_beyond_base = bounds.missed;
  if (bounds.painted()) {
    relief.above_mm = size * (in_steps ? relief.pieces.above : bounds.above_of);
    relief.below_mm = size * (in_steps ? relief.pieces.below : bounds.below_of);
  }
  relief.order_rows = static_cast<int>(constraints.rows.size());
  if (!lent) relief.order_rows_left_out = static_cast<int>(order_rows_.size() - constraints.rows.size());
  relief.order_violation_max_mm = size * order_violation(constraints.rows, relief.u);
  if (!relief.u.allFinite())
    throw Error(ErrorCode::could_not_solve, "",
                "The relief did not converge on this model: simplify or repair the model and try again.");
  return relief;
}

double ReliefSolver::memory_mb() const {
  const double n = static_cast<double>(frame_.P.rows());
  return qp_.memory_mb() + (balanced_ ? balanced_->memory_mb() : 0) +
         1e-6 * (n * 300 + static_cast<double>(order_rows_.size()) * 200);
}

}  // namespace formwright
