// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/photographs/mark_code.h"

#include <array>
#include <bit>
#include <vector>

#include "base/index.h"
#include "base/random.h"

namespace formwright {
namespace {

using Turned = std::array<std::uint64_t, 4>;

constexpr int cell_count = mark_inner_cells * mark_inner_cells;
constexpr std::uint64_t code_seed = 6101;  // of the list of numbers: printed marks stay readable only while it stays

constexpr int bit_of(int column, int row) { return cell_count - 1 - (row * mark_inner_cells + column); }

Turned all_turns(std::uint64_t bits) {
  Turned turns{bits};
  for (std::size_t k = 1; k < 4; ++k) turns[k] = turned_bits(turns[k - 1]);
  return turns;
}

int difference(std::uint64_t a, std::uint64_t b) { return std::popcount(a ^ b); }

/// Codes drawn at random and kept where they are far from all before them and from themselves turned.
std::vector<Turned> draw_codes() {
  std::vector<Turned> codes;
  Random random(code_seed);
  while (codes.size() < static_cast<std::size_t>(mark_numbers)) {
    const Turned turns = all_turns(random.next() >> (64 - cell_count));
    const int white = std::popcount(turns[0]);
    bool far = white >= 12 && white <= 24;  // neither nearly black nor nearly white
    for (std::size_t k = 1; k < 4 && far; ++k) far = difference(turns[0], turns[k]) >= mark_distance;
    for (std::size_t i = 0; i < codes.size() && far; ++i)
      for (std::size_t k = 0; k < 4 && far; ++k) far = difference(codes[i][0], turns[k]) >= mark_distance;
    if (far) codes.push_back(turns);
  }
  return codes;
}

const std::vector<Turned>& codes() {
  static const std::vector<Turned> list = draw_codes();
  return list;
}

}  // namespace

std::uint64_t mark_bits(int number) { return codes()[index(number)][0]; }

bool mark_cell_is_white(int number, int column, int row) {
  const int x = column - 1, y = row - 1;
  if (x < 0 || y < 0 || x >= mark_inner_cells || y >= mark_inner_cells) return false;
  return (mark_bits(number) >> bit_of(x, y) & 1) != 0;
}

std::uint64_t turned_bits(std::uint64_t bits) {
  std::uint64_t result = 0;
  for (int row = 0; row < mark_inner_cells; ++row)
    for (int column = 0; column < mark_inner_cells; ++column)
      if (bits >> bit_of(column, row) & 1) result |= std::uint64_t{1} << bit_of(row, mark_inner_cells - 1 - column);
  return result;
}

std::uint64_t mirrored_bits(std::uint64_t bits) {
  std::uint64_t result = 0;
  for (int row = 0; row < mark_inner_cells; ++row)
    for (int column = 0; column < mark_inner_cells; ++column)
      if (bits >> bit_of(column, row) & 1) result |= std::uint64_t{1} << bit_of(mark_inner_cells - 1 - column, row);
  return result;
}

std::optional<ReadCode> read_code(std::uint64_t bits) {
  const std::vector<Turned>& list = codes();
  for (std::size_t i = 0; i < list.size(); ++i)
    for (std::size_t k = 0; k < 4; ++k)
      if (const int wrong = difference(list[i][k], bits); wrong <= max_wrong_cells)
        return ReadCode{static_cast<int>(i), static_cast<int>(k), wrong};
  return std::nullopt;
}

}  // namespace formwright
