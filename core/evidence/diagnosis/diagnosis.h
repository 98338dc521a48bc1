// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// From measured data to the cause of a misfit: calibrate, show the misfit, name the cause, extend the model, measure
// the gain (docs/evidence.md).
#include <optional>
#include <string>

#include "evidence/diagnosis/answers.h"
#include "evidence/fit/held_out.h"

namespace formwright {

enum class Reading {
  none,             // the base model explains the data
  cause,            // one or more causes are named
  cannot_separate,  // one of two named causes; these data do not say which
  unknown,          // there is structure that no cause of the list makes
};

/// "none", "cause", "cannot_separate", "unknown".
const char* reading_name(Reading reading);

struct CauseFinding {
  int cause = 0;
  double probability = 0;                  // that it is at work, by itself or in a pair, as the answers have it
  double strength = 0, low = 0, high = 0;  // Cause::unit; 95 % interval
  double noise_deviation = 0;              // standard deviation of the strength by measuring noise alone
  bool fitted = false;                     // else the strength is a linear model's, and the interval has no width
  std::vector<double> values;              // of its parameters
  double min_visible_strength = 0;  // strength that these data would show; infinite where the calibration hides any
  double log_evidence = 0;          // over that of no cause
  double likeness = 0;              // by itself, to what calibration leaves: likenesses()
};

struct NotSeparable {
  int cause_a = 0, cause_b = 0;
  double similarity = 0;  // 1: the same to these data
};

/// An explanation that was asked to predict what was held out.
struct HeldOutTrial {
  std::vector<int> causes;
  bool significant =
      true;  // each of its causes moves points by more than the model's own misfit; else it was not asked
  HeldOutGain gain;
};

struct Diagnosis {
  Reading reading = Reading::none;
  bool looked_again = false;           // the answer is that of the model's finer self
  std::vector<std::string> doubts;     // sentences: why what is named may be wrong, or not all
  std::vector<int> verdict;            // causes, the strongest first
  std::vector<Answer> answers;         // most probable first: what verdict, table and sentence follow from
  std::vector<FailedCheck> failed;     // explanations that fit and are not believed, in the order they were checked
  std::vector<CauseFinding> causes;    // all, most probable first
  std::vector<Hypothesis> hypotheses;  // how well each explanation fits, before the checks; the best first
  std::vector<NotSeparable> not_separable;  // of the named causes with any other
  ParameterFit base;                        // calibrated without any effect
  ParameterFit extended;                    // with the named causes; as base where none is
  std::size_t structure = 0;                // of the best explanation: index into structure_sizes
  std::vector<NoiseEstimate> noise;         // each object
  std::vector<StructureTest> structure_before, structure_after;
  double noise_floor = 0;  // mean distance that noise alone gives
  double unexplained_before = 0,
         unexplained_after = 0;  // size of the structure left by the base model and by the best explanation
  HeldOutGain held_out;
  std::vector<HeldOutGain> held_out_others;  // of each measurement that is not of places, in its own unit
  std::vector<HeldOutTrial> trials;          // in the order they were asked
  int simulations = 0;
  double seconds_calibration = 0, seconds = 0;

  bool doubtful() const { return !doubts.empty(); }
};

struct DiagnosisOptions {
  bool pairs = true;
  Eigen::VectorXd start;  // where the calibration begins as well as at the nominal parameters; may be empty
};

/// Throws Error{could_not_solve} where the base model cannot be simulated, Error{cancelled}.
Diagnosis diagnose(SimulationBag& bag, const DiagnosisOptions& options, Context& context);

}  // namespace formwright
