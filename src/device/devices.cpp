#include "device/devices.h"

#include <chrono>
#include <thread>

#include "base/error.h"
#include "device/backends.h"

namespace argil::device {

std::vector<DeviceKind> device_kinds() {
  return {{"simulated", "a hand model that follows a trace and yields to the force"}};
}

std::unique_ptr<HapticDevice> make_device(const std::string& name, const DeviceOptions& options) {
  if (!(options.period > 0.0 && options.period <= 1.0))
    throw InputError("--device " + name, "period", std::to_string(options.period) + " s",
                     "give more than 0 and at most 1 s");
  if (name == "simulated") return internal::make_simulated(options);
  std::string known;
  for (const DeviceKind& kind : device_kinds()) known += (known.empty() ? "" : ", ") + kind.name;
  throw InputError("--device", "", "unknown device \"" + name + "\"", "choose one of " + known);
}

DeviceState wait_until_ready(const HapticDevice& device, double timeout) {
  using Clock = std::chrono::steady_clock;
  const auto end =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(timeout));
  while (device.state() == DeviceState::connecting && Clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  return device.state();
}

}  // namespace argil::device
