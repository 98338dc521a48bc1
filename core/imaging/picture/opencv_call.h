// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The only way into OpenCV: its exceptions become ours, and it prints nothing.
#include <functional>
#include <opencv2/core.hpp>

#include "imaging/picture/weighted_picture.h"

namespace formwright {

/// Runs `act`, which calls OpenCV. Throws std::bad_alloc where OpenCV had no memory, Error{internal} for whatever else
/// it refuses.
void opencv_call(const std::function<void()>& act);

/// The picture's own pixels, four floats each, as a matrix; it must not outlive the picture.
cv::Mat matrix_over(WeightedPicture& picture);

}  // namespace formwright
