// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/light/lit_scene.h"

#include <algorithm>
#include <cmath>

#include "base/index.h"
#include "relief/seen/picture_similarity.h"

namespace formwright {
namespace {

constexpr double share_not_white = 0.98;

std::vector<float> brightness(const std::vector<double>& light, double exposure) {
  std::vector<float> result(light.size());
  for (std::size_t p = 0; p < light.size(); ++p) result[p] = static_cast<float>(std::min(1.0, exposure * light[p]));
  return result;
}

/// Percent of the pixels of `mask` where less than half of what could come does.
double in_shadow_percent(const std::vector<char>& mask, const std::vector<double>& lit,
                         const std::vector<double>& open) {
  std::size_t pixels = 0, dark = 0;
  for (std::size_t p = 0; p < mask.size(); ++p) {
    if (!mask[p]) continue;
    ++pixels;
    dark += open[p] > 0 && lit[p] < 0.5 * open[p];
  }
  return pixels == 0 ? 0 : 100 * static_cast<double>(dark) / static_cast<double>(pixels);
}

}  // namespace

void add(SceneLight& a, const SceneLight& b) {
  add(a.relief, b.relief);
  add(a.model, b.model);
}

SceneLight scaled(const SceneLight& a, double share) {
  SceneLight result = a;
  for (std::vector<double>* values : {&result.relief.lit, &result.relief.open, &result.model.lit, &result.model.open})
    for (double& value : *values) value *= share;
  return result;
}

LitScene::LitScene(LitObject solid, LitObject model, const TriangleMesh& mesh, const SceneSizes& sizes,
                   Context& context)
    : solid_(std::move(solid)),
      model_(std::move(model)),
      relief_(make_lit_relief(solid_, sizes.plate, sizes.pixel_mm, sizes.relief_clearance_mm, context)),
      view_(picture_of_plate(sizes.plate, sizes.pixel_mm, sizes.distance_mm)),
      seen_relief_(see_relief(view_, solid_, context)),
      seen_model_(see_model(view_, model_, mesh, sizes.model_clearance_mm, context)) {}

SceneLight LitScene::lit_by(const LightSamples& light, Context& context) const {
  const double nodes = static_cast<double>(relief_.nodes.place.rows()),
               places = static_cast<double>(seen_model_.places.place.rows());
  SceneLight result;
  {
    const auto span = context.span(0, nodes / (nodes + places), "Casting light on the relief");
    result.relief = irradiance(solid_, relief_.nodes, light, context);
  }
  const auto span = context.span(nodes / (nodes + places), 1, "Casting light on the model");
  result.model = irradiance(model_, seen_model_.places, light, context);
  return result;
}

double LitScene::memory_mb() const {
  constexpr double bytes_a_node = 48, bytes_a_pixel = 70;
  return 1e-6 * (bytes_a_node * static_cast<double>(relief_.nodes.place.rows()) +
                 bytes_a_pixel * static_cast<double>(view_.pixels()));
}

std::optional<double> exposure(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  const auto place = static_cast<std::ptrdiff_t>(share_not_white * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  const double brightest = values[static_cast<std::size_t>(place)];
  // Under a light that all but grazes, the rest of it is round-off.
  return brightest > 1e-9 ? std::optional(1 / brightest) : std::nullopt;
}

std::optional<LightComparison> compare(const LitScene& scene, const SceneLight& main, const SceneLight& all,
                                       Context& context) {
  const std::optional<double> with_shadows = exposure(all.model.lit), without = exposure(all.model.open);
  if (!with_shadows || !without) return std::nullopt;
  const SeenRelief& relief = scene.seen_relief();
  const SeenModel& model = scene.seen_model();
  std::vector<char> mask(relief.covered.size());
  for (std::size_t p = 0; p < mask.size(); ++p) mask[p] = relief.covered[p] && model.place_of_pixel[p] >= 0;
  const PictureView& view = scene.view();
  const auto similarity = [&](const std::vector<double>& of_relief, const std::vector<double>& of_model, double times) {
    return brightness_similarity(view.columns, view.rows, brightness(model.values(of_model), times),
                                 brightness(relief.values(scene.relief(), of_relief), times), mask, context);
  };
  LightComparison result{};
  result.exposure = *with_shadows;
  result.similarity = similarity(all.relief.lit, all.model.lit, *with_shadows);
  result.similarity_no_shadows = similarity(all.relief.open, all.model.open, *without);
  result.relief_in_shadow_percent = in_shadow_percent(mask, relief.values(scene.relief(), main.relief.lit),
                                                      relief.values(scene.relief(), main.relief.open));
  result.model_in_shadow_percent = in_shadow_percent(mask, model.values(main.model.lit), model.values(main.model.open));
  return result;
}

}  // namespace formwright
