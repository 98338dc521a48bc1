// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A texture in linear light with its mip levels, filtered over the area that a printed dot covers.
// Williams 1983 (pyramid); McCormack, Perry, Farkas, Jouppi 1999 "Feline" (probes along the footprint's longer axis).
#include <vector>

#include "base/lanes.h"
#include "geometry/mesh/triangle_mesh.h"
#include "imaging/picture/image.h"

namespace formwright {

using Light = Float4;  // linear RGB, 0 to 65535 (light.h); the fourth is not used

class LinearPicture {
 public:
  /// Transparent parts are taken as white paper behind. `repeat`: the picture tiles the plane; otherwise its border
  /// goes on.
  LinearPicture(const Image& image, bool repeat, const Context& context);

  int width() const { return levels_.front().width; }
  int height() const { return levels_.front().height; }

  /// How to filter where a dot covers the parallelogram with the sides of `texels_per_dot` (columns; in texels).
  struct Footprint {
    int level = 0;    // the finer of two levels
    float blend = 0;  // share of the coarser one
    int probes = 1;
    Vec2 step{0, 0};  // between probes, in whole pictures
  };
  Footprint footprint(const Eigen::Matrix2d& texels_per_dot) const;

  /// Mean over the footprint about `place`: u to the right and v down, in whole pictures.
  Light sample(const Vec2& place, const Footprint& footprint) const;

 private:
  using Texel = std::uint16_t __attribute__((vector_size(8)));
  struct Level {
    int width = 0, height = 0;
    std::vector<Texel> texels;
  };
  static Level halved(const Level& fine, const Context& context);
  Light bilinear(const Level& level, const Vec2& place) const;

  std::vector<Level> levels_;
  bool repeat_;
};

}  // namespace formwright
