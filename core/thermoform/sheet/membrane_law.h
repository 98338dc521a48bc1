// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The elastic laws in the plane, four triangles at a time: stress, stiffness and energy of a strain.
#include "thermoform/sheet/membrane_group.h"

namespace formwright::membrane_detail {

/// 2D Lame parameters of plane stress, MPa; lambda is that of the stable neo-Hookean energy
/// mu/2 (tr C - 2) - mu (J - 1) + lambda/2 (J - 1)^2 (Smith, de Goes, Kim 2018, in two dimensions and without the
/// logarithm, which keeps rest stability when lambda = lambda_Lame + mu).
struct Lame {
  double mu, lambda;
};
inline Lame lame(double young_mpa, double poisson_ratio) {
  const double mu = young_mpa / (2 * (1 + poisson_ratio));
  return {mu, young_mpa * poisson_ratio / (1 - poisson_ratio * poisson_ratio) + mu};
}

/// Of det C, below which the incompressible law's 1 / det C goes on along its tangent: it would push without bound
/// where a real sheet wrinkles.
constexpr double min_squared_area_ratio = 0.25;

/// Second Piola-Kirchhoff stress and its tangent over (e00, e11, 2 e01), MPa.
struct Response {
  Double4 s00, s01, s11, d00, d01, d02, d11, d12, d22;
};

/// The response to the share `kept` of a Green strain `e`. The tangent is over that share, and for the neo-Hookean law
/// without its negative parts.
template <ElasticLaw law>
inline void respond(const MembraneMaterial& material, double young_mpa, const Strain& e, const Double4& kept,
                    Response& r) {
  const double nu = material.poisson_ratio, plane = young_mpa / (1 - nu * nu);
  if constexpr (law == ElasticLaw::st_venant_kirchhoff) {
    r.d00 = r.d11 = Double4{} + plane;
    r.d01 = Double4{} + plane * nu;
    r.d22 = Double4{} + plane * 0.5 * (1 - nu);
    r.d02 = r.d12 = Double4{};
    r.s00 = kept * (r.d00 * e.e00 + r.d01 * e.e11);
    r.s11 = kept * (r.d01 * e.e00 + r.d11 * e.e11);
    r.s01 = kept * (2.0 * r.d22 * e.e01);
  } else if constexpr (law == ElasticLaw::incompressible_neo_hookean) {
    // S = mu (1 - C^-1 / det C), the stress across the sheet being zero; the tangent is positive everywhere.
    const double mu = young_mpa / 3;
    const Double4 c00 = 1.0 + 2.0 * kept * e.e00, c01 = 2.0 * kept * e.e01, c11 = 1.0 + 2.0 * kept * e.e11;
    const Double4 determinant = maximum(c00 * c11 - c01 * c01, Double4{} + min_squared_area_ratio);
    const Double4 i00 = c11 / determinant, i01 = -c01 / determinant, i11 = c00 / determinant;
    const Double4 p = mu / determinant, twice = 2.0 * p;
    r.s00 = mu - p * i00;
    r.s01 = -p * i01;
    r.s11 = mu - p * i11;
    r.d00 = 2.0 * twice * i00 * i00;
    r.d01 = twice * (i00 * i11 + i01 * i01);
    r.d02 = 2.0 * twice * i00 * i01;
    r.d11 = 2.0 * twice * i11 * i11;
    r.d12 = 2.0 * twice * i11 * i01;
    r.d22 = twice * (i01 * i01 + 0.5 * (i00 * i11 + i01 * i01));
  } else {
    const Lame l = lame(young_mpa, nu);
    const Double4 c00 = 1.0 + 2.0 * kept * e.e00, c01 = 2.0 * kept * e.e01, c11 = 1.0 + 2.0 * kept * e.e11;
    const Double4 determinant = maximum(c00 * c11 - c01 * c01, Double4{} + 1e-9);
    const Double4 J = root(determinant), i00 = c11 / determinant, i01 = -c01 / determinant, i11 = c00 / determinant,
                  zero{};
    const Double4 p = (l.lambda * (J - 1.0) - l.mu) * J;
    r.s00 = l.mu + p * i00;
    r.s01 = p * i01;
    r.s11 = l.mu + p * i11;
    const Double4 outer = maximum((l.lambda * (2.0 * J - 1.0) - l.mu) * J, zero), inner = maximum(-2.0 * p, zero);
    r.d00 = outer * i00 * i00 + inner * i00 * i00;
    r.d01 = outer * i00 * i11 + inner * i01 * i01;
    r.d02 = outer * i00 * i01 + inner * i00 * i01;
    r.d11 = outer * i11 * i11 + inner * i11 * i11;
    r.d12 = outer * i11 * i01 + inner * i11 * i01;
    r.d22 = outer * i01 * i01 + inner * 0.5 * (i00 * i11 + i01 * i01);
  }
}

/// Energy per volume (mJ/mm^3) of the St. Venant-Kirchhoff law, which viscosity follows under either law.
inline Double4 stretching_density(const MembraneMaterial& material, double young_mpa, const Strain& e) {
  const double nu = material.poisson_ratio, plane = young_mpa / (1 - nu * nu);
  const Double4 trace = e.e00 + e.e11;
  return Double4((1 - nu) * (e.e00 * e.e00 + 2.0 * e.e01 * e.e01 + e.e11 * e.e11) + nu * trace * trace) * (0.5 * plane);
}

/// Energy per volume (mJ/mm^3) of the material's law.
inline Double4 energy_density(const MembraneMaterial& material, double young_mpa, const Strain& e) {
  if (material.elastic_law == ElasticLaw::st_venant_kirchhoff) return stretching_density(material, young_mpa, e);
  const Double4 c00 = 1.0 + 2.0 * e.e00, c01 = 2.0 * e.e01, c11 = 1.0 + 2.0 * e.e11;
  if (material.elastic_law == ElasticLaw::incompressible_neo_hookean) {
    const Double4 determinant = c00 * c11 - c01 * c01;
    const Double4 bounded = maximum(determinant, Double4{} + min_squared_area_ratio);
    return young_mpa / 6 * (c00 + c11 + 1.0 / bounded - (determinant - bounded) / (bounded * bounded) - 3.0);
  }
  const Lame l = lame(young_mpa, material.poisson_ratio);
  const Double4 J = root(maximum(c00 * c11 - c01 * c01, Double4{} + 1e-9));
  return 0.5 * l.mu * (c00 + c11 - 2.0) - l.mu * (J - 1.0) + 0.5 * l.lambda * (J - 1.0) * (J - 1.0);
}

}  // namespace formwright::membrane_detail
