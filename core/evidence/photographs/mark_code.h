// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Numbers written as squares: 8 x 8 cells, a black border around 6 x 6 cells that are black or white, as in ArUco
// [GMMM14]. Two numbers differ in at least 9 cells however either of them is turned.
#include <cstdint>
#include <optional>

namespace formwright {

inline constexpr int mark_cells = 8;        // along a side, the black border included
inline constexpr int mark_inner_cells = 6;  // along a side, without the border
inline constexpr int mark_numbers = 1000;   // numbers from 0
inline constexpr int mark_distance = 9;     // cells in which two numbers differ at least

/// The inner cells row by row from the back left, most significant bit first of 36; 1 is white.
/// Needs 0 <= number < mark_numbers.
std::uint64_t mark_bits(int number);

/// Is the cell white? `column` from the left, `row` from the back, both 0 to mark_cells - 1.
bool mark_cell_is_white(int number, int column, int row);

/// The cells turned by a quarter, counter-clockwise.
std::uint64_t turned_bits(std::uint64_t bits);
/// Left and right exchanged.
std::uint64_t mirrored_bits(std::uint64_t bits);

struct ReadCode {
  int number = 0;
  int quarter_turns = 0;  // counter-clockwise: as many turns of mark_bits(number) look like what was read
  int wrong_cells = 0;
};
inline constexpr int max_wrong_cells = 3;  // less than half of mark_distance: the nearest number is the only one

/// The number that differs from `bits` in at most max_wrong_cells cells; none where no number does.
std::optional<ReadCode> read_code(std::uint64_t bits);

}  // namespace formwright
