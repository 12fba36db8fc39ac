#pragma once

#include <atomic>
#include <mutex>
#include <thread>

#include "base/latest_value.h"
#include "device/devices.h"
#include "device/mode_switch.h"

namespace argil::device::internal {

/// Seconds of steady_clock.
double steady_seconds() noexcept;

/// A device that a thread of its own talks to. Samples and forces pass between that thread and the hand's by
/// LatestValue. What the device is sent is zero before its first valid sample, after release, and when the
/// hand's thread has not sent, or no valid sample has come, for kForceLifetime.
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

  /// Talks to the device until is_stopping() or the device is lost. Runs in the thread; what it throws is why
  /// the device is lost. Every derived class calls stop() in its destructor.
  virtual void work() = 0;
  /// Ends a wait in work(), soon after is_stopping() has become true. Any thread.
  virtual void interrupt() noexcept {}
  /// Tells the device of zero force by system calls that are allowed in a signal handler, if it can be.
  virtual void release_device() noexcept {}

  // For work():
  bool is_stopping() const noexcept { return m_is_stopping; }
  double stale_after() const { return m_options.stale_after; }
  double period() const { return m_options.period; }
  void set_info(const DeviceInfo& info);
  /// A sample in the device's axes [m]; counted as refused when it is not finite, further than kReach from
  /// the origin or its quaternion is none. False then.
  bool deliver(const Vec3& position, const Quat& orientation, unsigned buttons);
  void count_refused() { ++m_refused; }
  void count_repeated() { ++m_repeated; }
  /// What the device is to render now, in its own axes.
  Wrench take_wrench();

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
  mutable std::mutex m_mutex;  ///< of the next two; the hand's thread takes it never
  DeviceInfo m_info;
  std::string m_problem;
  std::thread m_thread;
};

}  // namespace argil::device::internal
