// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/relief/energy_scene.h"

#include <cstdio>
#include <ctime>
#include <utility>

#include "bench/relief/picture_sheet.h"
#include "geometry/queries/ray_caster.h"
#include "relief/normal_error.h"

namespace formwright::test {
namespace {

double seconds_of_processor() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

AllowedDepths allowed_depths(const ViewFrame& frame, const std::vector<InequalityRow>& rows, double thickness) {
  const Eigen::Index n = frame.P.rows();
  AllowedDepths allowed{Eigen::VectorXd(n),
                        Eigen::VectorXd(n),
                        {static_cast<Eigen::Index>(rows.size()), n},
                        Eigen::VectorXd(static_cast<Eigen::Index>(rows.size()))};
  for (int i = 0; i < n; ++i) {
    allowed.lower[i] = frame.u_for_depth(i, -thickness);
    allowed.upper[i] = frame.u_for_depth(i, 0);
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t k = 0; k < rows[r].index.size(); ++k)
      entries.emplace_back(static_cast<int>(r), rows[r].index[k], rows[r].coefficient[k]);
    allowed.order_bound[static_cast<Eigen::Index>(r)] = rows[r].bound;
  }
  allowed.order.setFromTriplets(entries.begin(), entries.end());
  return allowed;
}

}  // namespace

EnergyScene::EnergyScene(std::string name, const TriangleMesh& mesh, const ReliefOptions& options, Context& context)
    : name_(std::move(name)),
      thickness_percent_(100 * options.thickness_mm / options.width_mm),
      context_(context),
      F_(mesh.F),
      frame_(make_view_frame(mesh, options)),
      forms_(frame_, F_) {
  const RayCaster caster(TriangleMesh{frame_.P, F_});
  visibility_ = find_visibility(frame_, F_, caster, context);
  allowed_ = allowed_depths(frame_, depth_order_rows(frame_, F_, caster, context), 0.01 * thickness_percent_);
}

Eigen::VectorXd EnergyScene::moved_to(const Eigen::VectorXd& u, double ratio) const {
  if (ratio == 1) return u;
  return (ratio * (1 + frame_.kappa * u.array()) - 1) / frame_.kappa;
}

AllowedDepths EnergyScene::allowed_at(double ratio) const {
  if (ratio == 1) return allowed_;
  AllowedDepths moved = allowed_;
  moved.lower = moved_to(allowed_.lower, ratio);
  moved.upper = moved_to(allowed_.upper, ratio);
  // u = (u' - shift) / ratio, in every condition.
  const double shift = (ratio - 1) / frame_.kappa;
  moved.order_bound = ratio * allowed_.order_bound + allowed_.order * Eigen::VectorXd::Constant(frame_.P.rows(), shift);
  return moved;
}

SolvedForm EnergyScene::solve(std::string form, const LeastSquares& energy, double distance_ratio) const {
  const double start = seconds_of_processor();
  const AllowedDepths allowed = allowed_at(distance_ratio);
  const BoundedMinimum minimum = BoundedLeastSquares(frame_.P).minimise(energy, allowed, context_);
  return {std::move(form),
          moved_to(minimum.u, 1 / distance_ratio),
          seconds_of_processor() - start,
          minimum.converged,
          0,
          0};
}

SolvedForm EnergyScene::iterated(std::string form, const std::function<LeastSquares(const Eigen::VectorXd&)>& energy_at,
                                 double damping) const {
  const double start = seconds_of_processor();
  const SolvedForm first = solve("", forms_.proposed());
  IterationSettings settings;
  settings.damping = damping;
  const IteratedMinimum minimum = iterate(energy_at, allowed_, first.u, frame_.P, settings, context_);
  return {std::move(form),
          minimum.u,
          seconds_of_processor() - start,
          minimum.converged,
          static_cast<int>(minimum.change.size()),
          minimum.change.back()};
}

Json EnergyScene::row(const std::string& figure, const SolvedForm& solved) const {
  const NormalError error = normal_error(frame_, F_, visibility_, frame_.moved(solved.u));
  std::fprintf(stderr, "%s %-8s %5d vertices %3.0f %% %-42s %6.2f deg, in the picture %6.2f, %6.2f s, %s",
               figure.c_str(), name_.c_str(), static_cast<int>(frame_.P.rows()), thickness_percent_,
               solved.form.c_str(), error.mean_deg, error.mean_deg_image, solved.seconds,
               solved.converged ? "converged" : "not converged");
  if (solved.iterations > 0) std::fprintf(stderr, " in %d, last %.1e", solved.iterations, solved.last_change);
  std::fprintf(stderr, "\n");
  return {{"figure", figure},
          {"model", name_},
          {"vertices", frame_.P.rows()},
          {"thickness_percent", thickness_percent_},
          {"form", solved.form},
          {"normal_error_mean_deg", error.mean_deg},
          {"normal_error_mean_deg_image", error.mean_deg_image},
          {"normal_error_mean_deg_vertices", error.vertex_deg.mean()},
          {"processor_seconds", solved.seconds},
          {"converged", solved.converged},
          {"iterations", solved.iterations},
          {"last_change_of_slab", solved.last_change}};
}

Image EnergyScene::sheet(const std::vector<const SolvedForm*>& shown, double pixel_factor, double max_angle_deg,
                         bool faceted) const {
  const PictureGrid grid = eye_grid(frame_, pixel_factor);
  const NormalPicture model = drawn(frame_.P, grid, faceted);
  constexpr int gap = 8;
  const int across = grid.columns + gap, down = grid.rows + gap;
  Image sheet(across * (static_cast<int>(shown.size()) + 1) - gap, 2 * down - gap, Rgba{255, 255, 255, 255});
  shade_into(sheet, model, {0, 0});
  int left = across;
  for (const SolvedForm* solved : shown) {
    const NormalPicture relief = drawn(frame_.moved(solved->u), grid, faceted);
    shade_into(sheet, relief, {left, 0});
    colour_angles_into(sheet, model, relief, max_angle_deg, {left, down});
    left += across;
  }
  colour_scale_into(sheet, max_angle_deg, {0, down}, grid.columns, grid.rows);
  return sheet;
}

NormalPicture EnergyScene::drawn(const Positions& P, const PictureGrid& grid, bool faceted) const {
  if (!faceted) return draw_normals(frame_, P, F_, grid, context_);
  Positions corners(3 * F_.rows(), 3);
  Triangles faces(F_.rows(), 3);
  for (int f = 0; f < F_.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      corners.row(3 * f + k) = P.row(F_(f, k));
      faces(f, k) = 3 * f + k;
    }
  return draw_normals(frame_, corners, faces, grid, context_);
}

}  // namespace formwright::test
