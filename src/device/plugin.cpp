// Devices of shared libraries that offer plugin_api.h.

#include <dlfcn.h>

#include <cmath>
#include <cstring>
#include <new>
#include <stdexcept>

#include "base/error.h"
#include "base/realtime.h"
#include "device/attached.h"
#include "device/backends.h"
#include "device/plugin_api.h"

namespace argil::device::internal {
namespace {

struct CloseLibrary {
  void operator()(void* library) const { dlclose(library); }
};
using Library = std::unique_ptr<void, CloseLibrary>;

class PluginDevice final : public AttachedDevice {
 public:
  PluginDevice(const DeviceOptions& options, std::string file, std::string argument, Library library,
               const argil_plugin& plugin)
      : AttachedDevice(options),
        m_file(std::move(file)),
        m_argument(std::move(argument)),
        m_library(std::move(library)),
        m_plugin(plugin) {
    DeviceInfo info;
    info.kind = "plugin";
    info.name = m_file;
    set_info(info);
  }
  ~PluginDevice() override { stop(); }
  /// What a thread still uses that its library does not let come back, stays.
  static void operator delete(PluginDevice* self, std::destroying_delete_t) {
    self->stop();
    if (!self->has_ended()) return;
    self->~PluginDevice();
    ::operator delete(self);
  }

 private:
  void work() override;
  void release_device() noexcept override;
  DeviceInfo describe(void* device) const;
  void talk(void* device, bool has_force);
  void read(void* device);
  void write(void* device, const Wrench& wrench) const;
  void let_go(void* device, bool has_force) noexcept;
  [[noreturn]] void lose(const char* reason) const;

  std::string m_file;
  std::string m_argument;
  Library m_library;
  const argil_plugin& m_plugin;
  std::atomic<void*> m_device = nullptr;
};

void PluginDevice::lose(const char* reason) const {
  throw std::runtime_error(m_file + ": " + (reason != nullptr ? reason : "the device went away"));
}

DeviceInfo PluginDevice::describe(void* device) const {
  argil_plugin_info told{};
  m_plugin.describe(device, &told);
  DeviceInfo info;
  info.kind = "plugin";
  info.name.assign(told.name, strnlen(told.name, sizeof told.name));
  info.max_force = told.max_force;
  info.max_torque = told.max_torque;
  info.max_stiffness = told.max_stiffness;
  info.workspace = Vec3(told.workspace[0], told.workspace[1], told.workspace[2]);
  info.rate_hz = told.rate_hz;
  info.has_force = told.has_force != 0;
  for (const double limit : {info.max_force, info.max_torque, info.max_stiffness, info.rate_hz})
    if (!(limit >= 0.0 && std::isfinite(limit))) lose("describe: a limit is negative or not finite");
  return info;
}

void PluginDevice::write(void* device, const Wrench& wrench) const {
  m_plugin.write(device, wrench.force.data(), wrench.torque.data());
}

void PluginDevice::work() {
  const char* reason = nullptr;
  void* const device = m_plugin.open(m_argument.c_str(), &reason);
  if (device == nullptr) lose(reason);
  const DeviceInfo info = describe(device);
  set_info(info);
  m_device = device;
  struct LetGo {
    PluginDevice* self;
    void* device;
    bool has_force;
    ~LetGo() { self->let_go(device, has_force); }
  } const let_go{this, device, info.has_force};
  talk(device, info.has_force);
}

/// A device that does not wait for its next sample is asked once a period.
void PluginDevice::talk(void* device, bool has_force) {
  for (double deadline = monotonic_now(); !is_stopping();) {
    show_life();
    read(device);
    if (has_force) {
      write(device, begin_rendering());
      end_rendering();
    }
    deadline = find_next_deadline(deadline, period(), monotonic_now());
    sleep_until(deadline);
  }
}

void PluginDevice::read(void* device) {
  argil_plugin_sample sample{};
  const char* reason = nullptr;
  const int32_t result = m_plugin.read(device, &sample, &reason);
  if (result == ARGIL_PLUGIN_LOST) lose(reason);
  if (result != ARGIL_PLUGIN_SAMPLE && result != ARGIL_PLUGIN_NONE)
    lose(("read: " + std::to_string(result) + " is no argil_plugin_result").c_str());
  const double* q = sample.orientation;
  if (result == ARGIL_PLUGIN_SAMPLE)
    deliver(Eigen::Map<const Vec3>(sample.position), Quat(q[3], q[0], q[1], q[2]), sample.buttons);
}

/// Also when the device is lost: its last word is zero force.
void PluginDevice::let_go(void* device, bool has_force) noexcept {
  try {
    if (has_force) write(device, {});
  } catch (...) {
    release_device();
  }
  m_device = nullptr;
  wait_for_releases();
  try {
    m_plugin.close(device);
  } catch (...) {  // there is nothing left to close
  }
}

void PluginDevice::release_device() noexcept {
  void* const device = m_device;
  if (device != nullptr) m_plugin.release(device);
}

bool is_complete(const argil_plugin& p) {
  return p.open != nullptr && p.describe != nullptr && p.read != nullptr && p.write != nullptr &&
         p.release != nullptr && p.close != nullptr;
}

}  // namespace

std::unique_ptr<HapticDevice> make_plugin(const std::string& place, const DeviceOptions& options) {
  const std::size_t comma = place.find(',');
  const std::string file = place.substr(0, comma);
  const std::string argument = comma == std::string::npos ? "" : place.substr(comma + 1);
  // A name without a slash would be looked for in the system's folders.
  Library library(dlopen((file.find('/') == std::string::npos ? "./" + file : file).c_str(),
                         RTLD_NOW | RTLD_LOCAL));  // NOLINT: the flags are POSIX's
  if (library == nullptr) throw InputError("--device plugin:" + file, "", dlerror(), "name a shared library");
  using Entry = const argil_plugin* (*)();
  const auto entry = reinterpret_cast<Entry>(dlsym(library.get(), "argil_plugin_entry"));
  const argil_plugin* const plugin = entry != nullptr ? entry() : nullptr;
  if (plugin == nullptr)
    throw InputError("--device plugin:" + file, "", "no argil_plugin_entry in it",
                     "build it against src/device/plugin_api.h");
  if (plugin->version != ARGIL_PLUGIN_VERSION)
    throw InputError("--device plugin:" + file, "", "version " + std::to_string(plugin->version),
                     "build it against version " + std::to_string(ARGIL_PLUGIN_VERSION) + " of plugin_api.h");
  if (!is_complete(*plugin))
    throw InputError("--device plugin:" + file, "", "a function is missing", "give all six");
  return std::make_unique<PluginDevice>(options, file, argument, std::move(library), *plugin);
}

}  // namespace argil::device::internal
