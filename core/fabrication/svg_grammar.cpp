// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg_grammar.h"

#include <fast_float/fast_float.h>

#include <svgpp/parser/path_data.hpp>
#include <svgpp/parser/transform_list.hpp>
#include <svgpp/policy/error.hpp>

#include <string>
#include <utility>

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

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\n";
  const std::size_t from = text.find_first_not_of(blanks);
  return from == std::string_view::npos ? std::string_view()
                                        : text.substr(from, text.find_last_not_of(blanks) + 1 - from);
}

}  // namespace

bool draw_path_data(std::string_view data, CurveFlattener& flattener) {
  const std::string_view text = trimmed(data);
  if (text.empty() || text == "none") return true;
  PathEvents events{flattener};
  return svgpp::value_parser<
      svgpp::tag::type::path_data, svgpp::path_policy<PathPolicy>,
      svgpp::error_policy<QuietErrors::Policy<PathEvents>>>::parse(svgpp::tag::attribute::d(), events, text,
                                                                   svgpp::tag::source::attribute());
}

std::optional<Eigen::Affine2d> read_transform(std::string_view text) {
  text = trimmed(text);
  if (text.empty() || text == "none") return Eigen::Affine2d::Identity();
  TransformEvents events;
  const bool read =
      svgpp::value_parser<svgpp::tag::type::transform_list, svgpp::error_policy<QuietErrors::Policy<TransformEvents>>>::
          parse(svgpp::tag::attribute::transform(), events, text, svgpp::tag::source::attribute());
  if (!read || !events.map.matrix().allFinite()) return std::nullopt;
  return events.map;
}

std::optional<SvgLength> read_length(std::string_view text) {
  text = trimmed(text);
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  SvgLength length;
  const auto [rest, error] = fast_float::from_chars(text.data(), text.data() + text.size(), length.value);
  if (error != std::errc() || !std::isfinite(length.value)) return std::nullopt;
  const std::string_view unit = trimmed({rest, static_cast<std::size_t>(text.data() + text.size() - rest)});
  if (unit == "%") {
    length.percent = true;
    return length;
  }
  constexpr std::pair<std::string_view, double> relative[] = {{"", 1}, {"px", 1}, {"em", 16}, {"ex", 8}};
  for (const auto& [name, px] : relative)
    if (unit == name) {
      length.value *= px;
      return length;
    }
  constexpr std::pair<std::string_view, double> absolute[] = {
      {"mm", user_units_per_mm},   {"cm", 10 * user_units_per_mm}, {"in", 96}, {"pt", 96.0 / 72}, {"pc", 16},
      {"Q", user_units_per_mm / 4}};
  for (const auto& [name, px] : absolute)
    if (unit == name) {
      length.value *= px;
      length.absolute = true;
      return length;
    }
  return std::nullopt;
}

}  // namespace formwright
