// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/registration/scan_picture.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "geometry/planar/plane.h"
#include "base/error.h"
#include "base/parallel.h"
#include "imaging/picture/light.h"
#include "imaging/picture/picture_reader.h"

namespace formwright {
namespace {

constexpr int band_rows = 32;

}  // namespace

ScanColours::ScanColours(const Model& model, const Context& context) : model_(model) {
  if (model.FT.rows() == model.mesh.F.rows() && model.UV.rows() > 0)
    for (const Texture& texture : model.textures) {
      Sheet sheet;
      if (!texture.bytes.empty()) {
        sheet.image = read_picture(texture.bytes, texture.name, "texture");
        sheet.picture = std::make_unique<LinearPicture>(sheet.image, false, context);
      }
      sheets_.push_back(std::move(sheet));
    }
  bool any = model.vertex_colours.rows() > 0;
  for (const Sheet& sheet : sheets_) any = any || sheet.picture;
  if (!any)
    throw Error(ErrorCode::invalid_input, "scan",
                "The scan has no colours: give its picture as texture, and the material file of an OBJ.");
}

const ScanColours::Sheet* ScanColours::sheet_of(int face) const {
  if (sheets_.empty()) return nullptr;
  int texture = sheets_.size() == 1 ? 0 : -1;
  if (!model_.face_material.empty()) {
    const int material = model_.face_material[static_cast<std::size_t>(face)];
    if (material >= 0) texture = model_.materials[static_cast<std::size_t>(material)].diffuse_texture;
  }
  if (texture < 0 || !sheets_[static_cast<std::size_t>(texture)].picture) return nullptr;
  return &sheets_[static_cast<std::size_t>(texture)];
}

int ScanColours::width(int face) const { return sheet_of(face) ? sheet_of(face)->image.width : 0; }
int ScanColours::height(int face) const { return sheet_of(face) ? sheet_of(face)->image.height : 0; }

LinearPicture::Footprint ScanColours::footprint(int face, const std::array<Vec2, 3>& pixels) const {
  const Sheet* sheet = sheet_of(face);
  if (!sheet) return {};
  Eigen::Matrix2d edges, change;
  edges << pixels[1] - pixels[0], pixels[2] - pixels[0];
  const Vec2 a = model_.UV.row(model_.FT(face, 0)), b = model_.UV.row(model_.FT(face, 1)),
             c = model_.UV.row(model_.FT(face, 2));
  change << b - a, c - a;
  change.row(0) *= sheet->image.width;
  change.row(1) *= -sheet->image.height;
  if (!(std::abs(edges.determinant()) > 1e-12)) return {};
  return sheet->picture->footprint(change * edges.inverse());
}

Float4 ScanColours::at(int face, const Vec3& barycentric, const LinearPicture::Footprint& footprint) const {
  if (const Sheet* sheet = sheet_of(face)) {
    Vec2 uv = Vec2::Zero();
    for (int k = 0; k < 3; ++k) uv += barycentric[k] * model_.UV.row(model_.FT(face, k)).transpose();
    const Vec2 place(uv.x(), 1 - uv.y());
    const Image& image = sheet->image;
    const int x = std::clamp(static_cast<int>(std::floor(place.x() * image.width)), 0, image.width - 1);
    const int y = std::clamp(static_cast<int>(std::floor(place.y() * image.height)), 0, image.height - 1);
    if (image.at(x, y)[3] < 255) return Float4{};
    Float4 light = sheet->picture->sample(place, footprint) * static_cast<float>(1 / light_levels);
    light[3] = 1;
    return light;
  }
  if (model_.vertex_colours.rows() == 0) return Float4{};
  Vec3 colour = Vec3::Zero();
  for (int k = 0; k < 3; ++k) colour += barycentric[k] * model_.vertex_colours.row(model_.mesh.F(face, k)).transpose();
  return Float4{static_cast<float>(colour.x()), static_cast<float>(colour.y()), static_cast<float>(colour.z()), 1.0f};
}

WeightedPicture draw_scan(const Model& model, const ScanColours& colours, const TextureCoordinates& place_mm,
                          const PlaneFrame& frame, const Context& context) {
  WeightedPicture picture(frame.width, frame.height);
  const Triangles& F = model.mesh.F;
  const int bands = (frame.height + band_rows - 1) / band_rows;
  std::vector<std::vector<int>> faces_of(static_cast<std::size_t>(bands));
  std::vector<std::array<Vec2, 3>> corner(static_cast<std::size_t>(F.rows()));
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    auto& c = corner[static_cast<std::size_t>(f)];
    for (int k = 0; k < 3; ++k) c[static_cast<std::size_t>(k)] = frame.pixel(place_mm.row(F(f, k)).transpose());
    if (!(cross(c[1] - c[0], c[2] - c[0]) < 0)) continue;  // rows run down, so an upright face is clockwise
    const double top = std::min({c[0].y(), c[1].y(), c[2].y()}), bottom = std::max({c[0].y(), c[1].y(), c[2].y()});
    const double left = std::min({c[0].x(), c[1].x(), c[2].x()}), right = std::max({c[0].x(), c[1].x(), c[2].x()});
    if (!(bottom >= 0 && top <= frame.height && right >= 0 && left <= frame.width)) continue;
    const int from = std::clamp(static_cast<int>(std::max(0.0, top)) / band_rows, 0, bands - 1),
              to = std::clamp(static_cast<int>(std::min<double>(frame.height, bottom)) / band_rows, 0, bands - 1);
    for (int b = from; b <= to; ++b) faces_of[static_cast<std::size_t>(b)].push_back(static_cast<int>(f));
  }
  parallel_for(static_cast<std::size_t>(bands), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t band = begin; band < end; ++band) {
      context.check_cancelled();
      const int row_from = static_cast<int>(band) * band_rows,
                row_to = std::min(frame.height, row_from + band_rows) - 1;
      std::vector<char> drawn(static_cast<std::size_t>(frame.width) * band_rows, 0);
      for (const int f : faces_of[band]) {
        const auto& c = corner[static_cast<std::size_t>(f)];
        const double doubled = cross(c[1] - c[0], c[2] - c[0]);
        const LinearPicture::Footprint footprint = colours.footprint(f, c);
        const int y0 =
            std::max(row_from, static_cast<int>(std::ceil(std::max(-1.0, std::min({c[0].y(), c[1].y(), c[2].y()})))));
        const int y1 = std::min(
            row_to,
            static_cast<int>(std::floor(std::min<double>(frame.height, std::max({c[0].y(), c[1].y(), c[2].y()})))));
        const int x0 =
            std::max(0, static_cast<int>(std::ceil(std::max(-1.0, std::min({c[0].x(), c[1].x(), c[2].x()})))));
        const int x1 = std::min(
            frame.width - 1,
            static_cast<int>(std::floor(std::min<double>(frame.width, std::max({c[0].x(), c[1].x(), c[2].x()})))));
        for (int y = y0; y <= y1; ++y)
          for (int x = x0; x <= x1; ++x) {
            const Vec2 p(x, y);
            const Vec3 bary(cross(c[1] - p, c[2] - p) / doubled, cross(c[2] - p, c[0] - p) / doubled,
                            cross(c[0] - p, c[1] - p) / doubled);
            if (!(bary.minCoeff() >= -1e-9)) continue;
            char& seen = drawn[static_cast<std::size_t>(y - row_from) * static_cast<std::size_t>(frame.width) +
                               static_cast<std::size_t>(x)];
            if (seen) continue;
            seen = 1;
            picture.at(x, y) = colours.at(f, bary, footprint);
          }
      }
    }
  });
  return picture;
}

PlaneLookup::PlaneLookup(const Triangles& faces, const TextureCoordinates& place_mm)
    : faces_(faces), place_mm_(place_mm) {
  lower_ = place_mm.colwise().minCoeff();
  const Vec2 size = place_mm.colwise().maxCoeff().transpose() - lower_;
  cell_mm_ = std::max(1e-9, std::sqrt(std::max(size.x() * size.y(), 1e-12) / static_cast<double>(faces.rows()) * 2));
  columns_ = std::clamp(static_cast<int>(size.x() / cell_mm_) + 1, 1, 4096);
  rows_ = std::clamp(static_cast<int>(size.y() / cell_mm_) + 1, 1, 4096);
  cell_mm_ = std::max({cell_mm_, size.x() / columns_, size.y() / rows_});
  const auto over_cells = [&](Eigen::Index f, const auto& visit) {
    Vec2 low = place_mm.row(faces(f, 0)), high = low;
    for (int k = 1; k < 3; ++k) {
      low = low.cwiseMin(place_mm.row(faces(f, k)).transpose());
      high = high.cwiseMax(place_mm.row(faces(f, k)).transpose());
    }
    const auto at = [&](double place, double from, int count) {
      return std::clamp(static_cast<int>((place - from) / cell_mm_), 0, count - 1);
    };
    for (int y = at(low.y(), lower_.y(), rows_); y <= at(high.y(), lower_.y(), rows_); ++y)
      for (int x = at(low.x(), lower_.x(), columns_); x <= at(high.x(), lower_.x(), columns_); ++x)
        visit(static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x));
  };
  first_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) over_cells(f, [&](std::size_t cell) { ++first_[cell + 1]; });
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  items_.resize(static_cast<std::size_t>(first_.back()));
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (Eigen::Index f = 0; f < faces.rows(); ++f)
    over_cells(f, [&](std::size_t cell) { items_[static_cast<std::size_t>(next[cell]++)] = static_cast<int>(f); });
}

PlaneLookup::Found PlaneLookup::find(const Vec2& place) const {
  const Vec2 at = (place - lower_) / cell_mm_;
  if (!(at.x() >= 0 && at.y() >= 0 && at.x() <= columns_ && at.y() <= rows_)) return {-1, Vec3::Zero()};
  const std::size_t cell =
      static_cast<std::size_t>(std::min(static_cast<int>(at.y()), rows_ - 1)) * static_cast<std::size_t>(columns_) +
      static_cast<std::size_t>(std::min(static_cast<int>(at.x()), columns_ - 1));
  for (int i = first_[cell]; i < first_[cell + 1]; ++i) {
    const int f = items_[static_cast<std::size_t>(i)];
    const Vec2 a = place_mm_.row(faces_(f, 0)), b = place_mm_.row(faces_(f, 1)), c = place_mm_.row(faces_(f, 2));
    const double doubled = cross(b - a, c - a);
    if (!(doubled > 0)) continue;
    const Vec3 bary(cross(b - place, c - place) / doubled, cross(c - place, a - place) / doubled,
                    cross(a - place, b - place) / doubled);
    if (bary.minCoeff() >= -1e-9) return {f, bary};
  }
  return {-1, Vec3::Zero()};
}

}  // namespace formwright
