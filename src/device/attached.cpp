#include "device/attached.h"

#include <algorithm>
#include <cmath>
#include <exception>

#include "base/signal_stack.h"
#include "device/backends.h"

namespace argil::device::internal {
namespace {

constexpr double kReach = 10.0;  // [m]; no hand at a desk is further from its device
// Devices round quaternions to a few digits; what is further from unit length is another quantity.
constexpr double kMaxUnitError = 0.05;
constexpr double kLook = 0.02;        // [s] between two looks of the watching thread
constexpr double kEndPatience = 1.0;  // [s] for work() to come to its end
constexpr int kRenderPatience = 100;  // [ms] for a command under way to reach the device

}  // namespace

AttachedDevice::AttachedDevice(const DeviceOptions& options) : m_options(options), m_mode(options.mode) {}

void AttachedDevice::start() {
  stop();
  if (!has_ended()) return lose("the device has not come to its end: start the program again");
  m_mode = ModeSwitch(m_options.mode);
  m_last_arrival = {};
  m_last_order = {};
  for (Arrival old; m_arrivals.take(old);) continue;
  for (Order old; m_orders.take(old);) continue;
  m_samples = m_repeated = m_refused = 0;
  m_is_stopping = m_is_released = m_is_pushing = m_is_rendering = m_work_has_ended = false;
  m_alive_at = 0.0;
  {
    const std::lock_guard<std::mutex> lock(m_mutex);
    m_problem.clear();
  }
  m_state = DeviceState::connecting;
  m_is_watched = true;
  m_thread = std::thread([this] { run(); });
  m_watch_thread = std::thread([this] { watch(); });
}

void AttachedDevice::stop() noexcept {
  m_is_stopping = true;
  if (!m_thread.joinable()) return;
  interrupt();
  const double patience = m_is_watched ? kEndPatience : 0.0;  // it was left before
  for (const double end = monotonic_now() + patience; !m_work_has_ended && monotonic_now() < end;)
    pause_1_ms();
  if (!m_work_has_ended) release_counted();
  m_is_watched = false;
  if (m_watch_thread.joinable()) m_watch_thread.join();
  if (m_work_has_ended) m_thread.join();
  m_state = DeviceState::stopped;
}

void AttachedDevice::run() {
  const SignalStack stack;
  wake_without_slack();
  make_realtime(pthread_self(), kDevicePriority);  // where the hand's is refused, its warning says so
  std::string problem = "the device went away";
  try {
    work();
  } catch (const std::exception& error) {
    problem = error.what();
  } catch (...) {
    problem = "the device's library threw what is no std::exception";
  }
  if (!m_is_stopping) lose(problem);
  m_work_has_ended = true;
}

/// The first problem is the one that is told.
void AttachedDevice::lose(const std::string& problem) {
  const std::lock_guard<std::mutex> lock(m_mutex);
  if (m_state == DeviceState::lost) return;
  m_problem = problem;
  m_state = DeviceState::lost;
}

void AttachedDevice::watch() {
  const SignalStack stack;
  make_realtime(pthread_self(), kHandPriority);  // before a device's thread that does not wait
  double last = monotonic_now();
  while (m_is_watched && !m_work_has_ended) {
    sleep_until(last + kLook);
    const double now = monotonic_now();
    // Cleared first: a command that is on its way meanwhile sets it again.
    if (m_is_pushing && now - m_rendered_at > kForceLifetime && m_is_pushing.exchange(false))
      release_counted();
    const bool was_held_up = now - last > kForceLifetime;  // with the whole process, perhaps
    const double alive_at = m_alive_at;
    if (!was_held_up && alive_at > 0.0 && now - alive_at > kPatience && !m_is_stopping)
      lose(info().name + ": does not come back from its library: see that the device is connected");
    last = now;
  }
}

DeviceState AttachedDevice::state_at(double now, double sample_time) const noexcept {
  const DeviceState state = m_state;
  const bool is_fresh = now - sample_time <= m_options.stale_after;
  return state == DeviceState::ready && !is_fresh ? DeviceState::stale : state;
}

DeviceState AttachedDevice::state() const noexcept {
  return state_at(monotonic_now(), m_last_time);
}

DevicePoll AttachedDevice::poll() noexcept {
  m_arrivals.take(m_last_arrival);
  DevicePoll poll;
  poll.sample = m_last_arrival.sample;
  poll.number = m_last_arrival.number;
  poll.time = m_last_arrival.time;
  const double now = monotonic_now();
  poll.age = now - m_last_arrival.time;
  poll.state = state_at(now, m_last_arrival.time);
  return poll;
}

void AttachedDevice::send(const Wrench& on_hand) noexcept {
  const Quat to_device = m_options.device_to_world.rotation.conjugate();
  const Wrench wrench{to_device * finite_or_zero(on_hand.force), to_device * finite_or_zero(on_hand.torque)};
  m_orders.put({wrench, monotonic_now()});
}

/// A command under way may reach the device after the first zero: then there is a second. The flags are set
/// and read in opposite order by begin_rendering, so one of both sides sees the other.
void AttachedDevice::release() noexcept {
  m_is_released = true;
  const bool is_under_way = m_is_rendering;
  release_counted();
  for (int look = 0; look < kRenderPatience && m_is_rendering; ++look) pause_1_ms();
  if (is_under_way) release_counted();
}

void AttachedDevice::release_counted() noexcept {
  ++m_releasing;
  release_device();
  --m_releasing;
}

void AttachedDevice::wait_for_releases() const {
  while (m_releasing > 0) pause_1_ms();
}

Wrench AttachedDevice::begin_rendering() {
  m_is_rendering = true;
  m_rendered = find_wrench();
  if (!m_rendered.force.isZero(0.0) || !m_rendered.torque.isZero(0.0)) {
    m_rendered_at = monotonic_now();
    m_is_pushing = true;
  }
  return m_rendered;
}

void AttachedDevice::end_rendering() {
  m_rendered_at = monotonic_now();
  m_is_pushing = !m_rendered.force.isZero(0.0) || !m_rendered.torque.isZero(0.0);
  m_is_rendering = false;
}

Wrench AttachedDevice::find_wrench() {
  m_orders.take(m_last_order);
  const double oldest = std::min(m_last_order.time, m_last_time.load());
  // After a new start m_last_time is still that of a sample from before it.
  const bool is_alive = m_samples > 0 && monotonic_now() - oldest <= kForceLifetime;
  if (!is_alive || m_is_released || is_stopping()) return {};
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
  if (!is_within_reach(arrival.sample.position)) {
    count_refused();
    return false;
  }
  arrival.number = ++m_samples;
  arrival.time = monotonic_now();
  m_last_time = arrival.time;
  m_arrivals.put(arrival);
  DeviceState before = DeviceState::connecting;
  m_state.compare_exchange_strong(before, DeviceState::ready);  // what is lost stays lost
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
