// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/sha256.h"

#include <catch2/catch_test_macros.hpp>

namespace formwright {
namespace {

// The examples of FIPS 180-4 and of the NIST test vectors.
TEST_CASE("Sha256.AgreesWithThePublishedVectors") {
  CHECK(sha256_hex(as_bytes("")) == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  CHECK(sha256_hex(as_bytes("abc")) == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(sha256_hex(as_bytes("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq")) ==
        "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  CHECK(sha256_hex(as_bytes(std::string(1'000'000, 'a'))) ==
        "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST_CASE("Sha256.PadsEveryLengthAroundABlock") {
  // Lengths at which the padding changes from one block to two; the digests must all differ.
  std::string previous;
  for (std::size_t length = 54; length < 130; ++length) {
    const std::string digest = sha256_hex(as_bytes(std::string(length, 'x')));
    CHECK(digest.size() == 64u);
    CHECK(digest != previous);
    previous = digest;
  }
}

TEST_CASE("Sha256.PiecesGiveWhatTheWholeGives") {
  const std::string text(300, 'p');
  const std::string whole = sha256_hex(as_bytes(text));
  for (const std::size_t piece : {1u, 7u, 63u, 64u, 65u, 128u, 299u, 300u}) {
    Sha256 sum;
    for (std::size_t at = 0; at < text.size(); at += piece) sum.add(as_bytes(text.substr(at, piece)));
    sum.add({});
    INFO(piece);
    CHECK(sum.hex() == whole);
  }
}

}  // namespace
}  // namespace formwright
