#include "live/session.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/realtime.h"
#include "base/signal_stack.h"

namespace argil::live {
namespace {

constexpr std::size_t kWaitingSteps = 64;
constexpr double kLook = 2e-4;  // [s] between two looks of a thread that has nothing to do, at most

}  // namespace

Session::Session(sim::Simulation& simulation, device::HapticDevice& device, SessionOptions options)
    : m_simulation(simulation),
      m_device(device),
      m_options(std::move(options)),
      m_period(simulation.params().rates.haptic_period),
      m_mailbox(simulation.body_side().surface().num_vertices()),
      m_ticks(static_cast<std::size_t>(m_options.record_buffer_s / m_period) + 1),
      m_steps(kWaitingSteps),
      m_sample_number(m_options.first_sample) {
  const sim::HandState& hand = simulation.hand_state();
  m_sample = {hand.tool.position, hand.tool.orientation, hand.mode};
}

Session::~Session() {
  request_stop();
  m_is_abandoned.store(true, std::memory_order_relaxed);
  join();
}

void Session::start() {
  ARGIL_ASSERT(!m_hand_thread.joinable(), "started twice");
  m_simulation.hand().prepare_alone();
  if (m_options.is_realtime && !lock_memory())
    m_warning += "memory could not be locked: raise the limit \"memlock\"; ";
  m_running = 2;
  m_physics_thread = std::thread([this] { run_physics(); });
  m_hand_thread = std::thread([this] { run_hand(); });
  if (m_options.is_realtime && !make_realtime(m_hand_thread.native_handle(), kHandPriority))
    m_warning += "the hand's thread runs at ordinary priority: raise the limit \"rtprio\"; ";
}

void Session::join() {
  if (m_hand_thread.joinable()) m_hand_thread.join();
  if (m_physics_thread.joinable()) m_physics_thread.join();
}

std::optional<Failure> Session::failure() const {
  if (m_tick_failure) return m_tick_failure;
  if (const StepStatus hand = m_simulation.hand().status(); !hand.is_ok()) return hand.failure();
  if (m_mailbox.status().is_ok()) return std::nullopt;
  return m_mailbox.status().failure();
}

void Session::run_hand() {
  const SignalStack stack;
  wake_without_slack();
  m_end = make_ticks();
  m_device.send({});
  m_hand_has_ended.store(true, std::memory_order_release);
  m_running.fetch_sub(1, std::memory_order_release);
}

/// By absolute times, so that lateness does not add up. A tick that comes more than a period late is one tick
/// nevertheless; the periods that passed are counted and not made up for.
SessionEnd Session::make_ticks() {
  m_surface_time = monotonic_now();
  double deadline = m_surface_time + m_period;
  for (;;) {
    sleep_until(deadline);
    const double now = monotonic_now();
    output::TickTiming timing;
    timing.wake_late = now - deadline;
    timing.missed = static_cast<int>(std::max(0.0, std::floor(timing.wake_late / m_period)));
    deadline += (1 + timing.missed) * m_period;
    const SessionEnd end = make_tick(timing, now);
    if (end != SessionEnd::none) return end;
    if (m_simulation.clock().tick == m_options.num_ticks) return SessionEnd::done;
  }
}

SessionEnd Session::make_tick(output::TickTiming timing, double woken_at) {
  if (m_is_asked.load(std::memory_order_relaxed)) return SessionEnd::asked;
  if (!m_ticks.has_room()) return SessionEnd::overflow;  // before the hand feels what no record would have
  sim::HandSide& hand = m_simulation.hand();
  const device::DevicePoll poll = m_device.poll();
  if (poll.state == device::DeviceState::lost) return SessionEnd::lost;
  if (poll.is_valid()) {
    m_sample = poll.sample;
    m_sample_number = poll.number;
  }
  if (m_options.mode) m_sample.mode = *m_options.mode;
  timing.sample_age = poll.age;

  sim::TickPlan plan;
  plan.receives_step = m_mailbox.has_result();
  if (plan.receives_step) m_surface_time = m_mailbox.begun_at();
  const int ticks_since_step = hand.state().ticks_since_step + 1;
  plan.begins_step = ticks_since_step >= m_simulation.params().rates.physics_period_ticks &&
                     (plan.receives_step || m_mailbox.is_free());
  plan.feed = device::judge_feed(m_simulation.params().device.watchdog, poll.number, poll.age,
                                 woken_at - m_surface_time);
  if (const StepStatus status = sim::tick(hand, m_mailbox, m_sample, plan); !status.is_ok()) {
    m_tick_failure = status.failure();
    return SessionEnd::failed;
  }
  HandTick tick;
  if (plan.begins_step) tick.session.begun_step = hand.state().steps_begun;
  tick.session.feed = plan.feed;
  m_device.send({hand.gated().force, hand.gated().torque});

  timing.work = monotonic_now() - woken_at;
  tick.record = hand.make_record();
  tick.timing = timing;
  tick.session.sample = m_sample_number;
  tick.session.seen_step = m_mailbox.received();
  tick.session.device_state = poll.state;
  m_ticks.push(std::move(tick));
  return SessionEnd::none;
}

/// The hand wakes no one, which would be a call of the system: the physics thread looks often instead.
void Session::run_physics() {
  const SignalStack stack;
  wake_without_slack();
  const double look = std::min(kLook, 0.05 * m_period * m_simulation.params().rates.physics_period_ticks);
  while (!m_mailbox.is_failed()) {
    if (m_mailbox.has_load())
      make_step();
    else if (m_hand_has_ended.load(std::memory_order_acquire) && !m_mailbox.has_load())
      break;
    else
      sleep_until(monotonic_now() + look);
  }
  m_running.fetch_sub(1, std::memory_order_release);
}

void Session::make_step() {
  sim::BodySide& body = m_simulation.body_side();
  const Tick ticks_before = body.hand().ticks;
  BodyStep step;
  const double begin = monotonic_now();
  if (m_options.before_step) m_options.before_step(body.state().steps + 1);
  step.given_at = m_mailbox.begun_at();
  step.timing.wait = begin - step.given_at;
  step.timing.late = m_mailbox.num_ticks() - m_simulation.params().rates.physics_period_ticks;
  m_mailbox.make(body);
  step.timing.work = monotonic_now() - begin;
  const bool is_failed = m_mailbox.is_failed();
  m_mailbox.publish();
  if (is_failed) return;
  step.record = body.make_record();
  const int period = m_simulation.params().rates.frame_period_ticks;
  if (sim::passes_multiple(ticks_before, body.hand().ticks, period))
    step.frame = std::make_unique<sim::Frame>(body.make_frame(body.hand()));
  // Where the writing thread is behind, the physics is late, not the hand.
  while (!m_steps.push(std::move(step)) && !m_is_abandoned.load(std::memory_order_relaxed))
    sleep_until(monotonic_now() + kLook);
}

}  // namespace argil::live
