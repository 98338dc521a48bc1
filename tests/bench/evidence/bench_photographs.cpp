// SPDX-License-Identifier: GPL-3.0-or-later
// Error of points measured by virtual photographs, against their number, blur, glare, lens and the size of the
// pictures. JSON on standard output, one case a line.
#include <cstdio>

#include "base/context.h"
#include "evidence/photographs/measured_truth.h"

namespace {

using namespace formwright;

void measure(const char* name, const test::Scene& scene, const test::Phone& phone, int count) {
  const double distance = 430 * phone.focal / 0.8;
  const test::Taken taken = test::take_photographs(scene, phone, test::ring_of_views(count, distance));
  Context context;
  try {
    const PhotographMeasurement m =
        measure_photographs(taken.photographs, scene.sheet, test::options_of(scene), context);
    const test::TruthError e = test::truth_error(m, scene.bump);
    std::printf(
        "{\"case\": \"%s\", \"photographs\": %d, \"pixels\": [%d, %d], \"points\": %zu, \"of\": %zu, \"median_mm\": %.3f, "
        "\"percentile_95_mm\": %.3f, \"max_mm\": %.3f, \"chi_square\": %.2f, \"within_2_sigma\": %.3f, "
        "\"focal_error_percent\": %.2f, \"rms_px\": %.3f, \"seconds_find\": %.1f, \"seconds_solve\": %.1f}\n",
        name, count, phone.width, phone.height, e.points, 4 * scene.sheet.marks.size(), e.median_mm, e.percentile_95_mm,
        e.max_mm, e.chi_square, e.within_2_sigma, 100 * (m.lenses[0].focal_px / (phone.focal * phone.width) - 1),
        m.rms_px, m.seconds_find, m.seconds_solve);
  } catch (const std::exception& error) {
    std::printf("{\"case\": \"%s\", \"photographs\": %d, \"error\": \"%s\"}\n", name, count, error.what());
  }
  std::fflush(stdout);
}

/// Blur of other sizes than the constants of mark_edges.cpp were chosen with.
void measure_other_blurs(const test::Scene& scene) {
  test::Phone phone;
  phone.defocus_px = 1.5;
  measure("defocus 1.5 px", scene, phone, 6);
  phone.defocus_px = 0.5;
  phone.motion_px = {-1, 2.5};
  measure("moved by 2.7 px", scene, phone, 8);
  phone = {};
  phone.width = 3200;
  phone.height = 2400;
  phone.defocus_px = 2.8;
  measure("8 megapixels, defocus 2.8 px", scene, phone, 6);
}

}  // namespace

int main() {
  test::Scene scene;
  scene.sheet = test::small_mark_sheet();
  const test::Phone usual;
  for (const int count : {2, 3, 4, 6, 10}) measure("usual", scene, usual, count);
  {
    test::Phone phone = usual;
    phone.width = 3200;
    phone.height = 2400;
    phone.defocus_px = 1.2;
    measure("8 megapixels", scene, phone, 6);
  }
  for (const double blur : {1.2, 1.8}) {
    test::Phone phone = usual;
    phone.defocus_px = blur;
    measure(blur < 1.5 ? "defocus 1.2 px" : "defocus 1.8 px", scene, phone, 6);
  }
  {
    test::Phone phone = usual;
    phone.motion_px = {3, 2};
    measure("moved by 3.6 px", scene, phone, 6);
  }
  {
    test::Scene glossy = scene;
    glossy.gloss = 1;
    measure("glare", glossy, usual, 6);
  }
  {
    test::Phone phone = usual;
    phone.noise_levels = 6;
    phone.jpeg_quality = 75;
    measure("noise 6 levels, JPEG 75", scene, phone, 6);
  }
  for (const double focal : {0.6, 1.6}) {
    test::Phone phone = usual;
    phone.focal = focal;
    measure(focal < 1 ? "wide lens" : "long lens", scene, phone, 6);
  }
  {
    test::Phone phone = usual;
    phone.k1 = -0.25;
    phone.k2 = 0.1;
    phone.centre_off_px = {15, -10};
    measure("strong distortion, principal point off", scene, phone, 6);
  }
  {
    test::Scene drawn = scene;
    drawn.bump.draw = 0.45;
    drawn.bump.peak_mm = 50;
    measure("drawn by 1.8, 50 mm high", drawn, usual, 8);
  }
  measure_other_blurs(scene);
}
