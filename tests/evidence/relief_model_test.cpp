// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/relief/relief_model.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <numbers>
#include <random>

#include "base/error.h"
#include "evidence/diagnosis/diagnosis.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinULP;

/// Hills, a step and fine grooves, 100 mm wide and 8 mm deep.
double landscape(double x, double y) {
  const double hills = 3 * std::sin(0.09 * x + 0.5) * std::cos(0.07 * y) +
                       2 * std::exp(-0.005 * ((x - 60) * (x - 60) + (y - 55) * (y - 55)));
  const double step = 1.5 * std::tanh(0.8 * (x - 30 - 0.2 * y)),
               grooves = 0.25 * std::sin(1.1 * y) * std::exp(-0.002 * (x - 75) * (x - 75));
  return hills + step + grooves;
}

ReliefSurface surface_of(double pixel_mm) {
  ReliefSurface s;
  s.pixel_mm = pixel_mm;
  s.lower_mm = Vec2::Constant(0.5 * pixel_mm);
  const auto n = static_cast<Eigen::Index>(100 / pixel_mm);
  s.height_mm.resize(n, n);
  for (Eigen::Index r = 0; r < n; ++r)
    for (Eigen::Index c = 0; c < n; ++c)
      s.height_mm(r, c) = landscape(s.lower_mm.x() + pixel_mm * static_cast<double>(c),
                                    s.lower_mm.y() + pixel_mm * static_cast<double>(r));
  return s;
}

PhotographedRelief relief(double pixel_mm, int points, unsigned seed) {
  PhotographedRelief r;
  r.name = "landscape";
  r.surface = surface_of(pixel_mm);
  r.setup.light_direction = Vec3(-0.8, 0.6, 0.7);
  r.setup.camera_height_mm = 500;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(2, 98);
  for (int i = 0; i < points; ++i) r.points.push_back({Vec2(place(random), place(random)), 1, 0.01});
  return r;
}

int index_of(const ForwardModel& model, const std::string& name) {
  for (std::size_t p = 0; p < model.parameters().size(); ++p)
    if (model.parameters()[p].name == name) return static_cast<int>(p);
  return -1;
}

TEST_CASE("ReliefModel.APlaneHasTheBrightnessOfLambertsLaw") {
  PhotographedRelief r = relief(1, 50, 1);
  for (Eigen::Index row = 0; row < r.surface.height_mm.rows(); ++row)
    for (Eigen::Index c = 0; c < r.surface.height_mm.cols(); ++c)
      r.surface.height_mm(row, c) = 0.3 * static_cast<double>(c);
  const ReliefModel model({r});
  const Vec3 normal = Vec3(-0.3, 0, 1).normalized();
  const double expected = 0.1 + 0.9 * normal.dot(r.setup.light_direction.normalized());
  const Eigen::MatrixXd shaded = model.predict(0, model.nominal(), Context());
  for (Eigen::Index i = 0; i < shaded.rows(); ++i) CHECK_THAT(shaded(i, 0), WithinAbs(expected, 1e-9));
}

TEST_CASE("ReliefModel.AWallThrowsAShadowAsLongAsTheSunIsLow") {
  ReliefSurface s;
  s.pixel_mm = 0.25;
  s.height_mm = Eigen::MatrixXd::Zero(40, 400);
  s.height_mm.middleCols(200, 4).setConstant(5);
  const double slope = 0.5;  // of the ray: 5 mm of wall reach 10 mm far
  const Eigen::MatrixXd light = lit(s, Vec3(1, 0, slope).normalized());
  int dark = 0;
  for (Eigen::Index c = 0; c < 200; ++c) dark += light(20, c) < 0.5;
  CHECK_THAT(dark * s.pixel_mm, WithinAbs(10, 0.5));
  CHECK_THAT(light(20, 300), WithinULP(1.0, 4));
}

TEST_CASE("ReliefModel.BlurKeepsTheMeanOfAWaveAndDampsItAsAGaussianDoes") {
  Eigen::MatrixXd wave(256, 256);
  for (Eigen::Index r = 0; r < 256; ++r)
    for (Eigen::Index c = 0; c < 256; ++c)
      wave(r, c) = 1 + std::sin(2 * std::numbers::pi * static_cast<double>(c) / 32);
  const Eigen::MatrixXd soft = blurred(wave, 4);
  CHECK_THAT(soft.middleRows(64, 128).middleCols(64, 128).mean(), WithinAbs(1, 1e-6));
  const double damped = (soft.row(128).segment(64, 128).maxCoeff() - soft.row(128).segment(64, 128).minCoeff()) / 2;
  CHECK_THAT(damped, WithinAbs(std::exp(-0.5 * std::pow(4 * 2 * std::numbers::pi / 32, 2)), 2e-3));
}

TEST_CASE("ReliefModel.NamesWhatWasDoneToIt") {
  struct Case {
    const char *cause, *parameter;
    double value;
  };
  static constexpr Case cases[] = {{"light_direction", "light_tilt_x_deg", 8},
                                   {"light_distance", "light_nearness_per_m", 3},
                                   {"gloss", "gloss", 0.4},
                                   {"cast_shadow", "cast_shadow", 0.8},
                                   {"printer_blur", "printer_blur_mm", 0.9},
                                   {"depth_shrinkage", "depth_shrinkage", 0.2},
                                   {"viewer_offset", "viewer_offset_y_mm", 80}};
  int right = 0;
  for (const Case& c : cases) {
    // Made on heights four times as fine, in another exposure, with noise.
    PhotographedRelief fine = relief(0.25, 1500, 3);
    // Shadows need a low sun.
    if (std::string_view(c.cause) == "cast_shadow") fine.setup.light_direction.z() = 0.12;
    const ReliefModel truth({fine});
    Eigen::VectorXd u = truth.nominal();
    u[index_of(truth, "exposure")] = 0.3;
    u[index_of(truth, "ambient")] = 0.08;
    u[index_of(truth, c.parameter)] = c.value;
    const Eigen::MatrixXd brightness = truth.predict(0, u, Context());
    PhotographedRelief seen = relief(0.5, 1500, 3);
    seen.setup.light_direction = fine.setup.light_direction;
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0, 0.01);
    for (std::size_t i = 0; i < seen.points.size(); ++i)
      seen.points[i].brightness = std::max(0.0, brightness(static_cast<Eigen::Index>(i), 0) + noise(random));
    const ReliefModel model({seen});
    SimulationBag bag(model);
    Context context;
    DiagnosisOptions options;
    options.pairs = false;
    const Diagnosis d = diagnose(bag, options, context);
    const bool named =
        !d.verdict.empty() && model.causes()[static_cast<std::size_t>(d.verdict.front())].name == c.cause;
    right += named;
    std::string answer = c.cause;
    for (const CauseFinding& f : d.causes)
      answer += "; " + model.causes()[static_cast<std::size_t>(f.cause)].name + " p " + std::to_string(f.probability) +
                " strength " + std::to_string(f.strength) + " evidence " + std::to_string(f.log_evidence) +
                " visible from " + std::to_string(f.min_visible_strength);
    for (const HeldOutTrial& t : d.trials)
      answer += "; tried " + model.causes()[static_cast<std::size_t>(t.causes.front())].name +
                (t.significant ? " gain " : " not significant ") + std::to_string(t.gain.gain_share) + " sure " +
                std::to_string(t.gain.gain_probability);
    CAPTURE(answer);
    if (!named) std::printf("not named: %s\n", answer.c_str());
    {
      INFO(c.cause);
      CHECK((named || d.doubtful() || d.reading == Reading::cannot_separate || d.reading == Reading::unknown));
    }
    if (named) {
      CHECK(d.held_out.after.mean < d.held_out.before.mean);
    }
  }
  CHECK(right >= 6);
}

TEST_CASE("ReliefModel.WrongFilesGetAClearSentence") {
  const auto refused = [](const char* json, const char* words) {
    try {
      read_shading_setup(as_bytes(std::string_view(json)));
      FAIL_CHECK(json);
    } catch (const Error& error) {
      INFO(error.what());
      CHECK(std::string(error.what()).find(words) != std::string::npos);
    }
  };
  refused("[1]", "JSON object");
  refused("{}", "light_direction");
  refused(R"({"light_direction": [1, 2]})", "three numbers");
  refused(R"({"light_direction": [1, 0, -1]})", "viewer");
  refused(R"({"light_direction": [1, 0, 1], "camera_height_mm": -3})", "camera_height_mm");
  CHECK_THROWS_AS(read_shaded_points(as_bytes(std::string_view("x_mm,y_mm\n1,2\n"))), Error);
  CHECK_THROWS_AS(ReliefModel({relief(1, 5, 1)}), Error);
}

}  // namespace
}  // namespace formwright
