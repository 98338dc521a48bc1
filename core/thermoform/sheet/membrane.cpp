// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/sheet/membrane.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "thermoform/sheet/membrane_group.h"
#include "thermoform/sheet/membrane_law.h"
#include "thermoform/sheet/membrane_stiffness.h"

namespace formwright {

using namespace membrane_detail;

Membrane::~Membrane() = default;
Membrane::Membrane(Membrane&&) noexcept = default;

Membrane::Membrane(const TextureCoordinates& flat_mm, const Triangles& F, double thickness_mm,
                   const MembraneMaterial& material, const SheetVariation& variation)
    : F_(F), material_(material), thickness_mm_(static_cast<std::size_t>(F.rows()), thickness_mm) {
  for (std::size_t f = 0; f < variation.thickness.size(); ++f) thickness_mm_[f] *= variation.thickness[f];
  along_ = std::sqrt(1 + material.anisotropy);
  across_ = std::sqrt(1 - material.anisotropy);
  diagonal_ = std::sqrt(along_ * across_);
  const int faces = face_count();
  groups_.resize(static_cast<std::size_t>((faces + 3) / 4));
  active_.assign(groups_.size(), 1);
  for (int g = 0; g < static_cast<int>(groups_.size()); ++g) {
    Group& group = groups_[static_cast<std::size_t>(g)];
    group.first_face = 4 * g;
    group.lanes = std::min(4, faces - 4 * g);
    group.min_vertex = std::numeric_limits<int>::max();
    group.max_vertex = 0;
    group.past00 = group.past01 = group.past11 = Double4{};
    group.creep = group.weight = group.network_weight = Double4{};
    for (int l = 0; l < 4; ++l) {
      const int face = std::min(4 * g + l, faces - 1);  // empty lanes repeat the last triangle
      Eigen::Matrix2d edges;
      for (int k = 0; k < 3; ++k) {
        const int v = F(face, k);
        group.vertex[static_cast<std::size_t>(k)][static_cast<std::size_t>(l)] = v;
        group.min_vertex = std::min(group.min_vertex, v);
        group.max_vertex = std::max(group.max_vertex, v);
        if (k > 0) edges.col(k - 1) = (flat_mm.row(v) - flat_mm.row(F(face, 0))).transpose();
      }
      const double doubled_area = edges.determinant();
      // Written out: Eigen's inverse would do, but this is the same arithmetic on every target.
      group.b00[l] = group.flat00[l] = edges(1, 1) / doubled_area;
      group.b01[l] = group.flat01[l] = -edges(0, 1) / doubled_area;
      group.b10[l] = group.flat10[l] = -edges(1, 0) / doubled_area;
      group.b11[l] = group.flat11[l] = edges(0, 0) / doubled_area;
      group.volume[l] = 0.5 * doubled_area * thickness_mm_[static_cast<std::size_t>(face)];
      group.stiffness[l] = variation.stiffness.empty() ? 1 : variation.stiffness[static_cast<std::size_t>(face)];
      group.chill[l] = 1;
      if (l < group.lanes) volume_mm3_.push_back(group.volume[l]);
    }
  }
}

void Membrane::begin_step(const Positions& x, const HeldVertices& held) {
  Deformation d, total;
  for (Group& g : groups_) {
    char& active = active_[static_cast<std::size_t>(g.first_face / 4)] = 0;
    for (int l = 0; l < g.lanes; ++l)
      for (const auto& corner : g.vertex)
        active |= held[static_cast<std::size_t>(corner[static_cast<std::size_t>(l)])] == 0;
    if (!active) continue;
    deform(g, x, false, d);
    const Strain& e = d.strain;
    g.past00 = e.e00;
    g.past01 = e.e01;
    g.past11 = e.e11;
    // Areas: the rest one is half of 1/det B, the present one that times sqrt(det C).
    const Double4 rest_area = 0.5 / (g.b00 * g.b11 - g.b01 * g.b10);
    const Double4 determinant = (2.0 * e.e00 + 1.0) * (2.0 * e.e11 + 1.0) - 4.0 * e.e01 * e.e01;
    const Double4 area = rest_area * root(maximum(determinant, Double4{} + 1e-12));
    const Double4 thickness = g.volume / area;
    // With h = V/A alone a bubble has a largest pressure, beyond which it would grow until it is nothing; plastic that
    // has been drawn out that far hardens. So the stiffness stays that of the thickness at which the flow stops.
    // The incompressible law counts the volume itself: its thickness at rest is what it has thinned from.
    const bool counts_volume = material_.elastic_law == ElasticLaw::incompressible_neo_hookean;
    const auto weight_of = [&](const Double4& rest) {
      return rest * maximum(counts_volume ? Double4(g.volume / rest) : thickness, Double4{} + material_.flow_stop_mm);
    };
    g.weight = weight_of(rest_area) * (g.stiffness * g.chill);
    // The network's state without stress is the flat sheet, and a chill does not stiffen it.
    if (material_.network_share > 0)
      g.network_weight = weight_of(0.5 / (g.flat00 * g.flat11 - g.flat01 * g.flat10)) * g.stiffness;
    g.creep = material_.creep_per_s / g.chill;
    if (material_.yield_rule == YieldRule::total_strain) {
      deform(g, x, true, total);
      g.creep = norm(total.strain) > Double4{} + material_.yield_strain ? g.creep : Double4{};
    }
    for (int l = 0; l < g.lanes; ++l) thickness_mm_[static_cast<std::size_t>(g.first_face + l)] = thickness[l];
    if (material_.flow_stop_mm > 0) {
      // Fades over a quarter of the limit, so that the end of flow does not depend on the step.
      const Double4 room = (thickness - material_.flow_stop_mm) / (0.25 * material_.flow_stop_mm);
      const Double4 one = Double4{} + 1.0, zero{};
      g.creep *= room < zero ? zero : (room > one ? one : room);
    }
  }
}

void Membrane::end_step(const Positions& x, double dt_s, std::span<const double> chill) {
  Deformation d;
  Flow f;
  for (Group& g : groups_) {
    if (!active_[static_cast<std::size_t>(g.first_face / 4)]) continue;
    deform(g, x, false, d);
    flow(d.strain, g.creep, dt_s, material_.yield_rule, material_.yield_strain, f);
    if (!chill.empty()) {
      // What grows stiffer goes on pulling as hard as it did: the elastic strain that it no longer needs becomes
      // permanent.
      for (int l = 0; l < 4; ++l) {
        const double now = chill[static_cast<std::size_t>(std::min(g.first_face + l, face_count() - 1))];
        f.kept[l] *= g.chill[l] / now;
        g.chill[l] = now;
      }
    }
    // The plastic strain of this step makes the new rest metric N = 1 + 2 eps_p; with N = U^T U, B becomes B U^-1.
    const Double4 part = 2.0 * (1.0 - f.kept);
    const Double4 n00 = 1.0 + part * d.strain.e00, n01 = part * d.strain.e01, n11 = 1.0 + part * d.strain.e11;
    if (along_ != across_) {
      // Stiffer along x: the frame must not turn with the flow, so U is the symmetric root.
      const Double4 size = root(maximum(n00 * n11 - n01 * n01, Double4{} + 1e-12)),
                    scale = 1.0 / root(n00 + n11 + 2.0 * size);
      const Double4 r00 = scale * (n00 + size), r01 = scale * n01, r11 = scale * (n11 + size),
                    determinant = r00 * r11 - r01 * r01;
      const Double4 c00 = (g.b00 * r11 - g.b01 * r01) / determinant, c10 = (g.b10 * r11 - g.b11 * r01) / determinant;
      g.b01 = (g.b01 * r00 - g.b00 * r01) / determinant;
      g.b11 = (g.b11 * r00 - g.b10 * r01) / determinant;
      g.b00 = c00;
      g.b10 = c10;
      continue;
    }
    const Double4 u00 = root(n00), u01 = n01 / u00, u11 = root(maximum(n11 - u01 * u01, Double4{} + 1e-12));
    const Double4 c00 = g.b00 / u00, c10 = g.b10 / u00;
    g.b01 = (g.b01 - c00 * u01) / u11;
    g.b11 = (g.b11 - c10 * u01) / u11;
    g.b00 = c00;
    g.b10 = c10;
  }
}

inline membrane_detail::Strain Membrane::scaled(const membrane_detail::Strain& strain) const {
  return {along_ * strain.e00, diagonal_ * strain.e01, across_ * strain.e11};
}

void Membrane::use_matrix(const BlockMatrix& matrix) {
  slots_.resize(static_cast<std::size_t>(face_count()));
  for (int f = 0; f < face_count(); ++f)
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        slots_[static_cast<std::size_t>(f)][static_cast<std::size_t>(3 * a + b)] = matrix.slot(F_(f, a), F_(f, b));
}

template <ElasticLaw law, bool with_matrix>
void Membrane::flowing_response(const Group& g, const Strain& strain, double dt_s, Response& r) const {
  Flow f;
  flow(strain, g.creep, dt_s, material_.yield_rule, material_.yield_strain, f);
  // A sheet that is stiffer along x is an even one whose strains count for more there.
  const Strain e = scaled(strain);
  respond<law>(material_, material_.young_mpa * (1 - material_.network_share), e, f.kept, r);
  const double nu = material_.poisson_ratio, plane = material_.young_mpa / (1 - nu * nu);
  const double viscous = material_.viscosity_s / dt_s;  // 0 for an endless step
  if constexpr (with_matrix) {
    // d(kept eps) = kept (d eps) less what flows along eps itself; made symmetric in the metric of D.
    const Double4 q0 = r.d00 * e.e00 + r.d01 * e.e11 + 2.0 * r.d02 * e.e01,
                  q1 = r.d01 * e.e00 + r.d11 * e.e11 + 2.0 * r.d12 * e.e01;
    const Double4 q2 = r.d02 * e.e00 + r.d12 * e.e11 + 2.0 * r.d22 * e.e01;
    const Double4 lost = f.lost / maximum(q0 * e.e00 + q1 * e.e11 + 2.0 * q2 * e.e01, Double4{} + 1e-30);
    r.d00 = f.kept * r.d00 - lost * q0 * q0 + viscous * plane;
    r.d01 = f.kept * r.d01 - lost * q0 * q1 + viscous * plane * nu;
    r.d02 = f.kept * r.d02 - lost * q0 * q2;
    r.d11 = f.kept * r.d11 - lost * q1 * q1 + viscous * plane;
    r.d12 = f.kept * r.d12 - lost * q1 * q2;
    r.d22 = f.kept * r.d22 - lost * q2 * q2 + viscous * plane * 0.5 * (1 - nu);
  }
  const Strain past = scaled({g.past00, g.past01, g.past11});
  const Double4 v00 = e.e00 - past.e00, v01 = e.e01 - past.e01, v11 = e.e11 - past.e11;
  r.s00 += viscous * plane * (v00 + nu * v11);
  r.s01 += viscous * plane * (1 - nu) * v01;
  r.s11 += viscous * plane * (nu * v00 + v11);
}

template <bool with_matrix>
void Membrane::add_response(const Response& in_even_sheet, const Deformation& d, const RestFrame& rest,
                            const Double4& w, Double4 (&force1)[3], Double4 (&force2)[3], CornerBlocks* K) const {
  Response r = in_even_sheet;
  r.s00 *= along_;
  r.s01 *= diagonal_;
  r.s11 *= across_;
  for (int k = 0; k < 3; ++k) {
    const Double4 p0 = w * (d.f0[k] * r.s00 + d.f1[k] * r.s01), p1 = w * (d.f0[k] * r.s01 + d.f1[k] * r.s11);
    force1[k] += p0 * rest.b00 + p1 * rest.b01;
    force2[k] += p0 * rest.b10 + p1 * rest.b11;
  }
  if constexpr (with_matrix) {
    r.d00 *= along_ * along_;
    r.d01 *= along_ * across_;
    r.d02 *= along_ * diagonal_;
    r.d11 *= across_ * across_;
    r.d12 *= across_ * diagonal_;
    r.d22 *= diagonal_ * diagonal_;
    // The geometric part needs a stress without compression to stay positive semi-definite.
    const Double4 zero{}, middle = 0.5 * (r.s00 + r.s11), half = 0.5 * (r.s00 - r.s11);
    const Double4 radius = root(half * half + r.s01 * r.s01);
    const Double4 small = middle - radius,
                  share = maximum(middle + radius, zero) / maximum(2.0 * radius, Double4{} + 1e-30);
    const auto pulled = small >= zero;
    const Double4 t00 = pulled ? r.s00 : share * (r.s00 - small), t01 = pulled ? r.s01 : share * r.s01,
                  t11 = pulled ? r.s11 : share * (r.s11 - small);

    const auto single = [](const Double4& value) -> Float4 { return __builtin_convertvector(value, Float4); };
    const StiffnessParts parts{{{single(rest.b00), single(rest.b01)}, {single(rest.b10), single(rest.b11)}},
                               {single(d.f0[0]), single(d.f0[1]), single(d.f0[2])},
                               {single(d.f1[0]), single(d.f1[1]), single(d.f1[2])},
                               {single(w * r.d00), single(w * r.d01), single(w * r.d02), single(w * r.d11),
                                single(w * r.d12), single(w * r.d22)},
                               {single(w * t00), single(w * t01), single(w * t11)}};
    corner_blocks(parts, *K);
  }
}

template <ElasticLaw law, bool with_matrix>
void Membrane::add_group(const Group& g, const Positions& x, double dt_s, int begin, int end, Positions& force,
                         BlockMatrix* matrix) const {
  Double4 force1[3]{}, force2[3]{};
  CornerBlocks K;
  Deformation d;
  Response r;
  deform(g, x, false, d);
  flowing_response<law, with_matrix>(g, d.strain, dt_s, r);
  add_response<with_matrix>(r, d, {g.b00, g.b01, g.b10, g.b11}, g.weight, force1, force2, &K);
  if (material_.network_share > 0) {
    deform(g, x, true, d);
    respond<law>(material_, material_.young_mpa * material_.network_share, scaled(d.strain), Double4{} + 1.0, r);
    CornerBlocks of_network;
    add_response<with_matrix>(r, d, {g.flat00, g.flat01, g.flat10, g.flat11}, g.network_weight, force1, force2,
                              &of_network);
    if constexpr (with_matrix) {
      for (int i = 0; i < 81; ++i) (&K[0][0][0][0])[i] += (&of_network[0][0][0][0])[i];
    }
  }
  for (int l = 0; l < g.lanes; ++l) {
    const auto at = static_cast<std::size_t>(l);
    const int v0 = g.vertex[0][at], v1 = g.vertex[1][at], v2 = g.vertex[2][at];
    for (int k = 0; k < 3; ++k) {
      if (v0 >= begin && v0 < end) force(v0, k) += force1[k][l] + force2[k][l];
      if (v1 >= begin && v1 < end) force(v1, k) -= force1[k][l];
      if (v2 >= begin && v2 < end) force(v2, k) -= force2[k][l];
    }
  }
  if constexpr (with_matrix) {
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) {
        std::array<std::array<Float4, 3>, 4> block;
        one_by_one(K, a, b, block);
        for (int l = 0; l < g.lanes; ++l) {
          const int row = g.vertex[a][static_cast<std::size_t>(l)];
          if (row < begin || row >= end) continue;
          auto& to = matrix->block(slots_[static_cast<std::size_t>(g.first_face + l)][3 * a + b]);
          for (std::size_t j = 0; j < 3; ++j) to[j] += block[static_cast<std::size_t>(l)][j];
        }
      }
  }
}

void Membrane::add_any(std::size_t group, const Positions& x, double dt_s, int begin, int end, Positions& force,
                       BlockMatrix* matrix) const {
  const Group& g = groups_[group];
  if (g.max_vertex < begin || g.min_vertex >= end) return;
  const auto add = [&]<ElasticLaw law>() {
    if (matrix) add_group<law, true>(g, x, dt_s, begin, end, force, matrix);
    else add_group<law, false>(g, x, dt_s, begin, end, force, nullptr);
  };
  switch (material_.elastic_law) {
    case ElasticLaw::st_venant_kirchhoff: return add.template operator()<ElasticLaw::st_venant_kirchhoff>();
    case ElasticLaw::stable_neo_hookean: return add.template operator()<ElasticLaw::stable_neo_hookean>();
    case ElasticLaw::incompressible_neo_hookean:
      return add.template operator()<ElasticLaw::incompressible_neo_hookean>();
  }
}

void Membrane::add_forces(const Positions& x, double dt_s, int begin, int end, Positions& force,
                          BlockMatrix* matrix) const {
  for (std::size_t g = 0; g < groups_.size(); ++g)
    if (active_[g]) add_any(g, x, dt_s, begin, end, force, matrix);
}

void Membrane::add_forces_of(int first_face, int end_face, const Positions& x, double dt_s, Positions& force,
                             BlockMatrix* matrix) const {
  for (auto g = static_cast<std::size_t>(first_face / 4); g < static_cast<std::size_t>((end_face + 3) / 4); ++g)
    if (active_[g]) add_any(g, x, dt_s, 0, std::numeric_limits<int>::max(), force, matrix);
}

double Membrane::energy(const Positions& x, double dt_s) const {
  double sum = 0;
  Deformation d;
  for (const Group& g : groups_) {
    if (!active_[static_cast<std::size_t>(g.first_face / 4)]) continue;
    deform(g, x, false, d);
    const Strain e = scaled(d.strain), past = scaled({g.past00, g.past01, g.past11});
    const Double4 flowing = energy_density(material_, material_.young_mpa * (1 - material_.network_share), e);
    const Double4 viscous =
        material_.viscosity_s / dt_s *
        stretching_density(material_, material_.young_mpa, {e.e00 - past.e00, e.e01 - past.e01, e.e11 - past.e11});
    sum += lane_sum(g.weight * (flowing + viscous), g.lanes);
    if (material_.network_share == 0) continue;
    deform(g, x, true, d);
    sum += lane_sum(
        g.network_weight * energy_density(material_, material_.young_mpa * material_.network_share, scaled(d.strain)),
        g.lanes);
  }
  return sum;
}

std::vector<double> Membrane::stiffness_factors() const {
  std::vector<double> factors;
  for (const Group& g : groups_)
    for (int l = 0; l < g.lanes; ++l) factors.push_back(g.stiffness[l] * g.chill[l]);
  return factors;
}

Vec3 Membrane::rest_squared_lengths(int face) const {
  const Group& g = groups_[static_cast<std::size_t>(face / 4)];
  const int l = face % 4;
  Eigen::Matrix2d inverse;
  inverse << g.b00[l], g.b01[l], g.b10[l], g.b11[l];
  const Eigen::Matrix2d edges = inverse.inverse();
  return {edges.col(0).squaredNorm(), (edges.col(1) - edges.col(0)).squaredNorm(), edges.col(1).squaredNorm()};
}

double Membrane::elastic_strain(const Positions& x, int face) const {
  Deformation d;
  deform(groups_[static_cast<std::size_t>(face / 4)], x, false, d);
  return norm(d.strain)[face % 4];
}

}  // namespace formwright
