// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/relief/relief_light_operation.h"

#include "job/contract/operation_options.h"
#include "job/operations/relief/relief_base.h"
#include "job/operations/relief/relief_light_files.h"
#include "job/operations/relief/painting/loaded_painting.h"

namespace formwright {
namespace {

std::vector<OutputInfo> light_outputs() {
  return {
      {"light.png", "image/png", "Picture", "The relief in this light, from the viewpoint.", true},
      {"light_aside.png", "image/png", "Picture from aside",
       "The relief in this light from the side, as when one walks past.", true},
      {"light_model.png", "image/png", "Picture of the model",
       "The model itself in the same light with the same exposure, with the shadows that it casts.", true},
      {"light.ply", "application/x-ply", "PLY with the light",
       "The front of the solid as a mesh, with the brightness (0 to 1, linear) of every point.", true},
      {"walk_past.zip", "application/zip", "Walking past",
       "Pictures of the relief in this light from left to right, 5° apart up to 60° on either side, as when one walks past.",
       false},
      {"lithophane.png", "image/png", "Lithophane",
       "Height map with 16-bit grey levels of a plate that shows the lit model when light comes through it; white is the thickest. Its scale is in the report.",
       false}};
}

std::vector<ReportField> light_report_fields() {
  return {
      {"light_similarity", "Likeness in this light", "",
       "Structural similarity (SSIM) of pictures of relief and model in this light, both with the shadows that they cast; 1 is equal. Null where no light falls on them."},
      {"light_similarity_no_shadows", "Likeness without cast shadows", "", "The same if nothing cast a shadow."},
      {"relief_in_shadow_percent", "Relief in cast shadow", "%",
       "Share of the model's silhouette at which the relief throws a shadow on itself: more than half of the light is held off."},
      {"model_in_shadow_percent", "Model in cast shadow", "%", "The same share of the model."},
      {"sun_azimuth_deg", "Direction of the sun", "°", "Compass direction of the sun: 0 north, 90 east, 180 south."},
      {"sun_height_deg", "Height of the sun", "°", "Angle of the sun over the horizon as seen, with refraction."},
      {"sun_on_wall", "Sun on the wall", "", "Whether the sun is up and stands before the wall."},
      {"best_hour", "Best hour", "h",
       "Hour of the day, to half an hour, at which the relief looks most like the model; null where there is none."},
      {"best_sun_hour", "Best hour in the sun", "h", "The same of the hours at which the sun stands before the wall."},
      {"day", "Hours of the day", "",
       "Every half hour: hour, direction and height of the sun, whether it stands on the wall, likeness (null at night) and share of the relief in cast shadow."},
      {"light_pixel_mm", "Detail of the light", "mm", "Spacing of the points at which the light was computed."},
      {"viewer_distance_mm", "Viewing distance", "mm",
       "Distance from which the pictures are seen; null for far views."},
      {"lithophane_min_mm", "Thinnest place", "mm", "Thickness of the lithophane at level 0."},
      {"lithophane_mm_per_level", "Lithophane level", "mm",
       "Thickness of one of the 65,535 grey levels of the lithophane's height map."},
      {"size_mm", "Size of the solid", "mm", "Width, height and depth of the solid, including its plate."},
      {"seconds_scene", "Set-up", "s", "Time for solving the relief and making its solid; 0 if done before."},
      {"seconds_light", "Light", "s", "Time for casting this light."},
      {"seconds_day", "Hours of the day", "s", "Time for comparing the hours of the day; 0 if done before."},
      {"peak_memory_mb", "Peak memory", "MB", "Largest amount of memory that the process used."},
      {"notes", "Notes", "", "What to know about the result, as sentences."}};
}

void check_light(const ReliefLightOptions& options) {
  if (!read_date(options.date))
    throw Error(ErrorCode::invalid_input, "date",
                "The date is \"" + options.date.substr(0, 40) +
                    "\", and must be a day from 1901 to 2099 as year-month-day, such as 2026-06-21.");
  if (!(options.lithophane_min_mm < options.lithophane_max_mm))
    throw Error(ErrorCode::invalid_input, "lithophane_max_mm",
                "The lithophane's thickest place is not thicker than its thinnest: raise lithophane_max_mm.");
}

Json number_or_null(bool known, double value) { return known ? Json(value) : Json(nullptr); }

void report_day(Json& report, const std::vector<HourOfLight>& day) {
  Json rows = Json::array();
  for (const HourOfLight& one : day)
    rows.push_back({{"hour", one.hour},
                    {"sun_azimuth_deg", one.sun.azimuth_deg},
                    {"sun_height_deg", one.sun.height_deg},
                    {"sun_on_wall", one.sun_on_wall},
                    {"similarity", number_or_null(one.looks.has_value(), one.looks ? one.looks->similarity : 0)},
                    {"relief_in_shadow_percent",
                     number_or_null(one.looks.has_value(), one.looks ? one.looks->relief_in_shadow_percent : 0)}});
  report["day"] = rows;
  const auto best = best_hour(day, false), in_sun = best_hour(day, true);
  report["best_hour"] = number_or_null(best.has_value(), best ? day[*best].hour : 0);
  report["best_sun_hour"] = number_or_null(in_sun.has_value(), in_sun ? day[*in_sun].hour : 0);
}

OperationResult run_relief_light(const OperationCall& call, const ReliefLightOptions& options) {
  Context& context = call.context;
  OperationResult result;
  Json& report = result.report;
  Stopwatch watch;
  const std::shared_ptr<KeptLight> kept = [&] {
    const auto span = context.span(0, 0.5, "Solving the relief");
    return light_scene(call, options);
  }();
  report["seconds_scene"] = watch.lap();
  const ChosenLight light = [&] {
    const auto span = context.span(0.5, 0.7, "Casting light");
    return chosen_light(*kept, options, context);
  }();
  const LitScene& scene = *kept->scene;
  const std::optional<LightComparison> looks = compare(scene, light.main, light.all, context);
  const double exposure = looks ? looks->exposure : 0;
  std::vector<std::string> notes = light.notes;
  if (!looks && notes.empty()) notes.push_back("No light falls on the model from there.");
  if (options.solid == SolidKind::thick)
    notes.push_back(
        "The light falls on the filled solid: no light comes through what a thick surface leaves open behind it.");
  report["light_similarity"] = number_or_null(looks.has_value(), looks ? looks->similarity : 0);
  report["light_similarity_no_shadows"] = number_or_null(looks.has_value(), looks ? looks->similarity_no_shadows : 0);
  report["relief_in_shadow_percent"] = number_or_null(looks.has_value(), looks ? looks->relief_in_shadow_percent : 0);
  report["model_in_shadow_percent"] = number_or_null(looks.has_value(), looks ? looks->model_in_shadow_percent : 0);
  if (light.sun) {
    report["sun_azimuth_deg"] = light.sun->azimuth_deg;
    report["sun_height_deg"] = light.sun->height_deg;
    report["sun_on_wall"] = light.sun->height_deg > sun_sets_at_deg && light.sun_towards.z() > 0;
  }
  report["light_pixel_mm"] = scene.view().pixel_mm;
  report["viewer_distance_mm"] = number_or_null(kept->distance_mm > 0, kept->distance_mm);
  report["size_mm"] = {kept->plate.width_mm, kept->plate.height_mm, kept->size_depth_mm};
  report["seconds_light"] = watch.lap();
  if (options.light == LightKind::sun && options.day_table) {
    const auto span = context.span(0.7, 0.95, "Comparing the hours of the day");
    report_day(report, day_of_light(*kept, options, context));
  }
  report["seconds_day"] = watch.lap();

  context.progress(0.95, "Writing");
  const auto add_output = [&](const char* name, const auto& make) {
    if (!call.wants(name)) return;
    for (const OutputInfo& info : light_outputs())
      if (info.name == name) result.outputs.push_back(make_output(info, make()));
    context.check_cancelled();
  };
  const std::vector<double>& on_relief = light.all.relief.lit;
  add_output("light.png", [&] { return picture_of_relief(*kept, scene.view(), on_relief, exposure, context); });
  add_output("light_aside.png", [&] {
    const PictureView aside =
        picture_around(scene.solid(), scene.view().pixel_mm, kept->distance_mm, options.viewer_aside_deg);
    return picture_of_relief(*kept, aside, on_relief, exposure, context);
  });
  add_output("walk_past.zip", [&] { return walk_past(*kept, on_relief, exposure, context); });
  const SeenModel& model = scene.seen_model();
  add_output("light_model.png", [&] {
    std::vector<char> covered(model.place_of_pixel.size());
    for (std::size_t p = 0; p < covered.size(); ++p) covered[p] = model.place_of_pixel[p] >= 0;
    return light_picture(scene.view(), covered, model.values(light.all.model.lit), exposure, context);
  });
  add_output("light.ply", [&] { return lit_front(*kept, options.width_mm, on_relief, exposure, context); });
  add_output("lithophane.png", [&] {
    const Lithophane plate{options.lithophane_min_mm, options.lithophane_max_mm,
                           absorption_per_mm(options.lithophane_transmission_percent / 100)};
    report["lithophane_min_mm"] = plate.min_mm;
    report["lithophane_mm_per_level"] = (plate.max_mm - plate.min_mm) / 65535;
    return lithophane_picture(scene.view(), model, light.all.model.lit, exposure, plate, context);
  });
  report["notes"] = notes;
  return result;
}

}  // namespace

Operation relief_light_operation() {
  Operation operation;
  operation.name = "relief-light";
  operation.title = "Relief in real light";
  operation.summary =
      "Shows how a relief will look in the sun, under a sky, beside a window or under a strobe, with the shadows that it casts, and when it looks best.";
  operation.inputs = {model_input_info(), base_input_info(), painting_input_info(), painted_mesh_input_info()};
  operation.outputs = light_outputs();
  operation.report = light_report_fields();
  take_options<ReliefLightOptions>(operation, run_relief_light, check_light);
  return operation;
}

}  // namespace formwright
