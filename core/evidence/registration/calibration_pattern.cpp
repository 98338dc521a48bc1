// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/registration/calibration_pattern.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/data/json_text.h"
#include "base/parallel.h"

namespace formwright {
namespace {

constexpr const char* format_name = "formwright calibration pattern 1";
constexpr const char* mark_names[4] = {"front left", "front right", "back right", "back left"};
constexpr double mark_sign[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
constexpr int patches_a_side = 6;

/// Six greys and eighteen colours that a laser printer can print; every side of the sheet has some of all kinds.
constexpr std::array<std::array<std::uint8_t, 3>, 24> chart = {
    {{30, 30, 30},   {75, 75, 75},    {115, 115, 115}, {155, 155, 155}, {195, 195, 195}, {240, 240, 240},
     {200, 50, 45},  {60, 150, 70},   {50, 65, 160},   {235, 200, 40},  {190, 80, 150},  {20, 135, 170},
     {115, 82, 68},  {195, 150, 130}, {98, 122, 157},  {87, 108, 67},   {133, 128, 177}, {103, 189, 170},
     {214, 126, 44}, {80, 91, 166},   {193, 90, 99},   {94, 60, 108},   {157, 188, 64},  {224, 163, 46}}};

[[noreturn]] void refuse(const char* where, const std::string& message) {
  throw Error(ErrorCode::invalid_input, where, message);
}

/// How much of a pixel something covers, by 4 x 4 points.
template <class Inside>
int covered_of_16(const Vec2& centre_mm, double pixel_mm, const Inside& inside) {
  int count = 0;
  for (int k = 0; k < 16; ++k)
    count += inside(Vec2(centre_mm.x() + ((k % 4) - 1.5) * 0.25 * pixel_mm,
                         centre_mm.y() + ((k / 4) - 1.5) * 0.25 * pixel_mm))
                 ? 1
                 : 0;
  return count;
}

/// Calls paint(pixel, place) for the pixels within `reach_mm` of `centre_mm` in x and in y.
template <class Paint>
void over_square(Image& image, double pixel_mm, const Vec2& centre_mm, double reach_mm, const Paint& paint) {
  const double middle_x = 0.5 * image.width, middle_y = 0.5 * image.height;
  const int x0 = std::max(0, static_cast<int>(std::floor(middle_x + (centre_mm.x() - reach_mm) / pixel_mm)) - 1);
  const int x1 =
      std::min(image.width - 1, static_cast<int>(std::ceil(middle_x + (centre_mm.x() + reach_mm) / pixel_mm)) + 1);
  const int y0 = std::max(0, static_cast<int>(std::floor(middle_y - (centre_mm.y() + reach_mm) / pixel_mm)) - 1);
  const int y1 =
      std::min(image.height - 1, static_cast<int>(std::ceil(middle_y - (centre_mm.y() - reach_mm) / pixel_mm)) + 1);
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x)
      paint(image.at(x, y), Vec2((x + 0.5 - middle_x) * pixel_mm, (middle_y - y - 0.5) * pixel_mm));
}

std::uint8_t mixed(int under, int over, int share_of_16) {
  return static_cast<std::uint8_t>((under * (16 - share_of_16) + over * share_of_16 + 8) / 16);
}

}  // namespace

bool mark_is_black(int code, double share) {
  // From the middle: three rings that say the code, white, black, white.
  static constexpr bool inner[4][3] = {
      {true, false, false}, {false, true, false}, {true, false, true}, {false, true, true}};
  if (share < 0.6) return inner[code][std::min(2, static_cast<int>(share / 0.2))];
  return share >= 0.73 && share < 0.88;
}

CalibrationPattern make_calibration_pattern(const CalibrationPatternOptions& options) {
  CalibrationPattern pattern;
  pattern.sheet_mm = {options.sheet_x_mm, options.sheet_y_mm};
  pattern.opening_mm = {options.clamp_opening_x_mm, options.clamp_opening_y_mm};
  if (pattern.opening_mm.x() > pattern.sheet_mm.x())
    refuse("clamp_opening_x_mm", "The clamp opening is wider than the sheet: give the sheet's size with its rim.");
  if (pattern.opening_mm.y() > pattern.sheet_mm.y())
    refuse("clamp_opening_y_mm", "The clamp opening is longer than the sheet: give the sheet's size with its rim.");
  if (options.coarsest_mm < options.finest_mm)
    refuse(
        "coarsest_mm",
        "The spacing of the coarsest noise must not be smaller than that of the finest: raise coarsest_mm or lower finest_mm.");
  pattern.seed = static_cast<std::uint32_t>(options.seed);
  pattern.scales_mm = octaves_mm(options.finest_mm, options.coarsest_mm);
  const double radius = std::min(8.0, pattern.opening_mm.minCoeff() / 14), side = radius;
  const Vec2 inner = pattern.opening_mm / 2 - Vec2::Constant(options.margin_mm);
  if (inner.minCoeff() < 5 * radius) refuse("margin_mm", "The margin leaves no room for the marks: make it smaller.");
  for (int k = 0; k < 4; ++k) {
    const Vec2 sign(mark_sign[k][0], mark_sign[k][1]);
    pattern.marks[static_cast<std::size_t>(k)] = {mark_names[k], sign.cwiseProduct(inner - Vec2::Constant(radius)),
                                                  radius, k};
  }
  for (int i = 0; i < 4 * patches_a_side; ++i) {
    const int k = i % 4, n = i / 4, axis = k % 2;  // of front, right, back, left
    const double from = -inner[axis] + 2 * radius, step = -2 * from / patches_a_side;
    Vec2 centre;
    centre[axis] = from + (n + 0.5) * step;
    centre[1 - axis] = (k == 0 || k == 3 ? -1 : 1) * (inner[1 - axis] - side / 2);
    const auto& c = chart[static_cast<std::size_t>(i)];
    pattern.patches.push_back({centre, side, {c[0], c[1], c[2], 255}});
  }
  return pattern;
}

Image draw_calibration_pattern(const CalibrationPattern& pattern, int width, int height, double pixel_mm,
                               const Context& context) {
  Image image = noise_picture({pattern.seed, pixel_mm, pattern.scales_mm, pattern.contrast}, width, height, context);
  for (const ColourPatch& patch : pattern.patches)
    over_square(image, pixel_mm, patch.centre_mm, 0.5 * patch.side_mm, [&](Rgba& pixel, const Vec2& place) {
      const int share = covered_of_16(place, pixel_mm, [&](const Vec2& p) {
        return (p - patch.centre_mm).cwiseAbs().maxCoeff() <= 0.5 * patch.side_mm;
      });
      for (std::size_t c = 0; c < 3; ++c) pixel[c] = mixed(pixel[c], patch.colour[c], share);
    });
  for (const CornerMark& mark : pattern.marks)
    over_square(image, pixel_mm, mark.centre_mm, mark.radius_mm, [&](Rgba& pixel, const Vec2& place) {
      const auto share_of = [&](const Vec2& p) {
        const Vec2 d = p - mark.centre_mm;
        return std::sqrt(d.x() * d.x() + d.y() * d.y()) / mark.radius_mm;
      };
      const int inside = covered_of_16(place, pixel_mm, [&](const Vec2& p) { return share_of(p) <= 1; });
      const int black = covered_of_16(
          place, pixel_mm, [&](const Vec2& p) { return share_of(p) <= 1 && mark_is_black(mark.code, share_of(p)); });
      for (std::size_t c = 0; c < 3; ++c)
        pixel[c] = static_cast<std::uint8_t>((pixel[c] * (16 - inside) + 255 * (inside - black) + 8) / 16);
    });
  return image;
}

Json calibration_pattern_json(const CalibrationPattern& pattern) {
  Json json = {{"format", format_name},
               {"sheet_mm", {pattern.sheet_mm.x(), pattern.sheet_mm.y()}},
               {"clamp_opening_mm", {pattern.opening_mm.x(), pattern.opening_mm.y()}},
               {"seed", pattern.seed},
               {"noise_scales_mm", pattern.scales_mm},
               {"noise_contrast", pattern.contrast},
               {"marks", Json::array()},
               {"patches", Json::array()}};
  for (const CornerMark& m : pattern.marks)
    json["marks"].push_back({{"name", m.name},
                             {"centre_mm", {m.centre_mm.x(), m.centre_mm.y()}},
                             {"radius_mm", m.radius_mm},
                             {"code", m.code}});
  for (const ColourPatch& p : pattern.patches)
    json["patches"].push_back({{"centre_mm", {p.centre_mm.x(), p.centre_mm.y()}},
                               {"side_mm", p.side_mm},
                               {"srgb", {p.colour[0], p.colour[1], p.colour[2]}}});
  return json;
}

CalibrationPattern read_calibration_pattern(ByteView bytes) {
  const Json json = parse_json_text(as_text(bytes));
  if (!json.is_object() || !json.contains("format"))
    refuse("pattern", "This is not a pattern.json: give the one that evidence-pattern wrote beside the print.");
  if (json["format"] == "formwright mark sheet 1")
    refuse("pattern",
           "This pattern.json describes coded marks, which are measured by photographs: use evidence-photographs.");
  if (json["format"] != format_name)
    refuse("pattern",
           "This pattern.json is of another version: make it again with evidence-pattern and the same values.");
  const auto number = [](const Json& value, const char* key, double from, double to) {
    if (!value.is_number() || !(value.get<double>() >= from && value.get<double>() <= to))
      refuse("pattern", std::string("The pattern's “") + key + "” is wrong: give pattern.json as it was written.");
    return value.get<double>();
  };
  const auto at = [](const Json& object, const char* key) -> const Json& {
    if (!object.is_object() || !object.contains(key))
      refuse("pattern", std::string("The pattern has no “") + key + "”: give pattern.json as it was written.");
    return object[key];
  };
  const auto pair = [&](const Json& object, const char* key, double from, double to) {
    const Json& value = at(object, key);
    if (!value.is_array() || value.size() != 2)
      refuse("pattern",
             std::string("The pattern's “") + key + "” must be two numbers: give pattern.json as it was written.");
    return Vec2(number(value[0], key, from, to), number(value[1], key, from, to));
  };
  const auto list = [&](const char* key, std::size_t minimum, std::size_t maximum) -> const Json& {
    const Json& value = at(json, key);
    if (!value.is_array() || value.size() < minimum || value.size() > maximum)
      refuse("pattern",
             std::string("The pattern's “") + key + "” is not complete: give pattern.json as it was written.");
    return value;
  };
  CalibrationPattern pattern;
  pattern.sheet_mm = pair(json, "sheet_mm", 10, 3000);
  pattern.opening_mm = pair(json, "clamp_opening_mm", 10, 3000);
  pattern.seed = static_cast<std::uint32_t>(number(at(json, "seed"), "seed", 0, 2147483647));
  for (const Json& scale : list("noise_scales_mm", 1, 20))
    pattern.scales_mm.push_back(number(scale, "noise_scales_mm", 0.1, 500));
  pattern.contrast = number(at(json, "noise_contrast"), "noise_contrast", 0.01, 1);
  const Json& marks = list("marks", 4, 4);
  for (std::size_t k = 0; k < 4; ++k)
    pattern.marks[k] = {mark_names[k], pair(marks[k], "centre_mm", -1500, 1500),
                        number(at(marks[k], "radius_mm"), "radius_mm", 0.5, 100),
                        static_cast<int>(number(at(marks[k], "code"), "code", 0, 3))};
  for (const Json& p : list("patches", 0, 1000)) {
    ColourPatch patch{pair(p, "centre_mm", -1500, 1500), number(at(p, "side_mm"), "side_mm", 0.1, 200), {0, 0, 0, 255}};
    const Json& colour = at(p, "srgb");
    if (!colour.is_array() || colour.size() != 3)
      refuse("pattern", "A patch of the pattern has no colour of three numbers: give pattern.json as it was written.");
    for (std::size_t c = 0; c < 3; ++c) patch.colour[c] = static_cast<std::uint8_t>(number(colour[c], "srgb", 0, 255));
    pattern.patches.push_back(patch);
  }
  return pattern;
}

}  // namespace formwright
