// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Tables of numbers with a header: CSV as measuring programs write it.
#include <string>
#include <vector>

#include "base/bytes.h"

namespace formwright {

inline constexpr std::size_t max_table_rows = 5'000'000;

struct ColumnRule {
  std::string name;
  bool required = true;       // else 0 where the file has no such column
  bool may_be_blank = false;  // a row whose columns of this kind are all blank is passed over: not measured
};

/// Rows of the named columns, in the order of `columns`; others are passed over. Commas, any line ends, blanks around
/// fields, a byte order mark are fine. Throws Error{invalid_input, where}, naming `file_name` and the line: a missing
/// column, something that is no finite number, fewer than `min_rows` or more than `max_rows` rows.
std::vector<std::vector<double>> read_number_table(ByteView csv, const std::string& file_name, const std::string& where,
                                                   const std::vector<ColumnRule>& columns,
                                                   std::size_t max_rows = max_table_rows, std::size_t min_rows = 1);

}  // namespace formwright
