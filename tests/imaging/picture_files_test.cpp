// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures in and out, and files that are none: each gives one sentence.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <png.h>
#include <stb_image_write.h>
#include <zlib.h>

#include <random>

#include "base/error.h"
#include "imaging/picture/picture_reader.h"
#include "imaging/picture/png_writer.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

/// 24 x 16 pixels, left two thirds (200, 60, 30), the rest (20, 90, 220): progressive JPEG, quality 95, written by
/// Pillow.
constexpr std::string_view progressive_jpeg =
    "ffd8ffe000104a46494600010100000100010000ffdb0043000201010101010201010102020202020403020202020504040304060506060605060606"
    "070908060709070606080b08090a0a0a0a0a06080b0c0b0a0c090a0a0affdb004301020202020202050303050a0706070a0a0a0a0a0a0a0a0a0a0a0a"
    "0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0affc20011080010001803011100021101031101ffc400"
    "160001010100000000000000000000000000050006ffc400160101010100000000000000000000000000080007ffda000c03010002100310000001c1"
    "e6290a837404dc0bbb2a0dd013ffc40014100100000000000000000000000000000020ffda00080101000105025fffc4001411010000000000000000"
    "0000000000000020ffda0008010301013f015fffc40014110100000000000000000000000000000020ffda0008010201013f015fffc4001410010000"
    "0000000000000000000000000020ffda0008010100063f025fffc40014100100000000000000000000000000000020ffda0008010100013f215fffda"
    "000c0301000200030000001000003fffc40014110100000000000000000000000000000020ffda0008010301013f105fffc400141101000000000000"
    "00000000000000000020ffda0008010201013f105fffc40014100100000000000000000000000000000020ffda0008010100013f105fffd9";

Bytes of_hexadecimal(std::string_view text) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2)
    bytes.push_back(static_cast<std::byte>(std::stoi(std::string(text.substr(i, 2)), nullptr, 16)));
  return bytes;
}

Image noise_picture(int width, int height, bool with_alpha) {
  Image image(width, height, {0, 0, 0, 255});
  std::mt19937 random(3);
  for (Rgba& p : image.pixels)
    for (std::size_t k = 0; k < (with_alpha ? 4u : 3u); ++k) p[k] = static_cast<std::uint8_t>(random());
  return image;
}

/// A picture that goes smoothly from corner to corner, which JPEG keeps well.
Image ramp(int width, int height) {
  Image image(width, height, {0, 0, 0, 255});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image.at(x, y) = {static_cast<std::uint8_t>(255 * x / width), static_cast<std::uint8_t>(255 * y / height), 90,
                        255};
  return image;
}

Bytes baseline_jpeg(const Image& image) {
  Bytes bytes;
  const auto append = [](void* out, void* data, int size) {
    const auto* const from = static_cast<const std::byte*>(data);
    static_cast<Bytes*>(out)->insert(static_cast<Bytes*>(out)->end(), from, from + size);
  };
  stbi_write_jpg_to_func(append, &bytes, image.width, image.height, 4, image.pixels.data(), 92);
  return bytes;
}

/// The sentence with which a file is refused.
std::string refused(ByteView bytes) {
  try {
    read_picture(bytes, "a.png", "texture");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::invalid_input);
    CHECK(error.where() == "texture");
    const std::string sentence = error.what();
    {
      INFO(sentence);
      CHECK((sentence.starts_with("a.png: ") && sentence.ends_with(".")));
    }
    return sentence;
  }
  return "not refused";
}

TEST_CASE("PictureFiles.PngComesBackBitForBit") {
  for (const bool with_alpha : {false, true}) {
    const Image image = noise_picture(37, 21, with_alpha);
    const Image again = read_picture(write_png(image, 11811, Context()), "", "texture");
    CHECK(again.width == 37);
    CHECK(again.pixels == image.pixels);
  }
}

TEST_CASE("PictureFiles.PngSaysItsSizeAndSpace") {
  CHECK(pixels_per_metre(300) == 11811);
  const Bytes png = write_png(noise_picture(2, 2, false), 11811, Context());
  const std::string_view text = as_text(png);
  const std::size_t at = text.find("pHYs");
  REQUIRE(at != std::string_view::npos);
  CHECK(text.substr(at + 4, 9) == std::string_view{"\x00\x00\x2e\x23\x00\x00\x2e\x23\x01", 9});  // 11811, per metre
  CHECK(text.find("sRGB") != std::string_view::npos);
  CHECK(as_text(write_png(noise_picture(2, 2, false), 0, Context())).find("pHYs") == std::string_view::npos);
}

TEST_CASE("PictureFiles.BaselineJpegIsClose") {
  const Image image = ramp(80, 50);
  const Image again = read_picture(baseline_jpeg(image), "", "texture");
  REQUIRE(again.pixels.size() == image.pixels.size());
  double sum = 0;
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) sum += std::abs(image.pixels[i][k] - again.pixels[i][k]);
  CHECK(sum / static_cast<double>(3 * image.pixels.size()) < 3);
}

TEST_CASE("PictureFiles.ProgressiveJpegIsRead") {
  const Image image = read_picture(of_hexadecimal(progressive_jpeg), "", "texture");
  REQUIRE(image.width == 24);
  REQUIRE(image.height == 16);
  const int left[] = {200, 60, 30}, right[] = {20, 90, 220};
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK_THAT(image.at(4, 8)[k], WithinAbs(left[k], 3));
    CHECK_THAT(image.at(20, 8)[k], WithinAbs(right[k], 3));
  }
}

TEST_CASE("PictureFiles.TruncatedFilesAreRefused") {
  const Bytes png = write_png(noise_picture(60, 40, false), 0, Context()), jpeg = baseline_jpeg(ramp(60, 40)),
              progressive = of_hexadecimal(progressive_jpeg);
  for (const Bytes* whole : {&png, &jpeg, &progressive})
    for (const double share : {0.1, 0.3, 0.6, 0.9, 0.999}) {
      const auto size = static_cast<std::size_t>(share * static_cast<double>(whole->size()));
      INFO(size << " of " << whole->size());
      CHECK(refused(ByteView(whole->data(), size)).find("save") != std::string::npos);
    }
}

TEST_CASE("PictureFiles.DamagedFilesAreRefusedOrReadNeverWorse") {
  std::mt19937 random(11);
  int refusals = 0;
  for (const Bytes& whole : {write_png(noise_picture(30, 20, true), 0, Context()), baseline_jpeg(ramp(64, 40)),
                             of_hexadecimal(progressive_jpeg)})
    for (int i = 0; i < 200; ++i) {
      Bytes damaged = whole;
      for (int k = 0; k < 3; ++k) damaged[8 + random() % (damaged.size() - 8)] = static_cast<std::byte>(random());
      refusals += refused(damaged) != "not refused";
    }
  CHECK(refusals > 200);  // every PNG, by its checksums
}

TEST_CASE("PictureFiles.OtherKindsAndEmptyFilesAreRefused") {
  for (const std::string_view text : {"", "GIF89a......", "BM....", "<svg/>", "\x89PNG", "%PDF-1.4"}) {
    INFO(text);
    CHECK(refused(as_bytes(text)).find("neither a PNG nor a JPEG") != std::string::npos);
  }
}

TEST_CASE("PictureFiles.HugeClaimsAreRefusedBeforeTheyAreBelieved") {
  Bytes png = write_png(noise_picture(4, 4, false), 0, Context());
  const auto claim = [&](std::uint32_t width, std::uint32_t height) {
    for (int k = 0; k < 4; ++k) {
      png[static_cast<std::size_t>(16 + k)] = static_cast<std::byte>(width >> (24 - 8 * k));
      png[static_cast<std::size_t>(20 + k)] = static_cast<std::byte>(height >> (24 - 8 * k));
    }
    const auto crc = static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(png.data()) + 12, 17));
    for (int k = 0; k < 4; ++k) png[static_cast<std::size_t>(29 + k)] = static_cast<std::byte>(crc >> (24 - 8 * k));
  };
  claim(40000, 40000);
  CHECK(refused(png).find("40000 x 40000 pixels") != std::string::npos);
  claim(5000, 5000);  // allowed, but not in so few bytes
  CHECK(refused(png).find("ends too early") != std::string::npos);
  Bytes jpeg = baseline_jpeg(ramp(16, 16));
  const std::size_t frame = as_text(jpeg).find("\xff\xc0");
  REQUIRE(frame != std::string_view::npos);
  for (const std::size_t k : {5u, 7u}) jpeg[frame + k] = std::byte{0x75};  // 30000 x 30000
  CHECK(refused(jpeg).find("scale it down") != std::string::npos);
}

TEST_CASE("PictureFiles.AJpegHasSoManyScans") {
  const Bytes whole = of_hexadecimal(progressive_jpeg);
  const std::size_t last = as_text(whole).rfind("\xff\xda");
  const auto with_scans = [&](int more) {
    Bytes bytes = whole;
    for (int i = 0; i < more; ++i)
      bytes.insert(bytes.end() - 2, whole.begin() + static_cast<std::ptrdiff_t>(last), whole.end() - 2);
    return bytes;
  };
  CHECK(refused(with_scans(200)).find("more than 100 passes") != std::string::npos);
  CHECK(refused(with_scans(20)).find("passes") == std::string::npos);
}

TEST_CASE("PictureFiles.JpegWithoutATableThatItUsesIsRefused") {
  // stb would decode with memory that nobody has written.
  for (const Bytes& whole : {baseline_jpeg(ramp(64, 40)), of_hexadecimal(progressive_jpeg)})
    for (const char marker : {'\xc4', '\xdb'}) {
      const std::string_view text = as_text(whole);
      const std::size_t begin = text.find(std::string{'\xff', marker});
      REQUIRE(begin != std::string_view::npos);
      const std::size_t length =
          std::to_integer<std::size_t>(whole[begin + 2]) << 8 | std::to_integer<std::size_t>(whole[begin + 3]);
      Bytes without(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(begin));
      without.insert(without.end(), whole.begin() + static_cast<std::ptrdiff_t>(begin + 2 + length), whole.end());
      CHECK(refused(without).find("it uses a table that it does not have") != std::string::npos);
      CHECK_NOTHROW(read_picture(whole, "a.jpg", "texture"));
    }
}

}  // namespace
}  // namespace formwright
