// The hand's thread takes nothing from the heap once its arrays have grown to what the scene needs.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "live/session.h"
#include "live_scene.h"
#include "support/heap_count.h"

namespace argil::live {
namespace {

#ifdef ARGIL_COUNTS_HEAP

constexpr int kPress = 150;  // ticks until it is pressed as deep as it will be
constexpr int kTicks = 600;

/// Presses and stays there; counts the allocations of the thread that asks.
class Pressing final : public test::Scripted {
 public:
  std::vector<std::size_t> allocations = std::vector<std::size_t>(kTicks + 2, 0);

 private:
  device::DeviceSample sample(std::int64_t number) noexcept override {
    if (static_cast<std::size_t>(number) < allocations.size())
      allocations[static_cast<std::size_t>(number)] = argil::test::count_allocations_of_thread();
    return test::over(0.001 - 0.003 * std::min(1.0, static_cast<double>(number) / kPress));
  }
};

class HandThread : public testing::TestWithParam<sim::BetweenFrames> {};

TEST_P(HandThread, AllocatesNothingWhileItPresses) {
  Pressing device;
  device.start();
  sim::Params params = test::make_params(GetParam());
  params.plasticity.enabled = false;  // the same contacts all the time
  sim::Simulation simulation = test::make_simulation(params, device.poll().sample);
  Session session(simulation, device, {.num_ticks = kTicks, .is_realtime = false});
  session.start();
  double pressed = 0.0;
  for (bool is_running = true; is_running;) {
    is_running = session.is_running();
    HandTick tick;
    while (session.pop(tick)) pressed += tick.record.force.norm();
    BodyStep step;
    while (session.pop(step)) {
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  session.join();
  EXPECT_GT(pressed, 0.0);
  EXPECT_EQ(device.allocations[kTicks], device.allocations[2 * kPress]);
}

INSTANTIATE_TEST_SUITE_P(Every, HandThread,
                         testing::Values(sim::BetweenFrames::hold, sim::BetweenFrames::re_evaluate));

#endif

}  // namespace
}  // namespace argil::live
