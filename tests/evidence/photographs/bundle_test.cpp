// SPDX-License-Identifier: GPL-3.0-or-later
// Bundle adjustment of points that were projected by formula.
#include <catch2/catch_test_macros.hpp>
#include <cmath>

#include "base/random.h"
#include "evidence/photographs/bundle.h"
#include "evidence/photographs/photograph_studio.h"

namespace formwright {
namespace {

struct Truth {
  Bundle bundle;  // started beside the truth
  std::vector<Vec3> points;
};

/// Points on the bump and the board's corners as `views` see them, with Gaussian noise.
Truth projected(const std::vector<test::View>& views, const test::Phone& phone, double noise_px, std::uint64_t seed) {
  Truth truth;
  const MarkSheet sheet = test::small_mark_sheet();
  const test::Bump bump;
  Random random(seed);
  Bundle& b = truth.bundle;
  b.board_z_mm = 12;
  Lens lens{phone.width, phone.height};
  lens.focal_px = 0.8 * phone.width;
  lens.centre_px = 0.5 * Vec2(phone.width, phone.height);
  b.lenses = {lens};
  for (std::size_t k = 0; k < 4; ++k) b.strip_origin_mm[k] = sheet.strips[k].origin_mm;
  for (std::size_t i = 0; i < sheet.marks.size(); i += 7) {
    truth.points.push_back(bump.place_mm(sheet.marks[i].centre_mm));
    b.points.push_back(truth.points.back() + Vec3(0.8, -0.5, 1.1));
  }
  const auto see = [&](BundleObservation o, const test::View& view, const Vec3& p) {
    o.picture_px = test::pictured(phone, view, p) + noise_px * Vec2(random.normal(), random.normal());
    o.covariance_px2 = Eigen::Matrix2d::Identity() * std::pow(std::max(noise_px, 1e-4), 2);
    b.observations.push_back(o);
  };
  for (std::size_t c = 0; c < views.size(); ++c) {
    const test::View& view = views[c];
    const Vec3 forward = (view.at_mm - view.from_mm).normalized(), right = forward.cross(Vec3(0, 0, 1)).normalized(),
               down = forward.cross(right);
    Pose pose;
    const double cosine = std::cos(view.roll_rad), sine = std::sin(view.roll_rad);
    pose.rotation << (cosine * right + sine * down).transpose(), (-sine * right + cosine * down).transpose(),
        forward.transpose();
    pose.translation = -pose.rotation * view.from_mm + Vec3(3, -2, 5);
    b.cameras.push_back({0, pose});
    for (int k = 0; k < 4; ++k)
      for (const PlacedMark& m : sheet.strips[static_cast<std::size_t>(k)].marks)
        for (int corner = 0; corner < 4; ++corner) {
          const BoardStrip& strip = sheet.strips[static_cast<std::size_t>(k)];
          BundleObservation o;
          o.camera = static_cast<int>(c);
          o.strip = k;
          o.from_origin_mm = strip.machine_mm(m.corner_mm(corner)) - strip.origin_mm;
          const Vec2 p = strip.machine_mm(m.corner_mm(corner));
          see(o, view, {p.x(), p.y(), b.board_z_mm});
        }
    for (std::size_t p = 0; p < truth.points.size(); ++p) {
      BundleObservation o;
      o.camera = static_cast<int>(c);
      o.point = static_cast<int>(p);
      see(o, view, truth.points[p]);
    }
  }
  return truth;
}

struct BundleError {
  double rms_mm = 0, max_mm = 0, chi_square = 0, within_95 = 0;
};
BundleError error_of(const Truth& truth, const BundleFit& fit) {
  BundleError e;
  const auto count = static_cast<double>(truth.points.size());
  for (std::size_t p = 0; p < truth.points.size(); ++p) {
    const Vec3 d = truth.bundle.points[p] - truth.points[p];
    e.rms_mm += d.squaredNorm() / count;
    e.max_mm = std::max(e.max_mm, d.norm());
    const double squared = d.dot(fit.covariance_mm2[p].inverse() * d);
    e.chi_square += squared / (3 * count);
    e.within_95 += squared < 7.815 ? 1 / count : 0;  // 95 % of chi-square with three degrees of freedom
  }
  e.rms_mm = std::sqrt(e.rms_mm);
  return e;
}

TEST_CASE("Bundle.PointsProjectedByFormulaAreRecovered") {
  Truth truth = projected(test::ring_of_views(5), {}, 0, 1);
  truth.bundle.k_prior = 0;  // the lens is not to be drawn towards none
  const BundleFit fit = adjust_bundle(truth.bundle, false, true, 100, Context());
  const BundleError e = error_of(truth, fit);
  CHECK(e.max_mm < 1e-6);
  CHECK(std::abs(truth.bundle.lenses[0].focal_px - 1280) < 1e-5);
  CHECK(std::abs(truth.bundle.lenses[0].k1 - 0.08) < 1e-7);
  CHECK(fit.rms_px < 1e-8);
}

TEST_CASE("Bundle.CovarianceIsThatOfTheErrors") {
  double chi_square = 0, within = 0, noise = 0;
  constexpr int runs = 12;
  for (int run = 0; run < runs; ++run) {
    Truth truth = projected(test::ring_of_views(5), {}, 0.2, 100 + static_cast<std::uint64_t>(run));
    const BundleFit fit = adjust_bundle(truth.bundle, false, true, 60, Context());
    const BundleError e = error_of(truth, fit);
    chi_square += e.chi_square / runs;
    within += e.within_95 / runs;
    noise += fit.noise / runs;
  }
  INFO(chi_square << " " << within << " " << noise);
  CHECK(chi_square > 0.8);
  CHECK(chi_square < 1.2);
  CHECK(within > 0.90);
  CHECK(within < 0.985);
  CHECK(std::abs(noise - 1) < 0.05);
}

TEST_CASE("Bundle.ErrorFallsWithResolutionAndWithTheNumberOfPhotographs") {
  const auto rms = [](int views, int width) {
    double squares = 0;
    for (std::uint64_t run = 0; run < 4; ++run) {
      test::Phone phone;
      phone.width = width;
      phone.height = width * 3 / 4;
      Truth truth = projected(test::ring_of_views(views), phone, 0.2, 7 + run);
      const BundleFit fit = adjust_bundle(truth.bundle, false, true, 60, Context());
      squares += std::pow(error_of(truth, fit).rms_mm, 2) / 4;
    }
    return std::sqrt(squares);
  };
  const double base = rms(4, 1600);
  const double order = std::log2(base / rms(4, 3200));
  INFO(order);
  CHECK(std::abs(order - 1) < 0.15);  // error as 1 / resolution
  const double by_count = std::log2(base / rms(16, 1600)) / 2;
  {
    INFO(by_count);
    CHECK(by_count > 0.4);  // at least about 1 / sqrt(count)
    CHECK(by_count < 0.9);
  }
}

}  // namespace
}  // namespace formwright
