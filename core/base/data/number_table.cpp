// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/data/number_table.h"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace formwright {
namespace {

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t comma = line.find(',');
    fields.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

}  // namespace

std::vector<std::vector<double>> read_number_table(ByteView csv, const std::string& file_name, const std::string& where,
                                                   const std::vector<ColumnRule>& columns, bool may_be_empty,
                                                   std::size_t max_rows) {
  std::string_view text = as_text(csv);
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  std::vector<int> place(columns.size(), -1);
  std::vector<std::vector<double>> rows;
  int line_number = 0;
  bool header = false;
  const auto refuse = [&](const std::string& sentence) {
    throw Error(ErrorCode::invalid_input, where, file_name + ", line " + std::to_string(line_number) + ": " + sentence);
  };
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = trimmed(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    ++line_number;
    if (line.empty()) continue;
    const std::vector<std::string_view> fields = fields_of(line);
    if (!header) {
      header = true;
      std::string names;
      for (const ColumnRule& column : columns) names += (names.empty() ? "" : ",") + column.name;
      for (std::size_t i = 0; i < columns.size(); ++i) {
        const auto at = std::find(fields.begin(), fields.end(), columns[i].name);
        if (at != fields.end()) place[i] = static_cast<int>(at - fields.begin());
        else if (columns[i].required) refuse("the header has no “" + columns[i].name + "”; it must be " + names + ".");
      }
      continue;
    }
    bool measured = std::none_of(columns.begin(), columns.end(), [](const ColumnRule& c) { return c.may_be_blank; });
    for (std::size_t i = 0; i < columns.size(); ++i)
      measured |= columns[i].may_be_blank && place[i] >= 0 && static_cast<std::size_t>(place[i]) < fields.size() &&
                  !fields[static_cast<std::size_t>(place[i])].empty();
    if (!measured && fields.size() > 1) continue;
    std::vector<double> row(columns.size());
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (place[i] < 0) continue;
      const auto at = static_cast<std::size_t>(place[i]);
      if (at >= fields.size()) refuse("there are only " + std::to_string(fields.size()) + " columns.");
      const char* last = fields[at].data() + fields[at].size();
      const auto parsed = fast_float::from_chars(fields[at].data(), last, row[i]);
      if (parsed.ec != std::errc() || parsed.ptr != last || !std::isfinite(row[i]))
        refuse("“" + columns[i].name + "” is not a number.");
    }
    rows.push_back(std::move(row));
    if (rows.size() > max_rows) refuse("more than " + std::to_string(max_rows) + " rows: keep every tenth.");
  }
  if (rows.empty() && !may_be_empty)
    throw Error(ErrorCode::invalid_input, where,
                file_name + " has no rows: it needs a header and one line for each measured point.");
  return rows;
}

}  // namespace formwright
