// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/relief/relief_light_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace formwright {
namespace {

constexpr double automatic_pixels = 320;  // along the plate's longer side
constexpr double day_pixel_factor = 2;
constexpr int sun_samples = 8;
constexpr double bytes_a_triangle = 200;  // of a tree of rays, docs/ray_casting.md
// Rays to the light start above the solid by twice as much as its triangles may leave the height field.
constexpr double solid_clearance = 2;
constexpr double model_clearance = 1e-4;  // of the width

std::string scene_key(const OperationCall& call, const LoadedModel& loaded, const ReliefLightOptions& options) {
  Json shape = write_parameters(static_cast<const ReliefOptions&>(options));
  std::string inputs;
  for (const auto& [name, input] : call.inputs) inputs += name + "=" + input.key() + ":";
  return "relief-light:" + loaded.key + ":" + inputs + shape.dump() + ":" +
         (options.light_pixel_mm ? Json(*options.light_pixel_mm).dump() : "");
}

/// Right, up and towards the viewer, mm, the middle of the plate's front at 0.
TriangleMesh solid_on_wall(const SolvedRelief& solved, const ReliefLightOptions& options, PlateSize plate,
                           Context& context) {
  const HeightMap map = make_height_map(covering(*solved.solver, solved.relief), options.width_mm, plate,
                                        options.pixel_mm, allowed_space(solved, options), context);
  TriangleMesh solid = make_solid(map, options.plate_mm, solid_tolerance_share * options.thickness_mm, context);
  solid.V.rowwise() -= Eigen::RowVector3d(plate.width_mm / 2, plate.height_mm / 2, options.plate_mm - map.floor_mm);
  return solid;
}

Vec3 lamp_place(const ReliefLightOptions& options) {
  constexpr double radians = std::numbers::pi / 180;
  const double aside = radians * options.light_aside_deg, height = radians * options.light_height_deg;
  const Vec3 place = options.light_distance_mm *
                     Vec3(std::sin(aside) * std::cos(height), std::sin(height), std::cos(aside) * std::cos(height));
  // Rounded, so that the last digit of a machine's sine does not decide what lies in the shadow.
  constexpr double steps_a_mm = 1 << 20;
  return (place * steps_a_mm).array().round().matrix() / steps_a_mm;
}

}  // namespace

std::shared_ptr<KeptLight> light_scene(const OperationCall& call, const ReliefLightOptions& options) {
  Context& context = call.context;
  const std::shared_ptr<const LoadedModel> loaded = load_model(call);
  const std::string key = scene_key(call, *loaded, options);
  if (auto kept = call.session.find<KeptLight>(key)) return kept;
  // Another thickness or view: one scene is enough.
  call.session.drop("relief-light:");
  const SolvedRelief solved = [&] {
    const auto span = context.span(0, 0.8, "Solving the relief");
    return solve_relief(call, options);
  }();
  const auto span = context.span(0.8, 1, "Making the solid");
  context.progress(0, "Making the solid");
  const ViewFrame& frame = solved.solver->frame();
  auto kept = std::make_shared<KeptLight>();
  kept->key = key;
  kept->frame.axes = frame.axes;
  kept->frame.centre = frame.centre;
  kept->frame.scale = frame.scale;
  kept->frame.kappa = frame.kappa;
  kept->plate = plate_of(frame, options);
  kept->distance_mm = frame.kappa > 0 ? options.width_mm / frame.kappa : 0;
  const TriangleMesh solid = solid_on_wall(solved, options, kept->plate, context);
  kept->size_depth_mm = solid.V.col(2).maxCoeff() - solid.V.col(2).minCoeff();
  TriangleMesh model{frame.P * options.width_mm, solved.solver->F()};
  model.V.col(2) *= -1;
  const LitObject solid_object(solid), model_object(model);
  SceneSizes sizes{
      kept->plate,
      options.light_pixel_mm.value_or(std::max(kept->plate.width_mm, kept->plate.height_mm) / automatic_pixels),
      kept->distance_mm, solid_clearance * solid_tolerance_share * options.thickness_mm,
      model_clearance * options.width_mm};
  kept->scene = std::make_shared<LitScene>(solid_object, model_object, model, sizes, context);
  sizes.pixel_mm *= day_pixel_factor;
  kept->day_scene = std::make_shared<LitScene>(solid_object, model_object, model, sizes, context);
  constexpr double scenes_and_their_fill = 2.5;
  kept->memory_mb = scenes_and_their_fill * kept->scene->memory_mb() +
                    1e-6 * bytes_a_triangle * static_cast<double>(solid.F.rows() + model.F.rows());
  call.session.keep(key, kept, kept->memory_mb);
  return kept;
}

ChosenLight chosen_light(KeptLight& kept, const ReliefLightOptions& options, Context& context) {
  ChosenLight chosen;
  const LitScene& scene = *kept.scene;
  const auto cast = [&](const LightSamples& light) {
    chosen.main = scene.lit_by(light, context);
    chosen.all = chosen.main;
  };
  const double ground = options.ground_percent / 100;
  const auto under = [&](SkyKind kind) {
    cast(joined(sky_light(kind, 1, options.light_samples), ground_light(ground, options.light_samples)));
  };
  switch (options.light) {
    case LightKind::overcast: under(SkyKind::overcast); return chosen;
    case LightKind::bright_sky: under(SkyKind::uniform); return chosen;
    case LightKind::window:
      cast(window_light(lamp_place(options), options.window_width_mm, options.window_height_mm, options.light_samples));
      return chosen;
    case LightKind::strobe: cast(strobe_light(lamp_place(options))); return chosen;
    case LightKind::sun:
      chosen.sun = sun_position({options.latitude_deg, options.longitude_deg}, *read_date(options.date), options.hour,
                                options.utc_offset_h);
      break;
    case LightKind::sun_angles:
      chosen.sun = SunPosition{options.sun_azimuth_deg, options.sun_height_deg, options.sun_height_deg};
      break;
  }
  chosen.sun_towards = sun_direction(chosen.sun->azimuth_deg, chosen.sun->height_deg, options.wall_facing_deg);
  const bool is_up = chosen.sun->height_deg > sun_sets_at_deg, on_wall = is_up && chosen.sun_towards.z() > 0;
  if (!is_up) chosen.notes.push_back("The sun is below the horizon, so there is no daylight.");
  else if (!on_wall)
    chosen.notes.push_back("The sun stands behind the wall, so only the light of the sky and the ground falls on it.");
  if (is_up && kept.fill_samples != options.light_samples) {
    const auto span = context.span(0, 0.8, "Casting light of the sky");
    kept.fill = std::make_shared<FillLight>(scene, options.light_samples, context);
    kept.fill_samples = options.light_samples;
  }
  const auto span = context.span(0.8, 1, "Casting light of the sun");
  cast(sun_disc(on_wall ? chosen.sun_towards : Vec3(0, 0, -1), 1, on_wall ? sun_samples : 1));
  if (is_up) {
    const SceneLight fill =
        kept.fill->of({options.sky_percent / 100, ground, options.light_samples}, chosen.sun_towards.y());
    add(chosen.all, fill);
    if (!on_wall) chosen.main = fill;
  }
  return chosen;
}

const std::vector<HourOfLight>& day_of_light(KeptLight& kept, const ReliefLightOptions& options, Context& context) {
  const WallPlace wall{{options.latitude_deg, options.longitude_deg},
                       *read_date(options.date),
                       options.utc_offset_h,
                       options.wall_facing_deg};
  const OpenAir air{options.sky_percent / 100, options.ground_percent / 100, options.light_samples};
  const std::string key =
      Json{options.latitude_deg,    options.longitude_deg, options.date,           options.utc_offset_h,
           options.wall_facing_deg, options.sky_percent,   options.ground_percent, options.light_samples}
          .dump();
  if (kept.day_key != key) {
    kept.day = light_day(*kept.day_scene, wall, air, context);
    kept.day_key = key;
  }
  return kept.day;
}

}  // namespace formwright
