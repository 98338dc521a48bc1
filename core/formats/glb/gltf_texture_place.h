// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where a glTF material's picture lies on its mesh: which set of coordinates, moved by KHR_texture_transform.
#include <array>
#include <string>

#include "formats/glb/glb_scene.h"

namespace formwright {

struct GltfTexturePlace {
  std::string attribute = "TEXCOORD_0";
  std::array<double, 2> offset{0, 0}, scale{1, 1};
  double rotation = 0;  // of the coordinates, anticlockwise as seen with v downwards

  /// Coordinates of the attribute as the picture's, v still downwards.
  std::array<double, 2> operator()(const std::array<double, 2>& uv) const;
};

/// Of a material's textureInfo. What is wrong refuses the file.
GltfTexturePlace read_texture_place(const GltfDocument& document, const GltfDocument::Object& texture);

}  // namespace formwright
