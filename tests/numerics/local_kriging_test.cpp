// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/local_kriging.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <numeric>
#include <random>
#include <vector>

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

Eigen::MatrixX2d scattered(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 100);
  Eigen::MatrixX2d place(count, 2);
  for (int i = 0; i < count; ++i) place.row(i) << unit(random), unit(random);
  return place;
}

double wave(double x, double y) { return std::sin(x / 12) * std::cos(y / 15); }

Eigen::MatrixXd waves(const Eigen::MatrixX2d& place) {
  Eigen::MatrixXd value(place.rows(), 2);
  for (Eigen::Index i = 0; i < place.rows(); ++i)
    value.row(i) << wave(place(i, 0), place(i, 1)), 0.5 * wave(place(i, 1), place(i, 0));
  return value;
}

double mean_length(const Eigen::MatrixXd& rows) { return rows.rowwise().norm().mean(); }

TEST_CASE("LocalKriging.between_two_equal_values_it_is_the_closed_form") {
  Eigen::MatrixX2d place(2, 2);
  place << 0, 0, 10, 0;
  Eigen::MatrixXd value(2, 1);
  value << 3, 3;
  const LocalKriging field(place, value);
  REQUIRE(field.is_smooth());
  // Two equal values ask for the longest reach and the least noise of the grid: 0.64 of the extent, and 0.03.
  const double length = 6.4, signal = 0.97;
  Eigen::MatrixX2d at(3, 2);
  at << 0, 0, 2.5, 0, 5, 4;
  const Eigen::MatrixXd read = field.read(at);
  for (Eigen::Index i = 0; i < at.rows(); ++i) {
    const double to_first = (at.row(i) - place.row(0)).norm(), to_second = (at.row(i) - place.row(1)).norm();
    const double expected = 3 * signal * (std::exp(-to_first / length) + std::exp(-to_second / length)) /
                            (1 + signal * std::exp(-10 / length));
    CHECK_THAT(read(i, 0), WithinAbs(expected, 1e-12));
  }
}

TEST_CASE("LocalKriging.the_error_falls_with_the_spacing") {
  const Eigen::MatrixX2d at = (scattered(500, 9).array() * 0.9 + 5).matrix();
  std::vector<double> errors;
  for (const int count : {250, 1000, 4000}) {
    const Eigen::MatrixX2d place = scattered(count, 4);
    errors.push_back(mean_length(LocalKriging(place, waves(place)).read(at) - waves(at)));
  }
  CAPTURE(errors);
  // Four times the places halve the spacing.
  CHECK(std::log2(errors[0] / errors[1]) > 1);
  CHECK(std::log2(errors[1] / errors[2]) > 1);
}

TEST_CASE("LocalKriging.noise_is_smoothed_and_outliers_are_left_out") {
  const Eigen::MatrixX2d place = scattered(1500, 5);
  const Eigen::MatrixXd truth = waves(place);
  std::mt19937 random(6);
  std::normal_distribution<double> noise(0, 0.2);
  Eigen::MatrixXd value = truth.unaryExpr([&](double v) { return v + noise(random); });
  const LocalKriging noisy(place, value);
  CHECK(noisy.outliers() <= 3);
  CHECK(mean_length(noisy.read(place) - truth) < 0.6 * mean_length(value - truth));
  for (int k = 0; k < 15; ++k) value.row(100 * k).array() += 20;
  const LocalKriging with_outliers(place, value);
  CHECK(with_outliers.outliers() >= 15);
  CHECK(with_outliers.outliers() <= 20);
  CHECK(mean_length(with_outliers.read(place) - truth) < 1.1 * mean_length(noisy.read(place) - truth));
}

TEST_CASE("LocalKriging.of_many_places_too_outliers_are_left_out") {
  const Eigen::MatrixX2d place = scattered(9000, 12);
  Eigen::MatrixXd value = waves(place);
  for (int k = 1; k <= 40; ++k) value.row(200 * k + 1).array() -= 30;
  const LocalKriging field(place, value);
  CHECK(field.outliers() >= 40);
  CHECK(mean_length(field.read(place) - waves(place)) < 0.05);
}

TEST_CASE("LocalKriging.what_has_no_course_is_read_only_where_it_is_known") {
  const Eigen::MatrixX2d place = scattered(400, 7);
  std::mt19937 random(8);
  std::normal_distribution<double> noise(0, 1);
  const Eigen::MatrixXd value = Eigen::MatrixXd::NullaryExpr(400, 3, [&] { return noise(random); });
  const LocalKriging field(place, value);
  const Eigen::MatrixXd between = field.read(scattered(400, 11));
  CHECK(mean_length(between) < 0.35 * mean_length(value));
  // Where the sign changes from place to place neighbours say the opposite: each place is what it was, and no more.
  Eigen::MatrixX2d row(10, 2);
  Eigen::MatrixXd signs(10, 1);
  for (int i = 0; i < 10; ++i) {
    row.row(i) << 10 * i, 0;
    signs(i, 0) = i % 2 == 0 ? 1 : -1;
  }
  const LocalKriging alternating(row, signs);
  REQUIRE_FALSE(alternating.is_smooth());
  CHECK((alternating.read(row) - signs).norm() < 1e-4);
  CHECK(alternating.read((row.array() + 3).matrix()).norm() < 1e-4);
  Eigen::MatrixX2d away(1, 2);
  away << 1e6, -1e6;
  CHECK(field.read(away).norm() < 1e-12);
}

TEST_CASE("LocalKriging.few_or_equal_places_are_no_trouble") {
  const Eigen::MatrixX2d none(0, 2), at = scattered(3, 1);
  CHECK(LocalKriging(none, Eigen::MatrixXd(0, 3)).read(at) == Eigen::MatrixXd::Zero(3, 3));
  Eigen::MatrixX2d same(40, 2);
  same.rowwise() = Eigen::RowVector2d(4, 5);
  const Eigen::MatrixXd ones = Eigen::MatrixXd::Ones(40, 1);
  const Eigen::MatrixXd read = LocalKriging(same, ones).read(same.topRows(1));
  CHECK_THAT(read(0, 0), WithinAbs(1, 0.05));
  CHECK_THAT(LocalKriging(same.topRows(1), ones.topRows(1)).read(same.topRows(1))(0, 0), WithinAbs(1, 1e-5));
}

}  // namespace
}  // namespace formwright
