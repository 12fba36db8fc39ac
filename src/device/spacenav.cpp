// 6-DoF controllers by spacenavd: what the cap does is integrated to a pose. No force.

#ifdef ARGIL_HAS_SPNAV

#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <stdexcept>

#include "device/attached.h"
#include "device/backends.h"
#include "device/spacenav_motion.h"

// Last, for it brings in the macros of X11.
#include <spnav.h>

namespace argil::device::internal {
namespace {

constexpr double kLongestStep = 0.1;  // [s]; a thread that slept longer does not make up for it

class SpacenavDevice final : public AttachedDevice {
 public:
  explicit SpacenavDevice(const DeviceOptions& options) : AttachedDevice(options) { set_info(make_info()); }
  ~SpacenavDevice() override { stop(); }

 private:
  void work() override;
  void take_events();
  DeviceInfo make_info() const;

  std::array<int, 6> m_counts{};
  unsigned m_buttons = 0;
};

/// The connection to the daemon, of which libspnav has one a process.
struct Connection {
  Connection() {
    if (spnav_open() == -1)
      throw std::runtime_error("spacenav: cannot reach spacenavd; start it (package spacenavd)");
  }
  ~Connection() { spnav_close(); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
};

DeviceInfo SpacenavDevice::make_info() const {
  DeviceInfo info;
  info.kind = "spacenav";
  info.name = "spacenavd";
  info.workspace = Vec3::Constant(2.0 * kSpacenavReach);
  info.rate_hz = 1.0 / period();
  return info;
}

void SpacenavDevice::work() {
  const Connection connection;
  DeviceInfo info = make_info();
  std::array<char, 128> name{};
  if (spnav_protocol() >= 1) {
    spnav_client_name("argil");
    if (spnav_dev_type() == -1)
      throw std::runtime_error("spacenav: spacenavd runs, but no device is attached to it");
    if (spnav_dev_name(name.data(), name.size()) > 0) info.name = name.data();
  }
  set_info(info);
  m_counts = {};
  m_buttons = 0;
  SpacenavPose pose;
  for (double last = monotonic_now(); !is_stopping();) {
    pollfd waited{spnav_fd(), POLLIN, 0};
    ::poll(&waited, 1, static_cast<int>(std::max(1.0, 1000.0 * period())));
    const double now = monotonic_now();
    advance(m_counts, std::min(now - last, kLongestStep), pose);  // by what was so far
    last = now;
    char byte;
    if (::recv(waited.fd, &byte, 1, MSG_PEEK | MSG_DONTWAIT) == 0)
      throw std::runtime_error("spacenav: spacenavd has ended");
    take_events();
    deliver(pose.position, pose.orientation, m_buttons);
  }
}

void SpacenavDevice::take_events() {
  spnav_event event;
  while (spnav_poll_event(&event) != 0) {
    if (event.type == SPNAV_EVENT_MOTION) {
      const spnav_event_motion& m = event.motion;
      m_counts = {m.x, m.y, m.z, m.rx, m.ry, m.rz};
    } else if (event.type == SPNAV_EVENT_BUTTON && event.button.bnum >= 0 && event.button.bnum < 32) {
      const unsigned bit = 1U << event.button.bnum;
      m_buttons = event.button.press != 0 ? m_buttons | bit : m_buttons & ~bit;
    } else if (event.type == SPNAV_EVENT_DEV && event.dev.op == SPNAV_DEV_RM) {
      throw std::runtime_error("spacenav: the device was taken off");
    }
  }
}

}  // namespace

std::unique_ptr<HapticDevice> make_spacenav(const DeviceOptions& options) {
  return std::make_unique<SpacenavDevice>(options);
}

}  // namespace argil::device::internal

#else

#include "base/error.h"
#include "device/backends.h"

namespace argil::device::internal {

std::unique_ptr<HapticDevice> make_spacenav(const DeviceOptions&) {
  throw InputError("--device spacenav", "", "argil was built without libspnav",
                   "install libspnav-dev and build again");
}

}  // namespace argil::device::internal

#endif
