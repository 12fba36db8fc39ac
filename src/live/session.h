#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "base/spsc_ring.h"
#include "device/haptic_device.h"
#include "live/step_mailbox.h"
#include "output/result_file.h"

namespace argil::live {

/// How a session is run.
struct SessionOptions {
  Tick num_ticks = 0;                                   ///< after which it ends; 0: when it is asked to
  std::optional<device::ToolMode> mode = std::nullopt;  ///< of the tool; nothing: the device's buttons decide
  std::int64_t first_sample = 0;  ///< number of the sample at which the simulation starts
  double record_buffer_s = 8.0;   ///< ticks of so long may wait for who drains them
  bool is_realtime = true;        ///< asks the system for it; tests do without
  std::function<void(Tick)> before_step =
      nullptr;  ///< in the physics thread, with the step's number: tests make it late
};

/// A tick of the hand, as its thread gives it away.
struct HandTick {
  sim::HapticRecord record;
  output::SessionTick session;
  output::TickTiming timing;
};

/// A step of the body, as the physics thread gives it away.
struct BodyStep {
  sim::PhysicsRecord record;
  output::StepTiming timing;
  double given_at = 0.0;              ///< [s] on the monotonic clock, when the hand handed it over
  std::unique_ptr<sim::Frame> frame;  ///< with those that are due
};

/// Why a session ended.
enum class SessionEnd : std::uint8_t {
  none,      ///< it has not
  done,      ///< all its ticks are made
  asked,     ///< request_stop()
  lost,      ///< the device is gone
  failed,    ///< a physics step failed
  overflow,  ///< who drains it was too slow: the record would have had a hole
};

/// A device and a simulation in two threads. The hand's wakes once a tick, by the clock: one sample, contact,
/// one force; it never waits for anything else, takes no lock and, once its arrays have grown to what the
/// scene needs, allocates nothing. The physics thread makes the steps that the hand gives it, one at a time.
/// A third thread, the caller's, drains what both give away.
class Session {
 public:
  /// `simulation` has not begun; `device` is ready. Both are the session's until join().
  Session(sim::Simulation& simulation, device::HapticDevice& device, SessionOptions options);
  ~Session();  ///< stops and joins
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void start();
  /// Ends it at the next tick; also from a signal handler.
  void request_stop() noexcept { m_is_asked.store(true, std::memory_order_relaxed); }
  bool is_running() const { return m_running.load(std::memory_order_acquire) > 0; }
  /// Waits until both threads have ended: the hand's after its next tick, the physics after its step.
  void join();

  /// What came since the last look, in order; false when there is nothing.
  bool pop(HandTick& tick) { return m_ticks.pop(tick); }
  bool pop(BodyStep& step) { return m_steps.pop(step); }

  // After join().
  SessionEnd end() const { return m_end; }
  /// Of the step or the tick that failed.
  std::optional<Failure> failure() const;
  /// What the system did not grant, in words for the user; empty when all was.
  const std::string& warning() const { return m_warning; }

 private:
  void run_hand();
  SessionEnd make_ticks();
  SessionEnd make_tick(output::TickTiming timing, double woken_at);
  void run_physics();
  void make_step();

  sim::Simulation& m_simulation;
  device::HapticDevice& m_device;
  SessionOptions m_options;
  double m_period;  // [s]
  StepMailbox m_mailbox;
  SpscRing<HandTick> m_ticks;
  SpscRing<BodyStep> m_steps;
  device::DeviceSample m_sample;  // that was consumed last; the hand's thread
  std::int64_t m_sample_number = 0;
  double m_surface_time = 0.0;  // [s] when the hand handed over the step whose surface it meets
  SessionEnd m_end = SessionEnd::none;
  std::optional<Failure> m_tick_failure;
  std::string m_warning;
  std::atomic<bool> m_is_asked = false;
  std::atomic<bool> m_is_abandoned = false;  // no one drains any more
  std::atomic<bool> m_hand_has_ended = false;
  std::atomic<int> m_running = 0;  // threads
  std::thread m_hand_thread, m_physics_thread;
};

}  // namespace argil::live
