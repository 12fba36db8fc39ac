#pragma once

#include "device/trace.h"

namespace argil::device {

/// A hand that means to stay where it is.
inline Trace resting_intent(const Vec3& place) {
  Trace intent;
  intent.time = {0.0, 1.0};
  intent.samples = {{place, Quat::Identity(), ToolMode::push}, {place, Quat::Identity(), ToolMode::push}};
  return intent;
}

/// A hand that means to be `distance` further along x from the first tick on, in the mode `then`.
inline Trace step_intent(double distance, double period, ToolMode then = ToolMode::push) {
  Trace intent;
  intent.time = {0.0, period, 1.0};
  const DeviceSample after{Vec3(distance, 0.0, 0.0), Quat::Identity(), then};
  intent.samples = {DeviceSample(), after, after};
  return intent;
}

}  // namespace argil::device
