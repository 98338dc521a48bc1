// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/samples/png_pixels.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace formwright::test {
namespace {

using Colour = std::array<std::uint8_t, 3>;

/// A run of counted colours, split where it spreads most: Heckbert 1982, median cut.
struct Box {
  std::size_t from, to;  // into the list of colours
  int axis = 0;
  double spread = 0;  // pixels times squared extent along the axis
};

struct Counted {
  Colour colour;
  int pixels;
};

Box measured(const std::vector<Counted>& colours, std::size_t from, std::size_t to) {
  Box box{from, to};
  double pixels = 0;
  Colour low{255, 255, 255}, high{0, 0, 0};
  for (std::size_t k = from; k < to; ++k) {
    pixels += colours[k].pixels;
    for (std::size_t c = 0; c < 3; ++c)
      low[c] = std::min(low[c], colours[k].colour[c]), high[c] = std::max(high[c], colours[k].colour[c]);
  }
  for (std::size_t c = 0; c < 3; ++c) {
    const double extent = high[c] - low[c], spread = std::sqrt(pixels) * extent * extent;
    if (spread > box.spread) box.spread = spread, box.axis = static_cast<int>(c);
  }
  return box;
}

std::vector<Colour> palette_of(std::vector<Counted>& colours, std::size_t maximum) {
  std::vector<Box> boxes{measured(colours, 0, colours.size())};
  while (boxes.size() < maximum) {
    const auto widest =
        std::max_element(boxes.begin(), boxes.end(), [](const Box& a, const Box& b) { return a.spread < b.spread; });
    if (widest->spread <= 0) break;
    const Box box = *widest;
    const auto axis = static_cast<std::size_t>(box.axis);
    const auto at = [&](std::size_t k) { return colours.begin() + static_cast<std::ptrdiff_t>(k); };
    std::sort(at(box.from), at(box.to), [&](const Counted& a, const Counted& b) {
      return a.colour[axis] != b.colour[axis] ? a.colour[axis] < b.colour[axis] : a.colour < b.colour;
    });
    // At the mean: a median would spend the palette on the background.
    double sum = 0, pixels = 0;
    for (std::size_t k = box.from; k < box.to; ++k)
      sum += static_cast<double>(colours[k].pixels) * colours[k].colour[axis], pixels += colours[k].pixels;
    std::size_t cut = box.from + 1;
    while (cut + 1 < box.to && colours[cut].colour[axis] <= sum / pixels) ++cut;
    *widest = measured(colours, box.from, cut);
    boxes.push_back(measured(colours, cut, box.to));
  }
  std::vector<Colour> palette;
  for (const Box& box : boxes) {
    std::array<double, 3> sum{};
    double pixels = 0;
    for (std::size_t k = box.from; k < box.to; ++k) {
      pixels += colours[k].pixels;
      for (std::size_t c = 0; c < 3; ++c) sum[c] += static_cast<double>(colours[k].pixels) * colours[k].colour[c];
    }
    Colour mean;
    for (std::size_t c = 0; c < 3; ++c) mean[c] = static_cast<std::uint8_t>(sum[c] / pixels + 0.5);
    palette.push_back(mean);
  }
  return palette;
}

std::uint8_t nearest(const std::vector<Colour>& palette, const Colour& colour) {
  std::size_t best = 0;
  int minimum = 1 << 30;
  for (std::size_t k = 0; k < palette.size(); ++k) {
    int d = 0;
    for (std::size_t c = 0; c < 3; ++c) d += (palette[k][c] - colour[c]) * (palette[k][c] - colour[c]);
    if (d < minimum) minimum = d, best = k;
  }
  return static_cast<std::uint8_t>(best);
}

}  // namespace

RgbPicture decode_png(ByteView bytes, std::uint8_t behind) {
  RgbPicture picture;
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) == 0) return picture;
  image.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(image), behind);
  if (png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr) == 0) return picture;
  picture.width = static_cast<int>(image.width);
  picture.height = static_cast<int>(image.height);
  picture.bytes = std::move(pixels);
  return picture;
}

Bytes encode_palette_png(const RgbPicture& picture) {
  const std::size_t pixels = picture.bytes.size() / 3;
  std::vector<int> count(std::size_t{1} << 18, 0);  // 6 bits a channel
  const auto cell = [&](std::size_t k) {
    const std::uint8_t* p = &picture.bytes[3 * k];
    return static_cast<std::size_t>(p[0] >> 2) << 12 | static_cast<std::size_t>(p[1] >> 2) << 6 |
           static_cast<std::size_t>(p[2] >> 2);
  };
  const auto colour_of = [](std::size_t c) {
    const auto part = [&](std::size_t shift) { return static_cast<std::uint8_t>((c >> shift & 63U) << 2 | 2U); };
    return Colour{part(12), part(6), part(0)};
  };
  for (std::size_t k = 0; k < pixels; ++k) ++count[cell(k)];
  std::vector<Counted> colours;
  for (std::size_t c = 0; c < count.size(); ++c)
    if (count[c] > 0) colours.push_back({colour_of(c), count[c]});
  const std::vector<Colour> palette = palette_of(colours, 255);
  // Three quarters of the error go on to the pixels to come (Floyd and Steinberg 1976): no bands, little noise.
  const auto width = static_cast<std::size_t>(picture.width);
  std::vector<int> index_of(count.size(), -1);
  std::vector<std::uint8_t> indices(pixels);
  std::vector<std::array<double, 3>> carried(pixels + width + 2, {0, 0, 0});
  for (std::size_t k = 0; k < pixels; ++k) {
    Colour wanted;
    for (std::size_t c = 0; c < 3; ++c)
      wanted[c] = static_cast<std::uint8_t>(std::clamp(picture.bytes[3 * k + c] + 0.75 * carried[k][c], 0.0, 255.0));
    int& index = index_of[static_cast<std::size_t>(wanted[0] >> 2) << 12 |
                          static_cast<std::size_t>(wanted[1] >> 2) << 6 | static_cast<std::size_t>(wanted[2] >> 2)];
    if (index < 0) index = nearest(palette, wanted);
    indices[k] = static_cast<std::uint8_t>(index);
    const bool first = k % width == 0, last = k % width == width - 1;
    for (std::size_t c = 0; c < 3; ++c) {
      const double error = (wanted[c] - palette[static_cast<std::size_t>(index)][c]) / 16.0;
      if (!last) carried[k + 1][c] += 7 * error, carried[k + width + 1][c] += error;
      if (!first) carried[k + width - 1][c] += 3 * error;
      carried[k + width][c] += 5 * error;
    }
  }
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGB_COLORMAP;
  image.colormap_entries = static_cast<png_uint_32>(palette.size());
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<std::uint8_t> written(size);
  if (png_image_write_to_memory(&image, written.data(), &size, 0, indices.data(), 0, palette.data()) == 0) return {};
  Bytes bytes(size);
  std::memcpy(bytes.data(), written.data(), size);
  return bytes;
}

}  // namespace formwright::test
