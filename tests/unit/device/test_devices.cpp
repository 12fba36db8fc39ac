// Devices by name, and the simulated one as the hand's thread sees it. Balance against a spring by hand.
#include "device/devices.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/error.h"
#include "unit/device/intents.h"

namespace argil::device {
namespace {

std::string refusal(const std::string& name, const DeviceOptions& options) {
  try {
    make_device(name, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

DeviceOptions resting() {
  DeviceOptions options;
  options.intent = resting_intent(Vec3(0.01, 0.0, 0.0));
  return options;
}

TEST(Devices, RefusesAKindThatItDoesNotKnowAndNamesThoseThatItDoes) {
  const std::string text = refusal("phantom", {});
  EXPECT_NE(text.find("unknown device \"phantom\""), std::string::npos) << text;
  for (const DeviceKind& kind : device_kinds()) EXPECT_NE(text.find(kind.name), std::string::npos) << text;
}

TEST(Devices, RefusesASimulatedHandThatHasNothingToDo) {
  EXPECT_NE(refusal("simulated", {}).find("give it a trace to follow"), std::string::npos);
}

TEST(Devices, RefusesWhatIsNoHand) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const auto refuses = [](auto HandParams::*member, double value, const char* name) {
    DeviceOptions options = resting();
    options.hand.*member = value;
    EXPECT_NE(refusal("simulated", options).find(name), std::string::npos) << name << ' ' << value;
  };
  for (const double bad : {kNaN, -1.0, 1e9}) {
    refuses(&HandParams::mass, bad, "mass");
    refuses(&HandParams::stiffness, bad, "stiffness");
    refuses(&HandParams::damping, bad, "damping");
    refuses(&HandParams::reaction_delay, bad, "reaction delay");
    refuses(&HandParams::tremor, bad, "tremor");
    refuses(&HandParams::tremor_frequency, bad, "tremor frequency");
  }
  DeviceOptions options = resting();
  options.period = kNaN;
  EXPECT_NE(refusal("simulated", options).find("period"), std::string::npos);
}

TEST(SimulatedDevice, GivesASampleATickFromTheBeginningOfTheIntent) {
  const auto device = make_device("simulated", resting());
  EXPECT_EQ(device->state(), DeviceState::stopped);
  EXPECT_FALSE(device->poll().is_valid());
  device->start();
  EXPECT_EQ(wait_until_ready(*device, 1.0), DeviceState::ready);
  for (int tick = 0; tick < 5; ++tick) {
    const DevicePoll poll = device->poll();
    EXPECT_EQ(poll.number, tick + 1);
    EXPECT_EQ(poll.time, tick * 0.001);
    EXPECT_EQ(poll.age, 0.0);
    EXPECT_EQ(poll.state, DeviceState::ready);
    EXPECT_EQ(poll.sample.position, Vec3(0.01, 0.0, 0.0));
  }
  EXPECT_EQ(device->counts().samples, 5);
  device->stop();
  EXPECT_EQ(device->poll().state, DeviceState::stopped);
}

TEST(SimulatedDevice, ComesToBalanceWithASpringThatItFeels) {
  // The hand's spring k means to be at d, the wall's spring K at 0: x = k d / (k + K).
  const auto device = make_device("simulated", resting());
  device->start();
  DevicePoll poll;
  for (int tick = 0; tick < 5000; ++tick) {
    poll = device->poll();
    device->send({-500.0 * poll.sample.position, Vec3::Zero()});
  }
  EXPECT_NEAR(poll.sample.position.x(), 300.0 * 0.01 / 800.0, 1e-15);
}

TEST(SimulatedDevice, FeelsNothingOfAForceThatIsNotFinite) {
  const auto device = make_device("simulated", resting());
  device->start();
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    device->send({Vec3(0.0, bad, 1.0), Vec3::Zero()});
    for (int tick = 0; tick < 10; ++tick) EXPECT_EQ(device->poll().sample.position, Vec3(0.01, 0.0, 0.0));
  }
}

TEST(SimulatedDevice, FeelsNothingOnceItIsReleasedUntilItStartsAgain) {
  const auto device = make_device("simulated", resting());
  device->start();
  device->release();
  device->send({Vec3(1.0, 0.0, 0.0), Vec3::Zero()});
  for (int tick = 0; tick < 10; ++tick) EXPECT_EQ(device->poll().sample.position, Vec3(0.01, 0.0, 0.0));
  device->stop();
  device->start();
  EXPECT_EQ(device->poll().number, 1);
  device->send({Vec3(1.0, 0.0, 0.0), Vec3::Zero()});
  EXPECT_GT(device->poll().sample.position.x(), 0.01);
}

}  // namespace
}  // namespace argil::device
