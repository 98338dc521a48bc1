// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/contract/operation_options.h"
#include "job/operations/thermoform/thermoform_operations.h"

#include "base/format.h"
#include "formats/mesh_io.h"
#include "imaging/picture/picture_reader.h"
#include "imaging/picture/png_writer.h"
#include "job/operations/thermoform/thermoform_input.h"
#include "thermoform/print/print_pages.h"
#include "thermoform/print/texture_print.h"
#include "thermoform/sheet/sheet_presets.h"

namespace formwright {
namespace {

constexpr int formed_texture_px = 2048;

std::vector<InputInfo> thermoform_texture_inputs() {
  return {
      mould_input_info(),
      sheet_input_info(),
      {"material", "Material file", "The material file (MTL) that belongs to an OBJ model.", {"mtl"}, false, false, ""},
      {"texture",
       "Picture",
       "A PNG or JPEG picture that replaces the model's own, placed by the model's texture coordinates.",
       {"png", "jpg", "jpeg"},
       false,
       false,
       ""},
      profile_input_info()};
}

std::vector<OutputInfo> thermoform_texture_outputs() {
  return {
      {"print.png", "image/png", "Print as one picture",
       "The print for the whole sheet with its marks. The file contains its true size.", true},
      {"print.pdf", "application/pdf", "Print for paper",
       "The print at true size on the chosen paper, then a template of the marks on the frame. Print at 100 %.", true},
      {"formed.glb", "model/gltf-binary", "Formed sheet, coloured",
       "The formed sheet with the print on it, for viewing; y points up.", true},
      {"coverage.ply", "application/x-ply", "Coverage",
       "The model in machine coordinates. Every vertex has a code (0 coloured, 1 hidden, 2 not touched, 3 below the plate, 4 outside), its place on the sheet and the gap to it.",
       false}};
}

std::vector<ReportField> thermoform_texture_report_fields() {
  return {
      {"sheet_mm", "Sheet", "mm", "Width and length of the flat sheet."},
      {"picture_mm", "Picture", "mm",
       "Width and height of the picture: the whole number of pixels nearest to the size of the sheet."},
      {"picture_pixels", "Pixels", "", "Width and height of the picture in pixels."},
      {"dots_per_inch", "Resolution", "dpi",
       "Resolution from side to side as stored in the picture file, which holds whole pixels per metre."},
      {"colours_used", "Colours", "", "Where the colours of the print came from."},
      {"pages", "Pages", "", "Number of pages in the PDF, including the template for the frame."},
      {"page_mm", "Page", "mm", "Width and height of a page."},
      {"tiles", "Tiles", "", "Number of columns and rows of pages that together make the sheet."},
      {"area_coloured_mm2", "Coloured", "mm²",
       "Area of the model above the plate that receives colour from the print."},
      {"area_uncoloured_mm2", "Without colour", "mm²",
       "Area of the model above the plate that receives no colour from the print."},
      {"uncoloured_percent", "Without colour", "%",
       "Share of the model's surface above the plate that receives no colour from the print."},
      {"area_hidden_mm2", "Hidden", "mm²",
       "Area without colour because it is undercut or lies under another part of the model."},
      {"area_not_touched_mm2", "Not touched", "mm²",
       "Area without colour because the sheet spans it without touching."},
      {"area_outside_mm2", "Outside", "mm²", "Area without colour because it lies beyond the clamp's opening."},
      {"area_below_plate_mm2", "Below the plate", "mm²",
       "Area of the model in or below the base plate; not part of the other areas."},
      {"gap_mean_mm", "Mean gap", "mm",
       "Mean distance from coloured points of the model to the inner face of the sheet."},
      {"gap_max_mm", "Largest gap", "mm",
       "Largest distance from a coloured point of the model to the inner face of the sheet."},
      {"stretch_mean", "Mean stretch of the print", "",
       "Mean ratio of formed area to printed area. At 2 the colours spread over twice the area."},
      {"stretch_max", "Largest stretch of the print", "", "Largest ratio of formed area to printed area."},
      {"triangles", "Triangles of the map", "",
       "Number of triangles into which the model was subdivided to carry its colours to the sheet."},
      {"seconds_read", "Reading", "s",
       "Time for reading model and sheet, and for simulating if no formed sheet was given."},
      {"seconds_refine", "Subdividing", "s", "Time for subdividing the model."},
      {"seconds_project", "Projecting", "s", "Time for finding the place of every point of the model on the sheet."},
      {"seconds_colours", "Reading colours", "s", "Time for reading the colours of the model."},
      {"seconds_render", "Drawing", "s", "Time for drawing the print."},
      {"seconds_bleed", "Bleed", "s", "Time for continuing the colours beyond the model's edge."},
      {"seconds_write", "Writing", "s", "Time for writing the output files."},
      {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."},
      {"sentences", "Notes", "", "What to know about the print, as sentences."}};
}

/// The model with its material file read. A reader keeps no trace of the library's name, so that any file will do.
Model with_material(const LoadedModel& loaded, const InputBlob& material) {
  ModelFile file;
  file.model = loaded.model;
  file.material_libraries = {"given.mtl"};
  const Companion library{"given.mtl", *material.bytes};
  ReadOptions options;
  options.where = "material";
  read_model_materials(file, {&library, 1}, options);
  return std::move(file.model);
}

Bytes coverage_ply(const TexturePrint& print, Context& context) {
  Model model;
  model.mesh = print.surface.mesh;
  Eigen::VectorXd reason(model.mesh.vertex_count());
  for (Eigen::Index i = 0; i < reason.size(); ++i)
    reason[i] = static_cast<int>(print.projected.vertex[static_cast<std::size_t>(i)]);
  const std::vector<VertexColumn> columns = {{"reason", reason, ColumnKind::uint8},
                                             {"sheet_x_mm", print.projected.sheet_mm.col(0), ColumnKind::float32},
                                             {"sheet_y_mm", print.projected.sheet_mm.col(1), ColumnKind::float32},
                                             {"gap_mm", print.projected.gap_mm, ColumnKind::float32}};
  WriteOptions write;
  write.columns = columns;
  return write_model(model, MeshFormat::ply, write, context);
}

void report_print(Json& report, const TexturePrint& print, const PageLayout& layout,
                  const ThermoformPrintOptions& options) {
  const auto area = [&](Coverage c) { return print.area_mm2[static_cast<std::size_t>(c)]; };
  const double pixel_mm = print.grid.pixel_mm();
  report["sheet_mm"] = {options.sheet_x_mm, options.sheet_y_mm};
  report["picture_mm"] = {print.grid.width * pixel_mm * options.sent_scale().x(),
                          print.grid.height * pixel_mm * options.sent_scale().y()};
  report["picture_pixels"] = {print.grid.width, print.grid.height};
  report["dots_per_inch"] = sent_per_metre(print.grid, options).x() * 0.0254;
  report["colours_used"] = EnumNames<PrintColours>::names.at(static_cast<std::size_t>(print.colours));
  const bool has_template = options.marks && !registration_marks(options).empty();
  report["pages"] = layout.tiles.size() * (has_template ? 2 : 1);
  report["page_mm"] = {layout.width_mm, layout.height_mm};
  report["tiles"] = {layout.columns, layout.rows};
  report["area_coloured_mm2"] = area(Coverage::coloured);
  report["area_uncoloured_mm2"] = print.uncoloured_mm2();
  report["uncoloured_percent"] = 100 * print.uncoloured_share();
  report["area_hidden_mm2"] = area(Coverage::hidden);
  report["area_not_touched_mm2"] = area(Coverage::not_touched);
  report["area_outside_mm2"] = area(Coverage::outside);
  report["area_below_plate_mm2"] = area(Coverage::below_plate);
  report["gap_mean_mm"] = print.gap_mean_mm;
  report["gap_max_mm"] = print.gap_max_mm;
  report["stretch_mean"] = print.stretch_mean;
  report["stretch_max"] = print.stretch_max;
  report["triangles"] = print.surface.mesh.face_count();
  report["seconds_refine"] = print.seconds_refine;
  report["seconds_project"] = print.seconds_project;
  report["seconds_colours"] = print.seconds_colours;
  report["seconds_render"] = print.seconds_render;
  report["seconds_bleed"] = print.seconds_bleed;
}

/// Where files differ in size from the sheet: what the printer does to them.
void add_sent_size(const Vec2& scale, std::vector<std::string>& sentences) {
  const auto percent = [](double factor) { return with_max_decimals(100 * std::abs(1 - factor), 2) + " % "; };
  if (scale.x() == scale.y()) {
    if (scale.x() != 1)
      sentences.push_back("The files are " + percent(scale.x()) + (scale.x() < 1 ? "smaller" : "larger") +
                          " than the sheet, because the printer prints too " + (scale.x() < 1 ? "large." : "small."));
    return;
  }
  const auto side = [&](double factor, const char* where) {
    if (factor == 1) return;
    sentences.push_back("The files are " + percent(factor) + (factor < 1 ? "shorter " : "longer ") + where +
                        " than the sheet, because the printer prints too " + (factor < 1 ? "long" : "short") +
                        " that way.");
  };
  side(scale.x(), "from side to side");
  side(scale.y(), "from front to back");
}

OperationResult run_texture(const OperationCall& call, const Json& given) {
  Json parameters = merged_parameters(call, given);
  if (const auto profile = machine_profile(call)) {
    const Json measured = write_parameters(profile->measurement);
    for (const char* const name : {"print_scale", "print_stretch_x", "print_stretch_y"})
      if (!given.contains(name)) parameters[name] = measured[name];
  }
  const auto options = read_parameters<ThermoformPrintOptions>(parameters);
  Context& context = call.context;
  // What can be refused at once is, before a simulation.
  const PageLayout layout = page_layout(options);
  print_grid(options);
  std::optional<Image> picture;
  if (const auto texture = call.inputs.find("texture"); texture != call.inputs.end())
    picture = read_picture(*texture->second.bytes, texture->second.file_name, "texture");
  Stopwatch watch;
  FormedModel formed;
  {
    const auto span = context.span(0, 0.5, "Forming the sheet");
    formed = formed_model(call, options);
  }
  OperationResult result;
  Json& report = result.report;
  report["seconds_read"] = watch.lap();
  const auto material = call.inputs.find("material");
  std::optional<Model> with_mtl;
  if (material != call.inputs.end()) with_mtl = with_material(*formed.loaded, material->second);
  const Model& model = with_mtl ? *with_mtl : formed.loaded->model;
  TexturePrint print;
  {
    const auto span = context.span(0.5, 0.85, "Making the print");
    print = make_texture_print(model, formed.real_placement(model.mesh), *formed.sheet, picture, options, context);
  }
  report_print(report, print, layout, options);
  std::vector<std::string> sentences = formed.placement.notes;
  sentences.insert(sentences.end(), print.sentences.begin(), print.sentences.end());
  add_sent_size(options.sent_scale(), sentences);
  report["sentences"] = sentences;

  watch.lap();
  context.progress(0.85, "Writing");
  const auto add = [&](const char* name, Bytes bytes) {
    for (const OutputInfo& info : thermoform_texture_outputs())
      if (info.name == name) result.outputs.push_back(make_output(info, std::move(bytes)));
    context.check_cancelled();
  };
  if (call.wants("print.png"))
    add("print.png",
        write_png(with_marks(print.picture, print.grid, options), sent_per_metre(print.grid, options), context));
  context.progress(0.9);
  if (call.wants("print.pdf"))
    add("print.pdf", write_print_pdf(print.picture, print.grid, layout, options, "Thermoforming print", context));
  context.progress(0.95);
  if (call.wants("formed.glb")) add("formed.glb", formed_picture(*formed.sheet, print, formed_texture_px, context));
  if (call.wants("coverage.ply")) add("coverage.ply", coverage_ply(print, context));
  report["seconds_write"] = watch.seconds();
  return result;
}

}  // namespace

Operation thermoform_texture_operation() {
  Operation operation;
  operation.name = "thermoform-texture";
  operation.title = "Print for thermoforming";
  operation.summary =
      "Makes the picture to print on the flat sheet so that, after forming, every colour lands where it belongs.";
  operation.inputs = thermoform_texture_inputs();
  operation.outputs = thermoform_texture_outputs();
  operation.report = thermoform_texture_report_fields();
  operation.presets = sheet_presets();
  take_mergeable_options<ThermoformPrintOptions>(operation, run_texture);
  return operation;
}

}  // namespace formwright
