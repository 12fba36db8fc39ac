// The Haply Inverse Service as a device, against a program that speaks its protocol on loopback
// (tests/support/haply_stand_in.py) well, or in one of many bad ways. Deadlines are generous: what is
// asserted are states and counts.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <numbers>
#include <thread>

#include "base/error.h"
#include "device/devices.h"
#include "support/child_process.h"
#include "support/temp_folder.h"

namespace argil::device {
namespace {

constexpr double kDeadline = 60.0;  // [s]
const Vec3 kForce(1.5, -0.5, 0.25);

/// The stand-in, and a hand's thread that polls and sends every millisecond until something is so.
class Session {
 public:
  explicit Session(const std::string& mode, DeviceOptions options = {}, int good = 50)
      : m_server({ARGIL_SOURCE_DIR "/tests/support/haply_stand_in.py", "--mode", mode, "--good",
                  std::to_string(good)}) {
    const std::string port = m_server.read_line();
    m_device = make_device("haply:127.0.0.1:" + port.substr(port.find(' ') + 1), options);
    m_device->start();
  }
  HapticDevice& device() { return *m_device; }
  const DevicePoll& last() const { return m_poll; }

  template <class Condition>
  bool tick_until(Condition condition, const Vec3& force = kForce) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kDeadline);
    while (std::chrono::steady_clock::now() < end) {
      m_poll = m_device->poll();
      m_device->send({force, Vec3::Zero()});
      if (condition(m_poll)) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }
  bool comes_to(DeviceState state) {
    return tick_until([&](const DevicePoll& poll) { return poll.state == state; });
  }
  bool gets_samples(std::int64_t count) {
    return tick_until([&](const DevicePoll& poll) { return poll.number >= count; });
  }
  /// What the server saw of the next of the connections that have ended.
  nlohmann::json report() { return nlohmann::json::parse(m_server.read_line(), nullptr, false); }
  nlohmann::json stop() {
    m_device->stop();
    return report();
  }

 private:
  test::ChildProcess m_server;
  std::unique_ptr<HapticDevice> m_device;
  DevicePoll m_poll;
};

Vec3 vector(const nlohmann::json& list) {
  return {list.at(0).get<double>(), list.at(1).get<double>(), list.at(2).get<double>()};
}

TEST(Haply, FollowsTheHandAndLetsItFeelTheForce) {
  Session session("normal");
  EXPECT_FALSE(session.device().poll().is_valid());
  ASSERT_TRUE(session.gets_samples(300));
  EXPECT_EQ(session.device().info().name, "inverse3 04BA");
  EXPECT_TRUE(session.device().info().has_force);
  // The hand circles by 1 cm about (0, -0.12, 0.15) and yields by F/k, k = 300 N/m.
  const Vec3 off = session.last().sample.position - Vec3(0.0, -0.12, 0.15) - kForce / 300.0;
  EXPECT_NEAR(off.z(), 0.0, 2e-4);
  EXPECT_NEAR(off.head<2>().norm(), 0.01, 2e-3);
  const nlohmann::json report = session.stop();
  EXPECT_EQ(session.device().state(), DeviceState::stopped);
  EXPECT_EQ(session.device().counts().repeated, 0);
  EXPECT_EQ(session.device().counts().refused, 0);
  EXPECT_EQ(report.at("forced_too_early"), 0);
  EXPECT_EQ(report.at("unreadable"), 0);
  EXPECT_NEAR(report.at("largest_force").get<double>(), kForce.norm(), 1e-15);
  // The last word is zero force, then a close; every message but that one was answered in time.
  EXPECT_EQ(vector(report.at("last_force")), Vec3::Zero());
  EXPECT_TRUE(report.at("closed_well").get<bool>());
  EXPECT_NEAR(report.at("messages").get<double>(), static_cast<double>(session.device().counts().samples),
              2.0);
}

TEST(Haply, TurnsForcesIntoItsOwnAxesAndPositionsIntoTheWorlds) {
  DeviceOptions options;  // device x is world y; device z stays
  options.device_to_world = {2.0, Quat(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitZ())),
                             Vec3(0.0, 0.0, 1.0)};
  Session session("normal", options);
  ASSERT_TRUE(
      session.tick_until([](const DevicePoll& poll) { return poll.number >= 300; }, Vec3(0.0, 3.0, 0.0)));
  // World z: 1 + 2 · 0.15. The force along world y pushes along device x by 3/300 m: 2 cm along world y.
  const Vec3 off = session.last().sample.position - Vec3(0.24, 0.02, 1.3);
  EXPECT_NEAR(off.z(), 0.0, 1e-3);
  EXPECT_NEAR(off.head<2>().norm(), 0.02, 4e-3);
  session.stop();
}

TEST(Haply, StartsAgainAndSendsNoForceBeforeItsNewFirstSample) {
  Session session("normal");
  constexpr int kStarts = 5;
  for (int start = 0; start < kStarts; ++start) {
    ASSERT_TRUE(session.gets_samples(5));
    session.device().start();  // the hand's thread goes on at once, while the last sample is young
  }
  ASSERT_TRUE(session.gets_samples(5));
  for (int start = 0; start < kStarts; ++start) EXPECT_EQ(session.report().at("forced_too_early"), 0);
  EXPECT_EQ(session.stop().at("forced_too_early"), 0);
}

TEST(Haply, SendsNoForceOnceItIsReleased) {
  Session session("normal");
  ASSERT_TRUE(session.gets_samples(50));
  session.device().release();
  const std::int64_t then = session.last().number;
  ASSERT_TRUE(session.gets_samples(then + 20));
  // Without force the hand is on its circle again, z = 0.15.
  EXPECT_TRUE(
      session.tick_until([](const DevicePoll& p) { return std::abs(p.sample.position.z() - 0.15) < 1e-5; }));
  EXPECT_EQ(vector(session.stop().at("last_force")), Vec3::Zero());
}

TEST(Haply, LetsGoWhenTheHandsThreadSaysNoMore) {
  Session session("normal");
  ASSERT_TRUE(session.gets_samples(100));
  // Only polls: the hand goes back to its circle.
  for (int i = 0; i < 60000 && std::abs(session.device().poll().sample.position.z() - 0.15) > 1e-5; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_NEAR(session.device().poll().sample.position.z(), 0.15, 1e-5);
  session.stop();
}

/// A service that goes wrong in mid-session: which state, why, and zero force as the last word that it took.
struct Fault {
  std::string mode;
  std::string words;  ///< of the problem
};
void PrintTo(const Fault& fault, std::ostream* out) {
  *out << fault.mode;
}  // NOLINT: GoogleTest's name

/// The most that this process has ever held [bytes].
std::int64_t peak_memory() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return std::int64_t{1024} * usage.ru_maxrss;
}

class HaplyFault : public testing::TestWithParam<Fault> {};

TEST_P(HaplyFault, IsStaleThenLostAndSaysWhy) {
  Session session(GetParam().mode);
  ASSERT_TRUE(session.comes_to(DeviceState::ready));
  const std::int64_t memory = peak_memory();
  ASSERT_TRUE(session.comes_to(DeviceState::lost));
  EXPECT_NE(session.device().problem().find(GetParam().words), std::string::npos)
      << session.device().problem();
  // Half of the oversized message; a sanitizer's shadow of what a client may hold is less.
  EXPECT_LT(peak_memory() - memory, std::int64_t{12} << 20);
  EXPECT_TRUE(session.last().sample.position.allFinite());
  EXPECT_NEAR(session.last().sample.orientation.norm(), 1.0, 1e-12);
  const nlohmann::json report = session.stop();
  EXPECT_EQ(report.at("forced_too_early"), 0);
  EXPECT_EQ(report.at("unreadable"), 0);
  // Zero force is the last word, unless the channel was gone, or was closed for what is no WebSocket: a
  // service renders nothing then.
  if (GetParam().mode == "not_websocket") {
    EXPECT_TRUE(report.at("closed_well").get<bool>());
  } else if (GetParam().mode != "vanish") {
    EXPECT_EQ(vector(report.at("last_force")), Vec3::Zero());
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, HaplyFault,
    testing::Values(Fault{"garbage", "no JSON object"}, Fault{"not_websocket", "connection lost"},
                    Fault{"half", "no usable sample"}, Fault{"silent", "no usable sample"},
                    Fault{"zero_quaternion", "quaternion"}, Fault{"nan", "no JSON object"},
                    Fault{"null", "cursor_position"}, Fault{"huge", "position"},
                    Fault{"unplugged", "not connected any more"}, Fault{"vanish", "connection lost"},
                    Fault{"oversized", "message of more than 1 MiB"},
                    Fault{"endless", "message of more than 1 MiB"}),
    [](const auto& fault) { return fault.param.mode; });

TEST(Haply, BecomesReadyAgainAfterALateAnswer) {
  Session session("late");
  ASSERT_TRUE(session.comes_to(DeviceState::ready));
  ASSERT_TRUE(session.comes_to(DeviceState::stale));
  ASSERT_TRUE(session.comes_to(DeviceState::ready));
  ASSERT_TRUE(session.comes_to(DeviceState::stale));
  session.stop();
}

TEST(Haply, UsesOneStateACommandAndCountsTheRest) {
  Session session("surplus");
  ASSERT_TRUE(session.gets_samples(300));
  const nlohmann::json report = session.stop();
  EXPECT_GE(session.device().counts().repeated, 100);
  EXPECT_LE(session.device().counts().samples, report.at("messages").get<std::int64_t>());
}

TEST(Haply, GivesWhatASlowServiceHas) {
  Session session("slow");
  ASSERT_TRUE(session.gets_samples(60));
  EXPECT_EQ(session.device().counts().repeated, 0);
  EXPECT_EQ(vector(session.stop().at("last_force")), Vec3::Zero());
}

// The service holds the last command while it owes its answer.
TEST(Haply, IsToldOfZeroForceAlthoughItOwesAnAnswer) {
  Session session("silent");
  ASSERT_TRUE(session.comes_to(DeviceState::lost));  // after 2 s of silence
  const nlohmann::json report = session.stop();
  EXPECT_GT(report.at("largest_force").get<double>(), 0.0);
  EXPECT_LT(report.at("longest_hold").get<double>(), 1.0);  // 0.1 s on a machine that has time
}

// A command that is due is written when the answer before it comes, not a period later: at a period of 40 ms
// and answers after 50 ms a sample takes 50 ms and not 80.
TEST(Haply, LosesNoPeriodByALateAnswer) {
  DeviceOptions options;
  options.period = 0.04;
  Session session("slow", options, 1);
  const auto gets = [&](std::int64_t count) {
    return session.tick_until([&](const DevicePoll& poll) { return poll.number >= count; }, Vec3::Zero());
  };
  ASSERT_TRUE(gets(3));
  const double begin = session.last().time;
  ASSERT_TRUE(gets(23));
  EXPECT_LT(session.last().time - begin, 20 * 0.07);
  session.stop();
}

TEST(Haply, IsLostWithoutADeviceOrAService) {
  Session session("no_device");
  ASSERT_TRUE(session.comes_to(DeviceState::lost));
  EXPECT_NE(session.device().problem().find("no Inverse3 is connected"), std::string::npos);
  EXPECT_FALSE(session.last().is_valid());
  const nlohmann::json report = session.stop();
  EXPECT_EQ(report.at("messages"), 0);

  const auto device = make_device("haply:127.0.0.1:1", {});
  device->start();
  EXPECT_EQ(wait_until_ready(*device, kDeadline), DeviceState::lost);
  EXPECT_NE(device->problem().find("127.0.0.1:1: cannot connect"), std::string::npos) << device->problem();
}

TEST(Haply, RefusesAPlaceThatIsNone) {
  for (const char* name : {"haply::1", "haply:host:x", "haply:host:70000", "haply:a:b:1", "haply:host:"})
    ARGIL_EXPECT_THROW_WITH(make_device(name, {}), InputError, "haply:HOST:PORT");
}

}  // namespace
}  // namespace argil::device
