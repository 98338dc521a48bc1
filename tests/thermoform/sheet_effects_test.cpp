// SPDX-License-Identifier: GPL-3.0-or-later
// Effects: nothing at strength 0, the right way at others, and forces that stay gradients.
#include "thermoform/sheet/sheet_effects.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Dense>
#include <functional>

#include "geometry/queries/point_distance.h"
#include "geometry/queries/ray_caster.h"
#include "geometry/samples/samples.h"
#include "thermoform/contact/contact_chill.h"
#include "thermoform/sheet_fixture.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinULP;

using namespace thermoform_test;

double mean_movement(const FormedResult& a, const FormedResult& b) {
  return (a.sheet.mesh.V - b.sheet.mesh.V).rowwise().norm().mean();
}

TEST_CASE("SheetEffects.next_to_nothing_of_any_effect_gives_the_same_bits_as_none") {
  const TriangleMesh shape = pyramid(60, 40);
  const FormedResult none = form(shape, fine_stepping_machine(800));
  constexpr double next_to_nothing = 1e-300;  // runs each effect's code, and rounds to nothing
  for (double SheetEffects::*effect :
       {&SheetEffects::heating_gradient_x, &SheetEffects::heating_gradient_y, &SheetEffects::heating_centre,
        &SheetEffects::thickness_wedge_x, &SheetEffects::thickness_wedge_y, &SheetEffects::anisotropy,
        &SheetEffects::slip, &SheetEffects::cooling, &SheetEffects::weak_vacuum, &SheetEffects::clamp_slip_mm,
        &SheetEffects::mould_shift_x_mm, &SheetEffects::mould_rotation_deg, &SheetEffects::mould_scale}) {
    ThermoformOptions o = fine_stepping_machine(800);
    static_cast<SheetEffects&>(o).*effect = next_to_nothing;
    CHECK(form(shape, o).sheet.mesh.V == none.sheet.mesh.V);
    static_cast<SheetEffects&>(o).*effect = 0.5;
    CHECK(mean_movement(form(shape, o), none) > 0.01);
  }
}

/// x of the sheet's points of the right half less that of the left half, mirrored: 0 for a symmetric sheet.
Vec2 lopsidedness(const FormedResult& result, const SheetMesh& mesh) {
  Vec2 sum(0, 0);
  const auto at = [&](int column, int row) { return Vec3(result.sheet.mesh.V.row(row * mesh.columns + column)); };
  for (int row = 0; row < mesh.rows; ++row)
    for (int column = 0; column < mesh.columns; ++column) {
      sum.x() += std::abs(at(column, row).x() + at(mesh.columns - 1 - column, row).x());
      sum.y() += std::abs(at(column, row).y() + at(column, mesh.rows - 1 - row).y());
    }
  return sum / static_cast<double>(mesh.rows * mesh.columns);
}

TEST_CASE("SheetEffects.a_gradient_along_x_leaves_the_sheet_symmetric_in_y") {
  const SheetMesh mesh = make_sheet_mesh(Vec2(120, 120), 1500);
  for (double SheetEffects::*effect : {&SheetEffects::heating_gradient_x, &SheetEffects::thickness_wedge_x}) {
    ThermoformOptions o = fine_stepping_machine(1500);
    static_cast<SheetEffects&>(o).*effect = 0.4;
    const Vec2 lopsided = lopsidedness(form(pyramid(60, 40), o), mesh);
    CHECK(lopsided.x() > 0.1);
    CHECK(lopsided.y() < 0.1 * lopsided.x());
  }
}

TEST_CASE("SheetEffects.turning_the_machine_turns_the_result") {
  // What is along x here is along y there; a square sheet's mesh maps onto itself.
  const TriangleMesh shape = pyramid(60, 40);
  const SheetMesh mesh = make_sheet_mesh(Vec2(120, 120), 1500);
  const auto turned = [&](const std::function<void(ThermoformOptions&)>& along_x,
                          const std::function<void(ThermoformOptions&)>& along_y) {
    ThermoformOptions a = fine_stepping_machine(1500), b = a;
    along_x(a);
    along_y(b);
    const FormedResult in_x = form(shape, a), in_y = form(shape, b);
    double sum = 0, moved = mean_movement(in_x, form(shape, fine_stepping_machine(1500)));
    for (int row = 0; row < mesh.rows; ++row)
      for (int column = 0; column < mesh.columns; ++column) {
        // (x, y) -> (-y, x)
        const Vec3 p = in_x.sheet.mesh.V.row(row * mesh.columns + column),
                   q = in_y.sheet.mesh.V.row(column * mesh.columns + mesh.columns - 1 - row);
        sum += (Vec3(-p.y(), p.x(), p.z()) - q).norm();
      }
    return sum / static_cast<double>(mesh.rows * mesh.columns) / moved;
  };
  CHECK(turned([](ThermoformOptions& o) { o.heating_gradient_x = 0.4; },
               [](ThermoformOptions& o) { o.heating_gradient_y = 0.4; }) < 0.1);
  CHECK(turned([](ThermoformOptions& o) { o.thickness_wedge_x = 0.4; },
               [](ThermoformOptions& o) { o.thickness_wedge_y = 0.4; }) < 0.1);
  CHECK(turned([](ThermoformOptions& o) { o.anisotropy = 0.4; }, [](ThermoformOptions& o) { o.anisotropy = -0.4; }) <
        0.15);
}

TEST_CASE("SheetEffects.effects_move_points_the_way_they_should") {
  const TriangleMesh shape = pyramid(60, 40);
  const FormedResult none = form(shape, fine_stepping_machine(1500));
  const auto with = [&](const std::function<void(ThermoformOptions&)>& set) {
    ThermoformOptions o = fine_stepping_machine(1500);
    set(o);
    return form(shape, o);
  };
  // A colder right side stretches less: it stays thicker there, and the sheet's middle moves to it.
  const FormedResult heated = with([](ThermoformOptions& o) { o.heating_gradient_x = 0.4; });
  double right = 0, left = 0;
  for (Eigen::Index i = 0; i < heated.sheet.mesh.V.rows(); ++i)
    (heated.sheet.sheet_mm(i, 0) > 0 ? right : left) += heated.sheet.thickness_mm[i] - none.sheet.thickness_mm[i];
  CHECK(right > left);
  CHECK((heated.sheet.mesh.V - none.sheet.mesh.V).col(0).mean() > 0.02);
  // A clamp that gives way leaves the sheet thicker in the mean; its rim has come in, nowhere farther than that.
  const FormedResult slipped = with([](ThermoformOptions& o) { o.clamp_slip_mm = 3; });
  double farthest_mm = 0;
  for (Eigen::Index i = 0; i < slipped.sheet.mesh.V.rows(); ++i)
    if (slipped.sheet.contact_s[i] == 0)
      farthest_mm = std::max(farthest_mm, 60 - slipped.sheet.mesh.V.row(i).head<2>().cwiseAbs().maxCoeff());
  CHECK(farthest_mm > 1.5);
  CHECK(farthest_mm <= 3);
  CHECK(slipped.mean_thickness_mm > none.mean_thickness_mm);
  // Without a vacuum the sheet hangs over the model; with half of it, it touches less than with all.
  const FormedResult weak = with([](ThermoformOptions& o) { o.weak_vacuum = 0.95; });
  CHECK(weak.formed_area_mm2 < none.formed_area_mm2);
  CHECK_THAT(weak.pressure_end_kpa, WithinAbs(4, 1e-9));
  // A sheet that slides comes down the walls.
  const FormedResult sliding = with([](ThermoformOptions& o) { o.slip = 5; });
  double fallen = 0, counted = 0;
  for (Eigen::Index i = 0; i < none.sheet.mesh.V.rows(); ++i)
    if (none.sheet.mesh.V(i, 2) > 5 && none.sheet.contact_s[i] > 0)
      fallen += none.sheet.mesh.V(i, 2) - sliding.sheet.mesh.V(i, 2), ++counted;
  CHECK(fallen / counted > 0.2);
}

TEST_CASE("SheetEffects.more_slip_and_more_cooling_move_more") {
  const TriangleMesh shape = pyramid(60, 40);
  const FormedResult none = form(shape, fine_stepping_machine(1500));
  for (double SheetEffects::*effect : {&SheetEffects::slip, &SheetEffects::cooling}) {
    double before = 0;
    for (const double strength : {0.5, 1.0, 2.0, 4.0}) {
      ThermoformOptions o = fine_stepping_machine(1500);
      static_cast<SheetEffects&>(o).*effect = strength;
      const double moved = mean_movement(form(shape, o), none);
      {
        INFO(strength);
        CHECK(moved > before);
      }
      before = moved;
    }
  }
}

/// An effect's name.
std::string info(double SheetEffects::*effect) {
  std::string name;
  std::apply([&](const auto&... p) { ((p.member == effect ? name = p.name : name), ...); }, SheetEffects::parameters);
  return name;
}

TEST_CASE("SheetEffects.half_an_effect_moves_points_half_as_far_the_same_way") {
  // What a diagnosis relies on, which takes secants for derivatives.
  Context context;
  const TriangleMesh sample = make_sample("pyramid", 2000, context).mesh;
  const auto shape = std::make_shared<const MouldShape>(sample);
  ThermoformOptions o;
  o.triangles = 2500;
  o.size_mm = 100;
  o.step_mm = 0.5;
  const Placement placement = place(sample, o, clamp_opening_mm(o));
  const Positions reference = form_sheet(shape, placement, o, context).sheet.mesh.V;
  for (double SheetEffects::*effect :
       {&SheetEffects::heating_gradient_x, &SheetEffects::heating_centre, &SheetEffects::thickness_wedge_x,
        &SheetEffects::anisotropy, &SheetEffects::cooling, &SheetEffects::clamp_slip_mm}) {
    ThermoformOptions with = o;
    static_cast<SheetEffects&>(with).*effect = 0.25;
    const Positions half = form_sheet(shape, placement, with, context).sheet.mesh.V - reference;
    static_cast<SheetEffects&>(with).*effect = 0.5;
    const Positions full = form_sheet(shape, placement, with, context).sheet.mesh.V - reference;
    // Anisotropy pulls vertices across the pyramid's edges, where sticking decides for one side or the other.
    INFO(info(effect));
    CHECK(half.cwiseProduct(full).sum() / (half.norm() * full.norm()) >
          (effect == &SheetEffects::anisotropy ? 0.85 : 0.95));
    CHECK_THAT(half.norm() / full.norm(), WithinAbs(0.5, 0.15));
  }
}

TEST_CASE("SheetEffects.a_shifted_mould_on_a_huge_sheet_shifts_the_result") {
  const TriangleMesh shape = pyramid(20, 12);
  ThermoformOptions o = fine_stepping_machine(5000);
  o.platform_travel_mm = 40;
  // By a whole number of pairs of cells, so that the mesh looks the same from the mould.
  const SheetMesh mesh = make_sheet_mesh(Vec2(120, 120), o.triangles);
  const double cell = 120.0 / (mesh.columns - 1);
  const FormedResult straight = form(shape, o);
  o.mould_shift_x_mm = 2 * cell;
  const FormedResult shifted = form(shape, o);
  CHECK_THAT(shifted.placement.translation.x(), WithinAbs(2 * cell, 1e-12));
  double worst = 0;
  for (int row = 0; row < mesh.rows; ++row)
    for (int column = 0; column + 2 < mesh.columns; ++column) {
      const Eigen::Index i = row * mesh.columns + column;
      if (mesh.flat_mm.row(i).norm() > 8) continue;
      worst = std::max(
          worst,
          (shifted.sheet.mesh.V.row(i + 2) - straight.sheet.mesh.V.row(i) - Eigen::RowVector3d(2 * cell, 0, 0)).norm());
    }
  CHECK(worst < 0.25 * 2 * cell);
}

TEST_CASE("SheetEffects.the_mould_turns_and_grows_about_the_middle_of_the_plate") {
  SheetEffects effects;
  effects.mould_rotation_deg = 90;
  effects.mould_scale = 0.1;
  effects.mould_shift_y_mm = 2;
  Placement nominal;
  nominal.translation = Vec3(10, 0, -5);
  const Placement real = displaced(nominal, effects);
  CHECK((real(Vec3(1, 2, 3)) - Vec3(-2.2, 12.1 + 2, -2.2)).norm() < 1e-12);
  CHECK_THAT(real.scale, WithinULP(1.1, 4));
}

TEST_CASE("SheetEffects.a_wedge_keeps_its_volume") {
  ThermoformOptions o = fine_stepping_machine(1000);
  o.thickness_wedge_x = 0.5;
  o.thickness_wedge_y = -0.3;
  const FormedResult result = form(pyramid(60, 40), o);
  CHECK(result.volume_drift < 1e-12);
  CHECK_THAT(result.mean_thickness_mm * (result.formed_area_mm2 + result.unformed_area_mm2),
             WithinAbs(120 * 120 * 1.0, 1e-9 * 14400));
  // The flat sheet's corners in the clamp keep what they had.
  CHECK(result.sheet.thickness_mm.maxCoeff() > 1.4);
  CHECK_THAT(result.sheet.stretch.minCoeff(), WithinAbs(1, 0.35));
}

TEST_CASE("SheetEffects.forces_are_gradients_with_heat_wedge_anisotropy_and_chill") {
  const SheetMesh sheet = make_sheet_mesh(Vec2(40, 40), 50);
  const auto faces = static_cast<std::size_t>(sheet.F.rows());
  SheetVariation variation;
  for (std::size_t f = 0; f < faces; ++f) {
    variation.stiffness.push_back(0.5 + 0.03 * static_cast<double>(f));
    variation.thickness.push_back(1.3 - 0.01 * static_cast<double>(f));
  }
  for (const ElasticLaw law :
       {ElasticLaw::st_venant_kirchhoff, ElasticLaw::stable_neo_hookean, ElasticLaw::incompressible_neo_hookean}) {
    MembraneMaterial material;
    material.elastic_law = law;
    material.viscosity_s = 1e-3;
    material.yield_strain = 100;  // the energy is that of what does not flow
    material.anisotropy = 0.4;
    Membrane membrane(sheet.flat_mm, sheet.F, 0.8, material, variation);
    const HeldVertices free(sheet.clamped.size(), 0);
    Positions x = shaken(sheet, 0.1, 1);
    membrane.begin_step(x, free);
    std::vector<double> chill;
    for (std::size_t f = 0; f < faces; ++f) chill.push_back(1 + 0.02 * static_cast<double>(f));
    membrane.end_step(x, 1e-3, chill);
    membrane.begin_step(x, free);
    x = shaken(sheet, 0.3, 2);
    Positions force = Positions::Zero(x.rows(), 3);
    BlockMatrix matrix(static_cast<int>(x.rows()), std::span(sheet.F.data(), static_cast<std::size_t>(sheet.F.size())),
                       3);
    membrane.use_matrix(matrix);
    matrix.set_zero();
    membrane.add_forces(x, 1e-2, 0, static_cast<int>(x.rows()), force, &matrix);
    double worst = 0;
    for (Eigen::Index i = 0; i < x.rows(); ++i)
      for (int k = 0; k < 3; ++k) {
        const double at = x(i, k), h = 1e-5;
        x(i, k) = at + h;
        const double more = membrane.energy(x, 1e-2);
        x(i, k) = at - h;
        const double less = membrane.energy(x, 1e-2);
        x(i, k) = at;
        worst = std::max(worst, std::abs(force(i, k) + (more - less) / (2 * h)));
      }
    CHECK(worst / force.cwiseAbs().maxCoeff() < 1e-6);
    // Positive semi-definite, to single precision.
    const Eigen::Index n = 3 * x.rows();
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n);
    for (int row = 0; row < matrix.row_count(); ++row)
      for (std::size_t c = 0; c < matrix.columns(row).size(); ++c)
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j)
            dense(3 * row + i, 3 * matrix.columns(row)[c] + j) = static_cast<double>(
                matrix.block(matrix.first_slot(row) + static_cast<int>(c))[static_cast<std::size_t>(j)][i]);
    const Eigen::VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense).eigenvalues();
    CHECK(eigenvalues.minCoeff() > -1e-5 * eigenvalues.maxCoeff());
  }
}

TEST_CASE("SheetEffects.what_grows_stiff_goes_on_pulling_as_hard") {
  const SheetMesh sheet = make_sheet_mesh(Vec2(40, 40), 50);
  const HeldVertices free(sheet.clamped.size(), 0);
  MembraneMaterial material;
  Membrane membrane(sheet.flat_mm, sheet.F, 1, material);
  Positions x(sheet.flat_mm.rows(), 3);
  x << 1.03 * sheet.flat_mm.col(0), 1.01 * sheet.flat_mm.col(1), Eigen::VectorXd::Zero(sheet.flat_mm.rows());
  const auto pull = [&](const Positions& place) {
    Positions force = Positions::Zero(place.rows(), 3);
    membrane.begin_step(x, free);
    membrane.add_forces(place, std::numeric_limits<double>::infinity(), 0, static_cast<int>(place.rows()), force,
                        nullptr);
    return force;
  };
  const Positions hot = pull(x), hot_farther = pull(1.01 * x) - hot;
  membrane.end_step(x, 1e-3, std::vector<double>(static_cast<std::size_t>(sheet.F.rows()), 3));
  const Positions cold = pull(x), cold_farther = pull(1.01 * x) - cold;
  CHECK((cold - hot).norm() < 0.05 * hot.norm());
  CHECK_THAT(cold_farther.norm() / hot_farther.norm(), WithinAbs(3, 0.2));
}

TEST_CASE("SheetEffects.chill_comes_as_the_exponential_and_spreads_the_same_on_finer_sheets") {
  std::vector<double> beside;
  for (const int triangles : {3200, 12800}) {
    const SheetMesh sheet = make_sheet_mesh(Vec2(120, 120), triangles);
    ContactChill everywhere(sheet, 1), half(sheet, 1);
    HeldVertices all(sheet.clamped.size(), 1), right(sheet.clamped.size());
    for (std::size_t i = 0; i < right.size(); ++i) right[i] = sheet.flat_mm(static_cast<Eigen::Index>(i), 0) > -1e-9;
    for (int step = 0; step < 200; ++step) {
      everywhere.advance(0.001, all);
      half.advance(0.001, right);
    }
    double minimum = 1, at = 0, nearest = 1e300;
    for (std::size_t i = 0; i < right.size(); ++i) {
      if (sheet.clamped[i]) continue;
      if (sheet.flat_mm.row(static_cast<Eigen::Index>(i)).norm() < 40)
        minimum = std::min(minimum, everywhere.chill()[i]);
      CHECK(half.chill()[i] >= 0);
      CHECK(half.chill()[i] <= 1);
      if (const double away = (sheet.flat_mm.row(static_cast<Eigen::Index>(i)) - Eigen::RowVector2d(-6, 0)).norm();
          away < nearest)
        nearest = away, at = half.chill()[i];
    }
    CHECK_THAT(minimum, WithinAbs(1 - std::exp(-2.0), 0.01));
    beside.push_back(at);
  }
  CHECK_THAT(beside[0], WithinAbs(beside[1], 0.05));
  CHECK(beside[1] > 0.1);
}

TEST_CASE("SheetEffects.sliding_sheets_stay_outside_of_the_model") {
  Context context;
  for (const char* name : {"bust", "mountain"}) {
    const TriangleMesh mesh = make_sample(name, 4000, context).mesh;
    ThermoformOptions o;
    o.triangles = 1500;
    o.size_mm = 90;
    o.slip = 10;
    const Placement placement = place(mesh, o, clamp_opening_mm(o));
    const FormedResult result = form_sheet(std::make_shared<const MouldShape>(mesh), placement, o, context);
    {
      INFO(name);
      CHECK(result.sheet.mesh.V.allFinite());
      CHECK(result.vertex_distance_min_mm > 0);
    }
    const TriangleMesh placed = placement(mesh);
    const RayCaster rays(placed);
    int inside = 0;
    for (Eigen::Index i = 0; i < result.sheet.mesh.V.rows(); ++i) {
      const Vec3 p = result.sheet.mesh.V.row(i);
      if (p.z() <= 0) continue;
      std::vector<double> crossings;
      for (const RayHit& hit : rays.all_hits(p, Vec3(0.6, 0.64, 0.48), 0, 1e5))
        if (crossings.empty() || hit.distance > crossings.back() + 1e-9) crossings.push_back(hit.distance);
      if (crossings.size() % 2 == 1) ++inside;
    }
    INFO(name);
    CHECK(inside == 0);
  }
}

TEST_CASE("SheetEffects.what_leaves_nothing_of_the_sheet_is_refused") {
  const auto refused = [](const std::function<void(ThermoformOptions&)>& set, const std::string& where) {
    ThermoformOptions o = fine_stepping_machine(500);
    set(o);
    try {
      form(pyramid(60, 40), o);
      FAIL(where);
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::invalid_input);
      CHECK(error.where() == where);
    }
  };
  refused([](ThermoformOptions& o) { o.heating_gradient_x = 0.6, o.heating_gradient_y = -0.4; }, "heating_gradient_x");
  refused([](ThermoformOptions& o) { o.thickness_wedge_x = 0.6, o.thickness_wedge_y = 0.4; }, "thickness_wedge_x");
  refused([](ThermoformOptions& o) { o.clamp_slip_mm = 19; }, "clamp_slip_mm");
  refused([](ThermoformOptions& o) { o.mould_shift_x_mm = 40; }, "size_mm");
}

}  // namespace
}  // namespace formwright
