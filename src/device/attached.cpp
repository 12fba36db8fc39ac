#include "device/attached.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>

#include "device/backends.h"

namespace argil::device::internal {
namespace {

constexpr double kReach = 10.0;  // [m]; no hand at a desk is further from its device
// Devices round quaternions to a few digits; what is further from unit length is another quantity.
constexpr double kMaxUnitError = 0.05;

}  // namespace

double steady_seconds() noexcept {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

AttachedDevice::AttachedDevice(const DeviceOptions& options) : m_options(options), m_mode(options.mode) {}

void AttachedDevice::start() {
  stop();
  m_mode = ModeSwitch(m_options.mode);
  m_last_arrival = {};
  m_last_order = {};
  for (Arrival old; m_arrivals.take(old);) continue;
  for (Order old; m_orders.take(old);) continue;
  m_samples = m_repeated = m_refused = 0;
  m_is_stopping = m_is_released = false;
  {
    const std::lock_guard<std::mutex> lock(m_mutex);
    m_problem.clear();
  }
  m_state = DeviceState::connecting;
  m_thread = std::thread([this] { run(); });
}

void AttachedDevice::stop() noexcept {
  m_is_stopping = true;
  if (!m_thread.joinable()) return;
  interrupt();
  m_thread.join();
  m_state = DeviceState::stopped;
}

void AttachedDevice::run() {
  std::string problem = "the device went away";
  try {
    work();
  } catch (const std::exception& error) {
    problem = error.what();
  }
  if (m_is_stopping) return;
  {
    const std::lock_guard<std::mutex> lock(m_mutex);
    m_problem = problem;
  }
  m_state = DeviceState::lost;
}

DeviceState AttachedDevice::state_at(double now, double sample_time) const noexcept {
  const DeviceState state = m_state;
  const bool is_fresh = now - sample_time <= m_options.stale_after;
  return state == DeviceState::ready && !is_fresh ? DeviceState::stale : state;
}

DeviceState AttachedDevice::state() const noexcept {
  return state_at(steady_seconds(), m_last_time);
}

DevicePoll AttachedDevice::poll() noexcept {
  m_arrivals.take(m_last_arrival);
  DevicePoll poll;
  poll.sample = m_last_arrival.sample;
  poll.number = m_last_arrival.number;
  poll.time = m_last_arrival.time;
  const double now = steady_seconds();
  poll.age = now - m_last_arrival.time;
  poll.state = state_at(now, m_last_arrival.time);
  return poll;
}

void AttachedDevice::send(const Wrench& on_hand) noexcept {
  const Quat to_device = m_options.device_to_world.rotation.conjugate();
  const Wrench wrench{to_device * finite_or_zero(on_hand.force), to_device * finite_or_zero(on_hand.torque)};
  m_orders.put({wrench, steady_seconds()});
}

void AttachedDevice::release() noexcept {
  m_is_released = true;
  release_device();
}

Wrench AttachedDevice::take_wrench() {
  m_orders.take(m_last_order);
  const double oldest = std::min(m_last_order.time, m_last_time.load());
  // After a new start m_last_time is still that of a sample from before it.
  const bool is_alive = m_samples > 0 && steady_seconds() - oldest <= kForceLifetime;
  if (!is_alive || m_is_released || m_is_stopping) return {};
  return m_last_order.wrench;
}

bool AttachedDevice::deliver(const Vec3& position, const Quat& orientation, unsigned buttons) {
  const double norm = orientation.norm();
  if (!(position.cwiseAbs().maxCoeff() <= kReach && position.allFinite() &&
        std::abs(norm - 1.0) <= kMaxUnitError)) {
    count_refused();
    return false;
  }
  Arrival arrival;
  arrival.sample = {position, make_unit(orientation), m_mode.update(buttons)};
  move_to_world(m_options.device_to_world, arrival.sample);
  arrival.number = ++m_samples;
  arrival.time = steady_seconds();
  m_last_time = arrival.time;
  m_arrivals.put(arrival);
  m_state = DeviceState::ready;
  return true;
}

void AttachedDevice::set_info(const DeviceInfo& info) {
  const std::lock_guard<std::mutex> lock(m_mutex);
  m_info = info;
}

DeviceInfo AttachedDevice::info() const {
  const std::lock_guard<std::mutex> lock(m_mutex);
  return m_info;
}

DeviceCounts AttachedDevice::counts() const {
  return {m_samples, m_repeated, m_refused};
}

std::string AttachedDevice::problem() const {
  const std::lock_guard<std::mutex> lock(m_mutex);
  return m_problem;
}

}  // namespace argil::device::internal
