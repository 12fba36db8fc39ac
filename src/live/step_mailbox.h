#pragma once

#include <atomic>
#include <cstdint>

#include "sim/simulation.h"

namespace argil::live {

/// Passes one physics step at a time between the hand's thread and the physics thread. Load and answer belong
/// to one of them at a time, `m_phase` says to which: idle or answered to the hand, given to the physics. The
/// hand looks and goes on; it never waits, and what it takes and gives are swapped, not copied.
class StepMailbox {
 public:
  StepMailbox(Eigen::Index num_nodes, Eigen::Index num_vertices)
      : m_load(num_nodes), m_answer(num_vertices) {}

  // The hand's thread.
  /// May a step be given now? Not while one is under way.
  bool is_free() const { return m_phase.load(std::memory_order_acquire) == Phase::idle; }
  bool has_answer() const { return m_phase.load(std::memory_order_acquire) == Phase::answered; }
  /// With has_answer(): false when the step failed, which ends the session.
  bool see(sim::HandSide& hand) {
    if (!m_status.is_ok()) return false;
    hand.see(m_answer);
    m_seen = m_answer.step;
    m_phase.store(Phase::idle, std::memory_order_release);
    return true;
  }
  /// With is_free(). `late`: ticks that it had to wait for beyond the planned ones; `now` [s].
  void give(sim::HandSide& hand, int late, double now) {
    hand.give(m_load);
    m_late = late;
    m_given_at = now;
    m_phase.store(Phase::given, std::memory_order_release);
  }
  Tick seen() const { return m_seen; }  ///< number of the last step that was seen

  // The physics thread.
  bool has_load() const { return m_phase.load(std::memory_order_acquire) == Phase::given; }
  /// With has_load(): makes the step and answers. What late() and given_at() say is of this step until then.
  void answer(sim::BodySide& body) {
    m_status = body.step(m_load, m_answer);
    m_is_failed = !m_status.is_ok();
  }
  void publish() { m_phase.store(Phase::answered, std::memory_order_release); }
  int late() const { return m_late; }
  double given_at() const { return m_given_at; }
  bool is_failed() const { return m_is_failed; }

  /// When both threads have ended.
  const StepStatus& status() const { return m_status; }

 private:
  enum class Phase : std::uint8_t { idle, given, answered };
  sim::ContactLoad m_load;
  sim::BodyAnswer m_answer;
  StepStatus m_status = StepStatus::ok();
  bool m_is_failed = false;
  int m_late = 0;
  double m_given_at = 0.0;
  Tick m_seen = 0;  // the hand's alone
  std::atomic<Phase> m_phase = Phase::idle;
};

}  // namespace argil::live
