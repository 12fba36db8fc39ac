#pragma once

// What the device of hostile_plugin.cpp renders, in a file that its process and its test map.

#include <cstdint>

namespace argil::test {

struct RenderedForce {
  volatile double force[3];   ///< [N]
  volatile double torque[3];  ///< [N m]
  volatile double largest_force, largest_torque;
  volatile std::int32_t releases;
  volatile std::int32_t is_writing;
  volatile std::int32_t is_wrong;  ///< the mode has begun
};

}  // namespace argil::test
