// SPDX-License-Identifier: GPL-3.0-or-later
#include "imaging/picture/picture_reader.h"

#include <stb_image.h>

#include <array>
#include <bitset>
#include <map>
#include <memory>
#include <string>

#include "base/error.h"
#include "formats/shared/media_type.h"
#include "formats/shared/mesh_source.h"
#include "formats/png/png_stream.h"

namespace formwright {
namespace {

/// What is wrong with a picture, without its name and the fix.
struct Damaged : std::runtime_error {
  using std::runtime_error::runtime_error;
};
struct TooLarge {
  std::int64_t width, height;
};

constexpr int max_jpeg_scans = 100;

void check_size(std::int64_t width, std::int64_t height, std::int64_t max_pixels) {
  if (width < 1 || height < 1) throw Damaged("it has no pixels");
  if (width > max_picture_side || height > max_picture_side || width * height > max_pixels)
    throw TooLarge{width, height};
}

Image read_png(ByteView bytes, std::int64_t max_pixels) {
  const PngReader reader(bytes);
  const png_structp png = reader.png();
  const png_infop info = reader.info();
  png_set_user_limits(png, 0x7fffffff, 0x7fffffff);  // check_size says it in our words
  png_read_info(png, info);
  const std::int64_t width = png_get_image_width(png, info), height = png_get_image_height(png, info);
  check_size(width, height, max_pixels);
  // Deflate packs at most 1032 to 1, so no small file can ask for a large picture.
  const std::int64_t bits = std::int64_t{png_get_channels(png, info)} * png_get_bit_depth(png, info);
  if (width * height / 8 * bits / 1032 > static_cast<std::int64_t>(bytes.size())) throw Damaged("it ends too early");
  png_set_expand(png);
  png_set_scale_16(png);
  png_set_gray_to_rgb(png);
  png_set_add_alpha(png, 255, PNG_FILLER_AFTER);
  const int passes = png_set_interlace_handling(png);
  png_read_update_info(png, info);
  if (png_get_rowbytes(png, info) != 4 * static_cast<std::size_t>(width))
    throw Damaged("its kind of pixels is not known");
  Image image(static_cast<int>(width), static_cast<int>(height), {255, 255, 255, 255});
  for (int pass = 0; pass < passes; ++pass)
    for (int y = 0; y < image.height; ++y) png_read_row(png, image.at(0, y).data(), nullptr);
  png_read_end(png, nullptr);
  return image;
}

/// What a JPEG says of itself before each of its scans (ITU T.81, B.2): which tables there are, and which its
/// components use.
class JpegScans {
 public:
  explicit JpegScans(ByteView bytes) : bytes_(bytes) {}

  /// A progressive picture has about ten scans. One of nothing but runs of empty blocks takes some hundred bytes and
  /// goes over the whole picture, so that thousands of them take minutes. A table that is used and not there is memory
  /// to stb that nobody has written: it may read anywhere. Throws Damaged.
  void check() {
    int scans = 0;
    for (std::size_t i = 2; i + 3 < bytes_.size();) {
      const unsigned marker = at(i + 1);
      if (at(i) != 0xff || marker == 0x00 || marker == 0xff || (marker >= 0xd0 && marker <= 0xd8)) {
        ++i;  // within a scan: data, stuffed bytes and restarts
        continue;
      }
      if (marker == 0xd9) break;
      const std::size_t end = i + 2 + (at(i + 2) << 8 | at(i + 3));
      const ByteView segment = bytes_.subspan(i + 4, end > i + 4 && end <= bytes_.size() ? end - i - 4 : 0);
      if (marker == 0xc4) define_huffman(segment);
      else if (marker == 0xdb) define_quantisation(segment);
      else if (marker >= 0xc0 && marker <= 0xc2) read_frame(segment, marker == 0xc2);
      else if (marker == 0xda) {
        if (++scans > max_jpeg_scans) throw Damaged("it is drawn in more than 100 passes");
        check_scan(segment);
      }
      i = end;
    }
  }

 private:
  static unsigned value(std::byte byte) { return std::to_integer<unsigned>(byte); }
  unsigned at(std::size_t i) const { return value(bytes_[i]); }

  void define_huffman(ByteView segment) {
    for (std::size_t p = 0; p + 17 <= segment.size();) {
      const unsigned kind = value(segment[p]);
      std::size_t symbols = 0;
      for (std::size_t k = 1; k <= 16; ++k) symbols += value(segment[p + k]);
      huffman_[kind >> 4 & 1].set(kind & 15);
      p += 17 + symbols;
    }
  }
  void define_quantisation(ByteView segment) {
    for (std::size_t p = 0; p < segment.size();) {
      const unsigned kind = value(segment[p]);
      quantisation_.set(kind & 15);
      p += 1 + (kind >> 4 ? 128 : 64);
    }
  }
  void read_frame(ByteView segment, bool progressive) {
    progressive_ = progressive;
    for (std::size_t p = 6; p + 3 <= segment.size(); p += 3)
      table_of_component_[value(segment[p])] = value(segment[p + 2]) & 15;
  }
  void check_scan(ByteView segment) const {
    if (segment.empty()) return;
    const std::size_t components = value(segment[0]), last = 1 + 2 * components;
    if (segment.size() < last + 3) return;  // stb refuses it
    const bool begins_at_dc = value(segment[last]) == 0, refines = value(segment[last + 2]) >> 4 != 0;
    for (std::size_t p = 1; p < last; p += 2) {
      const unsigned tables = value(segment[p + 1]);
      const bool needs_dc = !progressive_ || (begins_at_dc && !refines), needs_ac = !progressive_ || !begins_at_dc;
      const auto quantisation = table_of_component_.find(value(segment[p]));
      if ((needs_dc && !huffman_[0].test(tables >> 4)) || (needs_ac && !huffman_[1].test(tables & 15)) ||
          (quantisation != table_of_component_.end() && !quantisation_.test(quantisation->second)))
        throw Damaged("it uses a table that it does not have");
    }
  }

  ByteView bytes_;
  std::array<std::bitset<16>, 2> huffman_;  // of DC and of AC coefficients
  std::bitset<16> quantisation_;
  std::map<unsigned, unsigned> table_of_component_;
  bool progressive_ = false;
};

Image read_jpeg(ByteView bytes, std::int64_t max_pixels) {
  if (bytes.size() > 0x7fffffff) throw Damaged("it is larger than 2 GB");
  JpegScans(bytes).check();
  const auto* const data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  const auto reason = [] {
    return std::string(stbi_failure_reason() != nullptr ? stbi_failure_reason() : "no reason given");
  };
  if (stbi_info_from_memory(data, size, &width, &height, &channels) == 0) throw Damaged(reason());
  check_size(width, height, max_pixels);
  // Even a picture of one colour takes 4 bits of each block of 8 x 8 points: a file that claims more ends too early.
  // stb itself fills what is missing with grey.
  if (std::int64_t{width} * height / 64 / 4 > std::int64_t{size}) throw Damaged("it ends too early");
  const std::string_view text = as_text(bytes);
  if (text.substr(text.size() - std::min<std::size_t>(text.size(), 65536)).rfind("\xff\xd9") == std::string_view::npos)
    throw Damaged("it ends too early");
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(data, size, &width, &height, &channels, 4), stbi_image_free);
  if (!pixels) throw Damaged(reason());
  Image image(width, height, {});
  std::memcpy(image.pixels.data(), pixels.get(), image.pixels.size() * sizeof(Rgba));
  return image;
}

}  // namespace

Image read_picture(ByteView bytes, std::string_view file_name, std::string_view where, std::int64_t max_pixels) {
  const auto refuse = [&](const std::string& what) -> Error {
    return {ErrorCode::invalid_input, std::string(where),
            (file_name.empty() ? std::string("The picture") : clean_text(file_name)) + ": " + what};
  };
  const std::string kind = picture_media_type(bytes);
  if (kind != "image/png" && kind != "image/jpeg")
    throw refuse("this is neither a PNG nor a JPEG picture; save it as one of them.");
  try {
    return kind == "image/png" ? read_png(bytes, max_pixels) : read_jpeg(bytes, max_pixels);
  } catch (const TooLarge& size) {
    throw refuse("the picture has " + std::to_string(size.width) + " x " + std::to_string(size.height) +
                 " pixels, more than fit; scale it down to at most " + std::to_string(max_pixels / 1'000'000) +
                 " million.");
  } catch (const std::runtime_error& error) {
    throw refuse(std::string("the picture is damaged (") + clean_text(error.what()) + "); save or copy it again.");
  }
}

}  // namespace formwright
