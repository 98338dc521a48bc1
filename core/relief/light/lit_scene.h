// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A relief on its wall and the model in its place, ready for any light: rays are set up once, and light adds up.
#include <optional>

#include "relief/light/seen_places.h"

namespace formwright {

struct SceneSizes {
  PlateSize plate;
  double pixel_mm;             // between nodes and between pixels
  double distance_mm;          // of the viewer, 0: far
  double relief_clearance_mm;  // see SurfacePoints
  double model_clearance_mm;
};

/// Of one light or several.
struct SceneLight {
  Irradiance relief, model;  // at LitRelief's nodes, at SeenModel's places
};
void add(SceneLight& a, const SceneLight& b);
/// `share` of a.
SceneLight scaled(const SceneLight& a, double share);

class LitScene {
 public:
  /// Both objects: x right, y up, z towards the viewer, mm, the middle of the plate's front at 0. `mesh`: the model's.
  /// Throws Error: see make_lit_relief.
  LitScene(LitObject solid, LitObject model, const TriangleMesh& mesh, const SceneSizes& sizes, Context& context);

  /// Throws Error: cancelled.
  SceneLight lit_by(const LightSamples& light, Context& context) const;

  const LitObject& solid() const { return solid_; }
  const LitRelief& relief() const { return relief_; }
  const PictureView& view() const { return view_; }
  const SeenRelief& seen_relief() const { return seen_relief_; }
  const SeenModel& seen_model() const { return seen_model_; }
  double memory_mb() const;  // without the objects, which scenes share

 private:
  LitObject solid_, model_;
  LitRelief relief_;
  PictureView view_;  // from the viewpoint
  SeenRelief seen_relief_;
  SeenModel seen_model_;
};

/// What a camera does: light times this is brightness, 1 is white. The brightest 2 % of `values` are white. Nothing
/// where there is no light.
std::optional<double> exposure(std::vector<double> values);

struct LightComparison {
  double similarity;                // SSIM of relief and model, both with the shadows they cast, over the model's
                                    // silhouette; see brightness_similarity
  double similarity_no_shadows;     // of both without cast shadows
  double exposure;                  // of the model's picture, and of the relief's
  double relief_in_shadow_percent;  // of the silhouette, where more than half of the main light is held off
  double model_in_shadow_percent;
};

/// `main`: the light that casts shadows; `all`: that and what fills them. Nothing where no light falls on the model.
/// Throws Error: cancelled.
std::optional<LightComparison> compare(const LitScene& scene, const SceneLight& main, const SceneLight& all,
                                       Context& context);

}  // namespace formwright
