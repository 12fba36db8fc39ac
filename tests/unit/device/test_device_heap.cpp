// What the hand's thread does with a device allocates nothing, whatever the device's own threads do.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "device/devices.h"
#include "support/child_process.h"
#include "support/heap_count.h"
#include "unit/device/intents.h"

namespace argil::device {
namespace {

#ifdef ARGIL_COUNTS_HEAP

/// Allocations of this thread in 300 polls and sends, after as many to warm up.
std::size_t count_in_ticks(HapticDevice& device) {
  std::size_t before = 0;
  for (int tick = 0; tick < 600; ++tick) {
    if (tick == 300) before = test::count_allocations_of_thread();
    device.poll();
    device.send({Vec3(1.0, -0.5, 0.001 * tick), Vec3::Zero()});
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  return test::count_allocations_of_thread() - before;
}

TEST(DeviceHeap, ASimulatedHandAllocatesNothing) {
  DeviceOptions options;
  options.intent = step_intent(0.01, 0.1);
  options.hand.tremor = 1e-4;
  const auto device = make_device("simulated", options);
  device->start();
  EXPECT_EQ(count_in_ticks(*device), 0U);
}

TEST(DeviceHeap, AServiceAllocatesNothingInTheHandsThread) {
  test::ChildProcess server({ARGIL_SOURCE_DIR "/tests/support/haply_stand_in.py"});
  const std::string port = server.read_line();
  const auto device = make_device("haply:127.0.0.1:" + port.substr(port.find(' ') + 1), {});
  device->start();
  ASSERT_EQ(wait_until_ready(*device, 60.0), DeviceState::ready);
  EXPECT_EQ(count_in_ticks(*device), 0U);
  EXPECT_GT(device->counts().samples, 0);
}

TEST(DeviceHeap, APluginAllocatesNothing) {
  const auto device = make_device("plugin:" ARGIL_EXAMPLE_PLUGIN, {});
  device->start();
  ASSERT_EQ(wait_until_ready(*device, 60.0), DeviceState::ready);
  EXPECT_EQ(count_in_ticks(*device), 0U);
}

#else

TEST(DeviceHeap, IsNotCounted) {
  GTEST_SKIP() << "malloc is the sanitizer's";
}

#endif

}  // namespace
}  // namespace argil::device
