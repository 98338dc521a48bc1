// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Scans with known truth: a pattern painted on a formed sheet, photographed by an imperfect camera, in triangles and an
// atlas of its own.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "evidence/registration/scan_registration.h"
#include "formats/shared/colour.h"
#include "imaging/picture/png_writer.h"
#include "imaging/picture/weighted_picture.h"

namespace formwright::test {

/// Where a point of the flat sheet went; the upper face, machine coordinates.
using FormedSurface = std::function<Vec3(const Vec2&)>;

/// A smooth dome over a flat rim: the sheet also slides inwards by up to `slide_mm`.
inline FormedSurface dome(double radius_mm, double height_mm, double slide_mm) {
  return [=](const Vec2& s) {
    const double r = s.norm(), share = r / radius_mm;
    if (share >= 1) return Vec3(s.x(), s.y(), 1.5);
    const double slid = r + slide_mm * std::sin(3.14159265358979 * share) * std::sin(3.14159265358979 * share);
    const double bowl = 1 - (slid / radius_mm) * (slid / radius_mm);
    const Vec2 p = r > 0 ? Vec2(s * (slid / r)) : Vec2(0, 0);
    return Vec3(p.x(), p.y(), 1.5 + height_mm * bowl * bowl);
  };
}

struct ScanCamera {
  double noise_levels = 3;  // of sRGB
  double blur_px = 0.8;     // of the texture
  double lighting = 0.35;   // brighter on one side by this share, darker at the rim
  bool colour_cast = true;
  int missing_patches = 0;  // transparent discs
  int wrong_patches = 0;    // discs of one grey, as a reconstruction fills what it has not seen
  double patch_mm = 8;      // radius of both
  double shape_noise_mm = 0;
  int texture_px = 2400;
  double spacing_mm = 2;  // of the scan's vertices
  bool turned = true;     // in coordinates of the scanner's own
  bool inwards = false;   // faces look down
  unsigned seed = 1;
};

/// The whole sheet, rim included, as a model with one PNG; charts of an atlas of 2 x 2, each turned another way.
inline Model virtual_scan(const FormedSurface& surface, const CalibrationPattern& pattern, const ScanCamera& camera) {
  const Context context;
  std::mt19937 random(camera.seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1, 1);
  const int columns = 2 * std::max(2, static_cast<int>(pattern.sheet_mm.x() / camera.spacing_mm / 2)),
            rows = 2 * std::max(2, static_cast<int>(pattern.sheet_mm.y() / camera.spacing_mm / 2));
  const Vec2 step(pattern.sheet_mm.x() / columns, pattern.sheet_mm.y() / rows);
  Model model;
  std::vector<Vec2> sheet;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      Vec2 s(-pattern.sheet_mm.x() / 2 + i * step.x(), -pattern.sheet_mm.y() / 2 + j * step.y());
      const bool inside = i > 0 && j > 0 && i < columns && j < rows;
      if (inside) s += 0.2 * Vec2(step.x() * uniform(random), step.y() * uniform(random));
      sheet.push_back(s);
    }
  model.mesh.V.resize(static_cast<Eigen::Index>(sheet.size()), 3);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Vec3 shift = Vec3::Zero();
  if (camera.turned) {
    turn = (Eigen::AngleAxisd(2.2, Vec3::UnitZ()) * Eigen::AngleAxisd(0.4, Vec3(1, 0.3, 0).normalized()))
               .toRotationMatrix();
    shift = {300, -120, 55};
  }
  for (std::size_t v = 0; v < sheet.size(); ++v) {
    Vec3 p = surface(sheet[v]);
    for (int k = 0; k < 3; ++k) p[k] += camera.shape_noise_mm * normal(random);
    model.mesh.V.row(static_cast<Eigen::Index>(v)) = turn * p + shift;
  }
  // Chart (a, b) covers a quarter of the sheet, with a margin; its own axes are turned by quarter turns.
  const double margin_mm = 3, chart_mm = 0.5 * pattern.sheet_mm.maxCoeff() + 2 * margin_mm;
  const auto chart_middle = [&](int a, int b) {
    return Vec2((a - 0.5) * pattern.sheet_mm.x() / 2, (b - 0.5) * pattern.sheet_mm.y() / 2);
  };
  const auto quarter = [](const Vec2& p, int turns) {
    Vec2 q = p;
    for (int k = 0; k < turns; ++k) q = Vec2(-q.y(), q.x());
    return q;
  };
  const auto uv = [&](const Vec2& s, int a, int b) {
    const Vec2 local = quarter(s - chart_middle(a, b), a + 2 * b) / chart_mm;  // -0.5 to 0.5
    return Vec2((a + 0.5 + local.x()) / 2, (b + 0.5 + local.y()) / 2);
  };
  std::vector<Vec2> coordinates;
  model.mesh.F.resize(2 * columns * rows, 3);
  model.FT.resize(2 * columns * rows, 3);
  int f = 0;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const int a = i < columns / 2 ? 0 : 1, b = j < rows / 2 ? 0 : 1;
      const int v0 = j * (columns + 1) + i, v1 = v0 + 1, v2 = v0 + columns + 2, v3 = v0 + columns + 1;
      const bool other = (i + j) % 2 == 0;
      const std::array<std::array<int, 3>, 2> two =
          other ? std::array<std::array<int, 3>, 2>{{{v0, v1, v2}, {v0, v2, v3}}}
                : std::array<std::array<int, 3>, 2>{{{v0, v1, v3}, {v1, v2, v3}}};
      for (const auto& t : two) {
        for (int k = 0; k < 3; ++k) {
          const int corner = camera.inwards ? t[static_cast<std::size_t>(2 - k)] : t[static_cast<std::size_t>(k)];
          model.mesh.F(f, k) = corner;
          model.FT(f, k) = static_cast<int>(coordinates.size());
          coordinates.push_back(uv(sheet[static_cast<std::size_t>(corner)], a, b));
        }
        ++f;
      }
    }
  model.UV.resize(static_cast<Eigen::Index>(coordinates.size()), 2);
  for (std::size_t i = 0; i < coordinates.size(); ++i) model.UV.row(static_cast<Eigen::Index>(i)) = coordinates[i];

  // The texture, texel by texel.
  const double pixel_mm = chart_mm * 2 / camera.texture_px / 2;
  const int width = static_cast<int>((pattern.sheet_mm.x() + 10) / pixel_mm),
            height = static_cast<int>((pattern.sheet_mm.y() + 10) / pixel_mm);
  const WeightedPicture print = weighted_picture(draw_calibration_pattern(pattern, width, height, pixel_mm, context));
  std::vector<Vec2> missing, wrong;
  const auto somewhere = [&] {
    return Vec2(0.42 * pattern.opening_mm.x() * uniform(random), 0.42 * pattern.opening_mm.y() * uniform(random));
  };
  for (int k = 0; k < camera.missing_patches; ++k) missing.push_back(somewhere());
  for (int k = 0; k < camera.wrong_patches; ++k) wrong.push_back(somewhere());
  const auto in_any = [&](const std::vector<Vec2>& discs, const Vec2& s) {
    return std::any_of(discs.begin(), discs.end(), [&](const Vec2& d) { return (d - s).norm() < camera.patch_mm; });
  };
  WeightedPicture seen(camera.texture_px, camera.texture_px);
  for (int y = 0; y < camera.texture_px; ++y)
    for (int x = 0; x < camera.texture_px; ++x) {
      const double u = (x + 0.5) / camera.texture_px * 2, v = (1 - (y + 0.5) / camera.texture_px) * 2;
      const int a = u < 1 ? 0 : 1, b = v < 1 ? 0 : 1;
      const Vec2 s = chart_middle(a, b) + chart_mm * quarter(Vec2(u - a - 0.5, v - b - 0.5), (8 - (a + 2 * b)) % 4);
      Float4 colour = bicubic(print, static_cast<float>(0.5 * width + s.x() / pixel_mm - 0.5),
                              static_cast<float>(0.5 * height - s.y() / pixel_mm - 0.5));
      if (in_any(wrong, s)) colour = Float4{120, 120, 120, 1};
      colour[3] = in_any(missing, s) ? 0.0f : 1.0f;
      seen.at(x, y) = colour;
    }
  seen = smoothed(seen, camera.blur_px, context);
  Image image(camera.texture_px, camera.texture_px, {0, 0, 0, 0});
  for (int y = 0; y < camera.texture_px; ++y)
    for (int x = 0; x < camera.texture_px; ++x) {
      const double u = (x + 0.5) / camera.texture_px * 2, v = (1 - (y + 0.5) / camera.texture_px) * 2;
      const int a = u < 1 ? 0 : 1, b = v < 1 ? 0 : 1;
      const Vec2 s = chart_middle(a, b) + chart_mm * quarter(Vec2(u - a - 0.5, v - b - 0.5), (8 - (a + 2 * b)) % 4);
      const Vec2 across = s.cwiseQuotient(pattern.sheet_mm / 2);
      const double light =
          0.75 * (1 + camera.lighting * (0.6 * across.x() + 0.3 * across.y() - 0.3 * across.squaredNorm()));
      const Float4& p = seen.at(x, y);
      if (p[3] < 0.5f) continue;
      Vec3 c;
      for (int k = 0; k < 3; ++k) c[k] = light * linear_of_srgb(static_cast<double>(p[k]) / 255);
      if (camera.colour_cast) {
        Eigen::Matrix3d cast;
        cast << 1.05, 0.08, 0.0, 0.04, 0.9, 0.05, 0.0, 0.1, 0.7;
        c = cast * c + Vec3(0.01, 0.015, 0.02);
      }
      Rgba& pixel = image.at(x, y);
      for (int k = 0; k < 3; ++k)
        pixel[static_cast<std::size_t>(k)] = static_cast<std::uint8_t>(
            std::clamp(std::lround(255 * srgb_of_linear(c[k]) + camera.noise_levels * normal(random)), 0l, 255l));
      pixel[3] = 255;
    }
  model.textures.push_back({"scan.png", "image/png", write_png(image, 0, context)});
  model.materials.push_back({"scan", Vec3(1, 1, 1), 0});
  model.face_material.assign(static_cast<std::size_t>(f), 0);
  return model;
}

struct RecoveredError {
  std::size_t points = 0;
  double median_mm = 0, percentile_95_mm = 0, maximum_mm = 0;
  double spread = 0;         // root mean square of error / (sigma sqrt 2): 1 when sigma is honest
  double spread_median = 0;  // median of error^2 / sigma^2 over that of two Gaussian directions (1.386), its root
};

inline RecoveredError recovered_error(const ScanRegistration& registration, const FormedSurface& surface) {
  std::vector<double> errors, ratios;
  RecoveredError result;
  for (const RegisteredPoint& p : registration.points) {
    const double e = (p.place_mm - surface(p.sheet_mm)).norm();
    errors.push_back(e);
    ratios.push_back(e * e / (p.sigma_mm * p.sigma_mm));
    result.spread += ratios.back() / 2;
  }
  if (errors.empty()) return result;
  result.points = errors.size();
  result.spread = std::sqrt(result.spread / static_cast<double>(errors.size()));
  std::sort(errors.begin(), errors.end());
  std::sort(ratios.begin(), ratios.end());
  result.median_mm = errors[errors.size() / 2];
  result.percentile_95_mm = errors[errors.size() * 95 / 100];
  result.maximum_mm = errors.back();
  result.spread_median = std::sqrt(ratios[ratios.size() / 2] / 1.386);
  return result;
}

}  // namespace formwright::test
