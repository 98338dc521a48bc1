// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A scan's colours, seen from above once it is laid flat.
#include <memory>
#include <vector>

#include "geometry/mesh/triangle_mesh.h"
#include "imaging/picture/linear_picture.h"
#include "imaging/picture/weighted_picture.h"

namespace formwright {

/// The colours that a scan was photographed with: textures by UV, or colours of its vertices.
class ScanColours {
 public:
  /// Keeps a reference to `model`. Throws Error{invalid_input, "scan"}: neither a picture with texture coordinates nor
  /// vertex colours.
  ScanColours(const Model& model, const Context& context);

  /// How a face is filtered where it is drawn with its corners at `pixels`.
  LinearPicture::Footprint footprint(int face, const std::array<Vec2, 3>& pixels) const;
  /// Linear light 0 to 1, and the weight in lane 3: 0 where the picture is transparent or the face has none.
  Float4 at(int face, const Vec3& barycentric, const LinearPicture::Footprint& footprint) const;

  int width(int face) const;  // of a face's picture, in pixels; 0 without one
  int height(int face) const;

 private:
  struct Sheet {
    Image image;
    std::unique_ptr<LinearPicture> picture;
  };
  const Sheet* sheet_of(int face) const;
  const Model& model_;
  std::vector<Sheet> sheets_;
};

/// A frame of pixels over the plane: the middle of the picture at the origin, y up.
struct PlaneFrame {
  int width = 0, height = 0;
  double pixel_mm = 1;
  Vec2 centre_mm{0, 0};

  Vec2 pixel(const Vec2& place) const {
    return {0.5 * width + (place.x() - centre_mm.x()) / pixel_mm - 0.5,
            0.5 * height - (place.y() - centre_mm.y()) / pixel_mm - 0.5};
  }
  Vec2 place(double column, double row) const {
    return centre_mm + Vec2((column + 0.5 - 0.5 * width) * pixel_mm, (0.5 * height - row - 0.5) * pixel_mm);
  }
};

/// Draws the faces at `place_mm` (n x 2): linear light 0 to 1 in the lanes, 0 weight where nothing is seen. Faces
/// upside down are left out; of several over one pixel the first counts.
WeightedPicture draw_scan(const Model& model, const ScanColours& colours, const TextureCoordinates& place_mm,
                          const PlaneFrame& frame, const Context& context);

/// From places of the plane to the face that lies there.
class PlaneLookup {
 public:
  /// Keeps references to both; at least one face.
  PlaneLookup(const Triangles& faces, const TextureCoordinates& place_mm);
  struct Found {
    int face;
    Vec3 barycentric;
  };
  /// The first face over `place`, upside-down ones left out; face -1 where there is none.
  Found find(const Vec2& place) const;

 private:
  const Triangles& faces_;
  const TextureCoordinates& place_mm_;
  Vec2 lower_;
  double cell_mm_ = 1;
  int columns_ = 1, rows_ = 1;
  std::vector<int> first_, items_;  // faces of each cell, end to end
};

}  // namespace formwright
