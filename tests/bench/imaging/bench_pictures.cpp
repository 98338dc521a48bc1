// SPDX-License-Identifier: GPL-3.0-or-later
// Halving and blurring a picture: the program's functions, which call OpenCV, against plain loops over the definition.
//   bench_pictures [--side PX]
// Prints JSON: seconds of processor time (best of five) and the largest difference of a colour.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <functional>
#include <string>

#include "base/context.h"
#include "base/data/json.h"
#include "imaging/warped_pictures.h"

using namespace formwright;

namespace {

Float4 weighed(const Float4& p) { return Float4{p[0] * p[3], p[1] * p[3], p[2] * p[3], p[3]}; }
Float4 unweighed(const Float4& p) { return p[3] > 1e-6f ? p / p[3] * Float4{1, 1, 1, p[3]} : Float4{}; }

/// Every pixel is the mean of the four that it covers; width and height are even.
WeightedPicture halved(const WeightedPicture& picture) {
  WeightedPicture result(picture.width / 2, picture.height / 2);
  for (int y = 0; y < result.height; ++y)
    for (int x = 0; x < result.width; ++x) {
      Float4 sum{};
      for (int k = 0; k < 4; ++k) sum += weighed(picture.at(2 * x + k % 2, 2 * y + k / 2));
      result.at(x, y) = unweighed(0.25f * sum);
    }
  return result;
}

/// Gaussian of three sigma to either side, first along rows, then along columns; borders are repeated.
WeightedPicture blurred(const WeightedPicture& picture, double sigma_px) {
  const int radius = static_cast<int>(std::ceil(3 * sigma_px)), w = picture.width, h = picture.height;
  std::vector<float> kernel;
  double sum = 0;
  for (int k = -radius; k <= radius; ++k) sum += std::exp(-0.5 * k * k / (sigma_px * sigma_px));
  for (int k = -radius; k <= radius; ++k)
    kernel.push_back(static_cast<float>(std::exp(-0.5 * k * k / (sigma_px * sigma_px)) / sum));
  WeightedPicture across(w, h), result(w, h);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      Float4 total{};
      for (int k = -radius; k <= radius; ++k)
        total += kernel[static_cast<std::size_t>(k + radius)] * weighed(picture.at(std::clamp(x + k, 0, w - 1), y));
      across.at(x, y) = total;
    }
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      Float4 total{};
      for (int k = -radius; k <= radius; ++k)
        total += kernel[static_cast<std::size_t>(k + radius)] * across.at(x, std::clamp(y + k, 0, h - 1));
      result.at(x, y) = unweighed(total);
    }
  return result;
}

double seconds_of(const std::function<WeightedPicture()>& make, WeightedPicture& made) {
  double best = 1e9;
  for (int k = 0; k < 5; ++k) {
    const std::clock_t start = std::clock();
    made = make();
    best = std::min(best, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return best;
}

Json compared(const char* name, const std::function<WeightedPicture()>& ours,
              const std::function<WeightedPicture()>& plain) {
  WeightedPicture a(1, 1), b(1, 1);
  Json row{{"name", name}};
  row["seconds"] = seconds_of(ours, a);
  row["seconds_plain"] = seconds_of(plain, b);
  float difference = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    for (std::size_t c = 0; c < 4; ++c) difference = std::max(difference, std::abs(a.pixels[i][c] - b.pixels[i][c]));
  row["max_difference"] = difference;
  return row;
}

}  // namespace

int main(int argc, char** argv) {
  const int side = argc == 3 && std::strcmp(argv[1], "--side") == 0 ? std::stoi(argv[2]) : 2048;
  const WeightedPicture picture =
      test::warped_pair(side, side, [](const Vec2&) { return Vec2(0, 0); }, {4, 0.8, 0.1}).second;
  Context context;
  Json rows = Json::array();
  rows.push_back(compared(
      "halve", [&] { return reduced(picture, side / 2, side / 2, context); }, [&] { return halved(picture); }));
  for (const double sigma_px : {0.8, 1.6, 3.2})
    rows.push_back(compared(("blur " + std::to_string(sigma_px).substr(0, 3) + " px").c_str(),
                            [&] { return smoothed(picture, sigma_px, context); },
                            [&] { return blurred(picture, sigma_px); }));
  std::printf("%s\n", Json{{"side", side}, {"rows", rows}}.dump(2).c_str());
}
