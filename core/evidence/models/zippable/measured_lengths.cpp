// SPDX-License-Identifier: GPL-3.0-or-later
#include <fast_float/fast_float.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "base/error.h"
#include "evidence/models/zippable/measured_zippable.h"

namespace formwright {
namespace {

constexpr std::size_t max_lengths = 10000;
constexpr double usual_tape_sigma_mm = 0.5;

[[noreturn]] void refuse_line(std::size_t line, const std::string& sentence) {
  throw Error(ErrorCode::invalid_input, "object", "lengths.csv, line " + std::to_string(line) + ": " + sentence);
}

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '"'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t comma = line.find_first_of(",;");
    fields.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

double number_in(std::string_view text, std::size_t line, const char* column) {
  double value = 0;
  const auto [end, error] = fast_float::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    refuse_line(line, std::string("“") + column + "” must be a number, such as 143.5.");
  return value;
}

ZipperMark mark_in(std::string_view text, std::size_t line, const char* column, bool flat) {
  ZipperMark mark;
  bool sided = false;
  if (!text.empty() && (text.back() == 'L' || text.back() == 'R' || text.back() == 'l' || text.back() == 'r')) {
    mark.left = text.back() == 'L' || text.back() == 'l';
    sided = true;
    text.remove_suffix(1);
  }
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), mark.number);
  if (error != std::errc() || end != text.data() + text.size() || mark.number < 0)
    refuse_line(line, std::string("“") + column + "” must be the number of a mark, such as 12, or 12L and 12R.");
  if (flat && !sided)
    refuse_line(line, "on the flat ribbon a mark needs its side: write " + std::to_string(mark.number) + "L or " +
                          std::to_string(mark.number) + "R.");
  return mark;
}

}  // namespace

std::string mark_text(const ZipperMark& mark, bool flat) {
  return std::to_string(mark.number) + (flat ? (mark.left ? "L" : "R") : "");
}

std::vector<MeasuredLength> read_measured_lengths(ByteView csv) {
  std::string_view text = as_text(csv);
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  std::vector<MeasuredLength> lengths;
  std::map<std::string, std::size_t, std::less<>> column;
  for (std::size_t line = 1; !text.empty(); ++line) {
    const std::size_t end = text.find('\n');
    const std::string_view row = trimmed(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (row.empty()) continue;
    const std::vector<std::string_view> fields = fields_of(row);
    if (column.empty()) {
      for (std::size_t i = 0; i < fields.size(); ++i) column.emplace(std::string(fields[i]), i);
      for (const char* name : {"from", "to", "state", "length_mm"})
        if (!column.contains(name))
          refuse_line(line, std::string("the column “") + name +
                                "” is missing: the header is from,to,state,length_mm,sigma_mm.");
      continue;
    }
    const auto field = [&](const char* name) {
      const auto at = column.find(name);
      return at == column.end() || at->second >= fields.size() ? std::string_view() : fields[at->second];
    };
    if (field("length_mm").empty()) continue;
    if (lengths.size() == max_lengths)
      refuse_line(line, "there are more than " + std::to_string(max_lengths) + " lengths: leave some out.");
    MeasuredLength length;
    if (field("state") != "flat" && field("state") != "zipped") refuse_line(line, "“state” must be flat or zipped.");
    length.flat = field("state") == "flat";
    length.from = mark_in(field("from"), line, "from", length.flat);
    length.to = mark_in(field("to"), line, "to", length.flat);
    length.length_mm = number_in(field("length_mm"), line, "length_mm");
    if (!(length.length_mm > 0)) refuse_line(line, "“length_mm” must be above 0.");
    length.sigma_mm = field("sigma_mm").empty() ? usual_tape_sigma_mm : number_in(field("sigma_mm"), line, "sigma_mm");
    if (!(length.sigma_mm > 0)) refuse_line(line, "“sigma_mm” must be above 0.");
    if (length.from.number == length.to.number && (!length.flat || length.from.left == length.to.left))
      refuse_line(line, "from and to are the same place.");
    lengths.push_back(length);
  }
  if (column.empty()) refuse_line(1, "the file is empty: the header is from,to,state,length_mm,sigma_mm.");
  return lengths;
}

}  // namespace formwright
