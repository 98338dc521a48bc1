// SPDX-License-Identifier: GPL-3.0-or-later
#include "foreign_laboratory/membrane.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace formwright::foreign_laboratory {
namespace {

using Four = Eigen::Array4d;
using Vector4 = std::array<Four, 3>;

// Gauss points of a cell from -1 to 1 in both directions, in the order of its corners.
const double gauss = 1 / std::sqrt(3.0);
const Four low_x = 0.5 * (1 - Four(-gauss, gauss, gauss, -gauss)), high_x = 1 - low_x;
const Four low_y = 0.5 * (1 - Four(-gauss, -gauss, gauss, gauss)), high_y = 1 - low_y;
const std::array<Four, 4> corner_weight = {low_x * low_y, high_x* low_y, high_x* high_y, low_x* high_y};

Vector4 cross(const Vector4& a, const Vector4& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace

bool Grid::on_rim(int node) const {
  const int i = node % (cells_x + 1), j = node / (cells_x + 1);
  return i == 0 || i == cells_x || j == 0 || j == cells_y;
}

Eigen::Vector2d Grid::flat_mm(int node) const {
  // Counted from the middle, so that mirrored nodes have the same coordinates to the last bit.
  const int i = node % (cells_x + 1), j = node / (cells_x + 1);
  return {0.5 * (2 * i - cells_x) * spacing_x_mm(), 0.5 * (2 * j - cells_y) * spacing_y_mm()};
}

std::array<int, 4> Grid::corners(int cell) const {
  const int first = node(cell % cells_x, cell / cells_x);
  return {first, first + 1, first + cells_x + 2, first + cells_x + 1};
}

/// Deformation gradient (its two columns) and what follows from it, at the Gauss points of a cell.
struct Membrane::Shape {
  Vector4 along_x, along_y, area;  // area: the cross product of the columns
  Four cxx, cxy, cyy, zz;          // C; its component across the sheet, 1/det
  Tensor inverse;                  // C^-1
  std::array<int, 4> corner;
  Four height;
};

Membrane::Membrane(const Grid& grid, const Polymer& polymer, const FlatSheet& flat) : grid_(grid), polymer_(polymer) {
  if (grid.cells_x < 1 || grid.cells_y < 1 || !(grid.width_mm > 0) || !(grid.length_mm > 0))
    throw std::invalid_argument("grid: give at least one cell in each direction and positive lengths");
  if (!(std::abs(flat.anisotropy) <= 0.9)) throw std::invalid_argument("anisotropy: give a number from -0.9 to 0.9");
  even_share_ = 1 - std::abs(flat.anisotropy);
  chain_share_ = 2 * std::abs(flat.anisotropy);
  chains_along_x_ = flat.anisotropy > 0;
  cells_.resize(static_cast<std::size_t>(grid.cell_count()));
  if (chain_share_ > 0) chains_.resize(cells_.size());
  mass_t_ = Eigen::VectorXd::Zero(grid.node_count());
  const double area = grid.spacing_x_mm() * grid.spacing_y_mm() / 4;
  const Four ones = Four::Ones();
  for (int c = 0; c < grid.cell_count(); ++c) {
    Cell& cell = cells_[static_cast<std::size_t>(c)];
    const std::array<int, 4> corner = grid.corners(c);
    const Eigen::Vector2d middle = 0.5 * (grid.flat_mm(corner[0]) + grid.flat_mm(corner[2]));
    const double signs_x[] = {-1, 1, 1, -1}, signs_y[] = {-1, -1, 1, 1};
    for (int g = 0; g < 4; ++g) {
      const double thickness = flat.thickness_mm(middle.x() + signs_x[g] * gauss / 2 * grid.spacing_x_mm(),
                                                 middle.y() + signs_y[g] * gauss / 2 * grid.spacing_y_mm());
      if (!(thickness > 0)) throw std::invalid_argument("thickness_mm: give a sheet that is thicker than 0 everywhere");
      cell.volume_mm3[g] = thickness * area;
    }
    for (const int node : corner) mass_t_[node] += polymer.density_t_per_mm3 * cell.volume_mm3.sum() / 4;
    cell.inverse = {ones, Four::Zero(), ones, ones};
    const auto at_rest = [&](double modulus) {
      const double even = even_share_ * modulus;
      return Tensor{even * ones, Four::Zero(), even * ones, even * ones};
    };
    cell.lasting = at_rest(polymer.lasting_modulus_mpa);
    for (std::size_t k = 0; k < 2; ++k) {
      cell.modulus_mpa[k] = polymer.relaxing_modulus_mpa[k];
      cell.relaxation_s[k] = polymer.relaxation_s[k];
      cell.relaxing[k] = at_rest(cell.modulus_mpa[k]);
    }
    if (chain_share_ > 0) {
      Chains& chains = chains_[static_cast<std::size_t>(c)];
      const auto chains_at_rest = [&](double modulus) {
        return Chains::Network{chain_share_ * modulus * ones, chain_share_ * modulus * ones};
      };
      chains.lasting = chains_at_rest(polymer.lasting_modulus_mpa);
      for (std::size_t k = 0; k < 2; ++k) chains.relaxing[k] = chains_at_rest(polymer.relaxing_modulus_mpa[k]);
    }
  }
}

Membrane::Shape Membrane::shape_of(int cell, const Points& x) const {
  Shape s;
  s.corner = grid_.corners(cell);
  const double per_x = 1 / grid_.spacing_x_mm(), per_y = 1 / grid_.spacing_y_mm();
  const auto a = x.col(s.corner[0]), b = x.col(s.corner[1]), c = x.col(s.corner[2]), d = x.col(s.corner[3]);
  for (Eigen::Index k = 0; k < 3; ++k) {
    s.along_x[static_cast<std::size_t>(k)] = low_y * ((b[k] - a[k]) * per_x) + high_y * ((c[k] - d[k]) * per_x);
    s.along_y[static_cast<std::size_t>(k)] = low_x * ((d[k] - a[k]) * per_y) + high_x * ((c[k] - b[k]) * per_y);
  }
  s.cxx = s.along_x[0] * s.along_x[0] + s.along_x[1] * s.along_x[1] + s.along_x[2] * s.along_x[2];
  s.cxy = s.along_x[0] * s.along_y[0] + s.along_x[1] * s.along_y[1] + s.along_x[2] * s.along_y[2];
  s.cyy = s.along_y[0] * s.along_y[0] + s.along_y[1] * s.along_y[1] + s.along_y[2] * s.along_y[2];
  const Four determinant = s.cxx * s.cyy - s.cxy * s.cxy;
  s.zz = 1 / determinant;
  s.inverse = {s.cyy * s.zz, -s.cxy * s.zz, s.cxx * s.zz, determinant};
  s.area = cross(s.along_x, s.along_y);
  s.height = a[2] * corner_weight[0] + b[2] * corner_weight[1] + c[2] * corner_weight[2] + d[2] * corner_weight[3];
  return s;
}

void Membrane::update_step(Cell& cell) const {
  for (std::size_t k = 0; k < 2; ++k) {
    const double ratio = step_s_ / cell.relaxation_s[k];
    const double kept = std::exp(-ratio);
    const double mean = ratio > 1e-8 ? -std::expm1(-ratio) / ratio : 1 - ratio / 2;
    const double modulus = even_share_ * cell.modulus_mpa[k];
    cell.kept[k] = kept;
    cell.early[k] = modulus * (mean - kept);
    cell.late[k] = modulus * (1 - mean);
  }
}

void Membrane::set_step(double step_s) {
  if (!(step_s > 0) || !std::isfinite(step_s)) throw std::invalid_argument("step_s: give a positive number");
  if (step_s == step_s_) return;
  step_s_ = step_s;
  for (Cell& cell : cells_) update_step(cell);
}

void Membrane::form_chains(std::size_t index, double added) {
  Cell& cell = cells_[index];
  const auto add = [&](Tensor& x, double modulus) {
    const double even = even_share_ * modulus;
    x.xx += even * cell.inverse.xx;
    x.xy += even * cell.inverse.xy;
    x.yy += even * cell.inverse.yy;
    x.zz += even * cell.inverse.zz;
  };
  add(cell.lasting, added * polymer_.lasting_modulus_mpa);
  for (std::size_t k = 0; k < 2; ++k) add(cell.relaxing[k], added * polymer_.relaxing_modulus_mpa[k]);
  if (chains_.empty()) return;
  Chains& chains = chains_[index];
  const auto add_chains = [&](Chains::Network& network, double modulus) {
    network.square += chain_share_ * modulus * chains.inverse;
    network.stretch += chain_share_ * modulus * chains.length;
  };
  add_chains(chains.lasting, added * polymer_.lasting_modulus_mpa);
  for (std::size_t k = 0; k < 2; ++k) add_chains(chains.relaxing[k], added * polymer_.relaxing_modulus_mpa[k]);
}

void Membrane::set_temperatures(std::span<const double> node_k) {
  if (node_k.size() != static_cast<std::size_t>(grid_.node_count()))
    throw std::invalid_argument("node_k: give one temperature a node");
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    Cell& cell = cells_[c];
    const std::array<int, 4> corner = grid_.corners(static_cast<int>(c));
    double kelvin = 0;
    for (const int node : corner) kelvin += node_k[static_cast<std::size_t>(node)] / 4;
    const double slower = relaxation_time_shift(polymer_, kelvin), stiffer = modulus_shift(polymer_, kelvin);
    if (stiffer > cell.stiffening) form_chains(c, stiffer - cell.stiffening);
    else if (stiffer < cell.stiffening) {
      const double share = stiffer / cell.stiffening;
      const auto soften = [&](Tensor& x) { x.xx *= share, x.xy *= share, x.yy *= share, x.zz *= share; };
      soften(cell.lasting);
      for (Tensor& x : cell.relaxing) soften(x);
      if (!chains_.empty()) {
        Chains& chains = chains_[c];
        for (Chains::Network* network : {&chains.lasting, &chains.relaxing[0], &chains.relaxing[1]})
          network->square *= share, network->stretch *= share;
      }
    }
    cell.stiffening = stiffer;
    for (std::size_t k = 0; k < 2; ++k) {
      cell.modulus_mpa[k] = stiffer * polymer_.relaxing_modulus_mpa[k];
      cell.relaxation_s[k] = slower * polymer_.relaxation_s[k];
    }
    if (step_s_ > 0) update_step(cell);
  }
}

void Membrane::relax(Cell& cell, const Tensor& inverse) const {
  for (std::size_t k = 0; k < 2; ++k) {
    Tensor& x = cell.relaxing[k];
    const double kept = cell.kept[k], early = cell.early[k], late = cell.late[k];
    x.xx = kept * x.xx + early * cell.inverse.xx + late * inverse.xx;
    x.xy = kept * x.xy + early * cell.inverse.xy + late * inverse.xy;
    x.yy = kept * x.yy + early * cell.inverse.yy + late * inverse.yy;
    x.zz = kept * x.zz + early * cell.inverse.zz + late * inverse.zz;
  }
  cell.inverse = inverse;
}

void Membrane::relax(const Cell& cell, Chains& chains, const Four& squared_stretch) const {
  const Four inverse = 1 / squared_stretch, length = squared_stretch.sqrt();
  const double share = chain_share_ / even_share_;
  for (std::size_t k = 0; k < 2; ++k) {
    const double early = share * cell.early[k], late = share * cell.late[k];
    Chains::Network& network = chains.relaxing[k];
    network.square = cell.kept[k] * network.square + early * chains.inverse + late * inverse;
    network.stretch = cell.kept[k] * network.stretch + early * chains.length + late * length;
  }
  chains.inverse = inverse;
  chains.length = length;
}

Membrane::Tensor Membrane::total(const Cell& cell) const {
  const Tensor &a = cell.lasting, &b = cell.relaxing[0], &c = cell.relaxing[1];
  return {a.xx + b.xx + c.xx, a.xy + b.xy + c.xy, a.yy + b.yy + c.yy, a.zz + b.zz + c.zz};
}

Membrane::Four Membrane::chain_stress(const Chains& chains, const Four& squared_stretch) const {
  const Four square = chains.lasting.square + chains.relaxing[0].square + chains.relaxing[1].square;
  const Four stretch = chains.lasting.stretch + chains.relaxing[0].stretch + chains.relaxing[1].stretch;
  return square - stretch / (squared_stretch * squared_stretch.sqrt());
}

void Membrane::second_piola_kirchhoff(int index, const Shape& s, Four& sxx, Four& sxy, Four& syy) const {
  const Tensor x = total(cells_[static_cast<std::size_t>(index)]);
  const Four across = s.zz * x.zz;  // p of the header
  sxx = x.xx - across * s.inverse.xx;
  sxy = x.xy - across * s.inverse.xy;
  syy = x.yy - across * s.inverse.yy;
  if (chains_.empty()) return;
  const Chains& chains = chains_[static_cast<std::size_t>(index)];
  if (chains_along_x_) sxx += chain_stress(chains, s.cxx);
  else syy += chain_stress(chains, s.cyy);
}

void Membrane::add_forces(int index, const Shape& s, double pressure_mpa, Points& force) const {
  const Cell& cell = cells_[static_cast<std::size_t>(index)];
  Four sxx, sxy, syy;
  second_piola_kirchhoff(index, s, sxx, sxy, syy);
  const double pressing = pressure_mpa * grid_.spacing_x_mm() * grid_.spacing_y_mm() / 4;
  const Four weight_x = cell.volume_mm3 / grid_.spacing_x_mm(), weight_y = cell.volume_mm3 / grid_.spacing_y_mm();
  for (std::size_t k = 0; k < 3; ++k) {
    const Four along_x = weight_x * (s.along_x[k] * sxx + s.along_y[k] * sxy);
    const Four along_y = weight_y * (s.along_x[k] * sxy + s.along_y[k] * syy);
    const double front = (along_x * low_y).sum(), back = (along_x * high_y).sum();
    const double left = (along_y * low_x).sum(), right = (along_y * high_x).sum();
    const Four pressed = pressing * s.area[k];
    const auto row = static_cast<Eigen::Index>(k);
    force(row, s.corner[0]) += front + left - (pressed * corner_weight[0]).sum();
    force(row, s.corner[1]) += right - front - (pressed * corner_weight[1]).sum();
    force(row, s.corner[2]) -= back + right + (pressed * corner_weight[2]).sum();
    force(row, s.corner[3]) += back - left - (pressed * corner_weight[3]).sum();
  }
}

void Membrane::advance(const Points& x, double pressure_mpa, Points& force) {
  force.setZero(3, grid_.node_count());
  double enclosed = 0;
  const double area = grid_.spacing_x_mm() * grid_.spacing_y_mm() / 4;
  for (int c = 0; c < grid_.cell_count(); ++c) {
    const Shape s = shape_of(c, x);
    Cell& cell = cells_[static_cast<std::size_t>(c)];
    relax(cell, s.inverse);
    if (!chains_.empty()) relax(cell, chains_[static_cast<std::size_t>(c)], chains_along_x_ ? s.cxx : s.cyy);
    add_forces(c, s, pressure_mpa, force);
    enclosed += (s.height * s.area[2]).sum() * area;
  }
  enclosed_mm3_ = enclosed;
}

void Membrane::forces(const Points& x, double pressure_mpa, Points& force) const {
  force.setZero(3, grid_.node_count());
  for (int c = 0; c < grid_.cell_count(); ++c) add_forces(c, shape_of(c, x), pressure_mpa, force);
}

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
