// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/png/png16.h"

#include <cmath>
#include <string>

#include "base/error.h"
#include "formats/shared/mesh_source.h"
#include "formats/png/png_stream.h"

namespace formwright {
namespace {

std::uint32_t per_metre(double pixel_mm) { return static_cast<std::uint32_t>(std::lround(1000 / pixel_mm)); }

}  // namespace

Bytes write_png16(const Grey16Image& image, const Context& context) {
  const auto width = static_cast<std::size_t>(image.width), height = static_cast<std::size_t>(image.height);
  if (image.width < 1 || image.height < 1 || image.levels.size() != width * height)
    throw Error(ErrorCode::internal, "", "The number of grey levels of a picture must be its width times its height.");
  Bytes bytes;
  try {
    const PngWriter writer(bytes);
    png_set_IHDR(writer.png(), writer.info(), static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 16,
                 PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    // Height maps are smooth: the Up and Paeth filters with the fast levels of deflate come within 5 % of the slow
    // ones.
    png_set_filter(writer.png(), PNG_FILTER_TYPE_BASE, PNG_FILTER_UP | PNG_FILTER_PAETH);
    png_set_compression_level(writer.png(), 4);
    const double px = image.pixel_width_mm, py = image.pixel_height_mm;
    if (px > 1e-6 && py > 1e-6 && px < 1000 && py < 1000)
      png_set_pHYs(writer.png(), writer.info(), per_metre(px), per_metre(py), PNG_RESOLUTION_METER);
    png_write_info(writer.png(), writer.info());
    png_set_swap(writer.png());  // PNG is big endian
    for (std::size_t row = 0; row < height; ++row) {
      if (row % 64 == 0) context.check_cancelled();
      png_write_row(writer.png(), reinterpret_cast<png_const_bytep>(image.levels.data() + row * width));
    }
    png_write_end(writer.png(), nullptr);
  } catch (const Error&) {
    throw;  // cancelled
  } catch (const std::runtime_error& error) {
    throw Error(ErrorCode::internal, "", std::string("The picture cannot be written: ") + error.what() + ".");
  }
  return bytes;
}

Grey16Image read_png16(ByteView bytes, std::string_view file_name, std::string_view where, std::size_t max_pixels) {
  const auto refuse = [&](const std::string& what) -> Error {
    return {ErrorCode::invalid_input, std::string(where),
            clean_text(file_name.empty() ? "The file" : file_name) + ": " + what};
  };
  if (bytes.size() < 8 || png_sig_cmp(reinterpret_cast<png_const_bytep>(bytes.data()), 0, 8) != 0)
    throw refuse("this is not a PNG picture; save the picture as PNG.");
  Grey16Image image;
  try {
    const PngReader reader(bytes);
    const png_structp png = reader.png();
    const png_infop info = reader.info();
    png_set_user_limits(png, 65535, 65535);
    png_read_info(png, info);
    const std::size_t width = png_get_image_width(png, info), height = png_get_image_height(png, info);
    // Deflate packs at most 1032 to 1, so no small file can ask for a large picture.
    const std::size_t channels_bits =
        static_cast<std::size_t>(png_get_channels(png, info)) * png_get_bit_depth(png, info);
    if (width * height > max_pixels)
      throw std::runtime_error("it has more than " + std::to_string(max_pixels / 1'000'000) + " million pixels");
    if (width * height / 8 * channels_bits / 1032 > bytes.size()) throw std::runtime_error("it ends too early");
    png_set_expand(png);
    png_set_strip_alpha(png);
    png_set_expand_16(png);
    if ((png_get_color_type(png, info) & PNG_COLOR_MASK_COLOR) != 0)
      png_set_rgb_to_gray(png, PNG_ERROR_ACTION_NONE, 0.2126, 0.7152);
    png_set_swap(png);
    const int passes = png_set_interlace_handling(png);
    png_read_update_info(png, info);
    if (png_get_rowbytes(png, info) != 2 * width) throw std::runtime_error("its kind of pixels is not known");
    image.width = static_cast<int>(width), image.height = static_cast<int>(height);
    image.levels.assign(width * height, 0);
    for (int pass = 0; pass < passes; ++pass)
      for (std::size_t row = 0; row < height; ++row)
        png_read_row(png, reinterpret_cast<png_bytep>(image.levels.data() + row * width), nullptr);
    png_read_end(png, nullptr);
    png_uint_32 x = 0, y = 0;
    int unit = 0;
    if (png_get_pHYs(png, info, &x, &y, &unit) != 0 && unit == PNG_RESOLUTION_METER && x > 0 && y > 0)
      image.pixel_width_mm = 1000.0 / x, image.pixel_height_mm = 1000.0 / y;
  } catch (const std::runtime_error& error) {
    throw refuse(std::string("the picture is damaged (") + clean_text(error.what()) + "); save or copy it again.");
  }
  return image;
}

}  // namespace formwright
