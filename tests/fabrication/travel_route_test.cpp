// SPDX-License-Identifier: GPL-3.0-or-later
#include "fabrication/toolpath/travel_route.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <numeric>
#include <set>

#include "base/random.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using Kind = RouteStop::Kind;

std::vector<RouteStop> random_stops(std::size_t count, Random& random) {
  std::vector<RouteStop> stops;
  const auto point = [&] { return Vec2(random.uniform(0, 100), random.uniform(0, 100)); };
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 at = point();
    switch (random.below(3)) {
      case 0: stops.push_back({Kind::loop, {at, at + Vec2(5, 0), at + Vec2(0, 5)}}); break;
      case 1: stops.push_back({Kind::line, {at, point()}}); break;
      default: stops.push_back({Kind::one_direction, {at, point()}});
    }
  }
  return stops;
}

double best_of_all(const std::vector<RouteStop>& stops) {
  std::vector<int> order(stops.size());
  std::iota(order.begin(), order.end(), 0);
  double best = 1e300;
  do {
    // The best doors of this order, stop by stop.
    std::vector<std::pair<Vec2, double>> states{{Vec2(0, 0), 0}};
    for (const int i : order) {
      const RouteStop& stop = stops[static_cast<std::size_t>(i)];
      std::vector<std::pair<Vec2, double>> next;
      for (std::size_t d = 0; d < (stop.kind == Kind::one_direction ? 1 : stop.doors_mm.size()); ++d) {
        double minimum = 1e300;
        for (const auto& [at, so_far] : states) minimum = std::min(minimum, so_far + (stop.doors_mm[d] - at).norm());
        next.emplace_back(stop.kind == Kind::loop ? stop.doors_mm[d] : stop.doors_mm[1 - d], minimum);
      }
      states = next;
    }
    for (const auto& state : states) best = std::min(best, state.second);
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

void expect_each_once(const std::vector<RouteStop>& stops, const std::vector<RouteStep>& route) {
  std::set<int> seen;
  for (const RouteStep& step : route) {
    seen.insert(step.stop);
    const RouteStop& stop = stops[static_cast<std::size_t>(step.stop)];
    CHECK(step.door >= 0);
    CHECK(step.door < static_cast<int>(stop.kind == Kind::one_direction ? 1 : stop.doors_mm.size()));
  }
  CHECK(seen.size() == stops.size());
  CHECK(route.size() == stops.size());
}

TEST_CASE("TravelRoute.IsCloseToTheBestOfAllOrders") {
  double sum = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    const auto stops = random_stops(7, random);
    const auto route = short_route(stops, {0, 0}, Context());
    expect_each_once(stops, route);
    const double ratio = route_length_mm(stops, route, {0, 0}) / best_of_all(stops);
    {
      INFO(seed);
      CHECK(ratio >= 1 - 1e-9);
      CHECK(ratio <= 1.3);
    }
    sum += ratio;
  }
  CHECK(sum / 20 < 1.05);
}

TEST_CASE("TravelRoute.AGridIsWalkedToAndFro") {
  std::vector<RouteStop> stops;
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x) stops.push_back({Kind::loop, {Vec2(10 * ((x * 7) % 20), 10 * ((y * 11) % 20))}});
  const auto route = short_route(stops, {0, 0}, Context());
  expect_each_once(stops, route);
  CHECK(route_length_mm(stops, route, {0, 0}) < 3990 * 1.06);
}

TEST_CASE("TravelRoute.MoreRoundsAreNeverLonger") {
  Random random(5);
  const auto stops = random_stops(300, random);
  double before = 1e300, nearest = 0;
  for (const int rounds : {0, 1, 2, 5, 20}) {
    const double length = route_length_mm(stops, short_route(stops, {0, 0}, Context(), rounds), {0, 0});
    CHECK(length <= before + 1e-9);
    if (rounds == 0) nearest = length;
    before = length;
  }
  CHECK(before < 0.92 * nearest);
}

TEST_CASE("TravelRoute.ThousandsOfStopsInOnePlaceOrOnALine") {
  std::vector<RouteStop> same(3000, {Kind::loop, {Vec2(5, 5)}}), row;
  CHECK_THAT(route_length_mm(same, short_route(same, {0, 5}, Context()), {0, 5}), WithinAbs(5, 1e-9));
  for (int i = 0; i < 3000; ++i) row.push_back({Kind::loop, {Vec2((i * 1009) % 3000, 0)}});
  CHECK_THAT(route_length_mm(row, short_route(row, {0, 0}, Context()), {0, 0}), WithinAbs(2999, 1e-6));
}

}  // namespace
}  // namespace formwright
