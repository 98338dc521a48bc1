// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/ruida/ruida_bounds.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>

#include "base/error.h"
#include "base/random.h"
#include "machines/ruida/ruida_driver.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

/// A job as its bytes are before they are scrambled.
struct RuidaJob {
  std::string plain;

  RuidaJob& code(std::initializer_list<unsigned> bytes) {
    for (const unsigned byte : bytes) plain += static_cast<char>(byte);
    return *this;
  }
  RuidaJob& number(std::int64_t value, int bytes) {
    for (int i = bytes - 1; i >= 0; --i) plain += static_cast<char>(value >> (7 * i) & 0x7f);
    return *this;
  }
  RuidaJob& begin() {
    return code({0xd8, 0x10}).code({0xe7, 0x04}).number(1, 2).number(1, 2).code({0xc9, 0x02}).number(20000, 5);
  }
  RuidaJob& to(bool burn, int x_um, int y_um) { return code({burn ? 0xa8u : 0x88u}).number(x_um, 5).number(y_um, 5); }
  RuidaJob& by(bool burn, int x_um, int y_um) {
    const unsigned base = burn ? 0xa8 : 0x88;
    if (y_um == 0) return code({base + 2}).number(x_um, 2);
    if (x_um == 0) return code({base + 3}).number(y_um, 2);
    return code({base + 1}).number(x_um, 2).number(y_um, 2);
  }
  Bytes file() const {
    Bytes bytes;
    for (const char c : plain) bytes.push_back(std::byte{ruida_swizzled(static_cast<unsigned char>(c))});
    return bytes;
  }
};

std::string refusal(const RuidaJob& job) {
  try {
    ruida_bounds(job.file());
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::invalid_input);
    CHECK(error.where() == "job");
    {
      INFO(error.what());
      CHECK(std::string(error.what()).ends_with('.'));
    }
    return error.what();
  }
  return "";
}

TEST_CASE("RuidaBounds.AreThoseOfWhatIsBurned") {
  // Far travel is not burned; a cut begins where the head stands.
  const GcodeBounds bounds = ruida_bounds(RuidaJob()
                                              .begin()
                                              .to(false, 900000, 900000)
                                              .to(false, 10000, 20500)
                                              .to(true, 30000, 20500)
                                              .by(true, 0, -4250)
                                              .to(false, 0, 0)
                                              .file());
  CHECK(bounds.low_mm == std::array<double, 3>{10, 16.25, 0});
  CHECK(bounds.high_mm == std::array<double, 3>{30, 20.5, 0});
  const GcodeBounds reached =
      ruida_job_bounds(RuidaJob().begin().to(false, 900000, 900000).to(true, 30000, -500).file()).reached;
  CHECK(reached.low_mm == std::array<double, 3>{30, -0.5, 0});
  CHECK(reached.high_mm == std::array<double, 3>{900, 900, 0});
}

TEST_CASE("RuidaBounds.FollowAbsoluteAndRelativeMovesOfEveryKind") {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    RuidaJob job;
    job.begin().to(false, 1000, 1000);
    std::array<int, 2> at{1000, 1000}, low{1 << 30, 1 << 30}, high{-(1 << 30), -(1 << 30)};
    const auto see = [&] {
      for (std::size_t i = 0; i < 2; ++i) low[i] = std::min(low[i], at[i]), high[i] = std::max(high[i], at[i]);
    };
    for (int i = 0; i < 300; ++i) {
      const bool burn = i == 0 || random.uniform() < 0.3;
      if (burn) see();
      if (random.uniform() < 0.1) {
        at = {static_cast<int>(random.below(1000000)) - 100000, static_cast<int>(random.below(1000000)) - 100000};
        job.to(burn, at[0], at[1]);
      } else {
        const int dx = static_cast<int>(random.below(16384)) - 8192, dy = static_cast<int>(random.below(16384)) - 8192;
        const std::size_t kind = random.below(3);
        const int x = kind == 1 ? 0 : dx, y = kind == 2 ? 0 : dy;
        job.by(burn, x, y);
        at[0] += x, at[1] += y;
      }
      if (burn) see();
    }
    const GcodeBounds bounds = ruida_bounds(job.file());
    for (std::size_t i = 0; i < 2; ++i) {
      INFO("seed " << seed);
      CHECK_THAT(bounds.low_mm[i], WithinAbs(1e-3 * low[i], 1e-9));
      CHECK_THAT(bounds.high_mm[i], WithinAbs(1e-3 * high[i], 1e-9));
    }
  }
}

TEST_CASE("RuidaBounds.RefuseWhereTheyCannotBeReported") {
  const auto burning = [](RuidaJob job) { return job.to(false, 0, 0).to(true, 5000, 5000); };
  CHECK(refusal(burning(RuidaJob().begin())) == "");
  CHECK(refusal(burning(RuidaJob().code({0xd8, 0x12}))).find("set at the laser's panel") != std::string::npos);
  CHECK(refusal(burning(RuidaJob().begin().code({0xd8, 0x11}))).find("set at the laser's panel") != std::string::npos);
  CHECK(refusal(burning(RuidaJob().code({0xf0}))).find("set at the laser's panel") != std::string::npos);
  CHECK(refusal(burning(RuidaJob().begin().code({0xe7, 0x08}).number(3, 2).number(1, 2))).find("array") !=
        std::string::npos);
  CHECK(
      refusal(burning(RuidaJob().begin().code({0xd9, 0x10, 0}).number(0, 5).number(0, 5))).find("is not known here") !=
      std::string::npos);
  CHECK(refusal(burning(RuidaJob().begin().code({0x80, 0x00}).number(0, 5))).find("is not known here") !=
        std::string::npos);
  CHECK(refusal(burning(RuidaJob().begin().code({0x80, 0x08}).number(0, 5))) == "");  // the table
  CHECK(refusal(RuidaJob().begin().by(true, 100, 100)).find("before it gives a position") != std::string::npos);
  CHECK(refusal(RuidaJob().begin().to(false, 1, 1)).find("burns nothing") != std::string::npos);
  CHECK(refusal(RuidaJob().begin().to(false, 1, 1).code({0xa8, 1, 2, 3})).find("incomplete") != std::string::npos);
  CHECK(refusal(RuidaJob().begin().by(false, 100, 100).to(true, 1, 1)).find("before it gives a position") !=
        std::string::npos);
  CHECK(refusal(RuidaJob{"G1 X5"}).find("not a Ruida job") != std::string::npos);
  CHECK(refusal(RuidaJob{}).find("not a Ruida job") != std::string::npos);
}

}  // namespace
}  // namespace formwright
