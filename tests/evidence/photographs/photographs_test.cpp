// SPDX-License-Identifier: GPL-3.0-or-later
// Virtual photographs of a bump known by formula, from JPEG files to measured points.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "base/error.h"
#include "base/statistics.h"
#include "evidence/photographs/measured_truth.h"

namespace formwright {
namespace {
using Catch::Matchers::ContainsSubstring;

test::Scene usual_scene() {
  test::Scene scene;
  scene.sheet = test::small_mark_sheet();
  return scene;
}

PhotographMeasurement measured(const test::Scene& scene, std::span<const Photograph> photographs,
                               const PhotographOptions& options) {
  Context context;
  return measure_photographs(photographs, scene.sheet, options, context);
}

TEST_CASE("Photographs.MarksOfABumpAreFoundWhereTheyAre") {
  const test::Scene scene = usual_scene();
  test::Taken taken = test::take_photographs(scene, {}, test::ring_of_views(6));
  const PhotographMeasurement m = measured(scene, taken.photographs, test::options_of(scene));
  const test::TruthError e = test::truth_error(m, scene.bump);
  INFO("points " << e.points << ", median " << e.median_mm << ", 95 % " << e.percentile_95_mm << ", max " << e.max_mm
                 << ", chi-square " << e.chi_square << ", within 2 sigma " << e.within_2_sigma);
  CHECK(e.points > 600);
  CHECK(e.median_mm < 0.06);
  CHECK(e.percentile_95_mm < 0.15);
  CHECK(e.chi_square > 0.4);
  CHECK(e.chi_square < 1.6);
  CHECK(e.within_2_sigma > 0.92);
  CHECK(std::abs(m.lenses[0].focal_px / 1280 - 1) < 0.005);
  CHECK(m.board_misfit_mm > 0.6);  // the strips lie 0.7 to 0.8 mm off
  CHECK(m.board_misfit_mm < 0.9);

  // Their order does not matter.
  std::reverse(taken.photographs.begin(), taken.photographs.end());
  const PhotographMeasurement reversed = measured(scene, taken.photographs, test::options_of(scene));
  REQUIRE(reversed.points.size() == m.points.size());
  double largest = 0;
  for (std::size_t i = 0; i < m.points.size(); ++i)
    largest = std::max(largest, (reversed.points[i].place_mm - m.points[i].place_mm).norm());
  CHECK(largest < 1e-5);

  // The board gives the scale: printed 1 % smaller, everything is 1 % smaller about its middle. Strips keep their
  // places.
  PhotographOptions smaller = test::options_of(scene);
  smaller.board_check_mm = 0.99 * scene.sheet.check_mm;
  const PhotographMeasurement scaled = measured(scene, taken.photographs, smaller);
  REQUIRE(scaled.points.size() > 500);
  const Vec3 a = scaled.points.back().place_mm - scaled.points.front().place_mm,
             b = m.points.back().place_mm - m.points.front().place_mm;
  CHECK(std::abs(a.norm() / b.norm() - 0.99) < 0.001);
}

TEST_CASE("Photographs.HardOnesAreMeasuredToAThirdOfAMillimetre") {
  test::Scene scene = usual_scene();
  scene.gloss = 1;
  scene.uneven = 0.6;
  scene.bump.draw = 0.35;
  test::Phone phone;
  phone.focal = 1.05;  // a longer lens than is usual
  phone.k1 = -0.15;
  phone.k2 = 0.1;
  phone.centre_off_px = {9, -6};
  phone.defocus_px = 1.0;
  phone.motion_px = {1.5, 1};
  phone.noise_levels = 5;
  phone.jpeg_quality = 80;
  test::Taken taken = test::take_photographs(scene, phone, test::ring_of_views(6, 560));
  const PhotographMeasurement m = measured(scene, taken.photographs, test::options_of(scene));
  const test::TruthError e = test::truth_error(m, scene.bump);
  INFO("points " << e.points << ", median " << e.median_mm << ", 95 % " << e.percentile_95_mm << ", max " << e.max_mm
                 << ", chi-square " << e.chi_square << ", within 2 sigma " << e.within_2_sigma);
  CHECK(e.points > 350);
  CHECK(e.median_mm < 0.3);
  CHECK(e.percentile_95_mm < 0.6);
  CHECK(e.chi_square < 3);
  CHECK(e.within_2_sigma > 0.85);
}

TEST_CASE("Photographs.BlurredOnesSayThatTheyAreLessSure") {
  const test::Scene scene = usual_scene();
  const auto views = test::ring_of_views(5);
  test::Phone sharp, blurred;
  blurred.defocus_px = 1.6;
  const test::Taken clear = test::take_photographs(scene, sharp, views),
                    hazy = test::take_photographs(scene, blurred, views);
  const auto error_of = [&](const std::vector<Photograph>& photographs, double& sigma_mm) {
    const PhotographMeasurement m = measured(scene, photographs, test::options_of(scene));
    std::vector<double> sigmas;
    for (const auto& point : m.points) sigmas.push_back(point.sigma_mm);
    sigma_mm = median(std::move(sigmas));
    return test::truth_error(m, scene.bump);
  };
  double sharp_sigma = 0, blurred_sigma = 0, mixed_sigma = 0;
  const test::TruthError of_sharp = error_of(clear.photographs, sharp_sigma),
                         of_blurred = error_of(hazy.photographs, blurred_sigma);
  INFO("sharp: median " << of_sharp.median_mm << ", sigma " << sharp_sigma << ", chi-square " << of_sharp.chi_square);
  INFO("blurred: median " << of_blurred.median_mm << ", sigma " << blurred_sigma << ", chi-square "
                          << of_blurred.chi_square);
  CHECK(of_blurred.median_mm > 1.5 * of_sharp.median_mm);
  CHECK(blurred_sigma > 1.5 * sharp_sigma);
  CHECK(of_blurred.chi_square > 0.2);
  CHECK(of_blurred.chi_square < 1.5);
  // A blurred photograph beside sharp ones has little weight: it does no harm.
  std::vector<Photograph> mixed = clear.photographs;
  mixed.back() = hazy.photographs.back();
  const std::vector<Photograph> without(mixed.begin(), mixed.end() - 1);
  const double median_without = error_of(without, mixed_sigma).median_mm;
  CHECK(error_of(mixed, mixed_sigma).median_mm < 1.1 * median_without);
}

TEST_CASE("Photographs.WhatCannotBeMeasuredIsRefusedOrNamed") {
  test::Scene scene = usual_scene();
  test::Phone phone;
  phone.width = 960;
  phone.height = 720;
  phone.noise_levels = 0;
  phone.samples = 1;
  const std::vector<test::View> views = test::ring_of_views(3);
  test::Taken taken = test::take_photographs(scene, phone, views);
  const PhotographOptions options = test::options_of(scene);
  const auto with = [&](std::vector<Bytes> files, const MarkSheet& sheet) {
    std::vector<Photograph> list;
    for (std::size_t i = 0; i < files.size(); ++i) list.push_back({"photograph", std::to_string(i) + ".jpg", files[i]});
    Context context;
    return measure_photographs(list, sheet, options, context);
  };
  const auto& f = taken.files;
  CHECK_THROWS_WITH(with({f[0]}, scene.sheet), ContainsSubstring("two or more"));
  CHECK_THROWS_WITH(with({f[0], f[0]}, scene.sheet), ContainsSubstring("several times"));
  CHECK_THROWS_WITH(with({f[0], to_bytes("no picture")}, scene.sheet), ContainsSubstring("1.jpg: this is neither"));
  MarkSheetPlan plan;
  plan.seed = 5;
  CHECK_THROWS_WITH(with(f, make_mark_sheet(plan)), ContainsSubstring("pattern.json"));
  test::Scene bare = scene;
  bare.has_board = false;
  const Bytes no_board = photograph(bare, phone, views[2], 3);
  CHECK_THROWS_WITH(with({no_board, f[0]}, scene.sheet), ContainsSubstring("Only one of the photographs"));
  const PhotographMeasurement without = with({f[0], no_board, f[1]}, scene.sheet);
  CHECK_FALSE(without.cameras[1].used);
  CHECK_THAT(without.notes.at(0), ContainsSubstring("1.jpg was left out"));
  test::Phone mirrored = phone;
  mirrored.mirrored = true;
  CHECK_THROWS_WITH(
      with({photograph(scene, mirrored, views[0], 1), photograph(scene, mirrored, views[1], 2)}, scene.sheet),
      ContainsSubstring("mirrored"));
  test::Phone small = phone;
  small.width = 64;
  small.height = 48;
  CHECK_THROWS_WITH(with({photograph(scene, small, views[0], 1), photograph(scene, small, views[1], 2)}, scene.sheet),
                    ContainsSubstring("No coded marks"));
  // Another size of photograph is another lens.
  test::Phone larger = phone;
  larger.width = 1280;
  larger.height = 960;
  larger.focal = 0.7;
  const PhotographMeasurement mixed =
      with({f[0], f[1], photograph(scene, larger, views[2], 1), photograph(scene, larger, views[0], 2)}, scene.sheet);
  REQUIRE(mixed.lenses.size() == 2);
  CHECK(test::truth_error(mixed, scene.bump).median_mm < 0.3);
}

}  // namespace
}  // namespace formwright
