// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/shared/vertex_merge.h"

#include <algorithm>
#include <bit>

namespace formwright {
namespace {

std::uint64_t hash_of(double x, double y, double z) {
  // Multiply and fold (as wyhash does): coordinates differ in few bits, often the high ones only.
  const auto mix = [](std::uint64_t h, double value) {
    h = (h ^ std::bit_cast<std::uint64_t>(value)) * 0x9E3779B97F4A7C15ull;
    return h ^ (h >> 32);
  };
  return mix(mix(mix(0x2545F4914F6CDD1Dull, x), y), z) * 0xD6E8FEB86659FD93ull;
}

}  // namespace

VertexMerger::VertexMerger(std::size_t expected_vertices) {
  points_.reserve(3 * expected_vertices);
  slots_.assign(std::bit_ceil(std::max<std::size_t>(64, 2 * expected_vertices)), -1);
}

std::size_t VertexMerger::slot_of(double x, double y, double z) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = static_cast<std::size_t>(hash_of(x, y, z) >> 20) & mask;
  while (slots_[slot] >= 0) {
    const double* p = points_.data() + 3 * static_cast<std::size_t>(slots_[slot]);
    if (p[0] == x && p[1] == y && p[2] == z) break;
    slot = (slot + 1) & mask;
  }
  return slot;
}

int VertexMerger::add(double x, double y, double z) {
  x += 0.0, y += 0.0, z += 0.0;  // -0 + 0 = 0
  const std::size_t slot = slot_of(x, y, z);
  if (slots_[slot] >= 0) return slots_[slot];
  const int index = vertex_count();
  points_.insert(points_.end(), {x, y, z});
  slots_[slot] = index;
  if (3 * static_cast<std::size_t>(vertex_count()) > 2 * slots_.size()) grow();
  return index;
}

void VertexMerger::grow() {
  slots_.assign(2 * slots_.size(), -1);
  for (int i = 0; i < vertex_count(); ++i) {
    const double* p = points_.data() + 3 * static_cast<std::size_t>(i);
    slots_[slot_of(p[0], p[1], p[2])] = i;
  }
}

Positions VertexMerger::positions() const {
  return Eigen::Map<const Positions>(points_.data(), static_cast<Eigen::Index>(points_.size() / 3), 3);
}

}  // namespace formwright
