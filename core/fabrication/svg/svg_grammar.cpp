// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg/svg_grammar.h"

#include <fast_float/fast_float.h>

#include <svgpp/parser/path_data.hpp>
#include <svgpp/parser/transform_list.hpp>
#include <svgpp/policy/error.hpp>

#include <algorithm>
#include <cmath>
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

struct TransformEvents {
  Eigen::Affine2d map = Eigen::Affine2d::Identity();

  void transform_matrix(const boost::array<double, 6>& m) {
    map.matrix() << m[0], m[2], m[4], m[1], m[3], m[5], 0, 0, 1;
  }
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

constexpr std::string_view blanks = " \t\r\n\f";

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
  text = without_blanks(text);
  if (text.empty() || text == "none") return Eigen::Affine2d::Identity();
  TransformEvents events;
  const bool read =
      svgpp::value_parser<svgpp::tag::type::transform_list, svgpp::error_policy<QuietErrors::Policy<TransformEvents>>>::
          parse(svgpp::tag::attribute::transform(), events, text, svgpp::tag::source::attribute());
  if (!read || !events.map.matrix().allFinite()) return std::nullopt;
  return events.map;
}

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
