// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A made relief under a known light as a forward model: from how it was printed, lit and looked at to the brightness of
// its points.
#include <string>
#include <vector>

#include "base/bytes.h"
#include "evidence/fit/forward_model.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// Heights over a rectangle, row by row from its lower left corner, towards the viewer.
struct ReliefSurface {
  double pixel_mm = 1;
  Vec2 lower_mm = Vec2::Zero();  // of the first height
  Eigen::MatrixXd height_mm;     // rows: y, columns: x

  /// The uppermost surface of `mesh` (mm, z towards the viewer), `pixels` along its longer side. Where the mesh leaves
  /// holes, its lowest height.
  static ReliefSurface of(const TriangleMesh& mesh, int pixels, Context& context);
};

struct ShadedPoint {
  Vec2 place_mm;
  double brightness;  // linear, of the whole picture's own scale
  double sigma;       // of the same; 0 where unknown
};

/// How the picture was taken, as far as it is known.
struct ShadingSetup {
  Vec3 light_direction = Vec3(-1, 1, 1);  // towards the light
  double light_distance_mm = 0;           // 0: very far
  double camera_height_mm = 0;            // above the relief's middle; 0: very far
};

struct PhotographedRelief {
  std::string name;
  ReliefSurface surface;
  ShadingSetup setup;
  std::vector<ShadedPoint> points;
};

/// shading.csv: header x_mm,y_mm,brightness[,sigma]. Throws Error{invalid_input, "object"} with the line.
std::vector<ShadedPoint> read_shaded_points(ByteView csv);
/// setup.json: light_direction [x, y, z], light_distance_mm, camera_height_mm. Throws Error{invalid_input, "object"},
/// naming the key.
ShadingSetup read_shading_setup(ByteView json);

/// The base is a matt surface: brightness = exposure (ambient + (1 - ambient) max(0, n . l)), without shadows that one
/// part casts on another. Causes: light_direction, light_distance, gloss, cast_shadow, printer_blur, depth_shrinkage,
/// viewer_offset.
class ReliefModel : public ForwardModel {
 public:
  /// At least one relief, of at least 30 points each. Throws Error{invalid_input, "object"}.
  explicit ReliefModel(std::vector<PhotographedRelief> reliefs);

  const std::vector<ModelParameter>& parameters() const override { return parameters_; }
  const std::vector<Cause>& causes() const override { return causes_; }
  const std::vector<Measurement>& measurements() const override { return measurements_; }
  Eigen::MatrixXd predict(int object, const Eigen::VectorXd& u, const Context& context) const override;
  double known_misfit() const override { return 0.01; }

 private:
  std::vector<PhotographedRelief> reliefs_;
  std::vector<ModelParameter> parameters_;
  std::vector<Cause> causes_;
  std::vector<Measurement> measurements_;
};

/// Gaussian blur of heights, sigma in mm; the edge is continued.
Eigen::MatrixXd blurred(const Eigen::MatrixXd& height, double sigma_pixels);

/// 1 where the light reaches a height, 0 in the shadow of another, between at its edge; `light`: unit vector towards
/// it.
Eigen::MatrixXd lit(const ReliefSurface& surface, const Vec3& light);

}  // namespace formwright
