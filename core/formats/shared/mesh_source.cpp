// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/shared/mesh_source.h"

#include <algorithm>

#include "base/error.h"

namespace formwright {
namespace {

/// Length of the valid UTF-8 sequence at `i`, 0 if there is none (RFC 3629: no surrogates, nothing overlong).
std::size_t utf8_sequence(std::string_view text, std::size_t i) {
  const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0u; };
  const auto tail = [&](std::size_t k) { return (byte(k) & 0xC0u) == 0x80u; };
  const unsigned lead = byte(i);
  if (lead < 0x80) return 1;
  if (lead >= 0xC2 && lead <= 0xDF) return tail(i + 1) ? 2 : 0;
  if (lead >= 0xE0 && lead <= 0xEF) {
    if (!tail(i + 1) || !tail(i + 2)) return 0;
    if (lead == 0xE0 && byte(i + 1) < 0xA0) return 0;
    if (lead == 0xED && byte(i + 1) > 0x9F) return 0;
    return 3;
  }
  if (lead >= 0xF0 && lead <= 0xF4) {
    if (!tail(i + 1) || !tail(i + 2) || !tail(i + 3)) return 0;
    if (lead == 0xF0 && byte(i + 1) < 0x90) return 0;
    if (lead == 0xF4 && byte(i + 1) > 0x8F) return 0;
    return 4;
  }
  return 0;
}

}  // namespace

std::string clean_text(std::string_view text, std::size_t max_bytes) {
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = utf8_sequence(text, i);
    const unsigned byte = static_cast<unsigned char>(text[i]);
    std::string piece;
    if (length > 1) piece = text.substr(i, length);
    else if (length == 0) piece = {static_cast<char>(0xC0u | (byte >> 6)), static_cast<char>(0x80u | (byte & 0x3Fu))};
    else piece = byte < 0x20 || byte == 0x7F ? ' ' : text[i];
    if (result.size() + piece.size() > max_bytes) return result + "…";
    result += piece;
    i += std::max<std::size_t>(length, 1);
  }
  return result;
}

std::string bare_name(std::string_view path) {
  const std::size_t slash = path.find_last_of("/\\");
  std::string name(slash == std::string_view::npos ? path : path.substr(slash + 1));
  std::ranges::transform(name, name.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return name;
}

std::string counted(std::int64_t count, std::string_view one, std::string_view many) {
  std::string digits = std::to_string(count);
  for (std::size_t i = digits.size(); i > 3 + (count < 0 ? 1u : 0u);) digits.insert(i -= 3, " ");
  return digits + ' ' + std::string(count == 1 ? one : many);
}

MeshSource::MeshSource(ByteView bytes, std::string_view file_name, const ReadOptions& options, Context& context)
    : bytes_(bytes), name_(clean_text(file_name)), options_(options), context_(context) {
  if (name_.empty()) name_ = "The file";
}

void MeshSource::refuse(const std::string& what) const {
  throw Error(ErrorCode::invalid_input, options_.where, name_ + ": " + what);
}

void MeshSource::refuse_line(std::size_t offset, const std::string& what) const {
  // Lines end in \n, \r\n or, in files of old Macintoshes, \r; counting is left until it is needed.
  const std::string_view before = text().substr(0, std::min(offset, bytes_.size()));
  auto line = 1 + std::ranges::count(before, '\n');
  if (line == 1 && text().find('\n') == std::string_view::npos) line += std::ranges::count(before, '\r');
  throw Error(ErrorCode::invalid_input, options_.where, name_ + ", line " + std::to_string(line) + ": " + what);
}

void MeshSource::check_triangle_count(std::int64_t count) const {
  if (count > options_.max_triangles)
    refuse("it holds " + counted(count, "triangle", "triangles") + ", and at most " +
           counted(options_.max_triangles, "is", "are") + " read here; simplify the mesh first.");
}

void MeshSource::refuse_empty(const std::string& instead) const {
  refuse((instead.empty() ? std::string("it holds no triangles") : "it holds " + instead + " but no triangles") +
         "; export the model as a mesh of faces.");
}

}  // namespace formwright
