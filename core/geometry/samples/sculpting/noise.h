// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Seeded noise and a seeded engine: integer hashes, no tables, no global state.
#include <cstdint>

#include "geometry/samples/sculpting/point.h"
#include "geometry/samples/sculpting/portable_math.h"

namespace formwright::samples {

/// Avalanching 32-bit hash (lowbias32: Wellons 2018).
inline std::uint32_t hash(std::uint32_t v) {
  v ^= v >> 16;
  v *= 0x7feb352dU;
  v ^= v >> 15;
  v *= 0x846ca68bU;
  v ^= v >> 16;
  return v;
}

/// Pseudo-random numbers in a fixed sequence for a seed.
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : state_(hash(seed + 0x9e3779b9U)) {}
  double uniform(double low = 0, double high = 1) {
    state_ += 0x9e3779b9U;
    return low + (high - low) * (hash(state_) * (1.0 / 4294967296.0));
  }
  /// Bell-shaped, mean 0, within [-1, 1], standard deviation about 0.4.
  double bell() { return (uniform() + uniform() + uniform()) / 1.5 - 1; }

 private:
  std::uint32_t state_;
};

/// Gradient noise (Perlin 2002) in 3D, period-free, about -1 to 1, mean 0, wavelength about 1.
double noise(const Point& p, std::uint32_t seed = 0);
/// `octaves` of noise, each of half the wavelength and `gain` times the height of the one before.
double fractal_noise(const Point& p, int octaves, double gain = 0.5, std::uint32_t seed = 0);
/// The same in the plane.
double noise(double x, double y, std::uint32_t seed = 0);

/// Distances from p to the nearest and second nearest of one random point per unit cell (Worley 1996).
struct CellDistances {
  double nearest, second;
  std::uint32_t nearest_id;
};
CellDistances cell_noise(const Point& p, std::uint32_t seed = 0);

}  // namespace formwright::samples
