#pragma once

// What the stand-in for OpenHaptics did, in a file that its process and its test map: a row a servo period,
// so that it is there also after the process has died.

#include <cstdint>

namespace argil::test {

constexpr std::int64_t kMostServoRows = 60000;  // a minute

struct ServoRow {
  volatile double time;           ///< [s] since hdStartScheduler
  volatile double pen_height;     ///< [mm] along the device's y
  volatile double force[3];       ///< [N] that the motors were told, device axes
  volatile std::int64_t buttons;  ///< as HD_DEVICE_BUTTON_1 …
  volatile std::int64_t fault;    ///< 1 from the scripted fault on
};

struct ServoLog {
  volatile std::int64_t num_rows;
  volatile std::int64_t num_misuses;  ///< calls that the documentation forbids
  volatile std::int64_t is_enabled;   ///< HD_FORCE_OUTPUT
  volatile std::int64_t is_stopped;   ///< hdStopScheduler was called last
  volatile std::int64_t is_disabled;  ///< hdDisableDevice was called last
  volatile std::int64_t num_updates;  ///< of the calibration
  ServoRow rows[kMostServoRows];
};

}  // namespace argil::test
