// Devices of shared libraries that offer plugin_api.h.

#include <dlfcn.h>

#include <chrono>
#include <cstring>
#include <stdexcept>

#include "base/error.h"
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

 private:
  void work() override;
  void release_device() noexcept override;
  DeviceInfo describe(void* device) const;
  void write(void* device, const Wrench& wrench);
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
  return info;
}

void PluginDevice::write(void* device, const Wrench& wrench) {
  m_plugin.write(device, wrench.force.data(), wrench.torque.data());
}

void PluginDevice::work() {
  const char* reason = nullptr;
  void* const device = m_plugin.open(m_argument.c_str(), &reason);
  if (device == nullptr) lose(reason);
  const DeviceInfo info = describe(device);
  set_info(info);
  m_device = device;
  // Also when the device is lost: its last word is zero force.
  struct Close {
    PluginDevice* self;
    void* device;
    bool has_force;
    ~Close() {
      if (has_force) self->write(device, {});
      self->m_device = nullptr;
      self->m_plugin.close(device);
    }
  } const close{this, device, info.has_force};
  while (!is_stopping()) {
    argil_plugin_sample sample{};
    const double begin = steady_seconds();
    const int32_t result = m_plugin.read(device, &sample, &reason);
    if (result == ARGIL_PLUGIN_LOST) lose(reason);
    const double* q = sample.orientation;
    if (result == ARGIL_PLUGIN_SAMPLE)
      deliver(Eigen::Map<const Vec3>(sample.position), Quat(q[3], q[0], q[1], q[2]), sample.buttons);
    if (info.has_force) write(device, take_wrench());
    // A device that does not wait for its next sample is asked once a period.
    const double rest = period() - (steady_seconds() - begin);
    if (rest > 0.0) std::this_thread::sleep_for(std::chrono::duration<double>(rest));
  }
}

void PluginDevice::release_device() noexcept {
  void* const device = m_device;
  if (device != nullptr && m_plugin.release != nullptr) m_plugin.release(device);
}

bool is_complete(const argil_plugin& p) {
  return p.open != nullptr && p.describe != nullptr && p.read != nullptr && p.write != nullptr &&
         p.close != nullptr;
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
    throw InputError("--device plugin:" + file, "", "a function is missing", "only release may be null");
  return std::make_unique<PluginDevice>(options, file, argument, std::move(library), *plugin);
}

}  // namespace argil::device::internal
