// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/samples/texture_atlas.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>

#include "base/error.h"
#include "base/index.h"
#include "base/parallel.h"

namespace formwright::samples {
namespace {

// View k looks against axis k / 2 (x, y, z), from its positive side for even k. Two coordinates of the picture and
// the depth towards the viewer, right-handed, so that a face seen from its front is counter-clockwise.
Point seen(int view, const Point& p) {
  switch (view) {
    case 0: return {-p.z, p.y, p.x};
    case 1: return {p.z, p.y, -p.x};
    case 2: return {p.x, -p.z, p.y};
    case 3: return {p.x, p.z, -p.y};
    case 4: return {p.x, p.y, p.z};
    default: return {-p.x, p.y, -p.z};
  }
}

struct Chart {
  int view = 0;
  std::vector<int> faces;
  Point low{1e30, 1e30, 0}, high{-1e30, -1e30, 0};  // in the picture, mm
  double u = 0, v = 0;                              // place of `low` on the sheet, mm
  double width() const { return high.x - low.x; }
  double height() const { return high.y - low.y; }
};

// Across each side of a face, by sorting the sides.
std::vector<std::array<int, 3>> neighbours_of(const Triangles& F) {
  struct Side {
    std::uint64_t key;
    int face, corner;
  };
  std::vector<Side> sides;
  sides.reserve(static_cast<std::size_t>(F.rows()) * 3);
  for (int f = 0; f < static_cast<int>(F.rows()); ++f)
    for (int c = 0; c < 3; ++c) {
      const auto a = static_cast<std::uint64_t>(F(f, c)), b = static_cast<std::uint64_t>(F(f, (c + 1) % 3));
      sides.push_back({std::min(a, b) << 32 | std::max(a, b), f, c});
    }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return a.key != b.key ? a.key < b.key : a.face < b.face; });
  std::vector<std::array<int, 3>> beside(static_cast<std::size_t>(F.rows()), {-1, -1, -1});
  for (std::size_t k = 0; k + 1 < sides.size(); ++k)
    if (sides[k].key == sides[k + 1].key) {
      beside[index(sides[k].face)][index(sides[k].corner)] = sides[k + 1].face;
      beside[index(sides[k + 1].face)][index(sides[k + 1].corner)] = sides[k].face;
    }
  return beside;
}

class Atlas {
 public:
  Atlas(const Model& model, const std::function<Point(const Point&)>& broad_normal, Context& context)
      : V_(model.mesh.V), F_(model.mesh.F), beside_(neighbours_of(F_)), context_(context) {
    choose_views(broad_normal);
    peel();
    collect();
  }

  std::vector<Chart>& charts() { return charts_; }
  Point vertex(int v) const { return {V_(v, 0), V_(v, 1), V_(v, 2)}; }
  Point corner(int f, int c) const { return vertex(F_(f, c)); }

  /// Rows of charts, tallest first, on a square sheet; returns its side in mm.
  double pack(double gap) {
    std::vector<int> order(charts_.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return charts_[index(a)].height() > charts_[index(b)].height(); });
    double area = 0, widest = 0;
    for (const Chart& c : charts_) {
      area += (c.width() + gap) * (c.height() + gap);
      widest = std::max({widest, c.width() + 2 * gap, c.height() + 2 * gap});
    }
    for (double side = std::max(widest, std::sqrt(area));; side *= 1.03) {
      double x = gap, y = gap, row = 0;
      for (int k : order) {
        Chart& c = charts_[index(k)];
        if (x + c.width() + gap > side) {
          x = gap;
          y += row + gap;
          row = 0;
        }
        c.u = x;
        c.v = y;
        x += c.width() + gap;
        row = std::max(row, c.height());
      }
      if (y + row + gap <= side) return side;
    }
  }

 private:
  void choose_views(const std::function<Point(const Point&)>& broad_normal) {
    const int faces = static_cast<int>(F_.rows());
    view_.resize(index(faces));
    parallel_for(index(faces), 2048, [&](std::size_t from, std::size_t to) {
      context_.check_cancelled();
      for (std::size_t f = from; f < to; ++f) {
        const int i = static_cast<int>(f);
        const Point centre = (corner(i, 0) + corner(i, 1) + corner(i, 2)) / 3;
        const Point n = normalized(normalized(broad_normal(centre)) * 1.5 +
                                   normalized(cross(corner(i, 1) - corner(i, 0), corner(i, 2) - corner(i, 0))));
        // The front gets more than its share: it is what is looked at.
        const double score[6] = {n.x, -n.x, n.y * 0.9, -n.y * 0.9, n.z * 1.25, -n.z};
        view_[f] = static_cast<int>(std::max_element(score, score + 6) - score);
      }
    });
    // A face follows two of its neighbours that agree.
    for (int round = 0; round < 6; ++round) {
      context_.check_cancelled();
      const std::vector<int> before = view_;
      for (int f = 0; f < faces; ++f) {
        const auto& n = beside_[index(f)];
        for (std::size_t c = 0; c < 3; ++c) {
          const int a = n[c], b = n[(c + 1) % 3];
          if (a >= 0 && b >= 0 && before[index(a)] == before[index(b)] && faces_viewer(f, before[index(a)]))
            view_[index(f)] = before[index(a)];
        }
      }
    }
  }

  bool faces_viewer(int f, int view) const {
    const Point a = seen(view, corner(f, 0)), b = seen(view, corner(f, 1)), c = seen(view, corner(f, 2));
    const Point n = cross(b - a, c - a);
    return n.z > 0.2 * length(n);
  }

  // Faces behind others of the same view go to the next layer, until none is hidden.
  void peel() {
    constexpr double cell = 0.5, hidden_mm = 2.5;
    const int faces = static_cast<int>(F_.rows());
    layer_.assign(index(faces), 0);
    Point low{1e30, 1e30, 1e30}, high{-1e30, -1e30, -1e30};
    for (int v = 0; v < static_cast<int>(V_.rows()); ++v) {
      const Point p = vertex(v);
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    const double reach = std::max({std::fabs(low.x), std::fabs(low.y), std::fabs(low.z), std::fabs(high.x),
                                   std::fabs(high.y), std::fabs(high.z)}) +
                         1;
    const int n = static_cast<int>(2 * reach / cell) + 2;
    parallel_for(6, 1, [&](std::size_t from, std::size_t) {
      const int view = static_cast<int>(from);
      std::vector<float> front(index(n) * index(n));
      for (int layer = 0; layer < 8; ++layer) {
        context_.check_cancelled();
        std::fill(front.begin(), front.end(), -1e30F);
        int members = 0;
        const auto cell_of = [&](double x) { return static_cast<int>((x + reach) / cell); };
        for (int f = 0; f < faces; ++f) {
          if (view_[index(f)] != view || layer_[index(f)] != layer) continue;
          ++members;
          const Point a = seen(view, corner(f, 0)), b = seen(view, corner(f, 1)), c = seen(view, corner(f, 2));
          const auto depth = static_cast<float>(std::min({a.z, b.z, c.z}));
          for (int y = cell_of(std::min({a.y, b.y, c.y})); y <= cell_of(std::max({a.y, b.y, c.y})); ++y)
            for (int x = cell_of(std::min({a.x, b.x, c.x})); x <= cell_of(std::max({a.x, b.x, c.x})); ++x) {
              float& at = front[index(y) * index(n) + index(x)];
              at = std::max(at, depth);
            }
        }
        if (members == 0) break;
        for (int f = 0; f < faces; ++f) {
          if (view_[index(f)] != view || layer_[index(f)] != layer) continue;
          const Point centre = seen(view, (corner(f, 0) + corner(f, 1) + corner(f, 2)) / 3);
          const double before =
              static_cast<double>(front[index(cell_of(centre.y)) * index(n) + index(cell_of(centre.x))]);
          // Steep faces reach far back within one cell.
          const Point a = seen(view, corner(f, 0)), b = seen(view, corner(f, 1)), c = seen(view, corner(f, 2));
          const double spread = std::max({a.z, b.z, c.z}) - std::min({a.z, b.z, c.z});
          if (before > centre.z + hidden_mm + spread) ++layer_[index(f)];
        }
      }
    });
  }

  // Connected faces of one view and layer make a chart; crumbs join a neighbour that can see them.
  void collect() {
    const int faces = static_cast<int>(F_.rows());
    std::vector<int> chart(index(faces), -1);
    for (int pass = 0; pass < 3; ++pass) {
      context_.check_cancelled();
      std::fill(chart.begin(), chart.end(), -1);
      charts_.clear();
      std::vector<int> stack;
      for (int seed = 0; seed < faces; ++seed) {
        if (chart[index(seed)] >= 0) continue;
        Chart c;
        c.view = view_[index(seed)];
        const int id = static_cast<int>(charts_.size());
        stack.assign(1, seed);
        chart[index(seed)] = id;
        while (!stack.empty()) {
          const int f = stack.back();
          stack.pop_back();
          c.faces.push_back(f);
          for (int g : beside_[index(f)])
            if (g >= 0 && chart[index(g)] < 0 && view_[index(g)] == view_[index(f)] &&
                layer_[index(g)] == layer_[index(f)]) {
              chart[index(g)] = id;
              stack.push_back(g);
            }
        }
        charts_.push_back(std::move(c));
      }
      if (pass == 2) break;
      const std::size_t crumb = std::max<std::size_t>(12, index(faces) / 800);
      for (const Chart& c : charts_) {
        if (c.faces.size() >= crumb) continue;
        // The neighbour along most sides.
        std::vector<std::pair<int, int>> votes;  // view and layer as one number, count
        for (int f : c.faces)
          for (int g : beside_[index(f)]) {
            if (g < 0 || chart[index(g)] == chart[index(f)]) continue;
            const int key = view_[index(g)] * 16 + layer_[index(g)];
            const auto found = std::find_if(votes.begin(), votes.end(), [&](const auto& v) { return v.first == key; });
            if (found == votes.end()) {
              votes.emplace_back(key, 1);
            } else {
              ++found->second;
            }
          }
        std::stable_sort(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
        for (const auto& [key, count] : votes) {
          const int view = key / 16;
          const auto visible =
              std::count_if(c.faces.begin(), c.faces.end(), [&](int f) { return faces_viewer(f, view); });
          if (static_cast<std::size_t>(visible) * 10 < c.faces.size() * 9) continue;
          for (int f : c.faces) {
            view_[index(f)] = view;
            layer_[index(f)] = key % 16;
          }
          break;
        }
      }
    }
    for (Chart& c : charts_) {
      std::sort(c.faces.begin(), c.faces.end());
      for (int f : c.faces)
        for (int k = 0; k < 3; ++k) {
          const Point p = seen(c.view, corner(f, k));
          c.low = {std::min(c.low.x, p.x), std::min(c.low.y, p.y), 0};
          c.high = {std::max(c.high.x, p.x), std::max(c.high.y, p.y), 0};
        }
    }
  }

  const Positions& V_;
  const Triangles& F_;
  std::vector<std::array<int, 3>> beside_;
  Context& context_;
  std::vector<int> view_, layer_;
  std::vector<Chart> charts_;
};

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
          const Point p = seen(chart.view, atlas.vertex(v));
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
        z += seen(chart.view, atlas.corner(f, c)).z / 3;
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

Bytes encode_png(const std::vector<Point>& image, int pixels) {
  // Linear light to sRGB bytes by the nearest of the 256 levels.
  std::array<double, 255> middle{};
  for (int b = 0; b < 255; ++b) middle[index(b)] = 0.5 * (srgb(b, 0, 0).x + srgb(b + 1, 0, 0).x);
  const auto level = [&](double v) {
    return static_cast<unsigned char>(std::upper_bound(middle.begin(), middle.end(), v) - middle.begin());
  };
  const std::size_t row = 3 * index(pixels);
  std::vector<unsigned char> raw(row * index(pixels)), filtered;
  parallel_for(index(pixels), 8, [&](std::size_t from, std::size_t to) {
    for (std::size_t k = from * index(pixels); k < to * index(pixels); ++k) {
      raw[3 * k] = level(image[k].x);
      raw[3 * k + 1] = level(image[k].y);
      raw[3 * k + 2] = level(image[k].z);
    }
  });
  filtered.reserve((row + 1) * index(pixels));
  for (std::size_t j = 0; j < index(pixels); ++j) {
    filtered.push_back(1);  // the filter "Sub": differences along the row
    for (std::size_t i = 0; i < row; ++i)
      filtered.push_back(static_cast<unsigned char>(raw[j * row + i] - (i < 3 ? 0 : raw[j * row + i - 3])));
  }
  uLongf size = compressBound(static_cast<uLong>(filtered.size()));
  std::vector<unsigned char> packed(size);
  if (compress2(packed.data(), &size, filtered.data(), static_cast<uLong>(filtered.size()), 4) != Z_OK)
    throw Error(ErrorCode::out_of_memory, "sample", "The sample's texture could not be compressed.");
  packed.resize(size);
  Bytes png;
  const auto byte = [&](unsigned v) { png.push_back(static_cast<std::byte>(v & 255U)); };
  const auto word = [&](unsigned long v) {
    for (int shift = 24; shift >= 0; shift -= 8) byte(static_cast<unsigned>(v >> shift));
  };
  const auto chunk = [&](const char* type, const std::vector<unsigned char>& data) {
    word(data.size());
    uLong crc = crc32(0, reinterpret_cast<const Bytef*>(type), 4);
    if (!data.empty())
      crc = crc32(crc, data.data(), static_cast<uInt>(data.size()));  // of no bytes it would begin again
    for (int k = 0; k < 4; ++k) byte(static_cast<unsigned char>(type[k]));
    for (unsigned char v : data) byte(v);
    word(crc);
  };
  for (unsigned v : {0x89U, 0x50U, 0x4eU, 0x47U, 0x0dU, 0x0aU, 0x1aU, 0x0aU}) byte(v);
  const auto n = static_cast<unsigned>(pixels);
  const auto b = [](unsigned v) { return static_cast<unsigned char>(v & 255U); };
  chunk("IHDR", {b(n >> 24), b(n >> 16), b(n >> 8), b(n), b(n >> 24), b(n >> 16), b(n >> 8), b(n), 8, 2, 0, 0, 0});
  chunk("sRGB", {0});
  chunk("IDAT", packed);
  chunk("IEND", {});
  return png;
}

}  // namespace formwright::samples
