// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/solver/face_strips.h"

#include <algorithm>
#include <limits>

#include "base/parallel.h"

namespace formwright {

FaceStrips::FaceStrips(const Triangles& F, int min_faces) {
  constexpr int group = 4;
  const int faces = static_cast<int>(F.rows());
  if (faces == 0) return;
  // Of the faces from a group on, the least vertex; of those before it, the highest.
  const auto groups = static_cast<std::size_t>((faces + group - 1) / group);
  std::vector<int> minimum(groups + 1, std::numeric_limits<int>::max()), highest(groups + 1, -1);
  for (std::size_t g = groups; g-- > 0;) {
    const Eigen::Index first = group * static_cast<Eigen::Index>(g),
                       count = std::min<Eigen::Index>(group, faces - first);
    minimum[g] = std::min(minimum[g + 1], F.middleRows(first, count).minCoeff());
  }
  for (std::size_t g = 0; g < groups; ++g) {
    const Eigen::Index first = group * static_cast<Eigen::Index>(g),
                       count = std::min<Eigen::Index>(group, faces - first);
    highest[g + 1] = std::max(highest[g], F.middleRows(first, count).maxCoeff());
  }
  // A strip ends where the faces after it no longer reach those before it.
  std::size_t start = 0;
  for (std::size_t g = 1; g < groups; ++g) {
    if (group * static_cast<int>(g - start) < min_faces || minimum[g] <= highest[start]) continue;
    start = g;
    first_.push_back(group * static_cast<int>(g));
  }
  first_.push_back(faces);
}

void FaceStrips::for_each(const std::function<void(int, int)>& body) const {
  const auto strips = static_cast<std::size_t>(count());
  for (std::size_t colour = 0; colour < 2; ++colour)
    parallel_for((strips + 1 - colour) / 2, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) body(first_[2 * k + colour], first_[2 * k + colour + 1]);
    });
}

}  // namespace formwright
