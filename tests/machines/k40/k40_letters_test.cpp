// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors were made with MeerK40t 0.9.9 (its checksum, distances and scrambling), which shares no code with ours.
#include <catch2/catch_test_macros.hpp>

#include "base/error.h"
#include "machines/k40/k40_driver.h"
#include "machines/k40/k40_talk.h"

namespace formwright {
namespace {

TEST_CASE("K40.ChecksumsAreOneWire") {
  CHECK(one_wire_crc(padded("IPP")) == 228);
  CHECK(one_wire_crc(padded("IS2P")) == 15);
  CHECK(one_wire_crc(padded("I")) == 130);
  CHECK(one_wire_crc(padded("PN")) == 243);
  CHECK(one_wire_crc(padded("IBzzaRl052S1P")) == 250);
}

TEST_CASE("K40.TransfersAreExact") {
  const Bytes transfer = k40_transfer("IPP");
  REQUIRE(transfer.size() == 34u);
  CHECK(transfer[0] == std::byte{0xa6});
  CHECK(transfer[1] == std::byte{0});
  CHECK(as_text(transfer).substr(2, 30) == padded("IPP"));
  CHECK(transfer[32] == std::byte{0xa6});
  CHECK(transfer[33] == std::byte{228});
}

TEST_CASE("K40.MovesAreWrittenInItsLetters") {
  CHECK(k40_rapid_move(1, 0) == "IBaS1P");
  CHECK(k40_rapid_move(25, -26) == "IByL|aS1P");
  CHECK(k40_rapid_move(-51, 52) == "IT|zR052S1P");
  CHECK(k40_rapid_move(1000, 300) == "IBzzz235Rz|tS1P");
  CHECK(k40_rapid_move(-254, 255) == "IT254RzS1P");
}

TEST_CASE("K40.ReadsEgvFiles") {
  const auto packets = k40_packets(
      "Document type : LHYMICRO-GL file\nFile version: 1.0.01\nCreator-Software: X\n\n%0%0%0%0%IBzzzS1P\nICV1752241000000003GAACBaRaFNSE-\n");
  REQUIRE(packets.size() == 3u);
  CHECK(packets[0] == "IBzzzS1P");
  CHECK(packets[1] == "ICV1752241000000003GAACBaRaFNS");
  CHECK(packets[2] == "E");
  CHECK_THROWS_AS(k40_packets("G1 X5\n"), Error);
  CHECK_THROWS_AS(k40_packets(""), Error);
}

}  // namespace
}  // namespace formwright
