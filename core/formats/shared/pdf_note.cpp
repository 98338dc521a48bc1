// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/shared/pdf_note.h"

#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>

#include "formats/shared/text_scan.h"

namespace formwright {
namespace {

constexpr std::size_t npos = std::string_view::npos;
constexpr std::int64_t max_object = 100'000'000;

/// The whole number behind `name`, the last one in `text`.
std::optional<std::int64_t> number_behind(std::string_view text, std::string_view name) {
  const std::size_t at = text.rfind(name);
  if (at == npos) return std::nullopt;
  TextScan scan(text.substr(at + name.size()));
  scan.skip_spaces();
  std::int64_t value = 0;
  if (!scan.integer(value) || value < 0) return std::nullopt;
  return value;
}

/// ISO 32000-1, 7.3.4.2.
std::string literal(std::string_view words) {
  std::string text = "(";
  for (const char c : words) {
    if (c == '(' || c == ')' || c == '\\') text += '\\';
    text += c;
  }
  return text + ")";
}

/// One entry of a table of references has exactly 20 bytes (7.5.4).
std::string table_entry(std::size_t offset) {
  char entry[24];
  std::snprintf(entry, sizeof entry, "%010zu 00000 n\r\n", offset);
  return entry;
}

}  // namespace

void note_pdf(Bytes& file, std::string_view words) {
  const std::string_view text = as_text(file);
  if (!text.starts_with("%PDF-")) return;
  const auto table = number_behind(text, "startxref");
  if (!table || static_cast<std::uint64_t>(*table) >= text.size()) return;
  const std::string_view end = text.substr(static_cast<std::size_t>(*table));
  const auto root = number_behind(end, "/Root"), info = number_behind(end, "/Info"), size = number_behind(end, "/Size");
  if (!end.starts_with("xref") || !root || !info || !size || *info > max_object) return;
  const std::string head = std::to_string(*info) + " 0 obj";
  std::size_t at = text.find("\n" + head);
  if (at == npos) return;
  at += 1 + head.size();
  const std::size_t object_end = text.find("endobj", at);
  if (object_end == npos) return;
  const std::size_t close = text.substr(at, object_end - at).rfind(">>");
  if (close == npos) return;
  std::string update(text.ends_with('\n') ? "" : "\n");
  const std::size_t object = text.size() + update.size();
  update += head + std::string(text.substr(at, close)) + "/Subject " + literal(words) + "\n>>\nendobj\n";
  const std::size_t next_table = text.size() + update.size();
  update += "xref\n" + std::to_string(*info) + " 1\n" + table_entry(object) + "trailer\n<<\n/Root " +
            std::to_string(*root) + " 0 R\n/Info " + std::to_string(*info) + " 0 R\n/Size " + std::to_string(*size) +
            "\n/Prev " + std::to_string(*table) + "\n>>\nstartxref\n" + std::to_string(next_table) + "\n%%EOF\n";
  const ByteView bytes = as_bytes(update);
  file.insert(file.end(), bytes.begin(), bytes.end());
}

}  // namespace formwright
