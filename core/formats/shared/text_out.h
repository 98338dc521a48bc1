// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Text formats out: numbers as short as they can be while reading back to the same bits, rows formatted in parallel.
#include <charconv>
#include <concepts>
#include <string>
#include <string_view>
#include <vector>

#include "base/bytes.h"
#include "base/context.h"
#include "base/parallel.h"

namespace formwright {

class TextOut {
 public:
  TextOut& operator<<(std::string_view text) {
    text_.append(text);
    return *this;
  }
  TextOut& operator<<(char c) {
    text_.push_back(c);
    return *this;
  }
  /// Shortest digits that read back as the same double or float.
  template <std::floating_point Number>
  TextOut& operator<<(Number value) {
    char buffer[32];
    return *this << std::string_view(buffer, std::to_chars(buffer, buffer + sizeof buffer, value + Number(0)).ptr);
  }
  TextOut& operator<<(int value) {
    char buffer[16];
    return *this << std::string_view(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
  }
  void reserve(std::size_t bytes) { text_.reserve(bytes); }
  std::string& text() { return text_; }

 private:
  std::string text_;
};

/// Calls format_row(out, i) for every i in [0, count) in chunks, and returns the chunks' text in order.
template <class FormatRow>
std::vector<std::string> format_rows(std::size_t count, std::size_t bytes_per_row, const Context& context,
                                     const FormatRow& format_row) {
  constexpr std::size_t rows_per_chunk = 16384;
  std::vector<std::string> chunks((count + rows_per_chunk - 1) / rows_per_chunk);
  parallel_for(count, rows_per_chunk, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    TextOut out;
    out.reserve((end - begin) * bytes_per_row);
    for (std::size_t i = begin; i < end; ++i) format_row(out, i);
    chunks[begin / rows_per_chunk] = std::move(out.text());
  });
  return chunks;
}

/// All pieces, one after the other.
inline Bytes concatenate(const std::vector<std::string>& pieces) {
  std::size_t size = 0;
  for (const auto& piece : pieces) size += piece.size();
  Bytes bytes;
  bytes.reserve(size);
  for (const auto& piece : pieces) {
    const ByteView view = as_bytes(piece);
    bytes.insert(bytes.end(), view.begin(), view.end());
  }
  return bytes;
}

}  // namespace formwright
