#include "device/devices.h"

#include <chrono>
#include <cstdio>
#include <thread>

#include "base/error.h"
#include "device/backends.h"

namespace argil::device {

namespace {

constexpr const char* kHaplyPort = "10001";

[[noreturn]] void refuse(const std::string& name, const std::string& problem, const std::string& remedy) {
  throw InputError("--device " + name, "", problem, remedy);
}

/// "", "HOST" or "HOST:PORT".
std::unique_ptr<HapticDevice> make_haply_at(const std::string& place, const DeviceOptions& options) {
  const std::size_t colon = place.rfind(':');
  const std::string host = place.substr(0, colon);
  const std::string port = colon == std::string::npos ? kHaplyPort : place.substr(colon + 1);
  const bool is_number = !port.empty() && port.size() <= 5 &&
                         port.find_first_not_of("0123456789") == std::string::npos &&
                         std::stoi(port) <= 65535;
  if (!is_number || host.find(':') != std::string::npos || (host.empty() && colon != std::string::npos))
    refuse("haply:" + place, "no host and port", "write haply, haply:HOST or haply:HOST:PORT");
  return internal::make_haply(host.empty() ? "127.0.0.1" : host, port, options);
}

/// What may follow a kind's name after a colon.
enum class Place { none, optional, required };

struct Kind {
  const char* name;
  const char* about;  ///< one line
  Place place;
  std::unique_ptr<HapticDevice> (*make)(const std::string& place, const DeviceOptions& options);
  bool is_built = true;  ///< else `make` says what this program lacks
};

#ifdef ARGIL_HAS_SPNAV
constexpr bool kHasSpacenav = true;
#else
constexpr bool kHasSpacenav = false;
#endif

/// Every kind of device that make_device knows.
constexpr Kind kKinds[] = {
    {"simulated", "a hand model that follows a trace and yields to the force", Place::none,
     [](const std::string&, const DeviceOptions& options) { return internal::make_simulated(options); }},
    {"haply", "Inverse3 by the Haply Inverse Service on this machine, or haply:HOST:PORT", Place::optional,
     make_haply_at},
    {"spacenav", "6-DoF controller by spacenavd, without force", Place::none,
     [](const std::string&, const DeviceOptions& options) { return internal::make_spacenav(options); },
     kHasSpacenav},
    {"plugin", "plugin:FILE[,ARGUMENT], a shared library of a device's own (plugin_api.h)", Place::required,
     internal::make_plugin},
};

/// "NAME, 3.3 N at most, …", and "not stated" for what the device does not say.
std::string print(const DeviceInfo& info) {
  const auto limit = [](double value, const char* unit, const char* of) {
    char text[64];
    std::snprintf(text, sizeof text, value > 0.0 ? "%.4g %s" : "not stated", value, unit);
    return std::string(", ") + of + " " + text;
  };
  std::string text = info.name;
  if (!info.has_force) {
    text += ", no force";
  } else {
    text += limit(info.max_force, "N", "largest force") + limit(info.max_torque, "N m", "torque") +
            limit(info.max_stiffness, "N/m", "stiffness");
  }
  text += limit(info.rate_hz, "Hz", "rate");
  char edges[96];
  const Vec3& w = info.workspace;
  std::snprintf(edges, sizeof edges, ", workspace %.3g x %.3g x %.3g m", w.x(), w.y(), w.z());
  return text + (w.minCoeff() > 0.0 ? edges : ", workspace not stated");
}

}  // namespace

std::vector<DeviceKind> device_kinds() {
  std::vector<DeviceKind> kinds;
  for (const Kind& kind : kKinds)
    if (kind.is_built) kinds.push_back({kind.name, kind.about});
  return kinds;
}

std::unique_ptr<HapticDevice> make_device(const std::string& name, const DeviceOptions& options) {
  if (!(options.period > 0.0 && options.period <= 1.0))
    refuse(name, "period of " + std::to_string(options.period) + " s", "give more than 0 and at most 1 s");
  if (!(options.stale_after > 0.0))
    refuse(name, "stale after " + std::to_string(options.stale_after) + " s", "give more than 0 s");
  const std::size_t colon = name.find(':');
  const bool has_place = colon != std::string::npos;
  const std::string place = has_place ? name.substr(colon + 1) : "";
  for (const Kind& kind : kKinds) {
    const bool fits =
        kind.place == Place::none ? !has_place : kind.place == Place::optional || !place.empty();
    if (name.substr(0, colon) == kind.name && fits) return kind.make(place, options);
  }
  std::string known;
  for (const DeviceKind& each : device_kinds()) known += (known.empty() ? "" : ", ") + each.name;
  throw InputError("--device", "", "unknown device \"" + name + "\"", "choose one of " + known);
}

std::string describe_devices(const std::vector<std::string>& names, double patience) {
  DeviceOptions options;
  const DeviceSample somewhere;
  options.intent.time = {0.0, 1.0};
  options.intent.samples = {somewhere, somewhere};
  std::vector<std::unique_ptr<HapticDevice>> devices;  // all: it refuses before it looks for any
  for (const std::string& name : names) devices.push_back(make_device(name, options));
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    HapticDevice& device = *devices[i];
    device.start();
    wait_until_ready(device, patience);
    text += names[i] + ": " + std::string(to_string(device.state())) + ", " + print(device.info());
    if (const std::string problem = device.problem(); !problem.empty()) text += " (" + problem + ")";
    text += '\n';
    device.stop();
  }
  return text;
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
