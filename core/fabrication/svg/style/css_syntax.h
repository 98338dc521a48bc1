// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The syntax of CSS (CSS Syntax 3) as far as drawings use it: rules, declarations, media.
#include <functional>
#include <string>
#include <string_view>

namespace formwright {

struct CssDeclaration {
  std::string_view name, value;
  bool important = false;
};

/// `css` without its comments and without <!-- and -->; what stands in quotes is kept.
std::string without_css_comments(std::string_view css);

/// "stroke: red; fill: none !important". Strings and brackets may hold semicolons. Views into `block`, which has no
/// comments.
void read_css_declarations(std::string_view block, const std::function<void(const CssDeclaration&)>& take);

/// What a sheet is made of. Views into the sheet.
struct CssSheetEvents {
  std::function<void(std::string_view selectors, std::string_view declarations)> rule;
  std::function<void(std::string_view what)> not_followed;  // "@import", a nested rule, a condition of @media
};

/// A sheet without comments. @media rules are followed when a screen fulfils them.
void read_css_sheet(std::string_view css, const CssSheetEvents& events);

enum class MediaMatch { yes, no, unknown };
/// "", "all", "screen, print": as a browser shows a drawing. Conditions in brackets are unknown.
MediaMatch match_media(std::string_view query);

}  // namespace formwright
