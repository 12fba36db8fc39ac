#pragma once

#include <algorithm>
#include <atomic>
#include <mutex>
#include <thread>

#include "base/latest_value.h"
#include "base/realtime.h"
#include "device/devices.h"
#include "device/mode_switch.h"

namespace argil::device::internal {

/// When a thread that keeps time wakes next [s]: a period after it should have woken last, so that lateness
/// does not add up; of what it is behind it makes up for one period at most.
inline double find_next_deadline(double last, double period, double now) {
  return std::max(last + period, now - period);
}

/// A device that a thread of its own talks to. Samples and forces pass between that thread and the hand's by
/// LatestValue. What the device is sent is zero before its first valid sample, after release, and when the
/// hand's thread has not sent, or no valid sample has come, for kForceLifetime. A second thread watches the
/// first: where that has left the device with a force for kForceLifetime, it releases the device; where it
/// has not come back from the device for kPatience, the device is lost.
class AttachedDevice : public HapticDevice {
 public:
  explicit AttachedDevice(const DeviceOptions& options);
  void start() final;
  void stop() noexcept final;
  DevicePoll poll() noexcept final;
  void send(const Wrench& on_hand) noexcept final;
  void release() noexcept final;
  DeviceState state() const noexcept final;
  DeviceInfo info() const final;
  DeviceCounts counts() const final;
  std::string problem() const final;

 protected:
  /// [s]; a hand's thread that is alive sends every tick. The output gate lets go gently before that.
  static constexpr double kForceLifetime = 0.1;
  static constexpr double kPatience = 2.0;  ///< [s] without a sign of life until the device is lost

  /// Talks to the device until is_stopping() or the device is lost. Runs in the thread; what it throws is why
  /// the device is lost. Every derived class calls stop() in its destructor.
  virtual void work() = 0;
  /// Ends a wait in work(), soon after is_stopping() has become true. Any thread.
  virtual void interrupt() noexcept {}
  /// Tells the device of zero force by system calls that are allowed in a signal handler, if it can be. Any
  /// thread, also while work() talks to it.
  virtual void release_device() noexcept {}

  // For work():
  bool is_stopping() const noexcept { return m_is_stopping || m_state == DeviceState::lost; }
  /// stop() waits for work() only so long; false after it when the device has not let work() come back. The
  /// object has to stay then.
  bool has_ended() const noexcept { return !m_thread.joinable(); }
  double stale_after() const { return m_options.stale_after; }
  double period() const { return m_options.period; }
  void set_info(const DeviceInfo& info);
  /// A sample in the device's axes [m]; counted as refused when it is not finite, further than kReach from
  /// the origin, takes the hand beyond kFarthestPlace in the world, or its quaternion is none. False then.
  bool deliver(const Vec3& position, const Quat& orientation, unsigned buttons);
  void count_refused() { ++m_refused; }
  void count_repeated() { ++m_repeated; }
  /// What the device is to render now, in its own axes; end_rendering when it was told.
  Wrench begin_rendering();
  void end_rendering();
  /// From now on the thread has to call it again within kPatience.
  void show_life() { m_alive_at = monotonic_now(); }
  /// Once release_device finds nothing to release any more, and before that is taken away: none is under way
  /// after it.
  void wait_for_releases() const;

 private:
  struct Arrival {
    DeviceSample sample;
    std::int64_t number = 0;
    double time = 0.0;
  };
  struct Order {
    Wrench wrench;
    double time = 0.0;
  };
  void run();
  void watch();
  void lose(const std::string& problem);
  void release_counted() noexcept;
  Wrench find_wrench();
  DeviceState state_at(double now, double sample_time) const noexcept;

  DeviceOptions m_options;
  LatestValue<Arrival> m_arrivals;
  LatestValue<Order> m_orders;
  Arrival m_last_arrival;                                   ///< the hand's thread
  Order m_last_order;                                       ///< the device's thread
  ModeSwitch m_mode;                                        ///< the device's thread
  std::atomic<DeviceState> m_state = DeviceState::stopped;  ///< never stale: that follows from the time
  std::atomic<double> m_last_time = 0.0;                    ///< of the last arrival
  std::atomic<std::int64_t> m_samples = 0;
  std::atomic<std::int64_t> m_repeated = 0;
  std::atomic<std::int64_t> m_refused = 0;
  std::atomic<bool> m_is_stopping = false;
  std::atomic<bool> m_is_released = false;
  std::atomic<bool> m_is_rendering = false;  ///< between begin_rendering and end_rendering
  std::atomic<bool> m_is_pushing = false;    ///< the device may have been told of a force that is not zero
  std::atomic<double> m_rendered_at = 0.0;   ///< when it was told last [s]
  std::atomic<double> m_alive_at = 0.0;      ///< [s]; 0: has not shown life yet
  std::atomic<int> m_releasing = 0;          ///< calls of release_device under way
  std::atomic<bool> m_is_watched = false;    ///< until the thread has ended or is left
  std::atomic<bool> m_work_has_ended = false;
  mutable std::mutex m_mutex;  ///< of the next two; the hand's thread takes it never
  DeviceInfo m_info;
  std::string m_problem;
  Wrench m_rendered;  ///< the device's thread
  std::thread m_thread, m_watch_thread;
};

}  // namespace argil::device::internal
