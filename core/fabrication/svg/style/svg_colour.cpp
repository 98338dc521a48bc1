// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg/style/svg_colour.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fast_float/fast_float.h>

#include "fabrication/svg/grammar/svg_grammar.h"

namespace formwright {
namespace {

constexpr std::pair<std::string_view, int> colour_names[] = {{"aliceblue", 0xf0f8ff},
                                                             {"antiquewhite", 0xfaebd7},
                                                             {"aqua", 0x00ffff},
                                                             {"aquamarine", 0x7fffd4},
                                                             {"azure", 0xf0ffff},
                                                             {"beige", 0xf5f5dc},
                                                             {"bisque", 0xffe4c4},
                                                             {"black", 0x000000},
                                                             {"blanchedalmond", 0xffebcd},
                                                             {"blue", 0x0000ff},
                                                             {"blueviolet", 0x8a2be2},
                                                             {"brown", 0xa52a2a},
                                                             {"burlywood", 0xdeb887},
                                                             {"cadetblue", 0x5f9ea0},
                                                             {"chartreuse", 0x7fff00},
                                                             {"chocolate", 0xd2691e},
                                                             {"coral", 0xff7f50},
                                                             {"cornflowerblue", 0x6495ed},
                                                             {"cornsilk", 0xfff8dc},
                                                             {"crimson", 0xdc143c},
                                                             {"cyan", 0x00ffff},
                                                             {"darkblue", 0x00008b},
                                                             {"darkcyan", 0x008b8b},
                                                             {"darkgoldenrod", 0xb8860b},
                                                             {"darkgray", 0xa9a9a9},
                                                             {"darkgreen", 0x006400},
                                                             {"darkgrey", 0xa9a9a9},
                                                             {"darkkhaki", 0xbdb76b},
                                                             {"darkmagenta", 0x8b008b},
                                                             {"darkolivegreen", 0x556b2f},
                                                             {"darkorange", 0xff8c00},
                                                             {"darkorchid", 0x9932cc},
                                                             {"darkred", 0x8b0000},
                                                             {"darksalmon", 0xe9967a},
                                                             {"darkseagreen", 0x8fbc8f},
                                                             {"darkslateblue", 0x483d8b},
                                                             {"darkslategray", 0x2f4f4f},
                                                             {"darkslategrey", 0x2f4f4f},
                                                             {"darkturquoise", 0x00ced1},
                                                             {"darkviolet", 0x9400d3},
                                                             {"deeppink", 0xff1493},
                                                             {"deepskyblue", 0x00bfff},
                                                             {"dimgray", 0x696969},
                                                             {"dimgrey", 0x696969},
                                                             {"dodgerblue", 0x1e90ff},
                                                             {"firebrick", 0xb22222},
                                                             {"floralwhite", 0xfffaf0},
                                                             {"forestgreen", 0x228b22},
                                                             {"fuchsia", 0xff00ff},
                                                             {"gainsboro", 0xdcdcdc},
                                                             {"ghostwhite", 0xf8f8ff},
                                                             {"gold", 0xffd700},
                                                             {"goldenrod", 0xdaa520},
                                                             {"gray", 0x808080},
                                                             {"green", 0x008000},
                                                             {"greenyellow", 0xadff2f},
                                                             {"grey", 0x808080},
                                                             {"honeydew", 0xf0fff0},
                                                             {"hotpink", 0xff69b4},
                                                             {"indianred", 0xcd5c5c},
                                                             {"indigo", 0x4b0082},
                                                             {"ivory", 0xfffff0},
                                                             {"khaki", 0xf0e68c},
                                                             {"lavender", 0xe6e6fa},
                                                             {"lavenderblush", 0xfff0f5},
                                                             {"lawngreen", 0x7cfc00},
                                                             {"lemonchiffon", 0xfffacd},
                                                             {"lightblue", 0xadd8e6},
                                                             {"lightcoral", 0xf08080},
                                                             {"lightcyan", 0xe0ffff},
                                                             {"lightgoldenrodyellow", 0xfafad2},
                                                             {"lightgray", 0xd3d3d3},
                                                             {"lightgreen", 0x90ee90},
                                                             {"lightgrey", 0xd3d3d3},
                                                             {"lightpink", 0xffb6c1},
                                                             {"lightsalmon", 0xffa07a},
                                                             {"lightseagreen", 0x20b2aa},
                                                             {"lightskyblue", 0x87cefa},
                                                             {"lightslategray", 0x778899},
                                                             {"lightslategrey", 0x778899},
                                                             {"lightsteelblue", 0xb0c4de},
                                                             {"lightyellow", 0xffffe0},
                                                             {"lime", 0x00ff00},
                                                             {"limegreen", 0x32cd32},
                                                             {"linen", 0xfaf0e6},
                                                             {"magenta", 0xff00ff},
                                                             {"maroon", 0x800000},
                                                             {"mediumaquamarine", 0x66cdaa},
                                                             {"mediumblue", 0x0000cd},
                                                             {"mediumorchid", 0xba55d3},
                                                             {"mediumpurple", 0x9370db},
                                                             {"mediumseagreen", 0x3cb371},
                                                             {"mediumslateblue", 0x7b68ee},
                                                             {"mediumspringgreen", 0x00fa9a},
                                                             {"mediumturquoise", 0x48d1cc},
                                                             {"mediumvioletred", 0xc71585},
                                                             {"midnightblue", 0x191970},
                                                             {"mintcream", 0xf5fffa},
                                                             {"mistyrose", 0xffe4e1},
                                                             {"moccasin", 0xffe4b5},
                                                             {"navajowhite", 0xffdead},
                                                             {"navy", 0x000080},
                                                             {"oldlace", 0xfdf5e6},
                                                             {"olive", 0x808000},
                                                             {"olivedrab", 0x6b8e23},
                                                             {"orange", 0xffa500},
                                                             {"orangered", 0xff4500},
                                                             {"orchid", 0xda70d6},
                                                             {"palegoldenrod", 0xeee8aa},
                                                             {"palegreen", 0x98fb98},
                                                             {"paleturquoise", 0xafeeee},
                                                             {"palevioletred", 0xdb7093},
                                                             {"papayawhip", 0xffefd5},
                                                             {"peachpuff", 0xffdab9},
                                                             {"peru", 0xcd853f},
                                                             {"pink", 0xffc0cb},
                                                             {"plum", 0xdda0dd},
                                                             {"powderblue", 0xb0e0e6},
                                                             {"purple", 0x800080},
                                                             {"rebeccapurple", 0x663399},
                                                             {"red", 0xff0000},
                                                             {"rosybrown", 0xbc8f8f},
                                                             {"royalblue", 0x4169e1},
                                                             {"saddlebrown", 0x8b4513},
                                                             {"salmon", 0xfa8072},
                                                             {"sandybrown", 0xf4a460},
                                                             {"seagreen", 0x2e8b57},
                                                             {"seashell", 0xfff5ee},
                                                             {"sienna", 0xa0522d},
                                                             {"silver", 0xc0c0c0},
                                                             {"skyblue", 0x87ceeb},
                                                             {"slateblue", 0x6a5acd},
                                                             {"slategray", 0x708090},
                                                             {"slategrey", 0x708090},
                                                             {"snow", 0xfffafa},
                                                             {"springgreen", 0x00ff7f},
                                                             {"steelblue", 0x4682b4},
                                                             {"tan", 0xd2b48c},
                                                             {"teal", 0x008080},
                                                             {"thistle", 0xd8bfd8},
                                                             {"tomato", 0xff6347},
                                                             {"turquoise", 0x40e0d0},
                                                             {"violet", 0xee82ee},
                                                             {"wheat", 0xf5deb3},
                                                             {"white", 0xffffff},
                                                             {"whitesmoke", 0xf5f5f5},
                                                             {"yellow", 0xffff00},
                                                             {"yellowgreen", 0x9acd32}};

struct Part {
  double value = 0;
  std::string_view unit;
};

/// The numbers in brackets; none when there are other than three or four.
std::optional<std::vector<Part>> parts_of(std::string_view text) {
  std::vector<Part> parts;
  while (!text.empty()) {
    std::string_view word = take_word(text);
    if (word.empty()) break;
    if (parts.size() == 4) return std::nullopt;
    Part part;
    if (word != "none") {
      if (word.front() == '+') word.remove_prefix(1);
      const auto [rest, error] = fast_float::from_chars(word.data(), word.data() + word.size(), part.value);
      if (error != std::errc() || !std::isfinite(part.value)) return std::nullopt;
      part.unit = {rest, static_cast<std::size_t>(word.data() + word.size() - rest)};
    }
    parts.push_back(part);
  }
  if (parts.size() < 3) return std::nullopt;
  return parts;
}

/// 0 to 1, from per cent or, without it, of `whole`.
double share(const Part& part, double whole) {
  return std::clamp(part.value / (part.unit == "%" ? 100 : whole), 0.0, 1.0);
}

double hue_degrees(const Part& part) {
  double degrees = part.value;
  if (part.unit == "rad") degrees *= 180 / std::numbers::pi;
  if (part.unit == "grad") degrees *= 0.9;
  if (part.unit == "turn") degrees *= 360;
  degrees = std::fmod(degrees, 360);
  return degrees < 0 ? degrees + 360 : degrees;
}

/// CSS Color 4, 7.1.
double hsl_channel(double degrees, double saturation, double lightness, double offset) {
  const double k = std::fmod(offset + degrees / 30, 12);
  return lightness - saturation * std::min(lightness, 1 - lightness) * std::max(-1.0, std::min({k - 3, 9 - k, 1.0}));
}

SvgColour colour_of(double r, double g, double b, const std::vector<Part>& parts) {
  const auto whole = [](double channel) { return static_cast<int>(std::lround(255 * std::clamp(channel, 0.0, 1.0))); };
  return {{whole(r), whole(g), whole(b)}, parts.size() > 3 ? share(parts[3], 1) : 1};
}

std::optional<SvgColour> function_colour(std::string_view name, const std::vector<Part>& parts) {
  if (name == "rgb" || name == "rgba")
    return colour_of(share(parts[0], 255), share(parts[1], 255), share(parts[2], 255), parts);
  const double second = share(parts[1], 100), third = share(parts[2], 100);
  double rgb[3];
  for (int i = 0; i < 3; ++i) {
    constexpr double offsets[] = {0, 8, 4};
    if (name == "hwb") {
      const double pure = hsl_channel(hue_degrees(parts[0]), 1, 0.5, offsets[i]);
      rgb[i] = second + third >= 1 ? second / (second + third) : pure * (1 - second - third) + second;
    } else {
      rgb[i] = hsl_channel(hue_degrees(parts[0]), second, third, offsets[i]);
    }
  }
  if (name != "hsl" && name != "hsla" && name != "hwb") return std::nullopt;
  return colour_of(rgb[0], rgb[1], rgb[2], parts);
}

std::optional<SvgColour> hex_colour(std::string_view digits) {
  if (digits.find_first_not_of("0123456789abcdef") != std::string_view::npos) return std::nullopt;
  const auto digit = [&](std::size_t i) { return digits[i] <= '9' ? digits[i] - '0' : digits[i] - 'a' + 10; };
  const bool brief = digits.size() == 3 || digits.size() == 4;
  if (!brief && digits.size() != 6 && digits.size() != 8) return std::nullopt;
  const auto channel = [&](std::size_t i) { return brief ? 17 * digit(i) : 16 * digit(2 * i) + digit(2 * i + 1); };
  const bool has_alpha = digits.size() == 4 || digits.size() == 8;
  return SvgColour{{channel(0), channel(1), channel(2)}, has_alpha ? channel(3) / 255.0 : 1};
}

}  // namespace

std::optional<SvgColour> read_colour(std::string_view text) {
  constexpr std::size_t max_bytes = 200;
  text = without_blanks(text);
  if (text.size() > max_bytes) return std::nullopt;
  std::string word(text);
  for (char& c : word)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + ('a' - 'A'));
  if (word.starts_with('#')) return hex_colour(std::string_view(word).substr(1));
  if (const std::size_t open = word.find('('); open != std::string::npos) {
    if (!word.ends_with(')')) return std::nullopt;
    const auto parts = parts_of(std::string_view(word).substr(open + 1, word.size() - open - 2));
    return parts ? function_colour(std::string_view(word).substr(0, open), *parts) : std::nullopt;
  }
  if (word == "transparent") return SvgColour{{0, 0, 0}, 0};
  const auto found = std::lower_bound(std::begin(colour_names), std::end(colour_names), word,
                                      [](const auto& entry, const std::string& name) { return entry.first < name; });
  if (found == std::end(colour_names) || found->first != word) return std::nullopt;
  return SvgColour{{found->second >> 16, found->second >> 8 & 255, found->second & 255}};
}

}  // namespace formwright
