#pragma once

#include <optional>
#include <string>
#include <utility>

#include "base/types.h"

namespace argil {

/// Why a run that started well could not go on. Ends the program with exit code 3.
struct Failure {
  Tick tick = 0;         ///< number, from 1, of the tick that was refused or could not be made
  std::string stage;     ///< stage of the step: "contact", "water", "solid", …
  int element = -1;      ///< tet, vertex or triangle concerned; -1: none in particular
  std::string quantity;  ///< what was out of bounds, with unit
  double value = 0.0;    ///< its value
  double bound = 0.0;    ///< the bound it broke
};

/// One line that says all of a failure.
std::string to_string(const Failure& failure);

/// Outcome of a stage or a tick: nothing, or the failure.
class [[nodiscard]] StepStatus {
 public:
  static StepStatus ok() { return {}; }
  static StepStatus failed(Failure failure) {
    StepStatus status;
    status.m_failure = std::move(failure);
    return status;
  }
  bool is_ok() const { return !m_failure.has_value(); }
  const Failure& failure() const { return *m_failure; }

 private:
  std::optional<Failure> m_failure;
};

}  // namespace argil

/// Hands a failed stage up to the caller.
#define ARGIL_TRY(expression) \
  if (::argil::StepStatus argil_status = (expression); !argil_status.is_ok()) return argil_status
