// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Measured objects with a known truth. They are made by another model than the one under diagnosis: a finer sheet,
// shorter steps, another elastic law, a slower vacuum, other material constants, noise and outliers.
#include <array>
#include <random>
#include <string>
#include <vector>

#include "evidence/models/thermoform/thermoform_model.h"

namespace formwright::virtual_lab {

enum class Mould { pyramid, box, ridge, cross, dome };
inline constexpr std::array mould_names{"pyramid", "box", "ridge", "cross", "dome"};
inline constexpr int drawn_moulds = 4;  // the first ones; the dome is asked for by name

/// In machine coordinates, on the plate; about 100 mm wide and 40 to 60 mm high.
TriangleMesh make_mould(Mould mould);

struct HiddenEffect {
  std::string cause;
  Json values = Json::object();  // of SheetEffects and MeasurementEffects
};

/// All causes a diagnosis may name.
std::vector<std::string> cause_names();

/// `level`: 1 strong, 1/2 medium, 1/4 weak; strong moves points by 0.5 to 1 mm. Sign and direction are drawn.
HiddenEffect draw_effect(const std::string& cause, double level, std::mt19937& random);

/// What else the truth has that the diagnosis does not know.
struct HiddenWorld {
  double young_factor = 1, creep_factor = 1, yield_strain = 0.1;
  double vacuum_ramp_s = 0.2;
  ElasticLaw elastic_law = ElasticLaw::stable_neo_hookean;
  double step_mm = 0.7;
  int triangles = 7000;
};
HiddenWorld draw_world(std::mt19937& random);

struct Observation {
  int points = 1200;
  double sigma_mm = 0.05;
  double outlier_share = 0.02;
};

/// The set-up every virtual object is made with, as setup.json would have it.
ObjectSetup usual_setup();

/// Forms the object and measures it.
FormedObject make_object(Mould mould, const HiddenWorld& world, const std::vector<HiddenEffect>& effects,
                         const Observation& observation, std::mt19937& random);

}  // namespace formwright::virtual_lab
