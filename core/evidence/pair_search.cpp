// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/pair_search.h"

#include <algorithm>
#include <numeric>

namespace formwright {

Linearisation without_cause(const ForwardModel& model, Linearisation about, int cause) {
  for (const int p : model.causes()[static_cast<std::size_t>(cause)].parameters) {
    for (std::size_t object = 0; object < about.residuals.size(); ++object)
      about.residuals[object] += about.u[p] * about.sensitivities[object][static_cast<std::size_t>(p)];
    about.u[p] = 0;
  }
  std::erase(about.causes, cause);
  return about;
}

std::vector<PairGuess> guess_pairs(const ForwardModel& model, const MisfitOfAll& misfit,
                                   const std::vector<Linearisation>& about) {
  std::vector<int> columns(model.parameters().size());
  std::iota(columns.begin(), columns.end(), 0);
  std::vector<PairGuess> guesses;
  for (std::size_t from = 0; from < about.size(); ++from) {
    const GramByStructure gram = misfit.gram(about[from].residuals, about[from].sensitivities);
    for (Hypothesis& h : all_hypotheses(model, true)) {
      if (h.causes.size() != 2 ||
          !std::includes(h.causes.begin(), h.causes.end(), about[from].causes.begin(), about[from].causes.end()))
        continue;
      weigh(model, gram, columns, about[from].u, h);
      const auto known =
          std::find_if(guesses.begin(), guesses.end(), [&](const PairGuess& g) { return g.causes == h.causes; });
      if (known == guesses.end())
        guesses.push_back({h.causes, h.log_evidence, h.u, from});
      else if (h.log_evidence > known->log_evidence)
        *known = {h.causes, h.log_evidence, h.u, from};
    }
  }
  std::stable_sort(guesses.begin(), guesses.end(),
                   [](const PairGuess& a, const PairGuess& b) { return a.log_evidence > b.log_evidence; });
  return guesses;
}

}  // namespace formwright
