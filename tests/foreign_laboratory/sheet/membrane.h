// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// An incompressible membrane of bilinear quadrilaterals with 2 x 2 Gauss points, in large strain.
//
// Stress. A network of shear modulus mu whose chains formed in the shapes C(s) of the past carries the second
// Piola-Kirchhoff stress S = X - p C^-1, X = mu times the mean of C(s)^-1 over the chains ([Lod64], ch. 6; for
// chains that never break X = mu I, the neo-Hookean solid). p follows from plane stress: S_33 = 0, C_33 = 1/det C.
// Chains that break after tau and form again make X' = (mu C^-1 - X)/tau. The recursion of [TPG70] is exact where C^-1
// changes linearly within a step. A sheet that grows stiffer by cooling gains chains in its present shape, which carry
// no stress until it changes again.
#include <Eigen/Core>
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "foreign_laboratory/sheet/polymer.h"

namespace formwright::foreign_laboratory {

using Points = Eigen::Matrix<double, 3, Eigen::Dynamic>;  // one column a node

/// A rectangle of nodes over the clamp's opening, centred on it.
struct Grid {
  int cells_x = 60, cells_y = 60;
  double width_mm = 220, length_mm = 240;

  int node(int i, int j) const { return i + (cells_x + 1) * j; }
  int node_count() const { return (cells_x + 1) * (cells_y + 1); }
  int cell_count() const { return cells_x * cells_y; }
  double spacing_x_mm() const { return width_mm / cells_x; }
  double spacing_y_mm() const { return length_mm / cells_y; }
  bool on_rim(int node) const;
  Eigen::Vector2d flat_mm(int node) const;
  /// The nodes of a cell, counter-clockwise from its corner of least x and y.
  std::array<int, 4> corners(int cell) const;
};

/// What the flat sheet is before it is heated.
struct FlatSheet {
  std::function<double(double x_mm, double y_mm)> thickness_mm = [](double, double) { return 1.0; };
  /// From extrusion: Young's modulus along x is 1 + this times the even sheet's, along y a little more than 1 - this.
  /// Between -0.9 and 0.9. Made by chains along the stiffer direction beside a softer even network.
  double anisotropy = 0;
};

class Membrane {
 public:
  /// Flat, without stress, at the polymer's forming temperature.
  Membrane(const Grid& grid, const Polymer& polymer, const FlatSheet& flat);

  /// One temperature a node. Where it falls relaxation slows down and chains form in the present shape.
  void set_temperatures(std::span<const double> node_k);

  /// The step that networks are advanced by; positive.
  void set_step(double step_s);
  /// Advances the networks by a step that ends at `x`, and gives what acts on the nodes there: the membrane's stress
  /// and `pressure_mpa` from above.
  void advance(const Points& x, double pressure_mpa, Points& force_n);
  /// The same without advancing.
  void forces(const Points& x, double pressure_mpa, Points& force_n) const;
  /// Free energy of the networks as they are, with the shape at `x`; forces() without pressure is minus its gradient.
  double energy_mj(const Points& x) const;

  /// Mass of the nodes (a fourth of each cell around) in tonnes.
  const Eigen::VectorXd& mass_t() const { return mass_t_; }
  /// Largest squared angular frequency (1/s^2) that the membrane can have at `x` with these masses, from above: the
  /// largest of any cell alone [FB84].
  double max_squared_frequency(const Points& x) const;
  /// Thickness at the nodes: the mean of the Gauss points around.
  Eigen::VectorXd thickness_mm(const Points& x) const;
  /// Mean over the sheet's volume of the larger principal Cauchy stress.
  double mean_stress_mpa(const Points& x) const;
  /// Volume between the membrane and z = 0, of the last call of advance().
  double enclosed_mm3() const { return enclosed_mm3_; }

  const Grid& grid() const { return grid_; }

 private:
  using Four = Eigen::Array4d;  // the Gauss points of a cell
  struct Tensor {               // symmetric; components 11, 12, 22, 33
    Four xx = Four::Zero(), xy = Four::Zero(), yy = Four::Zero(), zz = Four::Zero();
  };
  struct Cell {
    Tensor lasting, inverse;  // X of the network that lasts; C^-1 at the end of the last step
    std::array<Tensor, 2> relaxing;
    Four volume_mm3;
    // A step keeps `kept` of X and adds `early` C^-1 of its start and `late` C^-1 of its end.
    std::array<double, 2> kept{}, early{}, late{};
    std::array<double, 2> modulus_mpa{}, relaxation_s{};
    double stiffening = 1;  // modulus over that at forming temperature
  };
  /// Chains along the stiffer direction: mean of 1/stretch^2 and of the stretch at which they formed, times modulus.
  struct Chains {
    struct Network {
      Four square = Four::Zero(), stretch = Four::Zero();
    };
    Network lasting;
    std::array<Network, 2> relaxing;
    Four inverse = Four::Ones(), length = Four::Ones();  // at the end of the last step
  };
  struct Shape;

  Shape shape_of(int cell, const Points& x) const;
  void update_step(Cell& cell) const;
  void relax(Cell& cell, const Tensor& inverse) const;
  void relax(const Cell& cell, Chains& chains, const Four& squared_stretch) const;
  Tensor total(const Cell& cell) const;
  Four chain_stress(const Chains& chains, const Four& squared_stretch) const;
  void add_forces(int cell, const Shape& shape, double pressure_mpa, Points& force_n) const;
  void form_chains(std::size_t cell, double modulus_share);
  void second_piola_kirchhoff(int cell, const Shape& shape, Four& sxx, Four& sxy, Four& syy) const;

  Grid grid_;
  Polymer polymer_;
  double even_share_ = 1, chain_share_ = 0;  // of the moduli: in the even network, in chains along one direction
  bool chains_along_x_ = true;
  double step_s_ = 0, enclosed_mm3_ = 0;
  std::vector<Cell> cells_;
  std::vector<Chains> chains_;  // one a cell, or none where the sheet is even
  Eigen::VectorXd mass_t_;
};

}  // namespace formwright::foreign_laboratory
