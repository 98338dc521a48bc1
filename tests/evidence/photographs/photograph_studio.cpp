// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/photographs/photograph_studio.h"

#include <stb_image_write.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "base/parallel.h"
#include "base/random.h"
#include "imaging/picture/image.h"
#include "imaging/picture/png_writer.h"

namespace formwright::test {
namespace {

constexpr double paper_light = 0.82, ink_light = 0.03, frame_light = 0.25, table_light = 0.45;

Eigen::Matrix3d axes_of(const View& view) {
  const Vec3 forward = (view.at_mm - view.from_mm).normalized();
  Vec3 right = forward.cross(Vec3(0, 0, 1));
  if (right.norm() < 1e-6) right = Vec3(1, 0, 0);
  right.normalize();
  const Vec3 down = forward.cross(right);
  const double c = std::cos(view.roll_rad), s = std::sin(view.roll_rad);
  Eigen::Matrix3d axes;
  axes << (c * right + s * down).transpose(), (-s * right + c * down).transpose(), forward.transpose();
  return axes;
}

/// Marks by a grid of their own cells, to be found quickly.
class MarkTexture {
 public:
  explicit MarkTexture(const std::vector<PlacedMark>& marks) {
    for (const PlacedMark& mark : marks)
      for (int y = cell(mark.corner_mm(2).y()); y <= cell(mark.corner_mm(0).y()); ++y)
        for (int x = cell(mark.corner_mm(0).x()); x <= cell(mark.corner_mm(2).x()); ++x) marks_[{x, y}].push_back(mark);
  }
  double light(const Vec2& p) const {
    const auto found = marks_.find({cell(p.x()), cell(p.y())});
    if (found == marks_.end()) return paper_light;
    for (const PlacedMark& mark : found->second) {
      const Vec2 in = (p - mark.corner_mm(0)) / mark.side_mm * mark_cells;
      const int column = static_cast<int>(std::floor(in.x())), row = static_cast<int>(std::floor(-in.y()));
      if (column < 0 || row < 0 || column >= mark_cells || row >= mark_cells) continue;
      return mark_cell_is_white(mark.number, column, row) ? paper_light : ink_light;
    }
    return paper_light;
  }

 private:
  static int cell(double mm) { return static_cast<int>(std::floor(mm / 5)); }
  std::map<std::pair<int, int>, std::vector<PlacedMark>> marks_;
};

class Renderer {
 public:
  Renderer(const Scene& scene, const Phone& phone, const View& view)
      : scene_(scene), phone_(phone), view_(view), axes_(axes_of(view)), sheet_(scene.sheet.marks) {
    for (const BoardStrip& strip : scene.sheet.strips) strips_.emplace_back(strip.marks);
  }

  /// Linear light seen at a place in the picture.
  double light(const Vec2& picture_px) const {
    const double f = phone_.focal * std::max(phone_.width, phone_.height);
    const Vec2 centre = 0.5 * Vec2(phone_.width, phone_.height) + phone_.centre_off_px;
    const Vec2 distorted = (picture_px - centre) / f;
    Vec2 x = distorted;
    for (int i = 0; i < 12; ++i) {
      const double r2 = x.squaredNorm();
      x = distorted / (1 + phone_.k1 * r2 + phone_.k2 * r2 * r2);
    }
    const Vec3 direction = axes_.transpose() * Vec3(x.x(), x.y(), 1);
    return shade(direction);
  }

 private:
  double shade(const Vec3& d) const {
    const Vec3& o = view_.from_mm;
    if (d.z() >= -1e-6) return table_light;
    const Vec3 on_board = o + (scene_.board_z_mm - o.z()) / d.z() * d;
    const Vec2 half = 0.5 * scene_.sheet.opening_mm;
    const Vec2 b = on_board.head<2>();
    if (std::abs(b.x()) > half.x() || std::abs(b.y()) > half.y()) {
      if (std::abs(b.x()) > half.x() + 40 || std::abs(b.y()) > half.y() + 40) return table_light * evenness(b);
      return board_light(b) * evenness(b);
    }
    // The sheet, by Newton's method with a numerical slope along the ray.
    double t = (scene_.bump.base_mm + 0.5 * scene_.bump.peak_mm - o.z()) / d.z();
    const auto gap = [&](double s) {
      const Vec3 p = o + s * d;
      return p.z() - scene_.bump.height_mm(p.head<2>());
    };
    for (int i = 0; i < 8; ++i) {
      const double value = gap(t), slope = (gap(t + 0.01) - value) / 0.01;
      const double step = value / (slope < -1e-3 ? slope : -1e-3);
      t -= std::clamp(step, -30.0, 30.0);
      if (std::abs(step) < 1e-7) break;
    }
    const Vec3 p = o + t * d;
    if (std::abs(p.x()) > half.x() || std::abs(p.y()) > half.y()) return frame_light * 0.5;  // the frame's inner wall
    const Vec3 n = scene_.bump.normal(p.head<2>()), lamp = Vec3(-0.35, 0.3, 0.9).normalized();
    const double diffuse = 0.35 + 0.65 * std::max(0.0, n.dot(lamp));
    double value = sheet_.light(scene_.bump.sheet_mm(p.head<2>())) * diffuse * evenness(p.head<2>());
    if (scene_.gloss > 0) {
      const Vec3 bisector = (lamp - d.normalized()).normalized();
      value += scene_.gloss * 6 * std::pow(std::max(0.0, n.dot(bisector)), 400);
    }
    return value;
  }

  double board_light(const Vec2& b) const {
    if (!scene_.has_board) return frame_light;
    for (std::size_t k = 0; k < 4; ++k) {
      const BoardStrip& strip = scene_.sheet.strips[k];
      const Vec2 q = b - strip.origin_mm - scene_.strip_shift_mm[k];
      const double a = -(scene_.strip_turn_rad[k] + 0.5 * std::numbers::pi * strip.quarter_turns);
      const Vec2 own = Vec2(std::cos(a) * q.x() - std::sin(a) * q.y(), std::sin(a) * q.x() + std::cos(a) * q.y()) /
                       scene_.board_scale;
      if ((own - strip.lower_mm).minCoeff() < 0 || (strip.upper_mm - own).minCoeff() < 0) continue;
      return strips_[k].light(own);
    }
    return frame_light;
  }

  double evenness(const Vec2& p) const { return 1 - scene_.uneven * (0.5 + p.x() / 400); }

  const Scene& scene_;
  const Phone& phone_;
  const View& view_;
  Eigen::Matrix3d axes_;
  MarkTexture sheet_;
  std::vector<MarkTexture> strips_;
};

/// Averages along one axis with a Gaussian; the border repeats.
void blur(std::vector<float>& light, int width, int height, double sigma) {
  if (sigma <= 0) return;
  const int reach = static_cast<int>(std::ceil(3.5 * sigma));
  std::vector<double> weight;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) weight.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
  for (const double w : weight) sum += w;
  std::vector<float> other(light.size());
  for (const bool across : {true, false}) {
    parallel_for(static_cast<std::size_t>(height), 16, [&](std::size_t begin, std::size_t end) {
      for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
        for (int x = 0; x < width; ++x) {
          double value = 0;
          for (int i = -reach; i <= reach; ++i) {
            const int u = across ? std::clamp(x + i, 0, width - 1) : x,
                      v = across ? y : std::clamp(y + i, 0, height - 1);
            value +=
                weight[static_cast<std::size_t>(i + reach)] *
                static_cast<double>(
                    light[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u)]);
          }
          other[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
              static_cast<float>(value / sum);
        }
    });
    light.swap(other);
  }
}

double srgb_of(double light) { return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055; }

}  // namespace

double Bump::height_mm(const Vec2& p) const {
  const double u = p.squaredNorm() / (radius_mm * radius_mm);
  return base_mm + (u < 1 ? peak_mm * (1 - u) * (1 - u) : 0);
}

Vec3 Bump::normal(const Vec2& p) const {
  const double r2 = radius_mm * radius_mm, u = p.squaredNorm() / r2;
  const Vec2 slope = u < 1 ? Vec2(-4 * peak_mm * (1 - u) / r2 * p) : Vec2(0, 0);
  return Vec3(-slope.x(), -slope.y(), 1).normalized();
}

Vec2 Bump::sheet_mm(const Vec2& p) const {
  const double u = p.squaredNorm() / (radius_mm * radius_mm);
  return u < 1 ? Vec2(p * (1 - draw * (1 - u) * (1 - u))) : p;
}

Vec3 Bump::place_mm(const Vec2& s) const {
  double low = s.norm(), high = s.norm() / (1 - draw) + 1e-9;
  const Vec2 along = s.norm() > 0 ? Vec2(s / s.norm()) : Vec2(1, 0);
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (sheet_mm(middle * along).norm() < s.norm() ? low : high) = middle;
  }
  const Vec2 p = 0.5 * (low + high) * along;
  return {p.x(), p.y(), height_mm(p)};
}

std::vector<View> ring_of_views(int count, double distance_mm, double elevation_deg) {
  std::vector<View> views;
  for (int i = 0; i < count; ++i) {
    const double around = 2 * std::numbers::pi * (i + 0.15) / count;
    const double up = (elevation_deg + (i % 2 == 0 ? 0 : 14)) * std::numbers::pi / 180;
    views.push_back({distance_mm * Vec3(std::cos(around) * std::cos(up), std::sin(around) * std::cos(up), std::sin(up)),
                     Vec3(4 * std::cos(3 * around), 3 * std::sin(2 * around), 8),
                     0.15 * std::sin(5 * around) + (i % 3 == 2 ? 1.5 : 0)});
  }
  return views;
}

Vec2 pictured(const Phone& phone, const View& view, const Vec3& point_mm) {
  const Vec3 c = axes_of(view) * (point_mm - view.from_mm);
  const Vec2 x = c.head<2>() / c.z();
  const double r2 = x.squaredNorm();
  return 0.5 * Vec2(phone.width, phone.height) + phone.centre_off_px +
         phone.focal * std::max(phone.width, phone.height) * (1 + phone.k1 * r2 + phone.k2 * r2 * r2) * x;
}

Bytes photograph(const Scene& scene, const Phone& phone, const View& view, std::uint64_t seed) {
  const Renderer renderer(scene, phone, view);
  const int w = phone.width, h = phone.height, n = phone.samples;
  const int exposures = phone.motion_px.norm() > 0 ? 5 : 1;
  std::vector<float> light(static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
  parallel_for(static_cast<std::size_t>(h), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      for (int x = 0; x < w; ++x) {
        double sum = 0;
        for (int e = 0; e < exposures; ++e)
          for (int v = 0; v < n; ++v)
            for (int u = 0; u < n; ++u) {
              const Vec2 moved = exposures > 1 ? Vec2((e / (exposures - 1.0) - 0.5) * phone.motion_px) : Vec2(0, 0);
              sum += renderer.light(Vec2(x + (u + 0.5) / n, static_cast<double>(y) + (v + 0.5) / n) + moved);
            }
        light[y * static_cast<std::size_t>(w) + static_cast<std::size_t>(x)] =
            static_cast<float>(sum / (n * n * exposures));
      }
  });
  blur(light, w, h, phone.defocus_px);
  Image image(w, h, {0, 0, 0, 255});
  Random random(seed);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const double level = 255 * srgb_of(std::clamp(static_cast<double>(light[image.index(x, y)]), 0.0, 1.0));
      for (std::size_t k = 0; k < 3; ++k)
        image.at(phone.mirrored ? w - 1 - x : x, y)[k] =
            static_cast<std::uint8_t>(std::clamp(level + phone.noise_levels * random.normal() + 0.5, 0.0, 255.0));
    }
  if (phone.jpeg_quality == 0) return write_png(image, 0, Context());
  Bytes bytes;
  const auto append = [](void* out, void* data, int size) {
    const auto* const from = static_cast<const std::byte*>(data);
    static_cast<Bytes*>(out)->insert(static_cast<Bytes*>(out)->end(), from, from + size);
  };
  stbi_write_jpg_to_func(append, &bytes, w, h, 4, image.pixels.data(), phone.jpeg_quality);
  return bytes;
}

MarkSheet small_mark_sheet() {
  MarkSheetPlan plan;
  plan.sheet_mm = {216, 216};
  plan.opening_mm = {200, 200};
  return make_mark_sheet(plan);
}

}  // namespace formwright::test
