// SPDX-License-Identifier: GPL-3.0-or-later
// Virtual scans with known truth, from a painted sheet back to where its points went.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "base/error.h"
#include "evidence/registration/small_pattern.h"
#include "evidence/registration/virtual_scan.h"
#include "geometry/samples/samples.h"
#include "thermoform/forming.h"
#include "thermoform/sheet/sheet_lookup.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using test::recovered_error;
using test::RecoveredError;
using test::small_pattern;
using test::virtual_scan;

ScanRegistrationOptions small_options() {
  ScanRegistrationOptions options;
  options.picture_px = 640;
  options.grid_mm = 2.5;
  options.scan_sigma_mm = 0;
  return options;
}

test::ScanCamera small_camera() {
  test::ScanCamera camera;
  camera.texture_px = 1000;
  camera.spacing_mm = 1.25;
  return camera;
}

ScanRegistration registered(const test::FormedSurface& surface, const test::ScanCamera& camera,
                            const ScanRegistrationOptions& options = small_options()) {
  Context context;
  const CalibrationPattern pattern = small_pattern();
  return register_scan(virtual_scan(surface, pattern, camera), pattern, options, context);
}

TEST_CASE("Registration.AFlatSheetIsFoundWhereItLiesAndKnowsHowSureItIs") {
  const test::FormedSurface flat = test::dome(40, 0, 0);
  for (const double noise : {3.0, 9.0}) {
    test::ScanCamera camera = small_camera();
    camera.noise_levels = noise;
    const ScanRegistration r = registered(flat, camera);
    const RecoveredError e = recovered_error(r, flat);
    CHECK(e.points > 1400u);
    {
      INFO(noise);
      CHECK(e.median_mm < 0.03);
      CHECK(e.percentile_95_mm < 0.08);
      // Two directions of error, each of one sigma.
      CHECK(e.spread_median > 0.5);
      CHECK(e.spread_median < 1.3);
      CHECK(e.spread < 1.3);
    }
    CHECK(r.in_machine_coordinates);
    CHECK_THAT(*r.rim_scale, WithinAbs(1, 1e-3));
  }
}

TEST_CASE("Registration.ADomeThatSlidIsRecoveredAcrossTheSurface") {
  const test::FormedSurface surface = test::dome(42, 22, 3);
  const ScanRegistration r = registered(surface, small_camera());
  CHECK(r.first_displacement_rms_mm > 1);  // the corners alone are far off
  const RecoveredError e = recovered_error(r, surface);
  CHECK(e.points > 1400u);
  CHECK(e.median_mm < 0.05);
  CHECK(e.percentile_95_mm < 0.12);
  CHECK(e.spread_median > 0.5);
  CHECK(e.spread < 1.5);
  CHECK(*std::max_element(r.corner_residual_mm.begin(), r.corner_residual_mm.end()) < 0.4);
}

TEST_CASE("Registration.AThermoformedSheetIsRecovered") {
  Context context;
  const CalibrationPattern pattern = small_pattern();
  ThermoformOptions options;
  options.sheet_x_mm = 120;
  options.sheet_y_mm = 130;
  options.clamp_opening_x_mm = 106;
  options.clamp_opening_y_mm = 116;
  options.size_mm = 55;
  options.triangles = 2500;
  const Model mould = make_sample("pyramid", 500, context);
  const FormedResult formed = form_sheet(std::make_shared<const MouldShape>(mould.mesh),
                                         place(mould.mesh, options, clamp_opening_mm(options)), options, context);
  const SheetLookup lookup(formed.sheet);
  const double rim_z = options.clamp_height_mm + options.sheet_thickness_mm / 2;
  const test::FormedSurface surface = [&](const Vec2& s) {
    const auto at = lookup.find(s);
    return at ? lookup.outer(*at) : Vec3(s.x(), s.y(), rim_z);
  };
  const ScanRegistration r = registered(surface, small_camera());
  const RecoveredError e = recovered_error(r, surface);
  CHECK(e.points > 1200u);
  CHECK(e.median_mm < 0.12);
  CHECK(e.percentile_95_mm < 0.6);  // the scan's triangles cut the simulation's creases
  CHECK(e.spread < 1.6);            // and sigma says so
}

TEST_CASE("Registration.HolesWrongPatchesBlurAndNoiseCostPointsRatherThanTruth") {
  const test::FormedSurface surface = test::dome(42, 22, 3);
  test::ScanCamera camera = small_camera();
  camera.noise_levels = 8;
  camera.blur_px = 1.6;
  camera.missing_patches = 4;
  camera.wrong_patches = 3;
  camera.patch_mm = 5;
  const ScanRegistration r = registered(surface, camera), clean = registered(surface, small_camera());
  CHECK(r.points.size() + 40 < clean.points.size());
  const RecoveredError e = recovered_error(r, surface);
  CHECK(e.median_mm < 0.07);
  CHECK(e.percentile_95_mm < 0.2);
  CHECK(e.spread_median > 0.5);
  CHECK(e.spread < 1.5);
}

TEST_CASE("Registration.AScanThatLooksInwardsIsTurned") {
  const test::FormedSurface surface = test::dome(42, 15, 2);
  test::ScanCamera camera = small_camera();
  camera.inwards = true;
  const ScanRegistration r = registered(surface, camera);
  CHECK(r.marks.mirrored);
  CHECK(recovered_error(r, surface).percentile_95_mm < 0.12);
}

TEST_CASE("Registration.CornersByHandDoAsWell") {
  // Without charts turned about, the sheet's quarter (0, 0) is chart (0, 0): u = (0.5 + (x + sheet / 4) / chart) / 2.
  const CalibrationPattern pattern = small_pattern();
  const test::FormedSurface surface = test::dome(42, 15, 2);
  Context context;
  const test::ScanCamera camera = small_camera();
  const Model scan = virtual_scan(surface, pattern, camera);
  const ScanRegistration by_itself = register_scan(scan, pattern, small_options(), context);
  std::string corners, found;
  for (std::size_t m = 0; m < 4; ++m) {
    const CornerMark& mark = pattern.marks[m];
    // The texture place of the scan's vertex nearest to the mark.
    double nearest = 1e9;
    Vec2 uv;
    Eigen::Matrix3d turn =
        (Eigen::AngleAxisd(2.2, Vec3::UnitZ()) * Eigen::AngleAxisd(0.4, Vec3(1, 0.3, 0).normalized()))
            .toRotationMatrix();
    const Vec3 place = turn * surface(mark.centre_mm) + Vec3(300, -120, 55);
    for (int f = 0; f < scan.mesh.face_count(); ++f)
      for (int k = 0; k < 3; ++k)
        if (const double d = (scan.mesh.V.row(scan.mesh.F(f, k)).transpose() - place).norm(); d < nearest) {
          nearest = d;
          uv = scan.UV.row(scan.FT(f, k));
        }
    const Vec2 px(uv.x() * camera.texture_px, (1 - uv.y()) * camera.texture_px);
    corners += std::to_string(px.x()) + "," + std::to_string(px.y()) + " ";
    // What was found without help is where the mark is to be seen; a vertex may be half an edge away from it.
    REQUIRE(by_itself.corner_px[m]);
    CHECK((*by_itself.corner_px[m] - px).norm() < 0.03 * camera.texture_px);
    found += std::to_string(by_itself.corner_px[m]->x()) + "," + std::to_string(by_itself.corner_px[m]->y()) + " ";
  }
  ScanRegistrationOptions options = small_options();
  // Pixels found go back to where they came from.
  options.corners = found;
  const ScanRegistration again = register_scan(scan, pattern, options, context);
  for (std::size_t m = 0; m < 4; ++m) CHECK((again.marks.place_mm[m] - by_itself.marks.place_mm[m]).norm() < 1e-3);
  options.corners = corners;
  CHECK(recovered_error(register_scan(scan, pattern, options, context), surface).percentile_95_mm < 0.12);
  for (const char* wrong : {"1,2 3,4", "a,b", "1,1 2,2 3,3 99999,4"}) {
    options.corners = wrong;
    try {
      register_scan(scan, pattern, options, context);
      FAIL_CHECK(wrong);
    } catch (const Error& e) {
      CHECK(e.where() == "corners");
    }
  }
}

TEST_CASE("Registration.FinerPicturesComeNearer") {
  const test::FormedSurface surface = test::dome(42, 0, 0);
  double before = 1e9;
  for (const int side : {100, 200, 400}) {
    ScanRegistrationOptions options = small_options();
    options.picture_px = side;
    const double median = recovered_error(registered(surface, small_camera(), options), surface).median_mm;
    {
      INFO(side);
      CHECK(median < 0.8 * before);
    }
    before = median;
  }
}

TEST_CASE("Registration.AnotherPatternIsRefused") {
  const CalibrationPattern pattern = small_pattern();
  Context context;
  Model scan = virtual_scan(test::dome(40, 10, 0), pattern, small_camera());
  CalibrationPattern other = pattern;
  other.seed = 99;
  try {
    const ScanRegistration r = register_scan(scan, other, small_options(), context);
    FAIL_CHECK(r.similarity);
  } catch (const Error& e) {
    CHECK(e.where() == "pattern");
  }
  scan.textures[0].bytes.clear();
  CHECK_THROWS_AS(register_scan(scan, pattern, small_options(), context), Error);
}

}  // namespace
}  // namespace formwright
