// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Order statistics. None of them may be asked about values that are not numbers.
#include <algorithm>
#include <cstddef>
#include <vector>

namespace formwright {

/// The value with `rank` others before it when sorted. Needs rank < values.size(); reorders the values.
template <class Value>
Value value_of_rank(std::vector<Value>& values, std::size_t rank) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

/// The middle value; of an even number the upper of the middle two. 0 where there are no values.
template <class Value>
Value median(std::vector<Value> values) {
  return values.empty() ? Value(0) : value_of_rank(values, values.size() / 2);
}

/// Below which a `share` of the values lies, 0 to 1, interpolated between neighbours (Hyndman, Fan 1996, definition 7).
/// Needs a value.
inline double quantile(std::vector<double> values, double share) {
  const double at = share * static_cast<double>(values.size() - 1);
  const auto rank = static_cast<std::size_t>(at);
  const double low = value_of_rank(values, rank);
  if (rank + 1 >= values.size()) return low;
  // What nth_element has left above the rank holds the next value as its least.
  const double high = *std::min_element(values.begin() + static_cast<std::ptrdiff_t>(rank) + 1, values.end());
  return low + (at - static_cast<double>(rank)) * (high - low);
}

}  // namespace formwright
