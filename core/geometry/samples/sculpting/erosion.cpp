// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/samples/sculpting/erosion.h"

#include <algorithm>
#include <numeric>

#include "base/parallel.h"
#include "geometry/samples/sculpting/noise.h"

namespace formwright::samples {
namespace {

constexpr double erodibility = 1.0;

double lerp(double a, double b, double t) { return a + (b - a) * t; }

// Rock that rises faster under the main ridge: a bent spine from corner to corner with two spurs.
double uplift(double u, double v) {
  const double x = 2 * u - 1, z = 2 * v - 1;
  const double bend = 0.25 * noise(x * 1.3, z * 1.3, 40);
  const double across = 0.8 * x + 0.55 * z + bend, along = 0.55 * x - 0.8 * z;
  const double spine = exponential(-across * across / 0.10) * exponential(-along * along / 0.5);
  const double broad = exponential(-(x * x + z * z) / 0.5);
  return 0.25 + 0.9 * broad + 1.1 * spine + 0.25 * noise(x * 2.1, z * 2.1, 41);
}

}  // namespace

ErodedTerrain::ErodedTerrain(double side_mm, double height_mm, Context& context) : side_(side_mm) {
  resize(65);
  for (int j = 1; j + 1 < n_; ++j)
    for (int i = 1; i + 1 < n_; ++i) {
      const double u = static_cast<double>(i) / (n_ - 1), v = static_cast<double>(j) / (n_ - 1);
      height_[node(i, j)] = 0.02 * (1.5 + fractal_noise({u * 6, v * 6, 0.5}, 4, 0.6, 42));
    }
  erode(60, 0.06, context);
  resize(129);
  erode(16, 0.03, context);
  resize(257);
  erode(7, 0.012, context);
  const double top = *std::max_element(height_.begin(), height_.end());
  for (double& h : height_) h *= height_mm / top;
}

void ErodedTerrain::resize(int n) {
  const ErodedTerrain coarse = *this;
  n_ = n;
  const std::size_t count = static_cast<std::size_t>(n) * static_cast<std::size_t>(n);
  jitter_x_.assign(count, 0);
  jitter_z_.assign(count, 0);
  height_.assign(count, 0);
  drainage_.assign(count, 0);
  for (int j = 1; j + 1 < n; ++j)
    for (int i = 1; i + 1 < n; ++i) {
      const std::uint32_t h = hash(static_cast<std::uint32_t>(i) * 7919U + static_cast<std::uint32_t>(j) * 104729U +
                                   static_cast<std::uint32_t>(n));
      jitter_x_[node(i, j)] = static_cast<float>(0.6 * ((h & 0xffffU) / 65536.0 - 0.5));
      jitter_z_[node(i, j)] = static_cast<float>(0.6 * ((h >> 16) / 65536.0 - 0.5));
    }
  if (coarse.n_ == 0) return;
  parallel_for(count, 4096, [&](std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k) {
      const int i = static_cast<int>(k) % n, j = static_cast<int>(k) / n;
      if (i == 0 || j == 0 || i == n - 1 || j == n - 1) continue;
      const double x = ((i + static_cast<double>(jitter_x_[k])) / (n - 1) - 0.5) * side_,
                   z = ((j + static_cast<double>(jitter_z_[k])) / (n - 1) - 0.5) * side_;
      // A grain of noise starts the new, smaller valleys.
      height_[k] =
          std::max(0.0, coarse.at(x, z).height + 0.003 * noise(x * 0.9, z * 0.9, static_cast<std::uint32_t>(n)));
    }
  });
}

void ErodedTerrain::erode(int steps, double time_step, Context& context) {
  const std::size_t count = height_.size();
  const double cell = 1.0 / (n_ - 1);  // erosion runs in a unit square
  const std::ptrdiff_t beside[8] = {-1, 1, -n_, n_, -n_ - 1, -n_ + 1, n_ - 1, n_ + 1};
  std::vector<double> px(count), pz(count), lift(count);
  for (int j = 0; j < n_; ++j)
    for (int i = 0; i < n_; ++i) {
      px[node(i, j)] = (i + static_cast<double>(jitter_x_[node(i, j)])) * cell;
      pz[node(i, j)] = (j + static_cast<double>(jitter_z_[node(i, j)])) * cell;
      lift[node(i, j)] = uplift(px[node(i, j)], pz[node(i, j)]);
    }
  const auto rim = [&](std::size_t k) {
    const int i = static_cast<int>(k) % n_, j = static_cast<int>(k) / n_;
    return i == 0 || j == 0 || i == n_ - 1 || j == n_ - 1;
  };
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::vector<std::size_t> receiver(count);
  std::vector<double> run(count), smooth(count);
  for (int step = 0; step < steps; ++step) {
    context.check_cancelled();
    parallel_for(count, 4096, [&](std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        receiver[k] = k;
        run[k] = cell;
        if (rim(k)) continue;
        double steepest = 0;
        for (std::ptrdiff_t b : beside) {
          const std::size_t m = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(k) + b);
          const double dx = px[m] - px[k], dz = pz[m] - pz[k], distance = std::sqrt(dx * dx + dz * dz);
          const double slope = (height_[k] - height_[m]) / distance;
          if (slope > steepest) {
            steepest = slope;
            receiver[k] = m;
            run[k] = distance;
          }
        }
      }
    });
    std::sort(order.begin(), order.end(), [&](int a, int b) {
      const double ha = height_[static_cast<std::size_t>(a)], hb = height_[static_cast<std::size_t>(b)];
      return ha != hb ? ha > hb : a < b;
    });
    std::fill(drainage_.begin(), drainage_.end(), cell * cell);
    for (int k : order) {
      const auto a = static_cast<std::size_t>(k);
      if (receiver[a] != a) drainage_[receiver[a]] += drainage_[a];
    }
    for (auto it = order.rbegin(); it != order.rend(); ++it) {
      const auto k = static_cast<std::size_t>(*it);
      if (rim(k)) continue;
      const double risen = height_[k] + time_step * lift[k];
      if (receiver[k] == k) {
        height_[k] = risen;
        continue;
      }
      const double f = erodibility * time_step * 14 * std::sqrt(drainage_[k]) / run[k];
      height_[k] = std::min(risen, (risen + f * height_[receiver[k]]) / (1 + f));
    }
    // Creep of the slopes, and nothing steeper than loose rock can stand.
    const double creep = std::min(0.16, 2.2e-4 * time_step / (cell * cell));
    smooth = height_;
    parallel_for(count, 4096, [&](std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        if (rim(k)) continue;
        double sum = 0;
        for (std::size_t b = 0; b < 4; ++b)
          sum += smooth[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(k) + beside[b])];
        height_[k] += creep * (sum - 4 * smooth[k]);
      }
    });
  }
}

ErodedTerrain::Sample ErodedTerrain::at(double x, double z) const {
  const double gx = (x / side_ + 0.5) * (n_ - 1), gz = (z / side_ + 0.5) * (n_ - 1);
  const double maximum = n_ - 1;
  const auto cell_of = [&](double g, int& i, double& t) {
    const double c = clamp(g, 0, maximum - 1e-9);
    i = static_cast<int>(c);
    t = c - i;
  };
  // Where does the jittered sheet of nodes lie over this point? u + jitter(u) = g, a contraction.
  double u = gx, v = gz;
  int i, j;
  double s, t;
  for (int k = 0; k < 5; ++k) {
    cell_of(u, i, s);
    cell_of(v, j, t);
    const auto bilinear = [&](const std::vector<float>& f) {
      return lerp(lerp(static_cast<double>(f[node(i, j)]), static_cast<double>(f[node(i + 1, j)]), s),
                  lerp(static_cast<double>(f[node(i, j + 1)]), static_cast<double>(f[node(i + 1, j + 1)]), s), t);
    };
    const double ju = bilinear(jitter_x_), jv = bilinear(jitter_z_);
    u = gx - ju;
    v = gz - jv;
  }
  cell_of(u, i, s);
  cell_of(v, j, t);
  // Cubic B-splines: smooth, never overshooting.
  const auto weights = [](double f, double* w) {
    w[0] = (1 - f) * (1 - f) * (1 - f) / 6;
    w[1] = (3 * f * f * f - 6 * f * f + 4) / 6;
    w[2] = (-3 * f * f * f + 3 * f * f + 3 * f + 1) / 6;
    w[3] = f * f * f / 6;
  };
  double ws[4], wt[4];
  weights(s, ws);
  weights(t, wt);
  const bool inside = i > 0 && j > 0 && i + 2 < n_ && j + 2 < n_;
  Sample sample{0, 0};
  for (int b = 0; b < 4; ++b)
    for (int a = 0; a < 4; ++a) {
      const std::size_t k = inside ? node(i - 1 + a, j - 1 + b)
                                   : node(std::clamp(i - 1 + a, 0, n_ - 1), std::clamp(j - 1 + b, 0, n_ - 1));
      const double w = ws[a] * wt[b];
      sample.height += w * height_[k];
      sample.drainage += w * drainage_[k];
    }
  return sample;
}

}  // namespace formwright::samples
