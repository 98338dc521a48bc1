// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/curve/zipper_curve.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/random.h"
#include "zippable/zippable_shapes.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using std::numbers::pi;

Parameterisation charted(const Segmentation& s) {
  Context context;
  return parameterise(s, {1e-10}, context);
}

/// The surface point over (x, y) of a part, by looking at all triangles.
Vec3 lifted(const Segmentation& s, const Parameterisation& p, int part, double x, double y) {
  double best = -1e300;
  Vec3 result = Vec3::Zero();
  for (int f = 0; f < s.mesh.face_count(); ++f) {
    if (s.face_segment[f] != part) continue;
    const Vec2 a = p.corners_mm.row(3 * f), b = p.corners_mm.row(3 * f + 1), c = p.corners_mm.row(3 * f + 2);
    for (int turn = -1; turn <= 1; ++turn) {
      const Vec2 q(x - p.period_mm[part] * (std::floor(x / p.period_mm[part]) + turn), y);
      Eigen::Matrix2d m;
      m << b - a, c - a;
      const Vec2 w = m.inverse() * (q - a);
      const double minimum = std::min({w.x(), w.y(), 1 - w.x() - w.y()});
      if (minimum <= best) continue;
      best = minimum;
      result = (s.mesh.V.row(s.mesh.F(f, 0)) * (1 - w.x() - w.y()) + s.mesh.V.row(s.mesh.F(f, 1)) * w.x() +
                s.mesh.V.row(s.mesh.F(f, 2)) * w.y())
                   .transpose();
    }
  }
  return result;
}

TEST_CASE("LineTrace.OnACylinderIsTheHelix") {
  const int around = 48;
  const Segmentation s = test::alone(test::tube(around, 24));  // radius 1, height 1
  const Parameterisation p = charted(s);
  const LineTracer tracer(s, p);
  const double period = p.period_mm[0];
  const TracedLine line = tracer.trace(0, 0, 7.3 * period);
  CHECK(line.x_mm.size() > 7u * around);
  const double start = std::atan2(line.position_mm[0].y(), line.position_mm[0].x());
  for (std::size_t i = 0; i < line.x_mm.size(); ++i) {
    const double turns = line.x_mm[i] / period;
    CHECK_THAT(line.position_mm[i].z(), WithinAbs(turns / 7.3, 1e-9));
    // On the prism a share of a side is a share of its chord.
    const double sides = turns * around, whole = std::floor(sides + 1e-9), share = sides - whole;
    const auto corner = [&](double k) {
      return Vec2(std::cos(start + 2 * pi * k / around), std::sin(start + 2 * pi * k / around));
    };
    const Vec2 expected = (1 - share) * corner(whole) + share * corner(whole + 1);
    CHECK((line.position_mm[i].head<2>() - expected).norm() <= 1e-8);
  }
}

TEST_CASE("LineTrace.LiesOverTheStraightLineOnEveryPart") {
  for (const char* sample : {"t_shape", "cat", "bust"}) {
    const Segmentation s = test::proposed(sample, 1500).segmentation;
    const Parameterisation p = charted(s);
    const LineTracer tracer(s, p);
    test::Random random(3);
    for (int trial = 0; trial < 12; ++trial) {
      const int part = random.below(s.part_count());
      const double low = random.uniform(-2, 3) * p.period_mm[part],
                   high = low + random.uniform(0.01, 6) * p.period_mm[part];
      const TracedLine line = tracer.trace(part, low, high);
      CHECK(std::is_sorted(line.x_mm.begin(), line.x_mm.end()));
      for (int k = 0; k <= 8; ++k) {
        const double x = low + (high - low) * k / 8;
        INFO(sample << " part " << part << " at " << k);
        CHECK((line.at(x) - lifted(s, p, part, x, p.height_mm[part] * k / 8)).norm() <= 1e-6);
      }
    }
  }
}

TEST_CASE("Traversals.AreTheHamiltonianPaths") {
  const Segmentation t = test::proposed("t_shape", 1500).segmentation;
  CHECK(traversals(t, Context()).size() == 6u);  // three parts, each beside both others
  const Segmentation s = test::proposed("octopus", 6000).segmentation;
  const auto all = traversals(s, Context(), 100000);
  CHECK(all.size() > 100u);
  for (const Traversal& traversal : all) {
    REQUIRE(traversal.parts.size() == static_cast<std::size_t>(s.part_count()));
    std::vector<int> sorted = traversal.parts;
    std::sort(sorted.begin(), sorted.end());
    for (int i = 0; i < s.part_count(); ++i) CHECK(sorted[i] == i);
    for (std::size_t i = 0; i < traversal.interfaces.size(); ++i) {
      const Interface& interface = s.interfaces[traversal.interfaces[i]];
      const std::pair sides = std::minmax(interface.left, interface.right),
                      parts = std::minmax(traversal.parts[i], traversal.parts[i + 1]);
      CHECK(sides == parts);
    }
  }
  CHECK(traversals(test::alone(test::tube(12, 4)), Context()).size() == 1u);
}

/// Parts that only share what the list of pairs says.
Segmentation parts_sharing(int parts, const std::vector<std::pair<int, int>>& borders) {
  Segmentation s;
  s.segments.resize(static_cast<std::size_t>(parts));
  for (const auto& [left, right] : borders) {
    Interface interface;
    interface.left = left, interface.right = right;
    s.interfaces.push_back(interface);
  }
  return s;
}

TEST_CASE("Traversals.AreAllOfSmallGraphs") {
  // Against every order of the parts, for random graphs.
  Random random(7);
  for (int round = 0; round < 200; ++round) {
    const int parts = 2 + static_cast<int>(random.below(5));
    std::vector<std::pair<int, int>> borders;
    for (int a = 0; a < parts; ++a)
      for (int b = a + 1; b < parts; ++b)
        if (random.below(2) == 0) borders.emplace_back(a, b);
    std::vector<int> order(static_cast<std::size_t>(parts));
    std::iota(order.begin(), order.end(), 0);
    std::vector<std::vector<int>> expected, found;
    do {
      bool joined = true;
      for (std::size_t i = 0; i + 1 < order.size(); ++i)
        joined = joined && std::find(borders.begin(), borders.end(),
                                     std::pair<int, int>(std::minmax(order[i], order[i + 1]))) != borders.end();
      if (joined) expected.push_back(order);
    } while (std::next_permutation(order.begin(), order.end()));
    for (const Traversal& traversal : traversals(parts_sharing(parts, borders), Context()))
      found.push_back(traversal.parts);
    INFO(round);
    CHECK(found == expected);
  }
}

TEST_CASE("Traversals.WithoutAnOrderAreGivenUpSoon") {
  // A rich graph of forty parts with three tips: no order has more than two ends, which plain search never finds out.
  std::vector<std::pair<int, int>> borders;
  for (int a = 0; a < 37; ++a)
    for (int b = a + 1; b < 37; ++b)
      if (b - a < 6) borders.emplace_back(a, b);
  for (int tip = 37; tip < 40; ++tip) borders.emplace_back(tip - 20, tip);
  CHECK(traversals(parts_sharing(40, borders), Context(), 1).empty());
  // 14 parts against 17 have none either, since a path would have to alternate; that does not show soon, so it can be
  // cancelled.
  Host host;
  host.cancel_requested = [] { return true; };
  std::vector<std::pair<int, int>> two_sided;
  for (int a = 0; a < 14; ++a)
    for (int b = 14; b < 31; ++b) two_sided.emplace_back(a, b);
  CHECK_THROWS_AS(traversals(parts_sharing(31, two_sided), Context(host), 1), Error);
}

TEST_CASE("Crossings.AreTheSamePointOnBothSides") {
  const Segmentation s = test::proposed("star", 3000).segmentation;
  const Parameterisation p = charted(s);
  const LineTracer tracer(s, p);
  for (const RankedTraversal& ranked : ranked_traversals(s, p, 10, Context(), 40)) {
    const auto& [traversal, crossings, cost] = ranked;
    for (std::size_t i = 0; i + 1 < traversal.parts.size(); ++i) {
      const Vec3 out = tracer.on_line(traversal.parts[i], false, crossings.exit_mm[i]),
                 in = tracer.on_line(traversal.parts[i + 1], false, crossings.entry_mm[i + 1]);
      CHECK((out - in).norm() <= 1e-9);
      const LinePoint there = across_interface(s, p, {traversal.parts[i], crossings.exit_mm[i]});
      CHECK(there.part == traversal.parts[i + 1]);
      CHECK_THAT(there.x_mm, WithinAbs(crossings.entry_mm[i + 1], 1e-9));
    }
  }
}

TEST_CASE("Crossings.NoOtherPlacesAreMoreEven") {
  const Segmentation s = test::proposed("octopus", 4000).segmentation;
  const Parameterisation p = charted(s);
  test::Random random(9);
  const auto unevenness = [&](const Traversal& traversal, const std::vector<double>& along) {
    double sum = 0;
    const int parts = static_cast<int>(traversal.parts.size());
    for (int i = 1; i + 1 < parts; ++i) {
      const int part = traversal.parts[i];
      double before = 0, in = 0, out = 0;
      for (const InterfaceUse& use : s.segments[part].bottom.uses) {
        const double length = p.interface_length_mm[use.interface];
        const auto x = [&](int k) { return before + (use.forward ? along[k] : length - along[k]); };
        if (use.interface == traversal.interfaces[i - 1]) in = x(i - 1);
        if (use.interface == traversal.interfaces[i]) out = x(i);
        before += length;
      }
      const double share = (out - in) / p.period_mm[part] + (out < in ? 1 : 0) - 0.5;
      sum += share * share / (parts - 2);
    }
    return sum;
  };
  const auto all = traversals(s, Context(), 30);
  for (const Traversal& traversal : all) {
    const Crossings best = best_crossings(s, p, traversal);
    CHECK_THAT(best.unevenness, WithinAbs(unevenness(traversal, best.along_mm), 1e-12));
    for (int trial = 0; trial < 60; ++trial) {
      std::vector<double> other = best.along_mm;
      for (std::size_t i = 0; i < other.size(); ++i) {
        const double length = p.interface_length_mm[traversal.interfaces[i]], reach = trial % 2 == 0 ? 0.02 : 1;
        other[i] = std::clamp(other[i] + reach * random.uniform(-1, 1) * length, 0.1 * length, 0.9 * length);
      }
      CHECK(unevenness(traversal, other) >= best.unevenness - 2e-4);  // the pull to the middles may cost so much
    }
  }
}

TEST_CASE("ZipperCurve.IsOneCurveFromOpeningToOpening") {
  for (const char* sample : {"sphere", "t_shape", "star", "octopus"}) {
    CAPTURE(sample);
    CurveOptions options;
    options.width_mm = 8, options.sample_mm = 2;
    const test::Zipped z = std::string_view(sample) == "sphere"
                               ? test::zip(test::alone(test::cylinder_side(30, 80, 40, 30)), options)
                               : test::zip(test::proposed(sample, 4000, 3).segmentation, options);
    const int parts = z.segmentation.part_count();
    CHECK(z.curve.lines.size() == (parts == 1 ? 1u : static_cast<std::size_t>(2 * parts - 2)));
    CHECK(z.curve.pieces.size() == (parts == 1 ? 1u : static_cast<std::size_t>(parts - 1)));
    CHECK(z.curve.fermat_spirals == std::max(0, parts - 2));
    // Along a piece no step is longer than a few samples: crossings join.
    for (const auto& piece : z.curve.pieces)
      for (std::size_t i = 0; i + 1 < piece.size(); ++i)
        CHECK((z.curve.samples[piece[i]].position_mm - z.curve.samples[piece[i + 1]].position_mm).norm() <=
              5 * options.sample_mm);
    // Both lines of a Fermat spiral reach the opening half a period apart.
    for (std::size_t l = 0; l + 1 < z.curve.lines.size(); ++l) {
      const SpiralLine &in = z.curve.lines[l], &out = z.curve.lines[l + 1];
      if (in.part == out.part) {
        CHECK_THAT(out.x_high_mm - in.x_high_mm, WithinAbs(0.5 * z.parameterisation.period_mm[in.part], 1e-9));
      }
    }
  }
}

}  // namespace
}  // namespace formwright
