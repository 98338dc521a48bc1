// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/shared/file_note.h"

#include <zlib.h>

#include <algorithm>
#include <string>

#include "base/data/xml_text.h"
#include "formats/shared/byte_order.h"
#include "formats/shared/pdf_note.h"

namespace formwright {
namespace {

void insert(Bytes& file, std::size_t at, std::string_view words) {
  const ByteView bytes = as_bytes(words);
  file.insert(file.begin() + static_cast<std::ptrdiff_t>(at), bytes.begin(), bytes.end());
}

/// After the first line that begins so, among the first ones.
void after_line(Bytes& file, std::string_view beginning, const std::string& line) {
  const std::string_view head = as_text(file).substr(0, 200);
  const std::size_t at = head.find(beginning);
  const std::size_t end = at == std::string_view::npos ? at : head.find('\n', at);
  if (end != std::string_view::npos) insert(file, end + 1, line);
}

void note_svg(Bytes& file, std::string_view json) {
  const std::size_t end = as_text(file).rfind("</svg>");
  if (end != std::string_view::npos) insert(file, end, "<metadata id=\"made_by\">" + xml_text(json) + "</metadata>\n");
}

/// PNG 1.2, 3.2 and 4.2.3.1: length, type, data and a CRC over type and data, big endian.
void note_png(Bytes& file, std::string_view json) {
  constexpr std::size_t after_header = 33;
  if (file.size() < after_header || !as_text(file).starts_with("\x89PNG\r\n\x1a\n")) return;
  using namespace std::string_view_literals;
  const std::string data = "tEXt" + std::string("Comment\0"sv) + std::string(json);
  const auto big_endian = [](std::uint32_t value) {
    std::string bytes(4, '\0');
    for (std::size_t i = 0; i < 4; ++i) bytes[i] = static_cast<char>(value >> (24 - 8 * i));
    return bytes;
  };
  const uLong crc = crc32(0, reinterpret_cast<const Bytef*>(data.data()), static_cast<uInt>(data.size()));
  insert(file, after_header,
         big_endian(static_cast<std::uint32_t>(data.size() - 4)) + data + big_endian(static_cast<std::uint32_t>(crc)));
}

/// glTF 2.0, 4.4: the lengths of the file and of its first chunk, which is padded with spaces to whole words.
void note_glb(Bytes& file, std::string_view json) {
  constexpr std::size_t chunk = 12, text = 20;
  if (file.size() < text || !as_text(file).starts_with("glTF")) return;
  const auto length = load<std::uint32_t>(file.data() + chunk);
  constexpr std::string_view asset = "\"asset\":{";
  const std::size_t at = as_text(file).substr(text, length).find(asset);
  if (at == std::string_view::npos) return;
  std::string words = "\"extras\":{\"made_by\":" + std::string(json) + "},";
  words.insert(0, (4 - words.size() % 4) % 4, ' ');
  insert(file, text + at + asset.size(), words);
  store(file.data() + 8, static_cast<std::uint32_t>(file.size()));
  store(file.data() + chunk, static_cast<std::uint32_t>(length + words.size()));
}

void note_ply(Bytes& file, std::string_view json) {
  after_line(file, "comment Formwright", "comment made by " + std::string(json) + "\n");
}

void note_obj(Bytes& file, std::string_view json) {
  after_line(file, "# Formwright", "# made by " + std::string(json) + "\n");
}

void note_stl(Bytes& file, std::string_view words) {
  constexpr std::size_t head = 80;
  if (file.size() < head || !as_text(file).starts_with("Binary STL by Formwright")) return;
  const std::size_t used = std::min(as_text(file).find('\0'), head);
  if (used + words.size() <= head) std::ranges::copy(as_bytes(words), file.begin() + static_cast<std::ptrdiff_t>(used));
}

/// Group 999 is a comment, which stands before the first section (DXF reference, "Group codes in numerical order").
void note_dxf(Bytes& file, std::string_view words) {
  if (as_text(file).starts_with("0\nSECTION\n")) insert(file, 0, "999\nFormwright" + std::string(words) + "\n");
}

/// APPNOTE 6.3, 4.3.16: the archive's comment follows the last record, whose last number is its length.
void note_zip(Bytes& file, std::string_view json) {
  constexpr std::size_t record = 22, length = 20;
  if (file.size() < record || !as_text(file).substr(file.size() - record).starts_with("PK\x05\x06")) return;
  store(file.data() + file.size() - record + length, static_cast<std::uint16_t>(json.size()));
  insert(file, file.size(), json);
}

struct Place {
  std::string_view media_type;
  void (*put)(Bytes& file, std::string_view note);
  bool brief = false;
};
constexpr Place places[] = {{"application/pdf", note_pdf}, {"application/x-ply", note_ply},
                            {"application/zip", note_zip}, {"image/png", note_png},
                            {"image/svg+xml", note_svg},   {"image/vnd.dxf", note_dxf, true},
                            {"model/3mf", note_zip},       {"model/gltf-binary", note_glb},
                            {"model/obj", note_obj},       {"model/stl", note_stl, true}};

const Place* place_in(std::string_view media_type) {
  const auto* const found = std::ranges::find(places, media_type, &Place::media_type);
  return found == std::end(places) ? nullptr : found;
}

}  // namespace

bool takes_note(std::string_view media_type) { return place_in(media_type) != nullptr; }

void add_note(Bytes& file, std::string_view media_type, std::string_view json, std::string_view words) {
  if (const Place* const place = place_in(media_type)) place->put(file, place->brief ? words : json);
}

}  // namespace formwright
