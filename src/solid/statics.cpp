// Equilibrium: the limit of a step without mass, by Newton's method and shares of the load.

#include <algorithm>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>

#include "base/check.h"
#include "solid/solid.h"

namespace argil::solid {

constexpr double kEnd = std::numeric_limits<double>::infinity();  // of time: supports at their full way

StepStatus Solid::iterate_static(const SolidState& state, const StepLoads& loads) {
  m_x = state.x;
  m_x_hat = m_x;
  m_v.setZero();
  m_iterations = 0;
  place_supports(kEnd, m_load_share);
  ARGIL_TRY(update_kinematics(m_x, 0));
  for (bool solved = false; !solved;) {
    solved = assemble(loads);
    if (!solved) ARGIL_TRY(solve(loads, 0, solved));
  }
  return StepStatus::ok();
}

StepStatus Solid::find_equilibrium(SolidState& state, const StepLoads& loads) {
  wake_all();
  store_nodal_stiffness();
  constexpr double kSmallestShare = 1.0 / 1024.0;
  m_is_static = true;
  m_tau = 1.0;
  m_plastic_strain = &state.plastic_strain;
  m_v_hat.setZero();
  m_v_start.setZero(3, m_elements.num_nodes());
  m_x_start = state.x;
  m_counters = {};
  m_is_moved_by_load = false;
  start_contacts(loads.contacts.size());
  double done = 0.0;
  for (double step = 1.0; done < 1.0;) {
    m_load_share = std::min(1.0, done + step);
    const StepStatus status = iterate_static(state, loads);
    if (status.is_ok()) {
      done = m_load_share;
      state.x = m_x;
      step *= 2.0;
      continue;
    }
    step *= 0.5;
    if (step < kSmallestShare) {
      const StepStatus last_good = update_kinematics(state.x, 0);  // what records describe
      ARGIL_ASSERT(last_good.is_ok());
      Failure failure = status.failure();
      char share[16];
      std::snprintf(share, sizeof share, "%.4g", done);
      failure.quantity += std::string(" (the last good state carries ") + share + " of the load), which";
      return StepStatus::failed(std::move(failure));
    }
  }
  return check_resolution(state);
}

/// Positions are rounded to ε |x|: far from the origin, or under a small load, no digit of a displacement is
/// left.
StepStatus Solid::check_resolution(const SolidState& state) const {
  constexpr double kDigits = 100.0;
  const double bound = kDigits * std::numeric_limits<double>::epsilon() * state.x.cwiseAbs().maxCoeff();
  const double largest = std::sqrt((state.x - m_elements.rest).colwise().squaredNorm().maxCoeff());
  if (!m_is_moved_by_load || largest >= bound) return StepStatus::ok();
  return StepStatus::failed(
      {0, "solid", -1,
       "largest displacement [m] under the loads, which the rounding of positions this far from "
       "the origin hides: move the body there, or give a larger load",
       largest, bound});
}

}  // namespace argil::solid
