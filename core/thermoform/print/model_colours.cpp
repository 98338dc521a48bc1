// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/print/model_colours.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "imaging/picture/light.h"
#include "imaging/picture/picture_reader.h"

namespace formwright {
namespace {

constexpr double line_share = 0.08;  // of the distance between two contours, half of each line's width
const Vec3 paper_colour(1, 1, 1), ink(0.02, 0.02, 0.02), checker_light(0.86, 0.78, 0.55),
    checker_dark(0.05, 0.12, 0.35);

Light light_of(const Vec3& unit) {
  Light light{};
  for (std::size_t k = 0; k < 3; ++k)
    light[k] = static_cast<float>(std::clamp(unit[static_cast<Eigen::Index>(k)], 0.0, 1.0) * light_levels);
  return light;
}

/// Blue in the valleys to red on the peaks, so that heights can be distinguished at a glance.
Vec3 height_colour(double height) {
  const double t = height - std::floor(height);
  return {0.35 + 0.6 * t, 0.75 - 0.35 * std::abs(2 * t - 1), 0.95 - 0.6 * t};
}

bool usable(const Model& model, const std::vector<std::unique_ptr<LinearPicture>>& pictures) {
  return model.FT.rows() > 0 && std::ranges::any_of(pictures, [](const auto& p) { return p != nullptr; });
}

}  // namespace

ModelColours::ModelColours(const Model& model, const TriangleMesh& placed, const std::optional<Image>& own_picture,
                           const ThermoformPrintOptions& options, Context& context)
    : model_(model), placed_(placed), pattern_mm_(options.pattern_mm), kind_(options.colours) {
  if (own_picture && model.FT.rows() == 0)
    throw Error(
        ErrorCode::invalid_input, "texture",
        "The model has no texture coordinates, which place a picture on it: use a model with them (OBJ, GLB or PLY), or no picture.");
  if (kind_ == PrintColours::automatic || kind_ == PrintColours::picture) load_pictures(own_picture, context);
  const bool painted =
      std::ranges::any_of(model.materials, [](const Material& m) { return !m.diffuse.isApprox(Material().diffuse); });
  if (kind_ == PrintColours::automatic)
    kind_ = usable(model, pictures_)          ? PrintColours::picture
            : model.vertex_colours.rows() > 0 ? PrintColours::vertex_colours
            : painted                         ? PrintColours::material_colours
                                              : PrintColours::checker;
  const auto refuse = [](const std::string& what) {
    throw Error(ErrorCode::invalid_input, "colours", "The model has no " + what + ": choose other colours.");
  };
  if (kind_ == PrintColours::picture && !usable(model, pictures_))
    refuse("picture to print (an OBJ needs its MTL and picture files beside it)");
  if (kind_ == PrintColours::vertex_colours && model.vertex_colours.rows() == 0) refuse("colours at its vertices");
  if (kind_ == PrintColours::material_colours && model.face_material.empty()) refuse("materials");
}

void ModelColours::load_pictures(const std::optional<Image>& own_picture, Context& context) {
  if (model_.FT.rows() == 0) return;
  // A picture whose coordinates stay within it is not tiled, and so must not bleed in from its other side.
  const bool repeat = model_.UV.minCoeff() < -1e-6 || model_.UV.maxCoeff() > 1 + 1e-6;
  if (own_picture) {
    pictures_.push_back(std::make_unique<LinearPicture>(*own_picture, repeat, context));
    own_ = true;
    return;
  }
  for (const Texture& texture : model_.textures) {
    pictures_.emplace_back();
    if (texture.bytes.empty())
      notes_.push_back("The picture " + texture.name + " that the model names was not given: give it as texture.");
    else
      pictures_.back() =
          std::make_unique<LinearPicture>(read_picture(texture.bytes, texture.name, "mould"), repeat, context);
  }
}

const LinearPicture* ModelColours::picture_of(int face) const {
  if (pictures_.empty() || model_.FT.row(face).minCoeff() < 0) return nullptr;
  // A model that names its pictures says by that which faces have one.
  if (own_ && (model_.textures.empty() || model_.face_material.empty())) return pictures_.front().get();
  if (model_.face_material.empty()) return pictures_.size() == 1 ? pictures_.front().get() : nullptr;
  const int material = model_.face_material[static_cast<std::size_t>(face)];
  const int texture = material < 0 ? -1 : model_.materials[static_cast<std::size_t>(material)].diffuse_texture;
  return texture < 0 ? nullptr : pictures_[own_ ? 0 : static_cast<std::size_t>(texture)].get();
}

bool continues(const FaceColour& a, const FaceColour& b, const Vec2& place) {
  if (a.picture == nullptr || a.picture != b.picture || a.factor != b.factor) return false;
  const Vec2 apart = (a.at(place) - b.at(place)).head<2>().cwiseProduct(Vec2(a.picture->width(), a.picture->height()));
  return apart.squaredNorm() < 0.25 * std::ldexp(1.0, 2 * a.footprint.level);
}

FaceColour ModelColours::face(const RefinedSurface& surface, std::size_t f, const std::array<Vec2, 3>& pixels) const {
  const int old = surface.face_of[f];
  FaceColour result;
  result.pixel = pixels[0];
  Eigen::Matrix2d dots;
  for (int k = 0; k < 2; ++k) dots.col(k) = pixels[static_cast<std::size_t>(k) + 1] - pixels[0];
  const bool is_line = !(std::abs(dots.determinant()) > 1e-9);
  const Eigen::Matrix2d per_dot = is_line ? Eigen::Matrix2d::Zero().eval() : dots.inverse().eval();
  const auto vary = [&](const auto& rows, const auto& indices) {
    std::array<Vec3, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) {
      const double b = static_cast<double>(surface.place[f][k].x()), c = static_cast<double>(surface.place[f][k].y());
      const auto value =
          ((1 - b - c) * rows.row(indices(old, 0)) + b * rows.row(indices(old, 1)) + c * rows.row(indices(old, 2)))
              .eval();
      corner[k].setZero();
      corner[k].head(value.size()) = value.transpose();
    }
    Eigen::Matrix<double, 3, 2> sides;
    for (int k = 0; k < 2; ++k) sides.col(k) = corner[static_cast<std::size_t>(k) + 1] - corner[0];
    result.value = is_line ? Vec3((corner[0] + corner[1] + corner[2]) / 3) : corner[0];
    result.per_pixel = sides * per_dot;
  };
  if (kind_ == PrintColours::checker || kind_ == PrintColours::contours) {
    result.kind = kind_ == PrintColours::checker ? FaceColour::Kind::checker : FaceColour::Kind::contours;
    vary(placed_.V, placed_.F);
    return result;
  }
  const int material = model_.face_material.empty() ? -1 : model_.face_material[static_cast<std::size_t>(old)];
  const Vec3 diffuse = material < 0 ? Vec3(paper_colour) : model_.materials[static_cast<std::size_t>(material)].diffuse;
  if (kind_ == PrintColours::picture)
    if (const LinearPicture* const picture = picture_of(old)) {
      result.kind = FaceColour::Kind::picture;
      result.picture = picture;
      result.factor = own_ ? Vec3(paper_colour) : Vec3(diffuse.cwiseMax(0).cwiseMin(1));
      vary(model_.UV, model_.FT);
      result.value.y() = 1 - result.value.y();
      result.per_pixel.row(1) *= -1;
      result.footprint =
          picture->footprint(Vec2(picture->width(), picture->height()).asDiagonal() * result.per_pixel.topRows<2>());
      return result;
    }
  result.per_pixel.setZero();
  if (kind_ != PrintColours::material_colours && model_.vertex_colours.rows() > 0) {
    result.kind = FaceColour::Kind::interpolated;
    vary(model_.vertex_colours, model_.mesh.F);
    return result;
  }
  result.value = diffuse;
  return result;
}

Light ModelColours::colour(const FaceColour& face, const Vec2& place) const {
  const Vec3 value = face.at(place);
  switch (face.kind) {
    case FaceColour::Kind::picture: {
      const Light factor{static_cast<float>(face.factor[0]), static_cast<float>(face.factor[1]),
                         static_cast<float>(face.factor[2]), 0};
      return face.picture->sample(value.head<2>(), face.footprint) * factor;
    }
    case FaceColour::Kind::checker: {
      double sum = 0;
      for (int k = 0; k < 3; ++k) sum += std::floor(value[k] / pattern_mm_ + (k == 2 ? 0.0 : 0.5));
      return light_of(std::fmod(std::abs(sum), 2.0) < 0.5 ? checker_light : checker_dark);
    }
    case FaceColour::Kind::contours: {
      const double height = value.z() / pattern_mm_;
      return light_of(std::abs(height - std::round(height)) < line_share ? ink : height_colour(height / 10));
    }
    default: return light_of(value);
  }
}

}  // namespace formwright
