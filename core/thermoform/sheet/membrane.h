// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The sheet resists stretching, flows and thins: thesis 4.2.2. Discrete viscous sheets (Batty, Uribe, Audoly,
// Grinspun 2012) with additive plasticity on the Green strain (eq. 4.1 and what follows it). With the incompressible
// law the elastic energy is that of rubber [Tre75], by volume. Beside what flows there may be a network of chains that
// never does: Green and Tobolsky's lasting part of a melt (1946).
//
// Units inside the simulation: mm, N and s; stress in MPa = N/mm^2, energy in mJ, mass in tonnes (N s^2/mm).
#include <span>
#include <vector>

#include "base/lanes.h"
#include "geometry/mesh/triangle_mesh.h"
#include "thermoform/solver/block_matrix.h"
#include "thermoform/sheet/membrane_stiffness.h"
#include "thermoform/sheet/thermoform_options.h"

namespace formwright {

struct MembraneMaterial {
  ElasticLaw elastic_law = ElasticLaw::st_venant_kirchhoff;
  YieldRule yield_rule = YieldRule::elastic_excess;
  double young_mpa = 2.75;
  double poisson_ratio = 0.35;
  double creep_per_s = 500;
  double yield_strain = 0.1;
  double viscosity_s = 2.5e-5;
  double flow_stop_mm = 0.2;
  double anisotropy =
      0;  // stiffness along x times 1 + anisotropy, along y times 1 - anisotropy, between them their geometric mean
  double network_share = 0;  // of the stiffness: it never flows, and has no stress where the sheet is flat
};

/// What varies over the sheet: factors, one a triangle; nothing where all are 1.
struct SheetVariation {
  std::vector<double> thickness, stiffness;
};

namespace membrane_detail {
struct Strain;
struct Deformation;
struct RestFrame;
struct Response;
}  // namespace membrane_detail

/// Which vertices do not move by themselves: clamped or stuck.
using HeldVertices = std::vector<char>;

/// The rest state is kept as the inverse of each triangle's rest edges, which determines its metric and so, as in the
/// thesis, its squared rest edge lengths (T s = e; rest_triangle.h). A step goes begin_step, add_forces as often as
/// Newton asks, end_step.
class Membrane {
 public:
  /// `flat_mm`: n x 2, the undeformed sheet, whose triangles have positive area.
  Membrane(const TextureCoordinates& flat_mm, const Triangles& F, double thickness_mm, const MembraneMaterial& material,
           const SheetVariation& variation = {});

  /// Looks up where add_forces will write; `matrix` must live, and keep its pattern, as long as it is used.
  void use_matrix(const BlockMatrix& matrix);

  /// Thickness from the constant volume, h = V/A at `x` (n x 3), and the strain that viscosity counts from.
  void begin_step(const Positions& x, const HeldVertices& held);

  /// Adds the forces -dE/dx (N) at the end of a step of `dt_s`, where E is the elastic energy E_s of what does not flow
  /// within the step plus the viscous one (o/dt) E_s(x, x_k); and, unless `matrix` (see use_matrix) is null, a positive
  /// semi-definite approximation of d2E/dx2 (exact in tension, with nothing flowing). Only rows begin <= v < end are
  /// written, so that threads may share the work; triangles whose vertices are all held are left out.
  void add_forces(const Positions& x, double dt_s, int begin, int end, Positions& force, BlockMatrix* matrix) const;

  /// The same of the triangles first_face <= f < end_face alone, to any row; first_face is a multiple of four.
  void add_forces_of(int first_face, int end_face, const Positions& x, double dt_s, Positions& force,
                     BlockMatrix* matrix) const;

  /// The energy (mJ) whose gradient add_forces gives, where nothing flows within the step (dt_s = infinity leaves
  /// viscosity out; creep is ignored).
  double energy(const Positions& x, double dt_s) const;

  /// Plastic flow of a step of `dt_s` that ended at `x`: eps_p += dt c_creep eps_e, implicitly. `chill` (m, or empty
  /// for as before): from now on a triangle's stiffness is that many times its own, its flow that many times slower,
  /// its stress as it was.
  void end_step(const Positions& x, double dt_s, std::span<const double> chill = {});

  const std::vector<double>& thickness_mm() const { return thickness_mm_; }  // m, of the last begin_step
  const std::vector<double>& volume_mm3() const { return volume_mm3_; }      // m, constant
  /// m: how many times stiffer than the material's modulus each triangle is now.
  std::vector<double> stiffness_factors() const;
  const Triangles& F() const { return F_; }
  int face_count() const { return static_cast<int>(F_.rows()); }

  /// Squared lengths of a face's rest edges 01, 12, 20 (mm^2).
  Vec3 rest_squared_lengths(int face) const;
  /// Frobenius norm of the elastic Green strain at `x`.
  double elastic_strain(const Positions& x, int face) const;

 private:
  struct alignas(32) Group;  // four triangles
  /// What the even law sees of a strain.
  membrane_detail::Strain scaled(const membrane_detail::Strain& strain) const;
  /// Of what flows: stress, with viscosity, and its tangent within a step.
  template <ElasticLaw law, bool with_matrix>
  void flowing_response(const Group& group, const membrane_detail::Strain& strain, double dt_s,
                        membrane_detail::Response& response) const;
  /// Adds a response's forces on corners 1 and 2, times `weight`; its stiffness is written to `stiffness`.
  template <bool with_matrix>
  void add_response(const membrane_detail::Response& in_even_sheet, const membrane_detail::Deformation& deformation,
                    const membrane_detail::RestFrame& rest, const Double4& weight, Double4 (&force1)[3],
                    Double4 (&force2)[3], CornerBlocks* stiffness) const;
  template <ElasticLaw law, bool with_matrix>
  void add_group(const Group& group, const Positions& x, double dt_s, int begin, int end, Positions& force,
                 BlockMatrix* matrix) const;

  void add_any(std::size_t group, const Positions& x, double dt_s, int begin, int end, Positions& force,
               BlockMatrix* matrix) const;

  Triangles F_;
  MembraneMaterial material_;
  std::vector<Group> groups_;
  std::vector<char> active_;  // per group: some vertex is free
  std::vector<double> thickness_mm_, volume_mm3_;
  double along_ = 1, across_ = 1, diagonal_ = 1;  // square roots of the stiffness's factors in x, in y, between
  std::vector<std::array<int, 9>> slots_;         // per triangle, of corner a with corner b

 public:
  ~Membrane();
  Membrane(Membrane&&) noexcept;
};

}  // namespace formwright
