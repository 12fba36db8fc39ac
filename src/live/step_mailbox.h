#pragma once

#include <atomic>
#include <cstdint>

#include "base/realtime.h"
#include "sim/simulation.h"

namespace argil::live {

/// Passes one physics step at a time between the hand's thread and the physics thread. Load and result belong
/// to one of them at a time, `m_phase` says to which: idle or ended to the hand, begun to the physics. The
/// hand looks and goes on; it never waits, and load and result are swapped, not copied.
class StepMailbox final : public sim::BodySteps {
 public:
  explicit StepMailbox(Eigen::Index num_vertices) : m_result(num_vertices) {}

  // The hand's thread.
  /// May a step begin now? Not while one is under way.
  bool is_free() const { return m_phase.load(std::memory_order_acquire) == Phase::idle; }
  bool has_result() const { return m_phase.load(std::memory_order_acquire) == Phase::ended; }
  /// With has_result(). A step that failed ends the session.
  StepStatus receive_step(sim::HandSide& hand) override {
    if (!m_status.is_ok()) return m_status;
    hand.receive(m_result);
    m_received = m_result.step;
    m_phase.store(Phase::idle, std::memory_order_release);
    return StepStatus::ok();
  }
  /// With is_free().
  void start_step(sim::HandSide& hand) override {
    hand.hand_over(m_load);
    m_begun_at = monotonic_now();
    m_phase.store(Phase::begun, std::memory_order_release);
  }
  Tick received() const { return m_received; }  ///< number of the last step whose result the hand has

  // The physics thread.
  bool has_load() const { return m_phase.load(std::memory_order_acquire) == Phase::begun; }
  /// With has_load(): makes the step. Until publish(), begun_at() is of this one.
  void make(sim::BodySide& body) {
    m_status = body.step(m_load, m_result);
    m_is_failed = !m_status.is_ok();
    if (m_is_failed)
      body.roll_back();
    else
      body.commit();
  }
  void publish() { m_phase.store(Phase::ended, std::memory_order_release); }
  /// Ticks of the hand that the step gathered.
  int num_ticks() const { return m_load.num_ticks; }
  double begun_at() const { return m_begun_at; }  ///< [s] on the monotonic clock
  bool is_failed() const { return m_is_failed; }

  /// When both threads have ended.
  const StepStatus& status() const { return m_status; }

 private:
  enum class Phase : std::uint8_t { idle, begun, ended };
  sim::ContactLoad m_load;
  sim::StepResult m_result;
  StepStatus m_status = StepStatus::ok();
  bool m_is_failed = false;
  double m_begun_at = 0.0;
  Tick m_received = 0;  // the hand's alone
  std::atomic<Phase> m_phase = Phase::idle;
};

}  // namespace argil::live
