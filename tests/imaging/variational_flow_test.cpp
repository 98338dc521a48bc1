// SPDX-License-Identifier: GPL-3.0-or-later
// Flow on pairs with known displacement: exact cases, what must not change it, and how its error falls.
#include "imaging/flow/variational_flow.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "base/error.h"
#include "base/sha256.h"
#include "imaging/warped_pictures.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using test::end_point_error;
using test::warped_pair;

Flow flow_of(const test::WarpedPair& pair) {
  Context context;
  return variational_flow(pair.first, pair.second, {}, context);
}

WeightedPicture transposed(const WeightedPicture& picture) {
  WeightedPicture result(picture.height, picture.width);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) result.at(y, x) = picture.at(x, y);
  return result;
}

const auto affine = [](const Vec2& p) {
  return Vec2(0.03 * p.x() + 0.02 * p.y() + 1.7, -0.02 * p.x() - 0.02 * p.y() - 2.4);
};

TEST_CASE("VariationalFlow.EqualPicturesDoNotMove") {
  const test::WarpedPair pair = warped_pair(120, 90, [](const Vec2&) { return Vec2(0, 0); }, {});
  Context context;
  const Flow flow = variational_flow(pair.first, pair.first, {}, context);
  for (std::size_t i = 0; i < flow.u.size(); ++i) {
    REQUIRE(std::abs(flow.u[i]) < 1e-6f);
    REQUIRE(std::abs(flow.v[i]) < 1e-6f);
  }
}

TEST_CASE("VariationalFlow.TranslationIsFoundToTwoHundredths") {
  for (const Vec2& shift : {Vec2(3, -2), Vec2(-7.3, 4.6)}) {
    const test::WarpedPair pair = warped_pair(200, 160, [&](const Vec2&) { return shift; }, {});
    INFO(shift.transpose());
    CHECK(end_point_error(flow_of(pair), pair.truth, 14).mean < 0.02);
  }
}

TEST_CASE("VariationalFlow.AffineWarpsAreFoundToATenth") {
  const test::WarpedPair pair = warped_pair(256, 240, affine, {});
  const test::EndPointError e = end_point_error(flow_of(pair), pair.truth, 16);
  CHECK(e.mean < 0.1);
  CHECK(e.percentile_95 < 0.25);
}

TEST_CASE("VariationalFlow.ErrorFallsWithNoiseAndWithPixels") {
  double before = 1e9;
  for (const double noise : {24.0, 12.0, 6.0}) {
    const test::WarpedPair pair = warped_pair(200, 200, affine, {.noise = noise});
    const double error = end_point_error(flow_of(pair), pair.truth, 16).mean;
    {
      INFO(noise);
      CHECK(error < 0.9 * before);
    }
    before = error;
  }
  // The same warp and pattern, seen with more pixels: the error as a share of the picture falls at least as fast as
  // pixels shrink.
  double share_before = 1e9;
  for (const int side : {96, 192, 384}) {
    const test::WarpedPair pair = warped_pair(side, side, test::waves(0.012 * side, 0.6 * side), {.noise = 2});
    const double share = end_point_error(flow_of(pair), pair.truth, side / 12).mean / side;
    {
      INFO(side);
      CHECK(share < 0.6 * share_before);
    }
    share_before = share;
  }
}

TEST_CASE("VariationalFlow.AxesMayBeExchanged") {
  const test::WarpedPair pair = warped_pair(150, 110, test::waves(3, 90), {.noise = 4});
  Context context;
  const Flow flow = flow_of(pair),
             other = variational_flow(transposed(pair.first), transposed(pair.second), {}, context);
  double worst = 0;
  for (int y = 0; y < flow.height; ++y)
    for (int x = 0; x < flow.width; ++x) {
      worst = std::max(worst, static_cast<double>(std::abs(flow.u[flow.index(x, y)] - other.v[other.index(y, x)])));
      worst = std::max(worst, static_cast<double>(std::abs(flow.v[flow.index(x, y)] - other.u[other.index(y, x)])));
    }
  CHECK(worst < 0.01);
}

TEST_CASE("VariationalFlow.WhatIsMissingIsBridged") {
  test::WarpedPair pair = warped_pair(220, 220, affine, {.noise = 2});
  const double before = end_point_error(flow_of(pair), pair.truth, 16).mean;
  // Garbage of weight 0 in the second picture.
  for (int y = 0; y < 220; ++y)
    for (int x = 0; x < 220; ++x)
      if (std::hypot(x - 90, y - 120) < 14) pair.second.at(x, y) = Float4{255, 0, 255, 0};
  const Flow flow = flow_of(pair);
  CHECK(end_point_error(flow, pair.truth, 16).mean < 1.3 * before + 0.02);
  const std::size_t middle = flow.index(90, 120);
  CHECK_THAT(flow.u[middle], WithinAbs(pair.truth.u[middle], 0.5));
  CHECK_THAT(flow.v[middle], WithinAbs(pair.truth.v[middle], 0.5));
}

TEST_CASE("VariationalFlow.WhatIsSeenBesideHolesIsFoundNearlyAsWell") {
  constexpr int side = 320, radius = 8;
  test::WarpedPair pair = warped_pair(side, side, test::waves(2, 60), {.noise = 2, .blur_px = 0.5, .lighting = 0.05});
  const Flow whole = flow_of(pair);
  std::vector<char> hole(pair.second.pixels.size(), 0);
  for (int k = 0; k < 24; ++k) {
    const int middle_x = 31 + 53 * (k % 6) + 7 * (k % 4), middle_y = 40 + 76 * (k / 6) + 9 * (k % 3);
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        if (std::hypot(x - middle_x, y - middle_y) < radius) {
          pair.second.at(x, y) = Float4{255, 0, 255, 0};
          hole[pair.second.index(x, y)] = 1;
        }
  }
  const Flow flow = flow_of(pair);
  double error = 0, error_whole = 0;
  for (int y = 16; y < side - 16; ++y)
    for (int x = 16; x < side - 16; ++x) {
      const std::size_t i = flow.index(x, y);
      const double u = static_cast<double>(pair.truth.u[i]), v = static_cast<double>(pair.truth.v[i]);
      if (hole[pair.second.index(static_cast<int>(std::lround(x + u)), static_cast<int>(std::lround(y + v)))]) continue;
      error += std::hypot(static_cast<double>(flow.u[i]) - u, static_cast<double>(flow.v[i]) - v);
      error_whole += std::hypot(static_cast<double>(whole.u[i]) - u, static_cast<double>(whole.v[i]) - v);
    }
  CHECK(error < 1.25 * error_whole);
}

TEST_CASE("VariationalFlow.NothingKnownGivesNoFlow") {
  const WeightedPicture empty(40, 40);
  Context context;
  const Flow flow = variational_flow(empty, empty, {}, context);
  for (const float u : flow.u) CHECK(u == 0.0f);
}

TEST_CASE("VariationalFlow.AFirstGuessIsCorrected") {
  const test::WarpedPair pair = warped_pair(240, 240, test::bulge(20, 70), {.noise = 2});
  Context context;
  Flow guess = pair.truth;
  for (float& u : guess.u) u += 2.5f;
  const Flow flow = refined_flow(pair.first, pair.second, guess, 6, {}, context);
  CHECK(end_point_error(flow, pair.truth, 16).mean < 0.25);
}

TEST_CASE("VariationalFlow.EvidenceFollowsTheNoise") {
  for (const double noise : {3.0, 9.0}) {
    const test::WarpedPair pair = warped_pair(160, 160, [](const Vec2&) { return Vec2(2, 1); }, {.noise = noise});
    const FlowEvidence e = flow_evidence(pair.first, pair.second, pair.truth, Context());
    double squared = 0, count = 0;
    for (int y = 10; y < 150; ++y)
      for (int x = 10; x < 150; ++x) {
        squared += static_cast<double>(e.residual_squared[pair.truth.index(x, y)]);
        ++count;
      }
    // At whole pixels the cubic leaves noise as it is: three channels of noise^2 each.
    CHECK_THAT(std::sqrt(squared / count / 3), WithinAbs(noise, 0.08 * noise + 0.3));
  }
}

TEST_CASE("VariationalFlow.GivesTheSameBitsOnEveryMachine") {
  // Recorded natively on two threads; WebAssembly runs the same test on one.
  const test::WarpedPair pair = warped_pair(480, 450, affine, {});
  const Flow flow = flow_of(pair);
  std::vector<float> both = flow.u;
  both.insert(both.end(), flow.v.begin(), flow.v.end());
  CHECK(sha256_hex(ByteView(reinterpret_cast<const std::byte*>(both.data()), sizeof(float) * both.size())) ==
        "faa284b7de35f3c0f4860a1026b391a135b34159caefc0805f9629cd9384808a");
}

TEST_CASE("VariationalFlow.RefusesPicturesThatDoNotBelongTogether") {
  Context context;
  CHECK_THROWS_AS(variational_flow(WeightedPicture(40, 40), WeightedPicture(40, 41), {}, context), Error);
  CHECK_THROWS_AS(variational_flow(WeightedPicture(15, 40), WeightedPicture(15, 40), {}, context), Error);
}

}  // namespace
}  // namespace formwright
