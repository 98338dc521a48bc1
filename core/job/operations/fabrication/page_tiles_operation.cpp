// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/page_tiles.h"
#include "fabrication/svg/svg_reader.h"
#include "formats/png/png16.h"
#include "imaging/picture/picture_reader.h"
#include "job/contract/operation_options.h"
#include "job/operations/fabrication/fabrication_operations.h"
#include "job/contract/model_input.h"

namespace formwright {
namespace {

std::vector<OutputInfo> page_tiles_outputs() {
  return {{"pages.pdf", "application/pdf", "Pages", "The pages at exact size. Print at 100 %, not fitted to the page.",
           true}};
}

OperationResult run_page_tiles(const OperationCall& call, const PageTilesOptions& options) {
  Context& context = call.context;
  Stopwatch watch;
  const InputBlob& input = call.inputs.at("drawing");
  const std::string_view text = as_text(*input.bytes);
  const bool png = text.substr(0, 4) == "\x89PNG", jpeg = text.substr(0, 2) == "\xff\xd8";
  context.progress(0, "Reading");
  PageContent content;
  Image picture;
  SvgDrawing drawing;
  if (png || jpeg) {
    picture = read_picture(*input.bytes, input.file_name, "drawing");
    double width = options.width_mm.value_or(0);
    if (width <= 0 && png) width = read_png16(*input.bytes, input.file_name, "drawing").pixel_width_mm * picture.width;
    if (width <= 0)
      throw Error(ErrorCode::invalid_input, "width_mm", "The picture does not contain its size: give its width.");
    content = {&picture, nullptr, width, width * picture.height / picture.width};
  } else {
    drawing = read_svg_drawing(*input.bytes, {}, context);
    const double width = options.width_mm.value_or(drawing.sheet.width_mm);
    content = {nullptr, &drawing.sheet, width, width * drawing.sheet.height_mm / drawing.sheet.width_mm};
  }
  PageTiles tiles = make_page_tiles(content, options, context);
  OperationResult result;
  if (call.wants("pages.pdf"))
    result.outputs.push_back(make_output(page_tiles_outputs().front(), std::move(tiles.pdf)));
  tiles.notes.insert(tiles.notes.begin(), drawing.notes.begin(), drawing.notes.end());
  result.report["pages"] = tiles.columns * tiles.rows;
  result.report["columns"] = tiles.columns;
  result.report["rows"] = tiles.rows;
  result.report["page_mm"] = {tiles.page_width_mm, tiles.page_height_mm};
  result.report["room_mm"] = {tiles.room_width_mm, tiles.room_height_mm};
  result.report["size_mm"] = {content.width_mm, content.height_mm};
  result.report["seconds_total"] = watch.seconds();
  result.report["peak_memory_mb"] = context.peak_memory_mb();
  result.report["notes"] = tiles.notes;
  return result;
}

}  // namespace

Operation page_tiles_operation() {
  Operation operation;
  operation.name = "page-tiles";
  operation.title = "Pages";
  operation.summary =
      "Splits a picture or a drawing at exact size over the pages of a printer, with marks to join them.";
  InputInfo content;
  content.name = "drawing";
  content.label = "Picture or drawing";
  content.help = "A PNG or JPEG picture, or an SVG drawing, whose lines are printed in black.";
  content.extensions = {"svg", "png", "jpg", "jpeg"};
  operation.inputs = {content};
  operation.outputs = page_tiles_outputs();
  operation.report = {
      {"pages", "Pages", "", "Number of pages in all."},
      {"columns", "Columns", "", "Number of columns of pages."},
      {"rows", "Rows", "", "Number of rows of pages."},
      {"page_mm", "Page", "mm", "Width and height of a page as it lies."},
      {"room_mm", "Printable area", "mm", "Width and height that can be printed on a page, within its margins."},
      {"size_mm", "Size", "mm", "Printed width and height of the whole picture or drawing."},
      {"seconds_total", "Time", "s", "Time for the whole job."},
      {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."},
      {"notes", "Notes", "", "What to know about the result, as sentences."}};
  take_options<PageTilesOptions>(operation, run_page_tiles);
  return operation;
}

}  // namespace formwright
