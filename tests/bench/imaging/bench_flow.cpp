// SPDX-License-Identifier: GPL-3.0-or-later
// End-point error and seconds of variational_flow on pairs with known displacement.
//   bench_flow [--side PX] [--holes N] [--write DIR] [NAME=VALUE ...]     options of the flow by name
// --holes takes N round holes out of each second picture; errors are given with the places in them and without.
// --write leaves the pairs and their true flow for compare_opencv.py.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <random>
#include <string>

#include "imaging/picture/png_writer.h"
#include "imaging/warped_pictures.h"

using namespace formwright;

namespace {

Image bytes_of(const WeightedPicture& picture) {
  Image image(picture.width, picture.height, {0, 0, 0, 255});
  for (std::size_t i = 0; i < picture.pixels.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      image.pixels[i][c] = static_cast<std::uint8_t>(std::lround(picture.pixels[i][c]));
  return image;
}

/// Round holes of a fortieth of the picture's width in radius, at random places: no weight, and a colour that would
/// mislead whoever read it.
void make_holes(Image& picture, int count) {
  std::mt19937 random(7);
  const double radius = picture.width / 40.0;
  for (int i = 0; i < count; ++i) {
    const Vec2 middle(random() % static_cast<unsigned>(picture.width),
                      random() % static_cast<unsigned>(picture.height));
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x)
        if ((Vec2(x, y) - middle).norm() < radius) picture.at(x, y) = {255, 0, 255, 0};
  }
}

void save(const std::string& path, const void* data, std::size_t size) {
  std::ofstream(path, std::ios::binary).write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
}

}  // namespace

int main(int argc, char** argv) {
  int side = 2048, holes = 0;
  std::string folder;
  Json values = Json::object();
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--side") == 0 && i + 1 < argc) side = std::stoi(argv[++i]);
    else if (std::strcmp(argv[i], "--holes") == 0 && i + 1 < argc) holes = std::stoi(argv[++i]);
    else if (std::strcmp(argv[i], "--write") == 0 && i + 1 < argc) folder = argv[++i];
    else if (const char* equal = std::strchr(argv[i], '='))
      values[std::string(argv[i], static_cast<std::size_t>(equal - argv[i]))] = std::stod(equal + 1);
  }
  const auto options = read_parameters<VariationalFlowOptions>(values);
  struct Case {
    const char* name;
    std::function<Vec2(const Vec2&)> back;
    test::Camera camera;
  };
  const double s = side / 2048.0;
  const Case cases[] = {
      {"translation", [](const Vec2&) { return Vec2(-7.3, 4.6); }, {}},
      {"affine",
       [](const Vec2& p) { return Vec2(0.02 * p.x() + 0.015 * p.y(), -0.01 * p.x() - 0.015 * p.y()); },
       {2, 0.5, 0.05}},
      {"waves", test::waves(14 * s, 700 * s), {2, 0.5, 0.05}},
      {"short waves", test::waves(3 * s, 160 * s), {2, 0.5, 0.05}},
      {"bulge", test::bulge(150 * s, 500 * s), {4, 0.8, 0.1}},
      {"noisy bulge", test::bulge(150 * s, 500 * s), {12, 1.2, 0.1}}};
  Json result = Json::array();
  for (const Case& c : cases) {
    test::WarpedPair pair = test::warped_pair(side, side, c.back, c.camera);
    const Image first = bytes_of(pair.first);
    Image second = bytes_of(pair.second);
    make_holes(second, holes);
    Context context;
    const WeightedPicture a = weighted_picture(first), b = weighted_picture(second);
    const Stopwatch watch;
    const std::clock_t processor = std::clock();
    const Flow flow = variational_flow(a, b, options, context);
    const double seconds = watch.seconds(),
                 processor_seconds = static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC;
    const int margin = side / 40;
    const test::EndPointError e = test::end_point_error(flow, pair.truth, margin);
    double sum = 0, count = 0;
    for (int y = margin; y < side - margin; ++y)
      for (int x = margin; x < side - margin; ++x) {
        const std::size_t i = flow.index(x, y);
        const int there_x =
                      std::clamp(static_cast<int>(std::lround(x + static_cast<double>(pair.truth.u[i]))), 0, side - 1),
                  there_y =
                      std::clamp(static_cast<int>(std::lround(y + static_cast<double>(pair.truth.v[i]))), 0, side - 1);
        if (second.at(there_x, there_y)[3] == 0) continue;
        sum += std::hypot(flow.u[i] - pair.truth.u[i], flow.v[i] - pair.truth.v[i]);
        ++count;
      }
    result.push_back({{"pair", c.name},
                      {"side_px", side},
                      {"holes", holes},
                      {"seconds", seconds},
                      {"processor_seconds", processor_seconds},
                      {"error_mean_px", e.mean},
                      {"error_mean_of_seen_px", sum / count},
                      {"error_rms_px", e.root_mean_square},
                      {"error_95_px", e.percentile_95}});
    std::fprintf(stderr,
                 "%-12s %6.2f s (%.2f s of all processors)  mean %.4f  of what is seen %.4f  rms %.4f  95 %% %.4f px\n",
                 c.name, seconds, processor_seconds, e.mean, sum / count, e.root_mean_square, e.percentile_95);
    if (folder.empty()) continue;
    const std::string stem = folder + "/" + c.name;
    for (const auto& [suffix, image] : {std::pair{"_1.png", &first}, {"_2.png", &second}}) {
      const Bytes png = write_png(*image, 0, context);
      save(stem + suffix, png.data(), png.size());
    }
    save(stem + "_u.f32", pair.truth.u.data(), 4 * pair.truth.u.size());
    save(stem + "_v.f32", pair.truth.v.data(), 4 * pair.truth.v.size());
  }
  std::printf("%s\n", result.dump(1).c_str());
}
