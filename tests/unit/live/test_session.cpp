// A session in two threads against the same in one: equal bits whatever the threads' pace. No test asserts a
// time, only order and counts.
#include "live/session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <vector>

#include "device/devices.h"
#include "live_scene.h"

namespace argil::live {
namespace {

using device::DeviceState;
using device::ToolMode;
using std::chrono::milliseconds;

using test::kToolRadius;
using test::make_params;
using test::make_simulation;

/// Into the block and out again, with a wet tool from the middle of the press on.
device::Trace make_intent(double seconds) {
  device::Trace trace;
  for (int k = 0; k <= 100; ++k) {
    const double share = k / 100.0;
    device::DeviceSample sample;
    sample.position = {0.0211 + 0.002 * share, 0.0197,
                       0.02 + kToolRadius + 0.001 - 0.004 * std::sin(6.3 * share)};
    sample.mode = k < 25 ? ToolMode::push : ToolMode::wet;
    trace.time.push_back(seconds * share);
    trace.samples.push_back(sample);
  }
  return trace;
}

/// What a session gave away, and the hash of the state at its end.
struct Recorded {
  device::DeviceSample start;
  std::vector<HandTick> ticks;
  std::vector<BodyStep> steps;
  SessionEnd end = SessionEnd::none;
  std::string hash;
};

/// The simulated hand, which counts its ticks for another thread to wait for them.
class CountedHand final : public device::HapticDevice {
 public:
  explicit CountedHand(std::unique_ptr<device::HapticDevice> hand) : m_hand(std::move(hand)) {}
  void start() override { m_hand->start(); }
  void stop() noexcept override { m_hand->stop(); }
  device::DevicePoll poll() noexcept override {
    ++m_polls;
    return m_hand->poll();
  }
  void send(const device::Wrench& on_hand) noexcept override { m_hand->send(on_hand); }
  void release() noexcept override { m_hand->release(); }
  DeviceState state() const noexcept override { return m_hand->state(); }
  device::DeviceInfo info() const override { return m_hand->info(); }
  device::DeviceCounts counts() const override { return m_hand->counts(); }
  std::string problem() const override { return m_hand->problem(); }

  Tick polls() const { return m_polls; }
  /// Until the hand has made so many ticks more, or all of `last`.
  void wait_for_ticks(Tick ticks, Tick last) const {
    const Tick wanted = std::min(m_polls + ticks, last);
    while (m_polls < wanted) std::this_thread::sleep_for(milliseconds(1));
  }

 private:
  std::unique_ptr<device::HapticDevice> m_hand;
  std::atomic<Tick> m_polls = 0;
};

/// `late`: what the session gives away is taken when it has ended.
Recorded record(const sim::Params& params, SessionOptions options, device::HapticDevice& device,
                bool late = false) {
  Recorded recorded;
  device.start();
  const device::DevicePoll first = device.poll();
  recorded.start = first.sample;
  sim::Simulation simulation = make_simulation(params, first.sample);
  options.first_sample = first.number;
  options.is_realtime = false;
  Session session(simulation, device, options);
  session.start();
  for (bool is_running = true; is_running;) {
    is_running = session.is_running();
    HandTick tick;
    while (!(late && is_running) && session.pop(tick)) recorded.ticks.push_back(tick);
    BodyStep step;
    while (!(late && is_running) && session.pop(step)) recorded.steps.push_back(std::move(step));
    std::this_thread::sleep_for(milliseconds(1));
  }
  session.join();
  recorded.end = session.end();
  recorded.hash = simulation.state_hash();
  return recorded;
}

CountedHand make_hand(double seconds) {
  device::DeviceOptions device_options;
  device_options.intent = make_intent(seconds);
  return CountedHand(device::make_device("simulated", device_options));
}

Recorded record(const sim::Params& params, SessionOptions options) {
  CountedHand hand = make_hand(0.3);
  return record(params, std::move(options), hand);
}

/// The same in one thread gives the same forces, steps and frames, to the bit.
void expect_replays(const sim::Params& params, const Recorded& recorded) {
  sim::Simulation simulation = make_simulation(params, recorded.start);
  Tick seen = 0;
  std::size_t steps = 0;
  for (const HandTick& tick : recorded.ticks) {
    const device::DeviceSample sample{tick.record.tool_position, tick.record.tool_orientation,
                                      tick.record.mode};
    const sim::TickPlan plan{tick.session.seen_step != seen, tick.session.begun_step != 0, tick.session.feed};
    seen = tick.session.seen_step;
    ASSERT_TRUE(simulation.tick(sample, plan).is_ok());
    const sim::HapticRecord again = simulation.haptic_record();
    ASSERT_EQ(again.force, tick.record.force) << "tick " << tick.record.tick;
    ASSERT_EQ(again.torque, tick.record.torque) << "tick " << tick.record.tick;
    ASSERT_EQ(again.device_force, tick.record.device_force) << "tick " << tick.record.tick;
    ASSERT_EQ(again.force_age, tick.record.force_age) << "tick " << tick.record.tick;
    if (!plan.begins_step) continue;
    ASSERT_LT(steps, recorded.steps.size());
    const BodyStep& step = recorded.steps[steps++];
    ASSERT_EQ(simulation.physics_record().tick, step.record.tick);
    ASSERT_EQ(simulation.physics_record().elastic_energy, step.record.elastic_energy);
    if (!step.frame) continue;
    ASSERT_EQ(simulation.body_side().make_frame_of_step().state_hash, step.frame->state_hash);
  }
  EXPECT_EQ(steps, recorded.steps.size());
  EXPECT_EQ(simulation.state_hash(), recorded.hash);
}

double find_largest_force(const Recorded& recorded) {
  double largest = 0.0;
  for (const HandTick& tick : recorded.ticks) largest = std::max(largest, tick.record.force.norm());
  return largest;
}

class EveryWay : public testing::TestWithParam<sim::BetweenFrames> {};

TEST_P(EveryWay, AReplayInOneThreadHasTheBitsOfTheSession) {
  const sim::Params params = make_params(GetParam());
  const Recorded recorded = record(params, {.num_ticks = 300});
  EXPECT_EQ(recorded.end, SessionEnd::done);
  ASSERT_EQ(recorded.ticks.size(), 300U);
  EXPECT_GT(find_largest_force(recorded), 0.01);
  EXPECT_GT(recorded.steps.back().record.water_added, 0.0);
  expect_replays(params, recorded);
}

TEST_P(EveryWay, AlsoWhereThePhysicsIsSlow) {
  const sim::Params params = make_params(GetParam());
  SessionOptions options;
  options.num_ticks = 300;
  // Of irregular length, always longer than the two ticks that there are.
  CountedHand hand = make_hand(0.3);
  options.before_step = [&hand](Tick step) { hand.wait_for_ticks(3 + step % 7, 300); };
  const Recorded recorded = record(params, options, hand);
  ASSERT_EQ(recorded.ticks.size(), 300U);
  EXPECT_LE(recorded.steps.size(), 101U);  // three ticks a step
  // The last one may begin after a wait that the session's end cut short.
  for (std::size_t i = 1; i + 1 < recorded.steps.size(); ++i)
    EXPECT_GT(recorded.steps[i].timing.late, 0) << i;
  expect_replays(params, recorded);
}

TEST_P(EveryWay, AndWhereItStalls) {
  const sim::Params params = make_params(GetParam());
  SessionOptions options;
  options.num_ticks = 2000;
  CountedHand hand = make_hand(1.4);
  options.before_step = [&hand, has_stalled = false](Tick) mutable {
    if (has_stalled || hand.polls() < 120) return;
    has_stalled = true;
    hand.wait_for_ticks(400, 2000);
  };
  const Recorded recorded = record(params, options, hand);
  ASSERT_EQ(recorded.ticks.size(), 2000U);
  Tick met = 0, longest = 0, since = 0;  // ticks that met the same surface in a row
  int let_go = 0, forceless = 0;
  bool is_taken_again = false;
  for (const HandTick& tick : recorded.ticks) {
    since = tick.session.seen_step == met ? since + 1 : 0;
    met = tick.session.seen_step;
    longest = std::max(longest, since);
    is_taken_again |= let_go > 0 && (tick.record.gate_events & device::kGateWatchdog) == 0;
    if ((tick.record.gate_events & device::kGateWatchdog) == 0) continue;
    ++let_go;
    if (tick.record.force.norm() > 0.01 && tick.record.device_force.norm() == 0.0) ++forceless;
  }
  EXPECT_GE(longest, 399);  // the hand went on meanwhile
  EXPECT_GT(let_go, 0);
  EXPECT_GT(forceless, 0);
  EXPECT_TRUE(is_taken_again);
  expect_replays(params, recorded);
}

INSTANTIATE_TEST_SUITE_P(Session, EveryWay,
                         testing::Values(sim::BetweenFrames::hold, sim::BetweenFrames::re_evaluate));

TEST(Session, StepsAreNumberedAndSeenInOrderAndOnlyOneIsUnderWay) {
  const Recorded recorded = record(make_params(sim::BetweenFrames::re_evaluate), {.num_ticks = 200});
  Tick begun = 0, seen = 0;
  for (const HandTick& tick : recorded.ticks) {
    EXPECT_TRUE(tick.session.seen_step == seen || tick.session.seen_step == seen + 1);
    EXPECT_LE(tick.session.seen_step, begun);
    seen = tick.session.seen_step;
    if (tick.session.begun_step == 0) continue;
    EXPECT_EQ(tick.session.begun_step, ++begun);
    EXPECT_EQ(seen, begun - 1);
  }
  EXPECT_EQ(static_cast<std::size_t>(begun), recorded.steps.size());
}

TEST(Session, EndsAtTheNextTickWhenAskedTo) {
  device::DeviceOptions device_options;
  device_options.intent = make_intent(0.3);
  const auto device = device::make_device("simulated", device_options);
  device->start();
  sim::Simulation simulation = make_simulation(make_params(sim::BetweenFrames::hold), device->poll().sample);
  Session session(simulation, *device, {.is_realtime = false});
  session.start();
  session.request_stop();
  session.join();
  EXPECT_EQ(session.end(), SessionEnd::asked);
}

TEST(Session, AnUnfinishedOneEndsWithItsObject) {
  device::DeviceOptions device_options;
  device_options.intent = make_intent(0.3);
  const auto device = device::make_device("simulated", device_options);
  device->start();
  sim::Simulation simulation = make_simulation(make_params(sim::BetweenFrames::hold), device->poll().sample);
  {
    Session session(simulation, *device, {.is_realtime = false});
    session.start();
    std::this_thread::sleep_for(milliseconds(20));  // no one drains it
  }
  SUCCEED();
}

/// Goes down and vanishes after so many samples.
class Vanishing final : public test::Scripted {
 public:
  explicit Vanishing(int samples) : m_samples(samples) {}

 private:
  device::DeviceSample sample(std::int64_t number) noexcept override {
    if (number > m_samples) m_state = DeviceState::lost;
    return test::over(0.001 - 3e-5 * static_cast<double>(number));
  }
  int m_samples;
};

TEST(Session, ADeviceThatVanishesEndsItWithZeroForceAndAWholeRecord) {
  const sim::Params params = make_params(sim::BetweenFrames::re_evaluate);
  Vanishing device(100);
  const Recorded recorded = record(params, {}, device);
  EXPECT_EQ(recorded.end, SessionEnd::lost);
  EXPECT_EQ(recorded.ticks.size(), 99U);  // one sample was before the start
  EXPECT_GT(recorded.ticks.back().record.device_force.norm(), 0.01);
  EXPECT_EQ(device.last().force.norm(), 0.0);
  expect_replays(params, recorded);
}

TEST(Session, OneWhoseRecordIsFullEndsBeforeTheHandFeelsATickMore) {
  const sim::Params params = make_params(sim::BetweenFrames::re_evaluate);
  CountedHand hand = make_hand(0.3);
  const Recorded recorded = record(params, {.num_ticks = 300, .record_buffer_s = 0.1}, hand, true);
  EXPECT_EQ(recorded.end, SessionEnd::overflow);
  EXPECT_EQ(recorded.ticks.size(), 101U);  // of a tenth of a second, and one
  EXPECT_GT(find_largest_force(recorded), 0.01);
  expect_replays(params, recorded);
}

TEST(Session, AFailedStepEndsItAndIsTold) {
  // More kinetic energy than was given: with a limit of nothing the first moving step fails.
  sim::Params params = make_params(sim::BetweenFrames::re_evaluate);
  params.energy_limit = 1e-30;
  device::DeviceOptions device_options;
  device_options.intent = make_intent(0.3);
  const auto device = device::make_device("simulated", device_options);
  device->start();
  sim::Simulation simulation = make_simulation(params, device->poll().sample);
  Session session(simulation, *device, {.num_ticks = 300, .is_realtime = false});
  session.start();
  session.join();
  EXPECT_EQ(session.end(), SessionEnd::failed);
  ASSERT_TRUE(session.failure());
  EXPECT_EQ(session.failure()->stage, "solid");
}

}  // namespace
}  // namespace argil::live
