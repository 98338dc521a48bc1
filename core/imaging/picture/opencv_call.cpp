// SPDX-License-Identifier: GPL-3.0-or-later
#include "imaging/picture/opencv_call.h"

#include <mutex>
#include <new>
#include <string>

#include "base/error.h"

namespace formwright {
namespace {

int print_nothing(int, const char*, const char*, const char*, int, void*) { return 0; }

}  // namespace

void opencv_call(const std::function<void()>& act) {
  static std::once_flag once;
  std::call_once(once, [] { cv::redirectError(print_nothing); });
  try {
    act();
  } catch (const cv::Exception& exception) {
    if (exception.code == cv::Error::StsNoMem) throw std::bad_alloc();
    throw Error(ErrorCode::internal, "",
                "OpenCV refused a picture (" + exception.err + "): this is a bug in Formwright, please report it.");
  }
}

cv::Mat matrix_over(WeightedPicture& picture) {
  return cv::Mat(picture.height, picture.width, CV_32FC4, picture.pixels.data());
}

}  // namespace formwright
