// SPDX-License-Identifier: GPL-3.0-or-later
#include "foreign_laboratory/sheet/membrane.h"

#include <cmath>
#include <stdexcept>

#include "foreign_laboratory/sheet/membrane_shape.h"

namespace formwright::foreign_laboratory {

using namespace membrane_detail;

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

}  // namespace formwright::foreign_laboratory
