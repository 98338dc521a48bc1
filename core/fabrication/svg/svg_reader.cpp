// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/svg/svg_reader.h"

#include <cmath>

#include "fabrication/svg/grammar/drawing_limits.h"
#include "fabrication/svg/svg_viewport.h"
#include "fabrication/svg/svg_walker.h"

namespace formwright {
namespace {

pugi::xml_node root_of(pugi::xml_document& document, ByteView bytes) {
  const std::string_view text = as_text(bytes);
  if (text.empty()) refuse_drawing("The drawing is empty: choose another file.");
  if (text.starts_with("\x1f\x8b")) refuse_drawing("The drawing is compressed (SVGZ): save it as plain SVG.");
  const pugi::xml_parse_result parsed =
      document.load_buffer(bytes.data(), bytes.size(), pugi::parse_default | pugi::parse_ws_pcdata_single);
  const pugi::xml_node root = document.document_element();
  if (!parsed || !root)
    refuse_drawing("The drawing is not XML: " + std::string(parsed.description()) + " at byte " +
                   std::to_string(parsed.offset) + "; save it as plain SVG.");
  if (svg_local_name(root) != "svg")
    refuse_drawing("The drawing is not an SVG: its first element is <" +
                   std::string(svg_local_name(root).substr(0, 40)) + ">; save it as plain SVG.");
  return root;
}

}  // namespace

SvgDrawing read_svg_drawing(ByteView bytes, const SvgReadOptions& options, const Context& context) {
  pugi::xml_document document;
  const pugi::xml_node root = root_of(document, bytes);
  SvgDrawing drawing;
  const PageFrame page = read_page_frame(root, options.user_unit, drawing.notes);
  DrawingLimits limits(bytes.size(), context);
  SvgWalker walker(root, options.flatness_mm, limits);
  walker.walk(page);
  const SvgNotes& notes = walker.notes;
  if (walker.paths.empty() && notes.words > 0)
    refuse_drawing(
        "The drawing contains only text, which has no outlines to follow: convert the text to paths and save it again.");
  if (walker.paths.empty() && notes.pictures > 0)
    refuse_drawing("The drawing contains only pictures: trace them into paths first.");
  if (walker.paths.empty()) {
    // What was left out says why there is nothing.
    std::vector<std::string> reasons;
    add_sentences(notes, reasons);
    std::string sentence = "The drawing is empty: it needs shapes or paths with a stroke or a fill.";
    if (!reasons.empty()) sentence += " " + reasons.front();
    refuse_drawing(sentence);
  }

  CutSheet& sheet = drawing.sheet;
  sheet.title = root.child("title").text().as_string();
  sheet.width_mm = page.width_mm;
  sheet.height_mm = page.height_mm;
  sheet.paths = std::move(walker.paths);
  // Told to be of another size, a drawing's kerf is not what its outlines were moved for.
  if (options.user_unit == UserUnit::as_in_file || options.user_unit == UserUnit::mm)
    if (const double kerf_mm = root.attribute(kerf_attribute).as_double(); kerf_mm > 0 && kerf_mm <= 10)
      sheet.kerf_mm = kerf_mm;
  for (CutPath& path : sheet.paths)
    for (Vec2& p : path.points_mm) p.y() = std::round(1e6 * (page.height_mm - p.y())) / 1e6;
  add_sentences(notes, drawing.notes);
  return drawing;
}

}  // namespace formwright
