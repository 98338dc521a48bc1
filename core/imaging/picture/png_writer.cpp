// SPDX-License-Identifier: GPL-3.0-or-later
#include "imaging/picture/png_writer.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "formats/png/png_stream.h"

namespace formwright {

int pixels_per_metre(double dots_per_inch) { return static_cast<int>(std::lround(dots_per_inch / 0.0254)); }

Bytes write_png(const Image& image, int per_metre, const Context& context) {
  return write_png(image, Eigen::Vector2i(per_metre, per_metre), context);
}

Bytes write_png(const Image& image, const Eigen::Vector2i& per_metre, const Context& context) {
  if (image.width < 1 || image.height < 1 ||
      image.pixels.size() != static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height))
    throw Error(ErrorCode::internal, "", "The number of pixels of a picture must be its width times its height.");
  const bool opaque = std::all_of(image.pixels.begin(), image.pixels.end(), [](const Rgba& p) { return p[3] == 255; });
  Bytes bytes;
  try {
    const PngWriter writer(bytes);
    const png_structp png = writer.png();
    png_set_IHDR(png, writer.info(), static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height), 8,
                 opaque ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGBA, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    // Prints are large and mostly white or smooth: one filter and a fast level of deflate.
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);
    png_set_compression_level(png, 3);
    png_set_sRGB(png, writer.info(), PNG_sRGB_INTENT_PERCEPTUAL);
    if (per_metre.minCoeff() > 0)
      png_set_pHYs(png, writer.info(), static_cast<png_uint_32>(per_metre.x()), static_cast<png_uint_32>(per_metre.y()),
                   PNG_RESOLUTION_METER);
    png_write_info(png, writer.info());
    if (opaque) png_set_filler(png, 0, PNG_FILLER_AFTER);
    for (int y = 0; y < image.height; ++y) {
      if (y % 64 == 0) context.check_cancelled();
      png_write_row(png, image.at(0, y).data());
    }
    png_write_end(png, nullptr);
  } catch (const Error&) {
    throw;  // cancelled
  } catch (const std::runtime_error& error) {
    throw Error(ErrorCode::internal, "", std::string("The picture cannot be written: ") + error.what() + ".");
  }
  return bytes;
}

}  // namespace formwright
