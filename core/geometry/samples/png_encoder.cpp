// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/samples/png_encoder.h"

#include <zlib.h>

#include <algorithm>
#include <array>

#include "base/error.h"
#include "base/index.h"
#include "base/parallel.h"
#include "geometry/samples/shapes.h"

namespace formwright::samples {

Bytes encode_png(const std::vector<Point>& image, int pixels) {
  // Linear light to sRGB bytes by the nearest of the 256 levels.
  std::array<double, 255> middle{};
  for (int b = 0; b < 255; ++b) middle[index(b)] = 0.5 * (srgb(b, 0, 0).x + srgb(b + 1, 0, 0).x);
  const auto level = [&](double v) {
    return static_cast<unsigned char>(std::upper_bound(middle.begin(), middle.end(), v) - middle.begin());
  };
  const std::size_t row = 3 * index(pixels);
  std::vector<unsigned char> raw(row * index(pixels)), filtered;
  parallel_for(index(pixels), 8, [&](std::size_t from, std::size_t to) {
    for (std::size_t k = from * index(pixels); k < to * index(pixels); ++k) {
      raw[3 * k] = level(image[k].x);
      raw[3 * k + 1] = level(image[k].y);
      raw[3 * k + 2] = level(image[k].z);
    }
  });
  filtered.reserve((row + 1) * index(pixels));
  for (std::size_t j = 0; j < index(pixels); ++j) {
    filtered.push_back(1);  // the filter "Sub": differences along the row
    for (std::size_t i = 0; i < row; ++i)
      filtered.push_back(static_cast<unsigned char>(raw[j * row + i] - (i < 3 ? 0 : raw[j * row + i - 3])));
  }
  uLongf size = compressBound(static_cast<uLong>(filtered.size()));
  std::vector<unsigned char> packed(size);
  if (compress2(packed.data(), &size, filtered.data(), static_cast<uLong>(filtered.size()), 4) != Z_OK)
    throw Error(ErrorCode::out_of_memory, "sample", "The sample's texture could not be compressed.");
  packed.resize(size);
  Bytes png;
  const auto byte = [&](unsigned v) { png.push_back(static_cast<std::byte>(v & 255U)); };
  const auto word = [&](unsigned long v) {
    for (int shift = 24; shift >= 0; shift -= 8) byte(static_cast<unsigned>(v >> shift));
  };
  const auto chunk = [&](const char* type, const std::vector<unsigned char>& data) {
    word(data.size());
    uLong crc = crc32(0, reinterpret_cast<const Bytef*>(type), 4);
    if (!data.empty())
      crc = crc32(crc, data.data(), static_cast<uInt>(data.size()));  // of no bytes it would begin again
    for (int k = 0; k < 4; ++k) byte(static_cast<unsigned char>(type[k]));
    for (unsigned char v : data) byte(v);
    word(crc);
  };
  for (unsigned v : {0x89U, 0x50U, 0x4eU, 0x47U, 0x0dU, 0x0aU, 0x1aU, 0x0aU}) byte(v);
  const auto n = static_cast<unsigned>(pixels);
  const auto b = [](unsigned v) { return static_cast<unsigned char>(v & 255U); };
  chunk("IHDR", {b(n >> 24), b(n >> 16), b(n >> 8), b(n), b(n >> 24), b(n >> 16), b(n >> 8), b(n), 8, 2, 0, 0, 0});
  chunk("sRGB", {0});
  chunk("IDAT", packed);
  chunk("IEND", {});
  return png;
}

}  // namespace formwright::samples
