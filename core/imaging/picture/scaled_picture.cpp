// SPDX-License-Identifier: GPL-3.0-or-later
// Smaller and blurred pictures, by OpenCV. Colours are weighted: what is not known does not count.
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "imaging/picture/opencv_call.h"
#include "imaging/picture/weighted_picture.h"

namespace formwright {
namespace {

constexpr std::size_t pixels_a_chunk = 1 << 15;
constexpr int rows_a_band = 256;  // between two questions whether the job is cancelled

/// Colours times their weight, the weight itself in lane 3.
WeightedPicture weighed(const WeightedPicture& picture) {
  WeightedPicture result(picture.width, picture.height);
  parallel_for(picture.pixels.size(), pixels_a_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Float4& p = picture.pixels[i];
      result.pixels[i] = Float4{p[0] * p[3], p[1] * p[3], p[2] * p[3], p[3]};
    }
  });
  return result;
}

void unweigh(WeightedPicture& picture) {
  parallel_for(picture.pixels.size(), pixels_a_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Float4& p = picture.pixels[i];
      const float scale = p[3] > 1e-6f ? 1 / p[3] : 0;
      p = Float4{p[0] * scale, p[1] * scale, p[2] * scale, p[3] > 1e-6f ? std::min(p[3], 1.0f) : 0.0f};
    }
  });
}

}  // namespace

WeightedPicture reduced(const WeightedPicture& picture, int width, int height, const Context& context) {
  if (width < 1 || height < 1 || width > picture.width || height > picture.height || 4 * width < picture.width ||
      4 * height < picture.height)
    throw Error(ErrorCode::internal, "", "A picture can be reduced to a quarter at once, not further.");
  if (width == picture.width && height == picture.height) return picture;
  context.check_cancelled();
  WeightedPicture source = weighed(picture), result(width, height);
  opencv_call([&] {
    cv::Mat to = matrix_over(result);
    cv::resize(matrix_over(source), to, to.size(), 0, 0, cv::INTER_AREA);
  });
  context.check_cancelled();
  unweigh(result);
  return result;
}

WeightedPicture smoothed(const WeightedPicture& picture, double sigma_px, const Context& context) {
  if (!(sigma_px > 0)) return picture;
  const int radius = std::max(1, static_cast<int>(std::ceil(3 * sigma_px)));
  WeightedPicture source = weighed(picture), result(picture.width, picture.height);
  const int bands = (picture.height + rows_a_band - 1) / rows_a_band;
  parallel_for(static_cast<std::size_t>(bands), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t band = begin; band < end; ++band) {
      context.check_cancelled();
      const int first = static_cast<int>(band) * rows_a_band, last = std::min(first + rows_a_band, picture.height);
      opencv_call([&] {
        // A band of rows sees the rows beside it, because it is a part of the whole matrix.
        cv::Mat to = matrix_over(result).rowRange(first, last);
        cv::GaussianBlur(matrix_over(source).rowRange(first, last), to, cv::Size(2 * radius + 1, 2 * radius + 1),
                         sigma_px, sigma_px, cv::BORDER_REPLICATE);
      });
    }
  });
  unweigh(result);
  return result;
}

}  // namespace formwright
