// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/samples/render.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/parallel.h"
#include "geometry/mesh/adjacency.h"

namespace formwright::test {
namespace {

constexpr int oversampling = 3;
constexpr double far_away = -std::numeric_limits<double>::infinity();

std::size_t index(Eigen::Index i) { return static_cast<std::size_t>(i); }

double srgb_of(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}
double linear_of(double srgb) { return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4); }

/// Normals per corner: the mean of the faces around that turn by less than the crease angle.
Positions corner_normals(const TriangleMesh& mesh, double crease_deg) {
  Positions face(mesh.F.rows(), 3);
  std::vector<std::vector<int>> around(index(mesh.V.rows()));
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)), c = mesh.V.row(mesh.F(f, 2));
    face.row(f) = (b - a).cross(c - a);
    for (int k = 0; k < 3; ++k) around[index(mesh.F(f, k))].push_back(f);
  }
  const double minimum = std::cos(crease_deg * std::numbers::pi / 180);
  Positions result(3 * mesh.F.rows(), 3);
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) {
      Vec3 sum = Vec3::Zero();
      for (int g : around[index(mesh.F(f, k))])
        if (face.row(g).dot(face.row(f)) >= minimum * face.row(g).norm() * face.row(f).norm()) sum += face.row(g);
      result.row(3 * f + k) = sum.normalized();
    }
  return result;
}

/// A parallel camera: right, up, towards the viewer.
struct Camera {
  Vec3 right, up, back;
  Camera(const Vec3& direction, const Vec3& upright) : back(-direction.normalized()) {
    right = upright.cross(back).normalized();
    up = back.cross(right);
  }
  Vec3 see(const Vec3& p) const { return {right.dot(p), up.dot(p), back.dot(p)}; }
};

/// What is in front in each pixel.
struct Frame {
  int width, height;
  double scale, x0, y0;  // pixels a mm; the picture's left and upper side, mm
  std::vector<double> depth;
  std::vector<int> face;
  std::vector<float> u, v;  // barycentric

  Frame(int w, int h, double s, double left, double top)
      : width(w),
        height(h),
        scale(s),
        x0(left),
        y0(top),
        depth(index(w) * index(h), far_away),
        face(depth.size(), -1),
        u(depth.size()),
        v(depth.size()) {}
  double column(double x) const { return (x - x0) * scale; }
  double row(double y) const { return (y0 - y) * scale; }

  void draw(const TriangleMesh& mesh, const Camera& camera) {
    for (int f = 0; f < mesh.face_count(); ++f) {
      Vec3 p[3];
      for (int k = 0; k < 3; ++k) {
        p[k] = camera.see(mesh.V.row(mesh.F(f, k)));
        p[k].x() = column(p[k].x()), p[k].y() = row(p[k].y());
      }
      const double twice =
          (p[1].x() - p[0].x()) * (p[2].y() - p[0].y()) - (p[1].y() - p[0].y()) * (p[2].x() - p[0].x());
      if (std::abs(twice) < 1e-12) continue;
      const auto range = [&](int axis, int size) {
        const double low = std::min({p[0][axis], p[1][axis], p[2][axis]}),
                     high = std::max({p[0][axis], p[1][axis], p[2][axis]});
        return std::pair{std::max(0, static_cast<int>(std::floor(low - 0.5))),
                         std::min(size - 1, static_cast<int>(std::ceil(high)))};
      };
      const auto [left, right] = range(0, width);
      const auto [top, bottom] = range(1, height);
      for (int j = top; j <= bottom; ++j)
        for (int i = left; i <= right; ++i) {
          const double x = i + 0.5 - p[0].x(), y = j + 0.5 - p[0].y();
          const double s = (x * (p[2].y() - p[0].y()) - y * (p[2].x() - p[0].x())) / twice;
          const double t = ((p[1].x() - p[0].x()) * y - (p[1].y() - p[0].y()) * x) / twice;
          if (s < -1e-9 || t < -1e-9 || s + t > 1 + 1e-9) continue;
          const double z = p[0].z() + s * (p[1].z() - p[0].z()) + t * (p[2].z() - p[0].z());
          const std::size_t at = index(j) * index(width) + index(i);
          if (z <= depth[at]) continue;
          depth[at] = z, face[at] = f, u[at] = static_cast<float>(s), v[at] = static_cast<float>(t);
        }
    }
  }
};

/// How much of the lamp reaches a point: a shadow map, softened over some of its pixels.
class Shadow {
 public:
  Shadow(const TriangleMesh& mesh, const Vec3& lamp, const Vec3& up)
      : camera_(-lamp, std::abs(lamp.normalized().dot(up)) > 0.99 ? Vec3(1, 0.1, 0) : up), frame_(fitted(mesh)) {
    frame_.draw(mesh, camera_);
  }
  double lit(const Vec3& p) const {
    constexpr int reach = 4;
    const Vec3 q = camera_.see(p);
    const int i = static_cast<int>(frame_.column(q.x())), j = static_cast<int>(frame_.row(q.y()));
    int open = 0, all = 0;
    for (int y = j - reach; y <= j + reach; ++y)
      for (int x = i - reach; x <= i + reach; ++x, ++all) {
        if (x < 0 || y < 0 || x >= frame_.width || y >= frame_.height) {
          ++open;
          continue;
        }
        // The tolerance grows with the distance from the middle: a slope is not its own shadow.
        const double slack = (1.0 + 1.6 * std::hypot(x - i, y - j)) / frame_.scale;
        open += frame_.depth[index(y) * index(frame_.width) + index(x)] <= q.z() + slack ? 1 : 0;
      }
    return static_cast<double>(open) / all;
  }

 private:
  Frame fitted(const TriangleMesh& mesh) const {
    Vec3 low = Vec3::Constant(1e30), high = -low;
    for (int v = 0; v < mesh.vertex_count(); ++v) {
      const Vec3 q = camera_.see(mesh.V.row(v));
      low = low.cwiseMin(q), high = high.cwiseMax(q);
    }
    const double scale = 1000 / std::max(high.x() - low.x(), high.y() - low.y());
    return {static_cast<int>((high.x() - low.x()) * scale) + 2, static_cast<int>((high.y() - low.y()) * scale) + 2,
            scale, low.x(), high.y()};
  }
  Camera camera_;
  Frame frame_;
};

class Shader {
 public:
  Shader(const Model& model, const RenderOptions& options)
      : model_(model),
        options_(options),
        camera_(options.view_direction, options.view_up),
        lamp_((camera_.right * options.lamp.x() + camera_.up * options.lamp.y() + camera_.back * options.lamp.z())
                  .normalized()),
        frame_(fitted()),
        shadow_(model.mesh, lamp_, camera_.up),
        normals_(corner_normals(model.mesh, options.crease_deg)) {
    if (!model.textures.empty()) texture_ = decode_png(model.textures[0].bytes);
    floor_ = model.mesh.V.col(1).minCoeff();
    frame_.draw(model.mesh, camera_);
  }

  RgbPicture picture() const {
    RgbPicture result{options_.width, options_.height,
                      std::vector<std::uint8_t>(3 * index(options_.width) * index(options_.height))};
    parallel_for(index(options_.height), 4, [&](std::size_t from, std::size_t to) {
      for (std::size_t j = from; j < to; ++j)
        for (int i = 0; i < options_.width; ++i) {
          Vec3 sum = Vec3::Zero();
          for (int y = 0; y < oversampling; ++y)
            for (int x = 0; x < oversampling; ++x)
              sum += pixel(oversampling * i + x, oversampling * static_cast<int>(j) + y);
          for (int c = 0; c < 3; ++c)
            result.bytes[3 * (j * index(options_.width) + index(i)) + index(c)] = static_cast<std::uint8_t>(
                255 * std::clamp(srgb_of(sum[c] / (oversampling * oversampling)), 0.0, 1.0) + 0.5);
        }
    });
    return result;
  }

 private:
  Frame fitted() const {
    Vec3 low = Vec3::Constant(1e30), high = -low;
    for (int v = 0; v < model_.mesh.vertex_count(); ++v) {
      const Vec3 q = camera_.see(model_.mesh.V.row(v));
      low = low.cwiseMin(q), high = high.cwiseMax(q);
    }
    const int w = oversampling * options_.width, h = oversampling * options_.height;
    const double scale = options_.millimetres_across > 0
                             ? w / options_.millimetres_across
                             : 0.9 * std::min(w / (high.x() - low.x()), h / (high.y() - low.y()));
    return {w, h, scale, (low.x() + high.x()) / 2 - 0.5 * w / scale, (low.y() + high.y()) / 2 + 0.5 * h / scale};
  }

  Vec3 place(int i, int j, double z) const {
    return camera_.right * (frame_.x0 + (i + 0.5) / frame_.scale) +
           camera_.up * (frame_.y0 - (j + 0.5) / frame_.scale) + camera_.back * z;
  }

  /// Share of the sky that the pixels around leave open.
  double open_sky(int i, int j, double z, double reach_mm) const {
    double closed = 0, all = 0;
    for (int k = 0; k < 48; ++k) {
      const double angle = 2.399963 * k, r = reach_mm * frame_.scale * std::sqrt((k + 0.5) / 48);
      const int x = i + static_cast<int>(std::lround(r * std::cos(angle))),
                y = j + static_cast<int>(std::lround(r * std::sin(angle)));
      all += 1;
      if (x < 0 || y < 0 || x >= frame_.width || y >= frame_.height) continue;
      const double rise = frame_.depth[index(y) * index(frame_.width) + index(x)] - z,
                   run = std::max(1.0, r) / frame_.scale;
      if (rise > 0.25 * run) closed += std::min(1.0, rise / run) * (rise < 3 * reach_mm ? 1.0 : 3 * reach_mm / rise);
    }
    return 1 - 0.8 * closed / all;
  }

  Vec3 colour(int f, double s, double t) const {
    const double w[3] = {1 - s - t, s, t};
    Vec3 sum = Vec3::Zero();
    if (!options_.use_colours) return {0.62, 0.60, 0.56};
    if (!texture_.bytes.empty()) {
      Vec2 uv = Vec2::Zero();
      for (int k = 0; k < 3; ++k) uv += w[k] * model_.UV.row(model_.FT(f, k)).transpose();
      const std::uint8_t* p =
          texture_.pixel(std::clamp(static_cast<int>(uv.x() * texture_.width), 0, texture_.width - 1),
                         std::clamp(static_cast<int>((1 - uv.y()) * texture_.height), 0, texture_.height - 1));
      return {linear_of(p[0] / 255.0), linear_of(p[1] / 255.0), linear_of(p[2] / 255.0)};
    }
    if (model_.vertex_colours.rows() == 0) return {0.62, 0.60, 0.56};
    for (int k = 0; k < 3; ++k) sum += w[k] * Vec3(model_.vertex_colours.row(model_.mesh.F(f, k)));
    return sum;
  }

  Vec3 pixel(int i, int j) const {
    const std::size_t at = index(j) * index(frame_.width) + index(i);
    const int f = frame_.face[at];
    if (f < 0) {
      if (!options_.floor || camera_.back.y() < 0.02) return options_.background;
      // Where the line of sight meets the floor.
      const Vec3 p0 = place(i, j, 0);
      const double z = (floor_ - p0.y()) / camera_.back.y();
      const Vec3 p = place(i, j, z);
      return options_.background * (1 - 0.30 * (1 - shadow_.lit(p)));
    }
    const double s = frame_.u[at], t = frame_.v[at], z = frame_.depth[at];
    const Vec3 normal =
        (normals_.row(3 * f) * (1 - s - t) + normals_.row(3 * f + 1) * s + normals_.row(3 * f + 2) * t).normalized();
    const Vec3 p = place(i, j, z);
    const double facing = normal.dot(lamp_), key = facing > 0 ? facing * shadow_.lit(p + 0.3 * normal) : 0;
    const double fill =
        0.5 + 0.5 * normal.dot((camera_.up * 0.8 + camera_.right * 0.5 + camera_.back * 0.3).normalized());
    const double sky = open_sky(i, j, z, 5) * open_sky(i, j, z, 1.5);
    const Vec3 half = (lamp_ + camera_.back).normalized();
    const double gloss = facing > 0 ? std::pow(std::max(0.0, normal.dot(half)), 40) * shadow_.lit(p) : 0;
    return colour(f, s, t) * (1.05 * key + sky * (0.16 + 0.30 * fill)) + Vec3::Constant(0.06 * gloss);
  }

  const Model& model_;
  RenderOptions options_;
  Camera camera_;
  Vec3 lamp_;
  Frame frame_;
  Shadow shadow_;
  Positions normals_;
  RgbPicture texture_;
  double floor_ = 0;
};

}  // namespace

RgbPicture render(const Model& model, const RenderOptions& options) { return Shader(model, options).picture(); }

void paste(RgbPicture& sheet, const RgbPicture& tile, int x, int y) {
  for (int j = 0; j < tile.height; ++j)
    std::copy_n(tile.pixel(0, j), 3 * tile.width, &sheet.bytes[3 * (index(y + j) * index(sheet.width) + index(x))]);
}

RgbPicture blank_picture(int width, int height, const Vec3& linear_colour) {
  RgbPicture picture{width, height, {}};
  for (std::size_t k = 0; k < index(width) * index(height); ++k)
    for (int c = 0; c < 3; ++c)
      picture.bytes.push_back(static_cast<std::uint8_t>(255 * srgb_of(linear_colour[c]) + 0.5));
  return picture;
}

}  // namespace formwright::test
