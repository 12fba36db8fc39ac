#include "study/outcome.h"

#include <array>
#include <cmath>

#include "run/run.h"

namespace argil::study {
namespace {

/// Which failure a run's own words name.
Outcome classify_failure(const std::string& reason) {
  const auto says = [&](const char* words) { return reason.find(words) != std::string::npos; };
  if (says("volume ratio")) return Outcome::inverted;
  if (says("trembles")) return Outcome::chatter;
  if (says("energy")) return Outcome::growing_energy;
  if (says("residual") || says("line search") || says("positive definite")) return Outcome::not_converged;
  return Outcome::failed;
}

}  // namespace

Outcome classify(const CaseResult& result, const RunFigures& figures, const RunErrors& errors,
                 const OutcomeBounds& bounds) {
  if (result.exit_code == run::kInputRefused) return Outcome::refused;
  if (result.exit_code == run::kRunFailed) return classify_failure(result.reason);
  if (result.exit_code != run::kDone) return Outcome::killed;
  if (figures.energy_gain > bounds.growing_above) return Outcome::growing_energy;
  if (figures.chatter > bounds.chatter_above && !(figures.chatter <= 2.0 * errors.true_chatter))
    return Outcome::chatter;
  if (bounds.compares && std::isnan(errors.force)) return Outcome::unknown;
  return errors.force > bounds.wrong_above ? Outcome::wrong : Outcome::accurate;
}

bool is_stable(Outcome outcome) {
  return outcome == Outcome::accurate || outcome == Outcome::wrong;
}

bool is_known(Outcome outcome) {
  return outcome != Outcome::killed && outcome != Outcome::unknown;
}

std::string to_string(Outcome outcome) {
  constexpr std::array<const char*, 10> kNames = {"accurate", "wrong",         "growing_energy", "chatter",
                                                  "inverted", "not_converged", "failed",         "refused",
                                                  "killed",   "unknown"};
  return kNames[static_cast<std::size_t>(outcome)];
}

}  // namespace argil::study
