// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Gaussian noise of several scales, independent in each colour channel: a picture in which every place is unlike every
// other, whether seen from near or far (thesis 4.2.3; the grey one of Atcheson et al. 2008 had one channel).
#include <cstdint>
#include <vector>

#include "base/context.h"
#include "imaging/picture/image.h"

namespace formwright {

struct NoisePattern {
  std::uint32_t seed = 1;
  double pixel_mm = 0.2;
  std::vector<double> scales_mm;  // spacing of the random values of each scale
  double contrast = 0.2;          // standard deviation of the encoded colour, of the whole range
};

/// Scales from the finest, each twice the one before, none above the coarsest.
std::vector<double> octaves_mm(double finest_mm, double coarsest_mm);

/// sRGB, opaque; the origin of the noise lies in the middle of the picture, so that pictures of other sizes show the
/// same noise. Every scale has the same share of the variance. By integers, sums and products alone: the same bits on
/// every machine.
Image noise_picture(const NoisePattern& pattern, int width, int height, const Context& context);

}  // namespace formwright
