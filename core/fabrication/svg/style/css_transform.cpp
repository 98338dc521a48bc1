// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg/style/css_transform.h"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace formwright {
namespace {

using Words = std::vector<std::string_view>;

Words words_of(std::string_view text) {
  constexpr std::size_t max_words = 16;
  Words words;
  while (!(text = without_blanks(text)).empty() && words.size() <= max_words) words.push_back(take_word(text));
  return words;
}

/// A number and what stands behind it.
std::optional<std::pair<double, std::string_view>> number_of(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [rest, error] = fast_float::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  return std::pair(value, std::string_view(rest, static_cast<std::size_t>(word.data() + word.size() - rest)));
}

std::optional<double> plain(std::string_view word) {
  const auto number = number_of(word);
  if (number && number->second.empty()) return number->first;
  if (number && number->second == "%") return number->first / 100;
  return std::nullopt;
}

std::optional<double> degrees_of(std::string_view word) {
  const auto number = number_of(word);
  if (!number) return std::nullopt;
  const auto& [value, unit] = *number;
  if (same_word(unit, "deg") || (unit.empty() && value == 0)) return value;
  if (same_word(unit, "rad")) return value * 180 / std::numbers::pi;
  if (same_word(unit, "grad")) return value * 0.9;
  if (same_word(unit, "turn")) return value * 360;
  return std::nullopt;
}

std::optional<double> distance(std::string_view word, double whole, double font_size) {
  const auto length = read_length(word);
  if (!length || (length->unitless && length->value != 0)) return std::nullopt;
  return LengthBase{whole, font_size}.of(*length);
}

Eigen::Affine2d linear(double a, double b, double c, double d) {
  Eigen::Affine2d map = Eigen::Affine2d::Identity();
  map.linear() << a, c, b, d;
  return map;
}

/// Every word through `read`; none when one of them is none or their number is not in the range.
template <class Read>
std::optional<std::vector<double>> all_of(const Words& words, std::size_t min, std::size_t max, const Read& read) {
  if (words.size() < min || words.size() > max) return std::nullopt;
  std::vector<double> result;
  for (const std::string_view word : words) {
    const std::optional<double> value = read(word);
    if (!value) return std::nullopt;
    result.push_back(*value);
  }
  return result;
}

std::optional<Eigen::Affine2d> translation(std::string_view name, const Words& words, const TransformBox& box) {
  const bool along_y = same_word(name, "translatey");
  const bool one = along_y || same_word(name, "translatex");
  if (words.empty() || words.size() > (one ? 1u : 2u)) return std::nullopt;
  const auto first = distance(words[0], along_y ? box.height : box.width, box.font_size);
  const auto second = words.size() > 1 ? distance(words[1], box.height, box.font_size) : 0;
  if (!first || !second) return std::nullopt;
  return Eigen::Affine2d(along_y ? Eigen::Translation2d(0, *first) : Eigen::Translation2d(*first, *second));
}

std::optional<Eigen::Affine2d> function(std::string_view name, const Words& words, const TransformBox& box) {
  if (same_word(name.substr(0, 9), "translate") && name.size() <= 10) return translation(name, words, box);
  if (same_word(name, "matrix")) {
    const auto m = all_of(words, 6, 6, plain);
    if (!m) return std::nullopt;
    Eigen::Affine2d map = linear((*m)[0], (*m)[1], (*m)[2], (*m)[3]);
    map.translation() = Vec2((*m)[4], (*m)[5]);
    return map;
  }
  if (same_word(name, "scale") || same_word(name, "scalex") || same_word(name, "scaley")) {
    const auto s = all_of(words, 1, name.size() == 5 ? 2 : 1, plain);
    if (!s) return std::nullopt;
    if (name.size() == 5) return linear((*s)[0], 0, 0, s->back());
    return same_word(name, "scalex") ? linear((*s)[0], 0, 0, 1) : linear(1, 0, 0, (*s)[0]);
  }
  const auto angles = all_of(words, 1, 2, degrees_of);
  if (!angles) return std::nullopt;
  const double first = angles->front();
  if (same_word(name, "skew")) return linear(1, angles->size() > 1 ? slope_of(angles->back()) : 0, slope_of(first), 1);
  if (angles->size() > 1) return std::nullopt;
  if (same_word(name, "skewx")) return linear(1, 0, slope_of(first), 1);
  if (same_word(name, "skewy")) return linear(1, slope_of(first), 0, 1);
  if (!same_word(name, "rotate") && !same_word(name, "rotatez")) return std::nullopt;
  Eigen::Affine2d map = Eigen::Affine2d::Identity();
  map.linear() = turn_by(first);
  return map;
}

bool is_none(std::string_view text) { return text.empty() || same_word(text, "none"); }

}  // namespace

std::optional<Eigen::Affine2d> read_css_transform(std::string_view text, const TransformBox& box) {
  Eigen::Affine2d map = Eigen::Affine2d::Identity();
  text = without_blanks(text);
  if (is_none(text)) return map;
  while (!text.empty()) {
    const std::size_t open = text.find('('), close = text.find(')');
    if (open == std::string_view::npos || close == std::string_view::npos || close < open) return std::nullopt;
    const auto one =
        function(without_blanks(text.substr(0, open)), words_of(text.substr(open + 1, close - open - 1)), box);
    if (!one) return std::nullopt;
    map = map * *one;
    text = without_blanks(text.substr(close + 1));
  }
  if (!map.matrix().allFinite()) return std::nullopt;
  return map;
}

std::optional<Eigen::Affine2d> read_single_transforms(std::string_view translate, std::string_view rotate,
                                                      std::string_view scale, const TransformBox& box) {
  Eigen::Affine2d map = Eigen::Affine2d::Identity();
  const auto apply = [&](std::string_view name, std::string_view text) {
    if (is_none(text)) return true;
    const auto one = function(name, words_of(text), box);
    if (one) map = map * *one;
    return one.has_value();
  };
  if (!apply("translate", translate) || !apply("rotate", rotate) || !apply("scale", scale)) return std::nullopt;
  if (!map.matrix().allFinite()) return std::nullopt;
  return map;
}

std::optional<Vec2> read_transform_origin(std::string_view text, const TransformBox& box) {
  Words words = words_of(text);
  if (words.size() == 3) words.pop_back();  // depth
  if (words.empty() || words.size() > 2) return std::nullopt;
  const auto is_upright = [](std::string_view word) { return same_word(word, "top") || same_word(word, "bottom"); };
  if (words.size() == 1) words.push_back("center");
  if (is_upright(words[0]) || same_word(words[1], "left") || same_word(words[1], "right"))
    std::swap(words[0], words[1]);
  const auto place = [&](std::string_view word, double from, double whole, std::string_view low,
                         std::string_view high) -> std::optional<double> {
    if (same_word(word, low)) return from;
    if (same_word(word, high)) return from + whole;
    if (same_word(word, "center")) return from + whole / 2;
    const auto length = read_length(word);
    if (!length) return std::nullopt;
    return from + LengthBase{whole, box.font_size}.of(*length);
  };
  const auto x = place(words[0], box.x, box.width, "left", "right"),
             y = place(words[1], box.y, box.height, "top", "bottom");
  if (!x || !y) return std::nullopt;
  return Vec2(*x, *y);
}

}  // namespace formwright
