// SPDX-License-Identifier: GPL-3.0-or-later
// What a Membrane says of itself: energy, stress, thickness and the bound of its frequencies.
#include <algorithm>
#include <cmath>

#include "foreign_laboratory/sheet/membrane_shape.h"

namespace formwright::foreign_laboratory {

double Membrane::energy_mj(const Points& x) const {
  double sum = 0;
  for (int c = 0; c < grid_.cell_count(); ++c) {
    const Shape s = shape_of(c, x);
    const Cell& cell = cells_[static_cast<std::size_t>(c)];
    const Tensor t = total(cell);
    Four density = 0.5 * (t.xx * s.cxx + 2 * t.xy * s.cxy + t.yy * s.cyy + t.zz * s.zz);
    if (!chains_.empty()) {
      const Chains& chains = chains_[static_cast<std::size_t>(c)];
      const Four& squared_stretch = chains_along_x_ ? s.cxx : s.cyy;
      const Four square = chains.lasting.square + chains.relaxing[0].square + chains.relaxing[1].square;
      const Four stretch = chains.lasting.stretch + chains.relaxing[0].stretch + chains.relaxing[1].stretch;
      density += 0.5 * square * squared_stretch + stretch / squared_stretch.sqrt();
    }
    sum += (cell.volume_mm3 * density).sum();
  }
  return sum;
}

double Membrane::max_squared_frequency(const Points& x) const {
  // The second variation of the energy density by a displacement u with gradient g is at most |u|^2 g (X + 3 p C^-1) g,
  // plus y + 2 z/stretch^3 for chains along one direction. A cell's shape functions have at most
  // max(4/hx^2, 4/hy^2, 4/3 (1/hx^2 + 1/hy^2)) of squared gradient for a unit of lumped mass.
  const double per_x = 1 / (grid_.spacing_x_mm() * grid_.spacing_x_mm());
  const double per_y = 1 / (grid_.spacing_y_mm() * grid_.spacing_y_mm());
  const double gradient = std::max({4 * per_x, 4 * per_y, 4.0 / 3 * (per_x + per_y)});
  double largest = 0;
  for (int c = 0; c < grid_.cell_count(); ++c) {
    const Shape s = shape_of(c, x);
    const Cell& cell = cells_[static_cast<std::size_t>(c)];
    const Tensor t = total(cell);
    const Four across = 3 * s.zz * t.zz;
    Four xx = t.xx + across * s.inverse.xx, yy = t.yy + across * s.inverse.yy;
    const Four xy = t.xy + across * s.inverse.xy;
    if (!chains_.empty()) {
      const Chains& chains = chains_[static_cast<std::size_t>(c)];
      const Four& squared_stretch = chains_along_x_ ? s.cxx : s.cyy;
      const Four square = chains.lasting.square + chains.relaxing[0].square + chains.relaxing[1].square;
      const Four stretch = chains.lasting.stretch + chains.relaxing[0].stretch + chains.relaxing[1].stretch;
      (chains_along_x_ ? xx : yy) += square + 2 * stretch / (squared_stretch * squared_stretch.sqrt());
    }
    const Four stiffest = 0.5 * (xx + yy) + (0.25 * (xx - yy).square() + xy.square()).sqrt();
    // The lumped mass takes the cell's mean thickness, the stiffness that of each point.
    const double uneven = cell.volume_mm3.maxCoeff() / cell.volume_mm3.mean();
    largest = std::max(largest, stiffest.maxCoeff() * uneven);
  }
  return largest * gradient / polymer_.density_t_per_mm3;
}

Eigen::VectorXd Membrane::thickness_mm(const Points& x) const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(grid_.node_count()), count = sum;
  const double area = grid_.spacing_x_mm() * grid_.spacing_y_mm() / 4;
  for (int c = 0; c < grid_.cell_count(); ++c) {
    const Shape s = shape_of(c, x);
    const double mean = (cells_[static_cast<std::size_t>(c)].volume_mm3 / area * s.zz.sqrt()).mean();
    for (const int node : s.corner) sum[node] += mean, count[node] += 1;
  }
  return sum.cwiseQuotient(count);
}

double Membrane::mean_stress_mpa(const Points& x) const {
  double sum = 0, volume = 0;
  for (int index = 0; index < grid_.cell_count(); ++index) {
    const Shape s = shape_of(index, x);
    Four sxx, sxy, syy;
    second_piola_kirchhoff(index, s, sxx, sxy, syy);
    // F S F^T has the eigenvalues of S C, whose trace and determinant these are.
    const Four trace = sxx * s.cxx + 2 * sxy * s.cxy + syy * s.cyy;
    const Four determinant = (sxx * syy - sxy * sxy) / s.zz;
    const Four larger = 0.5 * trace + (0.25 * trace.square() - determinant).max(0).sqrt();
    const Cell& cell = cells_[static_cast<std::size_t>(index)];
    sum += (cell.volume_mm3 * larger).sum();
    volume += cell.volume_mm3.sum();
  }
  return sum / volume;
}

}  // namespace formwright::foreign_laboratory
