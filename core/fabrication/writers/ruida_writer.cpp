// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/writers/ruida_writer.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <utility>

namespace formwright {
namespace {

constexpr unsigned key = 0x88;
constexpr int max_relative_um = 8191;

struct Micrometres {
  int x = 0, y = 0;
};

class Commands {
 public:
  Commands& code(std::initializer_list<int> bytes) {
    for (const int b : bytes) byte(b);
    return *this;
  }
  /// Seven bits a byte, five or two bytes, negative ones as their complement.
  Commands& number(std::int64_t value) { return bits(value, 5); }
  Commands& small(std::int64_t value) { return bits(value, 2); }
  Commands& point(const Micrometres& p) { return number(p.x).number(p.y); }
  Commands& power(double percent) { return small(static_cast<std::int64_t>(percent * 16383 / 100)); }
  Commands& speed(double mm_per_s) { return number(std::llround(1000 * mm_per_s)); }

  std::int64_t sum() const { return sum_; }
  Bytes take() { return std::move(bytes_); }

 private:
  void byte(int b) {
    sum_ += b;
    bytes_.push_back(swizzled(static_cast<std::byte>(b)));
  }
  Commands& bits(std::int64_t value, int count) {
    for (int i = count - 1; i >= 0; --i) byte(static_cast<int>((value >> (7 * i)) & 0x7f));
    return *this;
  }
  Bytes bytes_;
  std::int64_t sum_ = 0;
};

using Settings = std::pair<double, double>;  // power in per cent, speed in mm/s

struct Extent {
  Micrometres low{1 << 30, 1 << 30}, high{-(1 << 30), -(1 << 30)};
  void add(const Micrometres& p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
};

Micrometres micrometres(const Vec3& p, const MachineOptions& machine) {
  const Vec2 at = to_controller(p.head<2>(), machine);
  return {static_cast<int>(std::lround(1e3 * at.x())), static_cast<int>(std::lround(1e3 * at.y()))};
}

void move(Commands& out, const Micrometres& from, const Micrometres& to, bool burn, bool absolute) {
  const int dx = to.x - from.x, dy = to.y - from.y, base = burn ? 0xa8 : 0x88;
  if (dx == 0 && dy == 0 && !absolute) return;
  if (absolute || std::abs(dx) > max_relative_um || std::abs(dy) > max_relative_um) out.code({base}).point(to);
  else if (dy == 0) out.code({base + 2}).small(dx);
  else if (dx == 0) out.code({base + 3}).small(dy);
  else out.code({base + 1}).small(dx).small(dy);
}

void write_head(Commands& out, const Extent& whole, const std::vector<std::pair<Settings, Extent>>& layers) {
  out.code({0xd8, 0x10}).code({0xe6, 0x01}).code({0xf0}).code({0xf1, 0x02, 0});  // from the machine's zero, absolute
  out.code({0xd8, 0x00}).code({0xe7, 0x06}).number(0).number(0).code({0xe7, 0x38, 0});
  out.code({0xe7, 0x03}).point(whole.low).code({0xe7, 0x07}).point(whole.high);
  out.code({0xe7, 0x50}).point(whole.low).code({0xe7, 0x51}).point(whole.high);
  out.code({0xe7, 0x04}).small(1).small(1).small(0).small(0).small(0).small(0).small(0).code({0xe7, 0x05, 0});
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const int part = static_cast<int>(i);
    const auto& [settings, extent] = layers[i];
    out.code({0xc9, 0x04, part}).speed(settings.second);
    for (const int which : {0x31, 0x32, 0x41, 0x42}) out.code({0xc6, which, part}).power(settings.first);
    out.code({0xca, 0x06, part}).number(0).code({0xca, 0x41, part, 0});
    for (const int which : {0x52, 0x61})
      out.code({0xe7, which, part}).point(extent.low).code({0xe7, which + 1, part}).point(extent.high);
  }
  out.code({0xca, 0x22, static_cast<int>(layers.size()) - 1});
  for (const int which : {0x54, 0x55}) out.code({0xe7, which, 0}).number(0).code({0xe7, which, 1}).number(0);
  out.code({0xf1, 0x03}).number(0).number(0).code({0xe7, 0x0a}).number(0);
  out.code({0xea, 0}).code({0xe7, 0x60, 0}).code({0xe7, 0x0b, 0});
  out.code({0xe7, 0x13})
      .point(whole.low)
      .code({0xe7, 0x17})
      .point(whole.high)
      .code({0xe7, 0x23})
      .number(0)
      .number(0)
      .code({0xe7, 0x24, 0});
  out.code({0xe7, 0x08}).small(1).small(1).small(0).small(1123).small(-3328).small(4).small(3480);
}

void write_settings(Commands& out, int part, const Settings& settings, bool air_assist) {
  out.code({0xca, 0x02, part})
      .code({0xca, 0x01, 0x10})
      .code({0xca, 0x01, air_assist ? 0x13 : 0x12})
      .code({0xc9, 0x02})
      .speed(settings.second);
  out.code({0xc6, 0x12}).number(0).code({0xc6, 0x13}).number(0);
  for (const int which : {0x01, 0x02, 0x21, 0x22}) out.code({0xc6, which}).power(settings.first);
  out.code({0xca, 0x03, 1});
}

void write_layer_end(Commands& out) { out.code({0xe7, 0x00}).code({0xca, 0x01, 0x00}).code({0xca, 0x01, 0x30}); }

}  // namespace

std::byte swizzled(std::byte plain) {
  unsigned b = static_cast<unsigned>(plain);
  b ^= (b >> 7) & 0xff;
  b ^= (b << 7) & 0xff;
  b ^= (b >> 7) & 0xff;
  return static_cast<std::byte>(((b ^ key) + 1) & 0xff);
}

std::byte unswizzled(std::byte wire) {
  unsigned b = (static_cast<unsigned>(wire) - 1) & 0xff;
  b ^= key;
  b ^= (b >> 7) & 0xff;
  b ^= (b << 7) & 0xff;
  b ^= (b >> 7) & 0xff;
  return static_cast<std::byte>(b);
}

Bytes write_ruida(const Toolpath& path, const LaserMachineOptions& machine) {
  std::vector<std::pair<Settings, Extent>> layers;
  std::map<Settings, int> part_of;
  Extent whole;
  for (const ToolMove& m : path.moves) {
    if (!m.work) continue;
    const Settings settings{m.power_percent, m.speed_mm_per_s};
    const auto [found, fresh] = part_of.emplace(settings, static_cast<int>(layers.size()));
    if (fresh) layers.emplace_back(settings, Extent{});
    for (const Vec3& p : m.points_mm) {
      layers[static_cast<std::size_t>(found->second)].second.add(micrometres(p, machine));
      whole.add(micrometres(p, machine));
    }
  }
  if (layers.size() > 128)
    throw Error(ErrorCode::invalid_input, "controller",
                "The job has over 128 different powers and speeds, more than a Ruida file holds: use fewer.");
  Commands out;
  write_head(out, whole, layers);
  int part = -1;
  Micrometres at;
  for (const ToolMove& m : path.moves) {
    if (!m.work) continue;  // the jump to the next path is the controller's own
    const Settings settings{m.power_percent, m.speed_mm_per_s};
    if (const int now = part_of.at(settings); now != part) {
      if (part >= 0) write_layer_end(out);
      write_settings(out, part = now, settings, machine.air_assist);
    }
    for (std::size_t i = 0; i < m.points_mm.size(); ++i) {
      const Micrometres to = micrometres(m.points_mm[i], machine);
      move(out, at, to, i > 0, i == 0);
      at = to;
    }
  }
  write_layer_end(out);
  const std::int64_t sum = out.sum() + 0xd7;  // of all that comes before, and the end
  out.code({0xe5, 0x05}).number(sum);
  out.code({0xd7});
  return out.take();
}

}  // namespace formwright
