// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/zippable/tucked_limbs.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/format.h"

namespace formwright {
namespace {

constexpr int max_limbs = 10;
constexpr std::size_t max_stretches_named = 3;

/// Per vertex, the one that it is sewn to which has the lowest number.
std::vector<int> sewn_to(const RibbonPattern& pattern) {
  std::vector<int> parent(static_cast<std::size_t>(pattern.flat.vertex_count()));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int v) {
    while (parent[static_cast<std::size_t>(v)] != v) v = parent[static_cast<std::size_t>(v)];
    return v;
  };
  const auto join = [&](int a, int b) {
    const auto [low, high] = std::minmax({root(a), root(b)});
    parent[static_cast<std::size_t>(high)] = low;
  };
  for (const SeamPair& pair : pattern.seams) join(pair.left, pair.right);
  for (const ClosurePair& pair : pattern.closures) join(pair.left, pair.right);
  for (std::size_t v = 0; v < parent.size(); ++v) parent[v] = root(static_cast<int>(v));
  return parent;
}

std::vector<std::array<double, 2>> zipper_on(const RibbonPattern& pattern, const Eigen::VectorXd& distance_mm,
                                             double length_mm) {
  std::vector<std::array<double, 2>> stretches;
  bool before = false;
  for (const SeamPair& pair : pattern.seams) {
    const bool on = distance_mm[pair.left] < length_mm;
    if (on && !before) stretches.push_back({pair.along_mm, pair.along_mm});
    if (on) stretches.back()[1] = pair.along_mm;
    before = on;
  }
  return stretches;
}

}  // namespace

ClosedShape closed_shape(const RibbonPattern& pattern) {
  const std::vector<int> one = sewn_to(pattern);
  ClosedShape shape;
  shape.vertex.assign(one.size(), -1);
  TriangleMesh& mesh = shape.mesh;
  mesh.V.resize(pattern.predicted_mm.rows(), 3);
  int count = 0;
  for (std::size_t v = 0; v < one.size(); ++v) {
    const bool first = one[v] == static_cast<int>(v);
    if (first) mesh.V.row(count) = pattern.predicted_mm.row(static_cast<Eigen::Index>(v));
    shape.vertex[v] = first ? count++ : shape.vertex[static_cast<std::size_t>(one[v])];
  }
  mesh.V.conservativeResize(count, 3);
  mesh.F.resize(pattern.flat.F.rows(), 3);
  Eigen::Index faces = 0;
  for (Eigen::Index f = 0; f < pattern.flat.F.rows(); ++f) {
    Eigen::RowVector3i t;
    for (int k = 0; k < 3; ++k) t[k] = shape.vertex[static_cast<std::size_t>(pattern.flat.F(f, k))];
    // Where the zipper turns about a point, a triangle may be sewn to itself.
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh.F.row(faces++) = t;
  }
  mesh.F.conservativeResize(faces, 3);
  return shape;
}

std::vector<RibbonLimb> limbs_of(const RibbonPattern& pattern, Context& context) {
  const ClosedShape shape = closed_shape(pattern);
  std::vector<RibbonLimb> limbs;
  for (Limb& limb : find_limbs(shape.mesh, max_limbs, context)) {
    limb.distance_mm = Eigen::VectorXd(limb.distance_mm(shape.vertex));
    RibbonLimb own{std::move(limb), {}};
    own.zipper_mm = zipper_on(pattern, own.limb.distance_mm, own.limb.length_mm);
    if (!own.zipper_mm.empty()) limbs.push_back(std::move(own));
  }
  std::stable_sort(limbs.begin(), limbs.end(), [](const RibbonLimb& a, const RibbonLimb& b) {
    return a.zipper_mm.front()[0] < b.zipper_mm.front()[0];
  });
  return limbs;
}

std::string limb_place(const RibbonLimb& limb, double marker_spacing_mm) {
  struct Marks {
    int first, last;
  };
  std::vector<Marks> marks;
  for (const auto& [from, to] : limb.zipper_mm) {
    const Marks on{static_cast<int>(std::ceil(from / marker_spacing_mm)),
                   static_cast<int>(std::floor(to / marker_spacing_mm))};
    if (on.first <= on.last) marks.push_back(on);
  }
  if (marks.empty()) return with_digits(limb.zipper_mm.front()[0], 2) + " mm along the zipper";
  // The longest say it best.
  std::stable_sort(marks.begin(), marks.end(),
                   [](const Marks& a, const Marks& b) { return a.last - a.first > b.last - b.first; });
  if (marks.size() > max_stretches_named) marks.resize(max_stretches_named);
  std::sort(marks.begin(), marks.end(), [](const Marks& a, const Marks& b) { return a.first < b.first; });
  std::string text;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (i > 0) text += i + 1 == marks.size() ? " and " : ", ";
    text += std::to_string(marks[i].first);
    if (marks[i].last > marks[i].first) text += " to " + std::to_string(marks[i].last);
  }
  const bool one = marks.size() == 1 && marks[0].first == marks[0].last;
  return (one ? "with mark " : "with marks ") + text;
}

}  // namespace formwright
