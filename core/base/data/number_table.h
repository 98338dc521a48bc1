// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Tables of numbers with a header: CSV as measuring programs write it.
#include <string>
#include <vector>

#include "base/bytes.h"

namespace formwright {

struct ColumnRule {
  std::string name;
  bool required = true;       // else 0 where the file has no such column
  bool may_be_blank = false;  // a row whose columns of this kind are all blank is passed over: not measured
};

/// Rows of the named columns, in the order of `columns`; others are passed over. Commas, any line ends, blanks around
/// fields, a byte order mark are fine. Throws Error{invalid_input, where}, naming `file_name` and the line: a missing
/// column, something that is no finite number, more than `max_rows` rows, or none unless `may_be_empty`.
std::vector<std::vector<double>> read_number_table(ByteView csv, const std::string& file_name, const std::string& where,
                                                   const std::vector<ColumnRule>& columns, bool may_be_empty = false,
                                                   std::size_t max_rows = 5'000'000);

}  // namespace formwright
