// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg_reader.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>
#include <unordered_map>

#include "fabrication/drawing_layers.h"
#include "fabrication/svg_grammar.h"
#include "fabrication/svg_style.h"
#include "fabrication/svg_viewport.h"

namespace formwright {
namespace {

constexpr std::size_t most_points = 2'000'000, most_elements = 1'000'000;
constexpr int most_nested = 256;

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::invalid_input, "drawing", message); }

struct Inherited {
  Eigen::Affine2d to_mm;  // y down
  ViewportSize viewport;
  std::optional<CutLayer> layer;
  std::string stroke = "none", fill = "black", colour = "black";
  bool visible = true;
  int depth = 0;
};

class Reader {
 public:
  Reader(const pugi::xml_node& root, const SvgReadOptions& options, const Context& context)
      : options_(options), context_(context), style_(root) {
    index(root);
  }

  void drawing(const pugi::xml_node& root, const Inherited& outer) { group(root, within(root, outer)); }

  std::vector<CutPath> paths;  // y down
  std::size_t points = 0, words = 0, pictures = 0, clipped = 0, malformed = 0, other_colours = 0;

 private:
  void group(const pugi::xml_node& node, const Inherited& inherited) {
    for (const pugi::xml_node& child : node.children())
      if (child.type() == pugi::node_element) element(child, inherited);
  }

  void index(const pugi::xml_node& root) {
    struct Finder : pugi::xml_tree_walker {
      std::unordered_map<std::string, pugi::xml_node>* by_id = nullptr;
      bool for_each(pugi::xml_node& node) override {
        if (const char* id = node.attribute("id").value(); *id != 0) by_id->emplace(id, node);
        return true;
      }
    } finder;
    finder.by_id = &by_id_;
    pugi::xml_node(root).traverse(finder);
  }

  Inherited within(const pugi::xml_node& node, const Inherited& outer) {
    Inherited inner = outer;
    if (++inner.depth > most_nested)
      refuse("The drawing is nested more than 256 levels deep: ungroup it, or look for a <use> that shows itself.");
    if (const auto transform = read_transform(node.attribute("transform").value()))
      inner.to_mm = outer.to_mm * *transform;
    else ++malformed;
    const auto inherit = [&](const char* name, std::string& value) {
      std::string own = style_.property(node, name);
      if (!own.empty() && own != "inherit") value = std::move(own);
    };
    inherit("color", inner.colour);
    inherit("stroke", inner.stroke);
    inherit("fill", inner.fill);
    if (const std::string own = style_.property(node, "visibility"); !own.empty() && own != "inherit")
      inner.visible = own == "visible";
    if (!style_.property(node, "clip-path").empty() || !style_.property(node, "mask").empty()) ++clipped;
    return inner;
  }

  void element(const pugi::xml_node& node, const Inherited& outer) {
    if (++elements_ > most_elements)
      refuse("The drawing has over a million elements: simplify it or split it into several files.");
    if (elements_ % 256 == 0) context_.check_cancelled();
    const std::string name = svg_local_name(node);
    constexpr std::string_view never[] = {
        "defs",  "clipPath", "mask", "marker",   "pattern", "linearGradient", "radialGradient", "symbol",
        "style", "title",    "desc", "metadata", "filter",  "script",         "namedview",      "foreignObject"};
    if (std::find(std::begin(never), std::end(never), name) != std::end(never)) return;
    if (style_.property(node, "display") == "none") return;
    Inherited inner = within(node, outer);
    if (name == "g" || name == "a" || name == "switch" || name == "svg") {
      std::optional<CutLayer> layer = layer_by_name(node.attribute("inkscape:label").value());
      if (!layer) layer = layer_by_name(node.attribute("id").value());
      if (layer) inner.layer = layer;
      if (name == "svg") enter_viewport(node, inner.to_mm, inner.viewport);
      group(node, inner);
    } else if (name == "use") {
      use(node, inner);
    } else if (name == "text" || name == "tspan" || name == "flowRoot") {
      if (inner.visible) ++words;
    } else if (name == "image") {
      if (inner.visible) ++pictures;
    } else {
      shape(node, name, inner);
    }
  }

  void use(const pugi::xml_node& node, Inherited inner) {
    std::string reference = node.attribute("href").value();
    if (reference.empty()) reference = node.attribute("xlink:href").value();
    if (!reference.starts_with('#')) return;
    const auto found = by_id_.find(reference.substr(1));
    if (found == by_id_.end()) return;
    inner.to_mm.translate(
        Vec2(length(node, "x", inner.viewport.width, 0), length(node, "y", inner.viewport.height, 0)));
    if (svg_local_name(found->second) != "symbol") return element(found->second, inner);
    Inherited symbol = within(found->second, inner);
    if (node.attribute("width")) symbol.viewport.width = length(node, "width", inner.viewport.width, 0);
    if (node.attribute("height")) symbol.viewport.height = length(node, "height", inner.viewport.height, 0);
    apply_view_box(found->second, symbol.to_mm, symbol.viewport);
    group(found->second, symbol);
  }

  double length(const pugi::xml_node& node, const char* name, double whole, double absent) {
    const pugi::xml_attribute attribute = node.attribute(name);
    if (!attribute) return absent;
    const auto value = read_length(attribute.value());
    if (!value) {
      ++malformed;
      return absent;
    }
    return value->percent ? value->value / 100 * whole : value->value;
  }

  void shape(const pugi::xml_node& node, const std::string& name, const Inherited& inner) {
    if (!inner.visible || !inner.to_mm.matrix().allFinite()) return;
    const auto layer = layer_of(inner);
    if (!layer) return;
    CurveFlattener flattener(inner.to_mm, options_.flatness_mm);
    const auto [w, h] = inner.viewport;
    const double diagonal = std::sqrt((w * w + h * h) / 2);
    const auto x = [&](const char* a) { return length(node, a, w, 0); };
    const auto y = [&](const char* a) { return length(node, a, h, 0); };
    bool well = true;
    if (name == "path") {
      well = draw_path_data(node.attribute("d").value(), flattener);
    } else if (name == "polyline" || name == "polygon") {
      const std::string points_text = node.attribute("points").value();
      if (!points_text.empty()) well = draw_path_data("M" + points_text + (name == "polygon" ? "Z" : ""), flattener);
    } else if (name == "line") {
      flattener.move_to({x("x1"), y("y1")});
      flattener.line_to({x("x2"), y("y2")});
    } else if (name == "circle") {
      if (const double r = length(node, "r", diagonal, 0); r > 0) flattener.ellipse({x("cx"), y("cy")}, r, r);
    } else if (name == "ellipse") {
      const double rx = x("rx"), ry = y("ry");
      if (rx > 0 && ry > 0) flattener.ellipse({x("cx"), y("cy")}, rx, ry);
    } else if (name == "rect") {
      rectangle(flattener, {x("x"), y("y")}, {x("width"), y("height")}, length(node, "rx", w, -1),
                length(node, "ry", h, -1));
    } else {
      return;
    }
    if (!well) ++malformed;
    keep(flattener, *layer, node.attribute("id").value());
  }

  static void rectangle(CurveFlattener& to, const Vec2& corner, const Vec2& size, double rx, double ry) {
    if (size.x() <= 0 || size.y() <= 0) return;
    if (rx < 0) rx = ry;
    if (ry < 0) ry = rx;
    rx = std::clamp(rx, 0.0, size.x() / 2);
    ry = std::clamp(ry, 0.0, size.y() / 2);
    const Vec2 far = corner + size;
    to.move_to({corner.x() + rx, corner.y()});
    const auto round = [&](const Vec2& p) {
      if (rx > 0 && ry > 0) to.arc_to(rx, ry, 0, false, true, p);
    };
    to.line_to({far.x() - rx, corner.y()});
    round({far.x(), corner.y() + ry});
    to.line_to({far.x(), far.y() - ry});
    round({far.x() - rx, far.y()});
    to.line_to({corner.x() + rx, far.y()});
    round({corner.x(), far.y() - ry});
    to.line_to({corner.x(), corner.y() + ry});
    round({corner.x() + rx, corner.y()});
    to.close();
  }

  /// None: not painted at all.
  std::optional<CutLayer> layer_of(const Inherited& inner) {
    const auto resolved = [&](const std::string& paint) { return paint == "currentColor" ? inner.colour : paint; };
    const std::string paint = inner.stroke != "none" ? resolved(inner.stroke) : resolved(inner.fill);
    if (paint == "none" || paint == "transparent") return std::nullopt;
    if (inner.layer) return inner.layer;
    const auto colour = read_colour(paint);
    const auto layer = colour ? layer_by_colour(*colour) : std::nullopt;
    if (!layer) ++other_colours;
    return layer.value_or(CutLayer::note);
  }

  void keep(CurveFlattener& flattener, CutLayer layer, const std::string& id) {
    std::string name;
    for (const char c : id)
      if (std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_') name += c == '_' ? '-' : c;
    for (CurveFlattener::Subpath& subpath : flattener.take()) {
      points += subpath.points_mm.size();
      if (points > most_points)
        refuse("The drawing has over 2 million points: simplify its curves or split it into several files.");
      for (const Vec2& p : subpath.points_mm)
        if (!p.allFinite() || p.cwiseAbs().maxCoeff() > 20'000)
          refuse("The drawing reaches farther than 20 m: check its units and its transforms.");
      std::string unique = name;
      if (!name.empty())
        if (const int count = ++names_[name]; count > 1) unique += "-" + std::to_string(count);
      paths.push_back({layer, std::move(subpath.points_mm), subpath.closed, std::move(unique)});
    }
  }

  const SvgReadOptions& options_;
  const Context& context_;
  StyleSheet style_;
  std::unordered_map<std::string, pugi::xml_node> by_id_;
  std::map<std::string, int> names_;
  std::size_t elements_ = 0;
};

pugi::xml_node root_of(pugi::xml_document& document, ByteView bytes) {
  const std::string_view text = as_text(bytes);
  if (text.empty()) refuse("The drawing is empty: choose another file.");
  if (text.starts_with("\x1f\x8b")) refuse("The drawing is compressed (SVGZ): save it as plain SVG.");
  const pugi::xml_parse_result parsed =
      document.load_buffer(bytes.data(), bytes.size(), pugi::parse_default | pugi::parse_ws_pcdata_single);
  const pugi::xml_node root = document.document_element();
  if (!parsed || !root)
    refuse("The drawing is not XML: " + std::string(parsed.description()) + " at byte " +
           std::to_string(parsed.offset) + "; save it as plain SVG.");
  if (svg_local_name(root) != "svg")
    refuse("The drawing is not an SVG: its first element is <" + svg_local_name(root) + ">; save it as plain SVG.");
  return root;
}

std::string counted(std::size_t count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

}  // namespace

SvgDrawing read_svg_drawing(ByteView bytes, const SvgReadOptions& options, const Context& context) {
  pugi::xml_document document;
  const pugi::xml_node root = root_of(document, bytes);
  SvgDrawing drawing;
  const PageFrame page = read_page_frame(root, options.user_unit, drawing.notes);
  Reader reader(root, options, context);
  Inherited outer;
  outer.to_mm = page.to_mm;
  outer.viewport = page.viewport;
  reader.drawing(root, outer);
  const std::size_t left_out = reader.words + reader.pictures;
  if (reader.paths.empty() && reader.words > 0)
    refuse("The drawing has words only, which have no outline to follow: convert text to paths and save it again.");
  if (reader.paths.empty() && left_out > 0) refuse("The drawing has pictures only: trace them into paths first.");
  if (reader.paths.empty()) refuse("Nothing is drawn in the file: it needs shapes or paths with a stroke or a fill.");

  CutSheet& sheet = drawing.sheet;
  sheet.title = root.child("title").text().as_string();
  sheet.width_mm = page.width_mm;
  sheet.height_mm = page.height_mm;
  sheet.paths = std::move(reader.paths);
  // Told to be of another size, a drawing's kerf is not what its outlines were moved for.
  if (options.user_unit == UserUnit::as_told || options.user_unit == UserUnit::mm)
    if (const double kerf_mm = root.attribute(kerf_attribute).as_double(); kerf_mm > 0 && kerf_mm <= 10)
      sheet.kerf_mm = kerf_mm;
  for (CutPath& path : sheet.paths)
    for (Vec2& p : path.points_mm) p.y() = std::round(1e6 * (page.height_mm - p.y())) / 1e6;
  const auto note = [&](std::size_t count, const std::string& one, const std::string& many) {
    if (count > 0) drawing.notes.push_back(counted(count, one, many));
  };
  note(reader.words, "text was left out: convert it to paths to have it on the material.",
       "texts were left out: convert them to paths to have them on the material.");
  note(reader.pictures, "picture was left out: only lines are followed.",
       "pictures were left out: only lines are followed.");
  note(reader.clipped, "clip or mask was not applied: what it hides is in the drawing.",
       "clips or masks were not applied: what they hide is in the drawing.");
  note(reader.malformed, "element has a fault and was read as far as it goes.",
       "elements have a fault and were read as far as they go.");
  note(reader.other_colours,
       "shape has a colour that names no layer (red cut, blue mark, black engrave) and is taken as a note.",
       "shapes have a colour that names no layer (red cut, blue mark, black engrave) and are taken as notes.");
  return drawing;
}

}  // namespace formwright
