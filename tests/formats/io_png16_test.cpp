// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "formats/png/png16.h"
#include "formats/io_test_tools.h"
#include "formats/model_samples.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinULP;
using namespace test;

Grey16Image sample(int width, int height) {
  Grey16Image image;
  image.width = width, image.height = height;
  image.pixel_width_mm = 0.1, image.pixel_height_mm = 0.25;
  for (int i = 0; i < width * height; ++i) image.levels.push_back(static_cast<std::uint16_t>(i * 40503));
  return image;
}

TEST_CASE("Png16.RoundTrip") {
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 5}, {257, 130}}) {
    const Grey16Image image = sample(width, height);
    const Grey16Image again = read_png16(write_png16(image), "a.png");
    CHECK(again.width == width);
    CHECK(again.height == height);
    CHECK(again.levels == image.levels);
    CHECK_THAT(again.pixel_width_mm, WithinULP(0.1, 4));
    CHECK_THAT(again.pixel_height_mm, WithinULP(0.25, 4));
  }
}

TEST_CASE("Png16.IsBigEndianGreyWithSize") {
  Grey16Image image = sample(1, 1);
  const std::string text(as_text(write_png16(image)));
  CHECK(text.substr(24, 2) == std::string{16, 0});  // depth, grey
  const std::size_t size = text.find("pHYs");
  REQUIRE(size != std::string::npos);
  CHECK(text.substr(size + 4, 9) == std::string{0, 0, 0x27, 0x10, 0, 0, 0x0f, '\xa0', 1});  // 10000 and 4000 a metre
  image.pixel_width_mm = 0;
  CHECK(as_text(write_png16(image)).find("pHYs") == std::string_view::npos);
}

TEST_CASE("Png16.ColoursBecomeGrey") {
  const Grey16Image red = read_png16(red_pixel_png(), "red.png");
  REQUIRE(red.levels.size() == 1u);
  CHECK_THAT(red.levels[0], WithinAbs(0.2126 * 65535, 257));  // a step of the picture's eight bits
}

TEST_CASE("Png16.BadPicturesAreRefused") {
  const auto refused = [](ByteView bytes) {
    try {
      read_png16(bytes, "bad.png");
      FAIL();
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::invalid_input);
      CHECK(error.where() == "image");
      INFO(error.what());
      CHECK(std::string(error.what()).starts_with("bad.png: "));
    }
  };
  const Bytes good = write_png16(sample(40, 40));
  refused({});
  refused(to_bytes("not a picture"));
  for (const std::size_t size : {8u, 20u, 33u, 60u, 200u}) refused(ByteView(good).first(size));
  Bytes flipped = good;
  flipped[100] ^= std::byte{1};
  refused(flipped);
  // A header that claims 60000 x 60000 pixels, with a right checksum, must not ask for memory.
  Bytes huge = write_png16(sample(1, 1));
  for (const std::size_t place : {16u, 20u}) huge[place + 2] = std::byte{0xea}, huge[place + 3] = std::byte{0x60};
  refused(huge);
  Grey16Image wrong = sample(3, 3);
  wrong.levels.pop_back();
  CHECK_THROWS_AS(write_png16(wrong), Error);
}

}  // namespace
}  // namespace formwright
