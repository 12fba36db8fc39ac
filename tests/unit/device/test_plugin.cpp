// Devices of shared libraries: the example of tests/support, well behaved and not, and files that are no
// plug-in.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "base/error.h"
#include "device/devices.h"
#include "support/temp_folder.h"

namespace argil::device {
namespace {

const std::string kPlugin = std::string("plugin:") + ARGIL_EXAMPLE_PLUGIN;

/// Polls and sends every millisecond until the condition holds, a minute at most.
template <class Condition>
bool tick_until(HapticDevice& device, const Vec3& force, Condition condition) {
  for (int tick = 0; tick < 60000; ++tick) {
    if (condition(device.poll())) return true;
    device.send({force, Vec3::Zero()});
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

bool comes_to(HapticDevice& device, DeviceState state) {
  return tick_until(device, Vec3(1, 0, 0), [&](const DevicePoll& poll) { return poll.state == state; });
}

TEST(Plugin, GivesItsSamplesAndFeelsTheForce) {
  const auto device = make_device(kPlugin, {});
  device->start();
  // A spring of 200 N/m at (0.01, 0.02, 0.03).
  const Vec3 expected(0.01 + 2.0 / 200.0, 0.02, 0.03 - 1.0 / 200.0);
  EXPECT_TRUE(tick_until(*device, Vec3(2.0, 0.0, -1.0), [&](const DevicePoll& poll) {
    return poll.is_valid() && (poll.sample.position - expected).norm() < 1e-15;
  }));
  // Its button 0 went down once: the next mode.
  EXPECT_TRUE(tick_until(*device, Vec3::Zero(),
                         [](const DevicePoll& poll) { return poll.sample.mode == ToolMode::pull; }));
  const DeviceInfo info = device->info();
  EXPECT_EQ(info.kind, "plugin");
  EXPECT_EQ(info.name, "spring of 200 N/m");
  EXPECT_EQ(info.max_force, 5.0);
  EXPECT_EQ(info.workspace, Vec3::Constant(0.1));
  EXPECT_TRUE(info.has_force);
}

TEST(Plugin, IsLostWithItsDevice) {
  const auto gone = make_device(kPlugin + ",vanishing", {});
  gone->start();
  EXPECT_TRUE(comes_to(*gone, DeviceState::lost));
  EXPECT_NE(gone->problem().find("the cable was pulled"), std::string::npos) << gone->problem();
  const auto never = make_device(kPlugin + ",none", {});
  never->start();
  EXPECT_TRUE(comes_to(*never, DeviceState::lost));
  EXPECT_NE(never->problem().find("no device is plugged in"), std::string::npos) << never->problem();
}

TEST(Plugin, IsStaleWhileItTalksNonsense) {
  const auto device = make_device(kPlugin + ",nan", {});
  device->start();
  EXPECT_TRUE(comes_to(*device, DeviceState::stale));
  EXPECT_TRUE(device->poll().sample.position.allFinite());
  EXPECT_GT(device->counts().refused, 0);
}

TEST(Plugin, IsNeverReadyWhileItsSamplesAreBeyondAKilometre) {
  // It rests 0.037 m from its origin: 37 km away at this scale.
  DeviceOptions options;
  options.device_to_world.scale = 1e6;
  const auto device = make_device(kPlugin, options);
  device->start();
  EXPECT_TRUE(
      tick_until(*device, Vec3::Zero(), [&](const DevicePoll&) { return device->counts().refused > 10; }));
  EXPECT_EQ(device->poll().state, DeviceState::connecting);
  EXPECT_EQ(device->poll().number, 0);
}

TEST(Plugin, RefusesFilesThatAreNone) {
  const test::TempFolder folder;
  const std::string text = folder.write("text.so", "no library");
  ARGIL_EXPECT_THROW_WITH(make_device("plugin:" + text, {}), InputError, "name a shared library");
  ARGIL_EXPECT_THROW_WITH(make_device("plugin:" + folder / "none.so", {}), InputError, "No such file");
  ARGIL_EXPECT_THROW_WITH(make_device("plugin:" ARGIL_WRONG_PLUGIN, {}), InputError, "against version 1");
  ARGIL_EXPECT_THROW_WITH(make_device("plugin:" ARGIL_INCOMPLETE_PLUGIN, {}), InputError,
                          "a function is missing");
  ARGIL_EXPECT_THROW_WITH(make_device("plugin:" ARGIL_NO_PLUGIN, {}), InputError, "no argil_plugin_entry");
}

TEST(DescribeDevices, SaysStateLimitsAndWhyADeviceIsNotThere) {
  const std::string text = describe_devices({"simulated", kPlugin, kPlugin + ",none"}, 10.0);
  EXPECT_NE(text.find("simulated: ready, hand model, largest force not stated"), std::string::npos) << text;
  EXPECT_NE(text.find(": ready, spring of 200 N/m, largest force 5 N, torque not stated, stiffness 2000 N/m, "
                      "rate 1000 Hz, workspace 0.1 x 0.1 x 0.1 m\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find(",none: lost, "), std::string::npos) << text;
}

TEST(DescribeDevices, RefusesWhatIsNone) {
  ARGIL_EXPECT_THROW_WITH(describe_devices({"simulated", "phantom"}, 10.0), InputError,
                          "unknown device \"phantom\"");
  ARGIL_EXPECT_THROW_WITH(describe_devices({"plugin:/none.so"}, 10.0), InputError, "No such file");
}

}  // namespace
}  // namespace argil::device
