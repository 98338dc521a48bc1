// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/glb/gltf_texture_place.h"

#include <cmath>

namespace formwright {

std::array<double, 2> GltfTexturePlace::operator()(const std::array<double, 2>& uv) const {
  const double c = std::cos(rotation), s = std::sin(rotation), u = scale[0] * uv[0], v = scale[1] * uv[1];
  return {offset[0] + c * u + s * v, offset[1] - s * u + c * v};
}

GltfTexturePlace read_texture_place(const GltfDocument& document, const GltfDocument::Object& texture) {
  GltfTexturePlace place;
  std::int64_t set = document.integer(texture, "texCoord", 0);
  const auto extensions = texture.find("extensions");
  if (extensions != texture.end() && extensions->is_object())
    if (const auto moved = extensions->find("KHR_texture_transform");
        moved != extensions->end() && moved->is_object()) {
      document.numbers(*moved, "offset", place.offset.data(), 2);
      document.numbers(*moved, "scale", place.scale.data(), 2);
      if (const auto turn = moved->find("rotation"); turn != moved->end() && turn->is_number())
        place.rotation = turn->get<double>();
      set = document.integer(*moved, "texCoord", set);
    }
  place.attribute = "TEXCOORD_" + std::to_string(set);
  return place;
}

}  // namespace formwright
