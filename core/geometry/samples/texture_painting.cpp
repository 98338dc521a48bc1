// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/samples/texture_painting.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/index.h"
#include "base/parallel.h"
#include "geometry/samples/png_encoder.h"
#include "geometry/samples/texture_atlas.h"

namespace formwright::samples {
namespace {

void attach(Model& model, Bytes png, const std::string& name) {
  model.textures.push_back({name + ".png", "image/png", std::move(png)});
  Material material;
  material.name = name;
  material.diffuse = {1, 1, 1};
  material.diffuse_texture = 0;
  model.materials.push_back(material);
  model.face_material.assign(static_cast<std::size_t>(model.mesh.F.rows()), 0);
}

}  // namespace

void paint_texture(Model& model, const std::function<Point(const Point&)>& broad_normal, const Colouring& colouring,
                   int pixels, const std::string& name, Context& context) {
  Atlas atlas(model, broad_normal, context);
  const double per_sheet = std::sqrt(5.0 * 1e4 / pixels / pixels);  // about a pixel in mm, for the gaps
  const double sheet = atlas.pack(4 * per_sheet);
  const Triangles& F = model.mesh.F;
  // One texture vertex for each vertex of a chart.
  model.FT.resize(F.rows(), 3);
  std::vector<Point> uv;
  std::vector<int> row_of(static_cast<std::size_t>(model.mesh.V.rows()), -1), touched;
  for (const Chart& chart : atlas.charts()) {
    touched.clear();
    for (int f : chart.faces)
      for (int c = 0; c < 3; ++c) {
        const int v = F(f, c);
        if (row_of[index(v)] < 0) {
          row_of[index(v)] = static_cast<int>(uv.size());
          touched.push_back(v);
          const Point p = Atlas::seen(chart.view, atlas.vertex(v));
          uv.push_back({(chart.u + p.x - chart.low.x) / sheet, (chart.v + p.y - chart.low.y) / sheet, 0});
        }
        model.FT(f, c) = row_of[index(v)];
      }
    for (int v : touched) row_of[index(v)] = -1;
  }
  model.UV.resize(static_cast<Eigen::Index>(uv.size()), 2);
  for (std::size_t k = 0; k < uv.size(); ++k) model.UV.row(static_cast<Eigen::Index>(k)) << uv[k].x, uv[k].y;

  // Which face paints which pixel: the one in front, with a rim of three pixels against seams.
  std::vector<int> painter(index(pixels) * index(pixels), -1);
  std::vector<float> nearest(painter.size(), 1e30F), depth_of(painter.size(), -1e30F);
  for (const Chart& chart : atlas.charts())
    for (int f : chart.faces) {
      if ((f & 0xfff) == 0) context.check_cancelled();
      double x[3], y[3], z = 0;
      for (int c = 0; c < 3; ++c) {
        x[c] = uv[index(model.FT(f, c))].x * pixels;
        y[c] = (1 - uv[index(model.FT(f, c))].y) * pixels;
        z += Atlas::seen(chart.view, atlas.corner(f, c)).z / 3;
      }
      constexpr double rim = 3;
      const int x0 = std::max(0, static_cast<int>(std::min({x[0], x[1], x[2]}) - rim)),
                x1 = std::min(pixels - 1, static_cast<int>(std::max({x[0], x[1], x[2]}) + rim));
      const int y0 = std::max(0, static_cast<int>(std::min({y[0], y[1], y[2]}) - rim)),
                y1 = std::min(pixels - 1, static_cast<int>(std::max({y[0], y[1], y[2]}) + rim));
      for (int j = y0; j <= y1; ++j)
        for (int i = x0; i <= x1; ++i) {
          const double px = i + 0.5, py = j + 0.5;
          // Squared distance to the triangle in the picture, 0 inside.
          bool inside_a = true, inside_b = true;
          double d2 = 1e30;
          for (int c = 0; c < 3; ++c) {
            const int e = (c + 1) % 3;
            const double dx = x[e] - x[c], dy = y[e] - y[c], wx = px - x[c], wy = py - y[c];
            const double side = dx * wy - dy * wx;
            inside_a = inside_a && side >= 0;
            inside_b = inside_b && side <= 0;
            const double l2 = dx * dx + dy * dy, t = l2 > 0 ? clamp((dx * wx + dy * wy) / l2, 0, 1) : 0;
            d2 = std::min(d2, (wx - t * dx) * (wx - t * dx) + (wy - t * dy) * (wy - t * dy));
          }
          if (inside_a || inside_b) d2 = 0;
          if (d2 > rim * rim) continue;
          const std::size_t at = index(j) * index(pixels) + index(i);
          const auto d = static_cast<float>(d2), depth = static_cast<float>(z);
          if (d < nearest[at] || (d == nearest[at] && depth > depth_of[at])) {
            nearest[at] = d;
            depth_of[at] = depth;
            painter[at] = f;
          }
        }
    }
  std::vector<int> view_of(static_cast<std::size_t>(F.rows()), 0);
  for (const Chart& chart : atlas.charts())
    for (int f : chart.faces) view_of[index(f)] = chart.view;
  std::vector<Point> image(painter.size(), Point{0.5, 0.5, 0.5});
  parallel_for(index(pixels), 4, [&](std::size_t from, std::size_t to) {
    context.check_cancelled();
    for (std::size_t at = from * index(pixels); at < to * index(pixels); ++at) {
      const int f = painter[at];
      if (f < 0) continue;
      const double u = (static_cast<double>(at % index(pixels)) + 0.5) / pixels,
                   v = 1 - (static_cast<double>(at / index(pixels)) + 0.5) / pixels;
      const Point &a = uv[index(model.FT(f, 0))], &b = uv[index(model.FT(f, 1))], &c = uv[index(model.FT(f, 2))];
      const double twice = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
      double s = 1.0 / 3, t = 1.0 / 3;
      if (std::fabs(twice) > 1e-14) {
        s = clamp(((u - a.x) * (c.y - a.y) - (v - a.y) * (c.x - a.x)) / twice, -0.5, 1.5);
        t = clamp(((b.x - a.x) * (v - a.y) - (b.y - a.y) * (u - a.x)) / twice, -0.5, 1.5);
      }
      const Point pa = atlas.corner(f, 0), pb = atlas.corner(f, 1), pc = atlas.corner(f, 2);
      image[at] = colouring(pa + (pb - pa) * s + (pc - pa) * t, normalized(cross(pb - pa, pc - pa)));
    }
  });
  context.check_cancelled();
  attach(model, encode_png(image, pixels), name);
}

void paint_from_above(Model& model, double side_mm, const std::function<Point(double, double)>& colouring, int pixels,
                      const std::string& name, Context& context) {
  model.UV.resize(model.mesh.V.rows(), 2);
  for (Eigen::Index v = 0; v < model.mesh.V.rows(); ++v)
    model.UV.row(v) << clamp(model.mesh.V(v, 0) / side_mm + 0.5, 0, 1), clamp(0.5 - model.mesh.V(v, 2) / side_mm, 0, 1);
  model.FT = model.mesh.F;
  std::vector<Point> image(index(pixels) * index(pixels));
  parallel_for(index(pixels), 4, [&](std::size_t from, std::size_t to) {
    context.check_cancelled();
    for (std::size_t j = from; j < to; ++j)
      for (std::size_t i = 0; i < index(pixels); ++i)
        image[j * index(pixels) + i] = colouring(side_mm * ((static_cast<double>(i) + 0.5) / pixels - 0.5),
                                                 side_mm * ((static_cast<double>(j) + 0.5) / pixels - 0.5));
  });
  context.check_cancelled();
  attach(model, encode_png(image, pixels), name);
}

}  // namespace formwright::samples
