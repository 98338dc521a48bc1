// SPDX-License-Identifier: GPL-3.0-or-later
#include "imaging/opencv/homography.h"

#include <opencv2/imgproc.hpp>

#include "imaging/opencv/opencv_call.h"

namespace formwright {

Eigen::Matrix3d projective_map(const std::array<Vec2, 4>& from, const std::array<Vec2, 4>& to) {
  std::array<cv::Point2f, 4> source, target;
  for (std::size_t k = 0; k < 4; ++k) {
    source[k] = cv::Point2f(static_cast<float>(from[k].x()), static_cast<float>(from[k].y()));
    target[k] = cv::Point2f(static_cast<float>(to[k].x()), static_cast<float>(to[k].y()));
  }
  Eigen::Matrix3d map;
  opencv_call([&] {
    const cv::Mat found = cv::getPerspectiveTransform(source.data(), target.data());
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) map(row, column) = found.at<double>(row, column);
  });
  return map;
}

}  // namespace formwright
