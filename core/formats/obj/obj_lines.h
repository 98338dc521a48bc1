// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// OBJ as lines of a keyword and words, for both passes of its reader: they must see exactly the same.
#include <cstring>
#include <string>
#include <string_view>

#include "formats/shared/text_scan.h"

namespace formwright {

/// Lines of a chunk, with continued ones joined. A comment is never continued: it may end in a Windows path.
class ObjLines {
 public:
  ObjLines(const char* begin, const char* end, char terminator) : at_(begin), end_(end), terminator_(terminator) {}

  bool next() {
    if (at_ == end_) return false;
    start_ = at_;
    line_ = physical();
    if (line_.empty() || line_.back() != '\\' || line_.front() == '#') return true;
    joined_.clear();
    while (!line_.empty() && line_.back() == '\\') {
      joined_.append(line_.substr(0, line_.size() - 1)).push_back(' ');
      if (at_ == end_) {
        line_ = {};
        break;
      }
      line_ = physical();
    }
    joined_.append(line_);
    line_ = joined_;
    return true;
  }
  std::string_view line() const { return line_; }
  const char* start() const { return start_; }

 private:
  std::string_view physical() {
    const auto left = static_cast<std::size_t>(end_ - at_);
    const char* stop = static_cast<const char*>(std::memchr(at_, terminator_, left));
    if (stop == nullptr) stop = end_;
    std::string_view line(at_, static_cast<std::size_t>(stop - at_));
    at_ = stop == end_ ? end_ : stop + 1;
    while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
    while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
    return line;
  }

  const char *at_, *end_, *start_ = nullptr;
  char terminator_;
  std::string_view line_;
  std::string joined_;
};

/// Next word of a line; empty at its end or at a comment.
inline std::string_view next_word(TextScan& scan) {
  scan.skip_blanks();
  if (scan.done() || *scan.at == '#') return {};
  const char* const from = scan.at;
  while (!scan.done() && !is_blank(*scan.at)) ++scan.at;
  return {from, static_cast<std::size_t>(scan.at - from)};
}

inline int count_words(TextScan scan) {
  int count = 0;
  while (!next_word(scan).empty()) ++count;
  return count;
}

enum class ObjKeyword { vertex, texture_vertex, face, group, material, library, line, free_form, other };

/// Splits the keyword off the line.
inline ObjKeyword keyword_of(std::string_view line, TextScan& rest) {
  rest = TextScan(line);
  if (line.size() > 1 && line[0] == 'v' && is_blank(line[1])) return rest.at += 1, ObjKeyword::vertex;
  if (line.size() > 1 && line[0] == 'f' && is_blank(line[1])) return rest.at += 1, ObjKeyword::face;
  const std::string_view word = next_word(rest);
  if (word == "vt") return ObjKeyword::texture_vertex;
  if (word == "vn" || word.empty()) return ObjKeyword::other;
  if (word == "g" || word == "o") return ObjKeyword::group;
  if (word == "usemtl") return ObjKeyword::material;
  if (word == "mtllib") return ObjKeyword::library;
  if (word == "l" || word == "p") return ObjKeyword::line;
  if (word == "surf" || word == "curv" || word == "curv2") return ObjKeyword::free_form;
  return ObjKeyword::other;
}

}  // namespace formwright
