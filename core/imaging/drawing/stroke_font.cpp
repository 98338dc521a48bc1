// SPDX-License-Identifier: GPL-3.0-or-later
#include <cctype>
#include <string_view>
#include <utility>

#include "imaging/drawing/drawing.h"

namespace formwright {
namespace {

// Polylines of a letter as pairs of digits, x from 0 to 4 and y from 0 (the base line) to 6.
constexpr std::pair<char, std::string_view> letters[] = {{'0', "103041453616050110"},
                                                         {'1', "142620 1030"},
                                                         {'2', "05163645440040"},
                                                         {'3', "05163645443313 334241301001"},
                                                         {'4', "30360242"},
                                                         {'5', "460603334241301001"},
                                                         {'6', "4536160501103041423303"},
                                                         {'7', "064610"},
                                                         {'8', "13040516364544331302011030414233"},
                                                         {'9', "0110304145361605041343"},
                                                         {'A', "002640 1232"},
                                                         {'B', "00063645443303 3342413000"},
                                                         {'C', "4536160501103041"},
                                                         {'D', "00062644422000"},
                                                         {'E', "46060040 0333"},
                                                         {'F', "460600 0333"},
                                                         {'G', "45361605011030414323"},
                                                         {'H', "0006 4046 0343"},
                                                         {'I', "1030 1636 2026"},
                                                         {'J', "4641301001"},
                                                         {'K', "0006 460340"},
                                                         {'L', "060040"},
                                                         {'M', "0006234640"},
                                                         {'N', "00064046"},
                                                         {'O', "103041453616050110"},
                                                         {'P', "00063645443303"},
                                                         {'Q', "103041453616050110 2240"},
                                                         {'R', "00063645443303 2340"},
                                                         {'S', "453616050413334241301001"},
                                                         {'T', "0646 2620"},
                                                         {'U', "060110304146"},
                                                         {'V', "062046"},
                                                         {'W', "0610233046"},
                                                         {'X', "0046 0640"},
                                                         {'Y', "062346 2320"},
                                                         {'Z', "06460040"},
                                                         {'-', "1333"},
                                                         {'.', "2021"},
                                                         {'/', "0046"},
                                                         {'+', "1333 2224"}};

}  // namespace

Drawing outlined(const Label& label) {
  Drawing drawing;
  const double unit = label.height_mm / 6, advance = 6 * unit;
  const double width = label.text.empty() ? 0 : (static_cast<double>(label.text.size()) - 1) * advance + 4 * unit;
  Vec2 corner = label.centre - Vec2(width / 2, label.height_mm / 2);
  for (const char c : label.text) {
    for (const auto& [letter, lines] : letters) {
      if (letter != std::toupper(static_cast<unsigned char>(c))) continue;
      bool begun = false;
      Vec2 last(0, 0);
      for (std::size_t i = 0; i + 1 < lines.size(); i += 2) {
        if (lines[i] == ' ') {
          begun = false;
          ++i;  // a new line begins behind the blank
        }
        const Vec2 point = corner + unit * Vec2(lines[i] - '0', lines[i + 1] - '0');
        if (begun) drawing.line(last, point, 0.12 * label.height_mm);
        last = point;
        begun = true;
      }
    }
    corner.x() += advance;
  }
  return drawing;
}

}  // namespace formwright
