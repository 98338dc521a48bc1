// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The colour of any point of a model: from its pictures, vertices, materials or a pattern.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "imaging/picture/linear_picture.h"
#include "thermoform/print/print_options.h"
#include "thermoform/print/surface_refinement.h"

namespace formwright {

/// A face of the refined surface, made ready to be coloured at places of the print: what colours it varies linearly
/// there.
struct FaceColour {
  enum class Kind { flat, interpolated, picture, checker, contours } kind = Kind::flat;
  Vec3 value;  // at `pixel`: linear RGB 0 to 1; texture place (u right, v down); position in mm
  Vec2 pixel;
  Eigen::Matrix<double, 3, 2> per_pixel;  // its change; 0 for a face that is only a line in the print
  Vec3 factor{1, 1, 1};                   // of a picture
  const LinearPicture* picture = nullptr;
  LinearPicture::Footprint footprint;

  Vec3 at(const Vec2& place) const { return value + per_pixel * (place - pixel); }
  bool has_edges_within() const { return kind == Kind::checker || kind == Kind::contours; }
};

/// Both show the same picture, and `place` (in pixels) at the same place of it within half a dot.
bool continues(const FaceColour& a, const FaceColour& b, const Vec2& place);

class ModelColours {
 public:
  /// `model` and `placed` (its mesh in machine coordinates, where patterns are drawn) must outlive this.
  /// `own_picture`: takes the place of the model's pictures; where the model names none, all faces with texture
  /// coordinates have it.
  /// Throws Error{invalid_input} with where = "colours" when the model does not have the colours that are asked for,
  /// "texture" for a picture without texture coordinates to lay it by, "mould" for a damaged picture within the model.
  ModelColours(const Model& model, const TriangleMesh& placed, const std::optional<Image>& own_picture,
               const ThermoformPrintOptions& options, Context& context);

  /// What was chosen: never automatic.
  PrintColours kind() const { return kind_; }
  const std::vector<std::string>& notes() const { return notes_; }

  /// Face `f` of the refined surface. `pixels`: its corners in the print, in pixels.
  FaceColour face(const RefinedSurface& surface, std::size_t f, const std::array<Vec2, 3>& pixels) const;

  /// At a place of the print, in pixels, that such a face covers.
  Light colour(const FaceColour& face, const Vec2& place) const;

 private:
  void load_pictures(const std::optional<Image>& own_picture, Context& context);
  const LinearPicture* picture_of(int face) const;

  const Model& model_;
  const TriangleMesh& placed_;
  double pattern_mm_;
  PrintColours kind_;
  std::vector<std::unique_ptr<LinearPicture>> pictures_;  // per texture of the model, or own_picture alone
  bool own_ = false;
  std::vector<std::string> notes_;
};

}  // namespace formwright
