// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/relief/relief_surface.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "geometry/queries/ray_caster.h"

namespace formwright {
namespace {

constexpr double penumbra_mm = 0.3;  // over which a shadow's edge fades
constexpr double no_blur = 0.05;     // pixels

double bilinear(const Eigen::MatrixXd& grid, double column, double row) {
  const double c = std::clamp(column, 0.0, static_cast<double>(grid.cols() - 1)),
               r = std::clamp(row, 0.0, static_cast<double>(grid.rows() - 1));
  const auto c0 = std::min(static_cast<Eigen::Index>(c), std::max<Eigen::Index>(0, grid.cols() - 2)),
             r0 = std::min(static_cast<Eigen::Index>(r), std::max<Eigen::Index>(0, grid.rows() - 2));
  const Eigen::Index c1 = std::min(c0 + 1, grid.cols() - 1), r1 = std::min(r0 + 1, grid.rows() - 1);
  const double s = c - static_cast<double>(c0), t = r - static_cast<double>(r0);
  return (1 - t) * ((1 - s) * grid(r0, c0) + s * grid(r0, c1)) + t * ((1 - s) * grid(r1, c0) + s * grid(r1, c1));
}

/// Heights of the uppermost surface over the grid of `surface`; places without one keep `otherwise` and are not
/// covered.
Eigen::MatrixXd heights_of(const TriangleMesh& mesh, const ReliefSurface& surface, Eigen::Index rows,
                           Eigen::Index columns, double otherwise,
                           Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>& covered, Context& context) {
  Eigen::MatrixXd height = Eigen::MatrixXd::Constant(rows, columns, otherwise);
  covered.setConstant(rows, columns, false);
  const double top = mesh.V.col(2).maxCoeff() + 1, way = top - mesh.V.col(2).minCoeff() + 1;
  const RayCaster rays(mesh);
  for (Eigen::Index r = 0; r < rows; ++r) {
    context.check_cancelled();
    for (Eigen::Index c = 0; c < columns; ++c) {
      const Vec3 above(surface.lower_mm.x() + surface.pixel_mm * static_cast<double>(c),
                       surface.lower_mm.y() + surface.pixel_mm * static_cast<double>(r), top);
      const auto hit = rays.first_hit(above, -Vec3::UnitZ(), 0, way);
      if (!hit) continue;
      height(r, c) = above.z() - hit->distance;
      covered(r, c) = true;
    }
  }
  return height;
}
}  // namespace

ReliefSurface ReliefSurface::of(const TriangleMesh& mesh, const TriangleMesh* base, int pixels,
                                const std::string& where, Context& context) {
  ReliefSurface surface;
  const Vec3 lower = mesh.V.colwise().minCoeff().transpose(), upper = mesh.V.colwise().maxCoeff().transpose();
  const Vec3 size = upper - lower;
  if (!(size.x() > 0) || !(size.y() > 0))
    throw Error(ErrorCode::invalid_input, where, "The relief has no extent in x and y: z must point at the viewer.");
  surface.pixel_mm = std::max(size.x(), size.y()) / pixels;
  surface.lower_mm = lower.head<2>() + Vec2::Constant(0.5 * surface.pixel_mm);
  const auto columns = std::max<Eigen::Index>(2, static_cast<Eigen::Index>(size.x() / surface.pixel_mm)),
             rows = std::max<Eigen::Index>(2, static_cast<Eigen::Index>(size.y() / surface.pixel_mm));
  surface.height_mm = heights_of(mesh, surface, rows, columns, lower.z(), surface.covered, context);
  if (base == nullptr) return surface;
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> under;
  surface.base_mm = heights_of(*base, surface, rows, columns, lower.z(), under, context);
  if (const auto missing = (surface.covered && !under).count(); missing > 0)
    throw Error(ErrorCode::invalid_input, where,
                "base.obj ends under the relief, at " + std::to_string(missing) + " of " +
                    std::to_string(surface.covered.count()) + " places: it must lie where the relief lies.");
  return surface;
}

bool ReliefSurface::holds(const Vec2& place_mm) const {
  const Vec2 at = on_grid(place_mm);
  for (const double row : {std::floor(at.y()), std::ceil(at.y())})
    for (const double column : {std::floor(at.x()), std::ceil(at.x())}) {
      const auto r = static_cast<Eigen::Index>(std::clamp(row, -1.0, static_cast<double>(height_mm.rows()))),
                 c = static_cast<Eigen::Index>(std::clamp(column, -1.0, static_cast<double>(height_mm.cols())));
      if (r >= 0 && c >= 0 && r < height_mm.rows() && c < height_mm.cols() && is_covered(r, c)) return true;
    }
  return false;
}

double ReliefSurface::at(const Eigen::MatrixXd& values, const Vec2& place_mm) const {
  const Vec2 at = on_grid(place_mm);
  if (covered.size() == 0) return bilinear(values, at.x(), at.y());
  double sum = 0, weights = 0;
  for (const double row : {std::floor(at.y()), std::floor(at.y()) + 1})
    for (const double column : {std::floor(at.x()), std::floor(at.x()) + 1}) {
      const auto r = static_cast<Eigen::Index>(std::clamp(row, 0.0, static_cast<double>(values.rows() - 1))),
                 c = static_cast<Eigen::Index>(std::clamp(column, 0.0, static_cast<double>(values.cols() - 1)));
      if (!covered(r, c)) continue;
      const double weight = (1 - std::abs(at.y() - row)) * (1 - std::abs(at.x() - column));
      sum += weight * values(r, c);
      weights += weight;
    }
  return weights > 0 ? sum / weights : bilinear(values, at.x(), at.y());
}

Vec2 ReliefSurface::height_range_mm() const {
  if (covered.size() == 0) return {height_mm.minCoeff(), height_mm.maxCoeff()};
  const double lowest = height_mm.minCoeff(), highest = height_mm.maxCoeff();
  return {covered.select(height_mm.array(), highest).minCoeff(), covered.select(height_mm.array(), lowest).maxCoeff()};
}

Vec3 ReliefSurface::normal(Eigen::Index row, Eigen::Index column) const {
  const auto rise = [&](Eigen::Index row_step, Eigen::Index column_step) {
    const auto end = [&](Eigen::Index sign) {
      const Eigen::Index r = row + sign * row_step, c = column + sign * column_step;
      const bool inside = r >= 0 && c >= 0 && r < height_mm.rows() && c < height_mm.cols() && is_covered(r, c);
      return inside ? sign : Eigen::Index{0};
    };
    const Eigen::Index before = end(-1), after = end(1);
    if (before == after) return 0.0;
    return (height_mm(row + after * row_step, column + after * column_step) -
            height_mm(row + before * row_step, column + before * column_step)) /
           (pixel_mm * static_cast<double>(after - before));
  };
  return Vec3(-rise(0, 1), -rise(1, 0), 1).normalized();
}

ReliefSurface ReliefSurface::made_with(double blur_mm, double depth_shrinkage) const {
  ReliefSurface made = *this;
  made.height_mm = blurred(height_mm, blur_mm / pixel_mm, covered);
  if (base_mm.size() > 0) made.height_mm = base_mm + (1 - depth_shrinkage) * (made.height_mm - base_mm);
  else made.height_mm *= 1 - depth_shrinkage;
  return made;
}

Eigen::MatrixXd blurred(const Eigen::MatrixXd& height, double sigma_pixels,
                        const Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>& covered) {
  if (!(sigma_pixels > no_blur)) return height;
  const int reach = static_cast<int>(std::ceil(4 * sigma_pixels));
  Eigen::VectorXd kernel(2 * reach + 1);
  for (int i = -reach; i <= reach; ++i) kernel[i + reach] = std::exp(-0.5 * i * i / (sigma_pixels * sigma_pixels));
  kernel /= kernel.sum();
  const auto along_rows = [&](const Eigen::MatrixXd& in) {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(in.rows(), in.cols());
    for (Eigen::Index c = 0; c < in.cols(); ++c)
      for (int i = -reach; i <= reach; ++i)
        out.col(c) += kernel[i + reach] * in.col(std::clamp<Eigen::Index>(c + i, 0, in.cols() - 1));
    return out;
  };
  const auto smoothed = [&](const Eigen::MatrixXd& in) -> Eigen::MatrixXd {
    return along_rows(along_rows(in).transpose()).transpose();
  };
  if (covered.size() == 0 || covered.all()) return smoothed(height);
  const Eigen::MatrixXd counts = covered.cast<double>().matrix();
  const Eigen::MatrixXd sum = smoothed(height.cwiseProduct(counts)), weights = smoothed(counts);
  return covered.select(sum.array() / weights.array().max(1e-300), height.array()).matrix();
}

Eigen::MatrixXd lit(const ReliefSurface& surface, const Vec3& light) {
  const Eigen::MatrixXd& z = surface.height_mm;
  Eigen::MatrixXd result = Eigen::MatrixXd::Ones(z.rows(), z.cols());
  const double across = light.head<2>().norm();
  if (across < 1e-6 || light.z() <= 0) return result;
  const Vec2 step = light.head<2>() / across;
  const double rise = light.z() / across * surface.pixel_mm, highest = z.maxCoeff();
  for (Eigen::Index r = 0; r < z.rows(); ++r)
    for (Eigen::Index c = 0; c < z.cols(); ++c) {
      double blocked = -1e9;
      for (int k = 1;; ++k) {
        const double ray = z(r, c) + k * rise, column = static_cast<double>(c) + k * step.x(),
                     row = static_cast<double>(r) + k * step.y();
        if (ray > highest + penumbra_mm || column < 0 || row < 0 || column > static_cast<double>(z.cols() - 1) ||
            row > static_cast<double>(z.rows() - 1))
          break;
        blocked = std::max(blocked, bilinear(z, column, row) - ray);
      }
      result(r, c) = std::clamp(1 - blocked / penumbra_mm, 0.0, 1.0);
    }
  return result;
}

}  // namespace formwright
