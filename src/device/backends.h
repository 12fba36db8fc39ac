#pragma once

// The kinds of devices, each behind HapticDevice; devices.h chooses one by name.

#include <memory>

#include "device/devices.h"

namespace argil::device::internal {

std::unique_ptr<HapticDevice> make_simulated(const DeviceOptions& options);
std::unique_ptr<HapticDevice> make_haply(const std::string& host, const std::string& port,
                                         const DeviceOptions& options);
/// Throws InputError in a program that was built without libspnav.
std::unique_ptr<HapticDevice> make_spacenav(const DeviceOptions& options);
/// `place`: FILE or FILE,ARGUMENT. Throws InputError for a file that is no plug-in.
std::unique_ptr<HapticDevice> make_plugin(const std::string& place, const DeviceOptions& options);

/// `v`, or zero when it is not finite: no device renders what is no force.
inline Vec3 finite_or_zero(const Vec3& v) {
  return v.allFinite() ? v : Vec3::Zero().eval();
}

}  // namespace argil::device::internal
