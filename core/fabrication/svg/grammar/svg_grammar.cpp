// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg/grammar/svg_grammar.h"

#include <fast_float/fast_float.h>

#include <svgpp/parser/path_data.hpp>
#include <svgpp/policy/error.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace formwright {
namespace {

struct PathEvents {
  CurveFlattener& to;
  using Absolute = svgpp::tag::coordinate::absolute;

  void path_move_to(double x, double y, Absolute) { to.move_to({x, y}); }
  void path_line_to(double x, double y, Absolute) { to.line_to({x, y}); }
  void path_cubic_bezier_to(double x1, double y1, double x2, double y2, double x, double y, Absolute) {
    to.cubic_to({x1, y1}, {x2, y2}, {x, y});
  }
  void path_elliptical_arc_to(double rx, double ry, double turn, bool large, bool sweep, double x, double y, Absolute) {
    to.arc_to(rx, ry, turn, large, sweep, {x, y});
  }
  void path_close_subpath() { to.close(); }
  void path_exit() {}
};

/// Arcs stay arcs: as curves of third order they would be off by 0.03 % of their radius.
struct PathPolicy : svgpp::policy::path::minimal {
  static const bool arc_as_cubic_bezier = false;
};

struct QuietErrors {
  template <class Context>
  struct Policy {
    using context_type = Context;
    template <class Tag, class Value>
    static bool parse_failed(const Context&, Tag, const Value&) {
      return false;
    }
  };
};

/// At most six numbers, which need no blank between them where a sign or a point tells them apart.
std::optional<std::vector<double>> packed_numbers(std::string_view text) {
  std::vector<double> numbers;
  while (!(text = without_blanks(text)).empty()) {
    if (!numbers.empty() && text.front() == ',') text = without_blanks(text.substr(1));
    if (text.starts_with('+')) text.remove_prefix(1);
    double value = 0;
    const auto [rest, error] = fast_float::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || !std::isfinite(value) || numbers.size() == 6) return std::nullopt;
    numbers.push_back(value);
    text.remove_prefix(static_cast<std::size_t>(rest - text.data()));
  }
  return numbers;
}

std::optional<Eigen::Affine2d> transform_function(std::string_view name, const std::vector<double>& n) {
  const std::size_t count = n.size();
  if (count == 0) return std::nullopt;
  Eigen::Affine2d map = Eigen::Affine2d::Identity();
  if (name == "matrix" && count == 6) {
    map.matrix() << n[0], n[2], n[4], n[1], n[3], n[5], 0, 0, 1;
  } else if (name == "translate" && count <= 2) {
    map.translation() = Vec2(n[0], count > 1 ? n[1] : 0);
  } else if (name == "scale" && count <= 2) {
    map.linear() << n[0], 0, 0, n.back();
  } else if (name == "rotate" && (count == 1 || count == 3)) {
    map.linear() = turn_by(n[0]);
    if (count == 3) map.translation() = Vec2(n[1], n[2]) - map.linear() * Vec2(n[1], n[2]);
  } else if (name == "skewX" && count == 1) {
    map.linear()(0, 1) = slope_of(n[0]);
  } else if (name == "skewY" && count == 1) {
    map.linear()(1, 0) = slope_of(n[0]);
  } else {
    return std::nullopt;
  }
  return map;
}

}  // namespace

bool draw_path_data(std::string_view data, CurveFlattener& flattener) {
  const std::string_view text = without_blanks(data);
  if (text.empty() || text == "none") return true;
  PathEvents events{flattener};
  return svgpp::value_parser<
      svgpp::tag::type::path_data, svgpp::path_policy<PathPolicy>,
      svgpp::error_policy<QuietErrors::Policy<PathEvents>>>::parse(svgpp::tag::attribute::d(), events, text,
                                                                   svgpp::tag::source::attribute());
}

std::optional<Eigen::Affine2d> read_transform(std::string_view text) {
  Eigen::Affine2d map = Eigen::Affine2d::Identity();
  text = without_blanks(text);
  if (text == "none") return map;
  while (!text.empty()) {
    const std::size_t open = text.find('('), close = text.find(')');
    if (open == std::string_view::npos || close == std::string_view::npos || close < open) return std::nullopt;
    const auto numbers = packed_numbers(text.substr(open + 1, close - open - 1));
    const auto one = numbers ? transform_function(without_blanks(text.substr(0, open)), *numbers) : std::nullopt;
    if (!one) return std::nullopt;
    map = map * *one;
    text.remove_prefix(close + 1);
    text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n\f,"), text.size()));
  }
  if (!map.matrix().allFinite()) return std::nullopt;
  return map;
}

Eigen::Matrix2d turn_by(double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  double c = std::cos(angle), s = std::sin(angle);
  if (std::fmod(degrees, 90) == 0) {
    c = std::round(c);
    s = std::round(s);
  }
  Eigen::Matrix2d turn;
  turn << c, -s, s, c;
  return turn;
}

double slope_of(double degrees) { return std::tan(degrees * std::numbers::pi / 180); }

double LengthBase::of(const SvgLength& length) const {
  switch (length.unit) {
    case SvgLength::Unit::percent: return length.value / 100 * whole;
    case SvgLength::Unit::em: return length.value * font_size;
    case SvgLength::Unit::root_em: return length.value * 16;
    case SvgLength::Unit::px: break;
  }
  return length.value;
}

std::optional<SvgLength> read_length(std::string_view text) {
  text = without_blanks(text);
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  SvgLength length;
  const auto [rest, error] = fast_float::from_chars(text.data(), text.data() + text.size(), length.value);
  if (error != std::errc() || !std::isfinite(length.value)) return std::nullopt;
  const std::string_view unit = without_blanks({rest, static_cast<std::size_t>(text.data() + text.size() - rest)});
  struct Known {
    std::string_view name;
    double scale;
    SvgLength::Unit unit;
    bool absolute;
  };
  using Unit = SvgLength::Unit;
  constexpr Known units[] = {{"", 1, Unit::px, false},
                             {"px", 1, Unit::px, false},
                             {"%", 1, Unit::percent, false},
                             {"em", 1, Unit::em, false},
                             {"ex", 0.5, Unit::em, false},
                             {"ch", 0.5, Unit::em, false},
                             {"rem", 1, Unit::root_em, false},
                             {"mm", user_units_per_mm, Unit::px, true},
                             {"cm", 10 * user_units_per_mm, Unit::px, true},
                             {"in", 96, Unit::px, true},
                             {"pt", 96.0 / 72, Unit::px, true},
                             {"pc", 16, Unit::px, true},
                             {"q", user_units_per_mm / 4, Unit::px, true}};
  for (const Known& known : units) {
    if (!same_word(unit, known.name)) continue;
    length.value *= known.scale;
    length.unit = known.unit;
    length.absolute = known.absolute;
    length.unitless = unit.empty();
    return length;
  }
  return std::nullopt;
}

std::optional<std::vector<SvgLength>> read_lengths(std::string_view text) {
  constexpr std::size_t max_lengths = 10'000;
  std::vector<SvgLength> result;
  text = without_blanks(text);
  while (!text.empty()) {
    const auto length = read_length(take_word(text));
    if (!length || result.size() == max_lengths) return std::nullopt;
    result.push_back(*length);
  }
  return result;
}

std::string_view without_blanks(std::string_view text) {
  const std::size_t from = text.find_first_not_of(blanks);
  return from == std::string_view::npos ? std::string_view()
                                        : text.substr(from, text.find_last_not_of(blanks) + 1 - from);
}

std::string_view take_word(std::string_view& text) {
  constexpr std::string_view between = " \t\r\n\f,/";
  const std::size_t from = text.find_first_not_of(between);
  if (from == std::string_view::npos) {
    text = {};
    return {};
  }
  text.remove_prefix(from);
  const std::string_view word = text.substr(0, std::min(text.find_first_of(between), text.size()));
  text.remove_prefix(word.size());
  text.remove_prefix(std::min(text.find_first_not_of(between), text.size()));
  return word;
}

bool same_word(std::string_view text, std::string_view lower_case) {
  return std::equal(text.begin(), text.end(), lower_case.begin(), lower_case.end(), [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? static_cast<char>(a + ('a' - 'A')) : a) == b;
  });
}

}  // namespace formwright
