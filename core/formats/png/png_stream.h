// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// libpng on bytes in memory, freed whatever happens: for this library's pictures and those of core/imaging.
#include <png.h>

#include <cstring>
#include <new>
#include <stdexcept>

#include "base/bytes.h"

namespace formwright {

// libpng reports errors through a function that must not return. It may throw, and so no setjmp is needed, which
// would skip destructors; libpng holds nothing that png_destroy_* does not free.
[[noreturn]] inline void png_failed(png_structp, png_const_charp message) { throw std::runtime_error(message); }
inline void png_warned(png_structp, png_const_charp) {}

class PngWriter {
 public:
  explicit PngWriter(Bytes& out)
      : png_(png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, png_failed, png_warned)) {
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
    if (info_ == nullptr) throw std::bad_alloc();
    png_set_write_fn(png_, &out, append_bytes, nullptr);
  }
  ~PngWriter() { png_destroy_write_struct(&png_, &info_); }
  PngWriter(const PngWriter&) = delete;

  png_structp png() const { return png_; }
  png_infop info() const { return info_; }

 private:
  static void append_bytes(png_structp png, png_bytep data, std::size_t size) {
    auto& out = *static_cast<Bytes*>(png_get_io_ptr(png));
    const auto* const from = reinterpret_cast<const std::byte*>(data);
    out.insert(out.end(), from, from + size);
  }

  png_structp png_;
  png_infop info_ = nullptr;
};

class PngReader {
 public:
  explicit PngReader(ByteView bytes)
      : left_(bytes), png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, png_failed, png_warned)) {
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
    if (info_ == nullptr) throw std::bad_alloc();
    png_set_read_fn(png_, this, take_bytes);
    // Chunks beside the pixels are not needed. A packed text of 8 kB unpacks to 8 MB, and libpng keeps up to 1000 of
    // them; 1 means none.
    png_set_chunk_cache_max(png_, 1);
    png_set_chunk_malloc_max(png_, 8'000'000);
  }
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngReader(const PngReader&) = delete;

  png_structp png() const { return png_; }
  png_infop info() const { return info_; }

 private:
  static void take_bytes(png_structp png, png_bytep data, std::size_t size) {
    ByteView& left = static_cast<PngReader*>(png_get_io_ptr(png))->left_;
    if (size > left.size()) png_error(png, "it ends too early");
    std::memcpy(data, left.data(), size);
    left = left.subspan(size);
  }

  ByteView left_;
  png_structp png_;
  png_infop info_ = nullptr;
};

}  // namespace formwright
