// SPDX-License-Identifier: GPL-3.0-or-later
// The pictures of the documentation (docs/img), see docs/samples.md.
//   sample_pictures sheet OUT.png
//   sample_pictures one SAMPLE VERTICES PIXELS OUT.png [turn_deg tilt_deg]
//   sample_pictures relief SAMPLE VERTICES RELIEF.ply THICKNESS_MM OUT.png
//   sample_pictures solids OUT.png SOLID.stl ...
//   sample_pictures grid OUT.png COLUMNS PICTURE.png ...
// RELIEF.ply: `formwright relief --sample SAMPLE --sample-vertices VERTICES --projection orthographic`.
#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <iterator>
#include <numbers>
#include <string>
#include <vector>

#include "base/error.h"
#include "formats/mesh_io.h"
#include "geometry/mesh/measures.h"
#include "geometry/samples/render.h"
#include "geometry/samples/samples.h"

namespace {

using namespace formwright;
using namespace formwright::test;

void save(const std::string& path, const Bytes& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file) throw Error(ErrorCode::invalid_input, "out", path + " could not be written.");
  std::cout << path << ": " << bytes.size() / 1000 << " kB\n";
}

/// Seen from the right by `turn_deg` and from above by `tilt_deg`.
Vec3 looking(double turn_deg, double tilt_deg) {
  const double turn = turn_deg * std::numbers::pi / 180, tilt = tilt_deg * std::numbers::pi / 180;
  return {-std::sin(turn) * std::cos(tilt), -std::sin(tilt), -std::cos(turn) * std::cos(tilt)};
}

struct Tile {
  const char* sample;
  double turn_deg, tilt_deg;
};
constexpr Tile tiles[] = {{"bust", -24, 6},    {"cat", 24, 10},     {"octopus", 10, 24},    {"mountain", 16, 32},
                          {"fish", -14, 8},    {"coin", -12, 14},   {"star", 18, 12},       {"heart", 18, 12},
                          {"pyramid", 28, 24}, {"t_shape", 28, 18}, {"hemisphere", 20, 24}, {"torus", 24, 16}};

void sheet(const std::string& path) {
  constexpr int side = 400, columns = 4;
  RgbPicture picture = blank_picture(columns * side, 3 * side, RenderOptions().background);
  int k = 0;
  for (const Tile& tile : tiles) {
    Context context;
    RenderOptions options;
    options.width = options.height = side;
    options.view_direction = looking(tile.turn_deg, tile.tilt_deg);
    int vertices = 0;
    for (const SampleInfo& info : sample_catalog())
      if (info.name == tile.sample) vertices = std::max(40000, 2 * info.default_vertices);
    paste(picture, render(make_sample(tile.sample, vertices, context), options), k % columns * side,
          k / columns * side);
    ++k;
  }
  save(path, encode_palette_png(picture));
}

Model read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  Context context;
  return read_model(as_bytes(text), path, context);
}

/// Each from the front and, below, turned and tilted and by `shrink` smaller; plaster. `size` of the largest, mm.
RgbPicture side_by_side(const std::vector<const Model*>& models, const Vec3& size, double turn_deg, double tilt_deg,
                        double shrink) {
  constexpr int width = 400, front = 500, side = 300;
  RgbPicture picture = blank_picture(static_cast<int>(models.size()) * width, front + side, RenderOptions().background);
  int k = 0;
  for (const Model* model : models) {
    RenderOptions options;
    options.use_colours = false;
    options.floor = false;
    options.width = width;
    options.height = front;
    options.millimetres_across = 1.12 * std::max(size.x(), size.y() * width / front);
    paste(picture, render(*model, options), k * width, 0);
    options.height = side;
    options.view_direction = looking(turn_deg, tilt_deg);
    // The same lamp, as this camera sees it.
    const double tilt = tilt_deg * std::numbers::pi / 180, up = options.lamp.y(), back = options.lamp.z();
    options.lamp.y() = std::cos(tilt) * up - std::sin(tilt) * back;
    options.lamp.z() = std::sin(tilt) * up + std::cos(tilt) * back;
    options.millimetres_across *= shrink;
    paste(picture, render(*model, options), k * width, front);
    ++k;
  }
  return picture;
}

/// The model, its relief and its linear compression into the same slab, from the front and nearly from the side.
void relief(const std::string& sample, int vertices, const std::string& ply, double thickness_mm,
            const std::string& path) {
  Context context;
  Model relief = read_file(ply);
  relief.vertex_colours.resize(0, 3);
  Model original = make_sample(sample, vertices, context);
  const BoundingBox box = bounding_box(original.mesh), flat_box = bounding_box(relief.mesh);
  original.mesh.V *= flat_box.size().x() / box.size().x();
  Model linear = original;
  linear.mesh.V.col(2) *= thickness_mm / bounding_box(linear.mesh).size().z();
  save(path, encode_palette_png(side_by_side({&original, &relief, &linear}, flat_box.size(), 0, 62, 1.05)));
}

/// Solids of reliefs as they lie, from the front and from the side.
void solids(const std::string& path, const std::vector<std::string>& files) {
  std::vector<Model> models;
  Vec3 size = Vec3::Zero();
  for (const std::string& file : files) {
    models.push_back(read_file(file));
    const BoundingBox box = bounding_box(models.back().mesh);
    models.back().mesh.V.rowwise() -= box.centre().transpose();
    size = size.cwiseMax(box.size());
  }
  std::vector<const Model*> all;
  for (const Model& model : models) all.push_back(&model);
  save(path, encode_palette_png(side_by_side(all, size, 25, 50, 1.35)));
}

/// Pictures of one size beside and below each other.
void grid(const std::string& path, int columns, const std::vector<std::string>& files) {
  constexpr std::uint8_t behind = 222;
  std::vector<RgbPicture> pictures;
  for (const std::string& file : files) {
    std::ifstream stream(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    pictures.push_back(decode_png(to_bytes(bytes), behind));
    if (pictures.back().bytes.empty()) throw Error(ErrorCode::invalid_input, "grid", file + " is no picture.");
  }
  const int width = pictures.front().width, height = pictures.front().height;
  const int rows = (static_cast<int>(files.size()) + columns - 1) / columns;
  RgbPicture sheet = blank_picture(columns * width, rows * height, RenderOptions().background);
  for (int k = 0; k < static_cast<int>(files.size()); ++k)
    paste(sheet, pictures[static_cast<std::size_t>(k)], k % columns * width, k / columns * height);
  save(path, encode_palette_png(sheet));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc == 3 && std::strcmp(argv[1], "sheet") == 0) {
      sheet(argv[2]);
    } else if (argc >= 6 && std::strcmp(argv[1], "one") == 0) {
      Context context;
      RenderOptions options;
      options.width = options.height = std::atoi(argv[4]);
      options.view_direction = looking(argc > 6 ? std::atof(argv[6]) : 0, argc > 7 ? std::atof(argv[7]) : 0);
      save(argv[5], encode_palette_png(render(make_sample(argv[2], std::atoi(argv[3]), context), options)));
    } else if (argc == 7 && std::strcmp(argv[1], "relief") == 0) {
      relief(argv[2], std::atoi(argv[3]), argv[4], std::atof(argv[5]), argv[6]);
    } else if (argc > 3 && std::strcmp(argv[1], "solids") == 0) {
      solids(argv[2], {argv + 3, argv + argc});
    } else if (argc > 4 && std::strcmp(argv[1], "grid") == 0) {
      grid(argv[2], std::atoi(argv[3]), {argv + 4, argv + argc});
    } else {
      std::cerr
          << "sample_pictures sheet OUT.png | one SAMPLE VERTICES PIXELS OUT.png [turn_deg tilt_deg] | relief "
             "SAMPLE VERTICES RELIEF.ply THICKNESS_MM OUT.png | solids OUT.png SOLID.stl ... | grid OUT.png COLUMNS PICTURE.png ...\n";
      return 2;
    }
  } catch (const Error& error) {
    std::cerr << error.what() << "\n";
    return 2;
  }
}
