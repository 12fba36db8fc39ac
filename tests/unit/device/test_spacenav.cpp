// 6-DoF controllers: speeds integrated to a pose against closed forms, and a real spacenavd that reads a
// controller which this test plays at the other end of a pseudo-terminal (Magellan, a serial protocol of
// lines that end with a carriage return: "vQ" is answered by the version; "d" and 24 nibbles are six axes
// plus 0x8000; "k" and 3 nibbles are the buttons [as spacenavd reads them]).
#include "device/spacenav_motion.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>  // NOLINT: kill is POSIX
#include <stdlib.h>  // NOLINT: posix_openpt is POSIX
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <numbers>
#include <thread>

#include "base/error.h"
#include "device/devices.h"
#include "device/mode_switch.h"
#include "support/child_process.h"
#include "support/temp_folder.h"

namespace argil::device {
namespace {

using internal::advance;
using internal::SpacenavPose;

TEST(SpacenavMotion, MovesAtASpeedInProportionToTheCap) {
  SpacenavPose pose;
  for (int i = 0; i < 1000; ++i) advance({350, -175, 0, 0, 0, 0}, 0.001, pose);
  EXPECT_NEAR((pose.position - Vec3(0.07, -0.035, 0.0)).norm(), 0.0, 1e-14);  // 7 cm/s for 1 s
  EXPECT_EQ(pose.orientation.coeffs(), Quat::Identity().coeffs());
}

TEST(SpacenavMotion, TurnsAboutAFixedAxis) {
  SpacenavPose pose;
  for (int i = 0; i < 1000; ++i) advance({0, 0, 0, 0, 0, 350}, 0.001, pose);  // 1 rad/s for 1 s
  const Quat expected(Eigen::AngleAxisd(1.0, Vec3::UnitZ()));
  EXPECT_NEAR((pose.orientation.coeffs() - expected.coeffs()).norm(), 0.0, 1e-13);
}

TEST(SpacenavMotion, StaysWithinItsReach) {
  SpacenavPose pose;
  for (int i = 0; i < 100; ++i) advance({32767, 0, -32768, 0, 0, 0}, 1.0, pose);
  EXPECT_EQ(pose.position, Vec3(internal::kSpacenavReach, 0.0, -internal::kSpacenavReach));
}

TEST(ModeSwitch, GoesOnAndBackWithEachPress) {
  ModeSwitch mode(ToolMode::push);
  EXPECT_EQ(mode.update(0), ToolMode::push);
  EXPECT_EQ(mode.update(1), ToolMode::pull);
  EXPECT_EQ(mode.update(1), ToolMode::pull);  // held
  EXPECT_EQ(mode.update(0), ToolMode::pull);
  EXPECT_EQ(mode.update(1), ToolMode::wet);
  EXPECT_EQ(mode.update(3), ToolMode::pull);  // back while the other is held
  EXPECT_EQ(mode.update(0), ToolMode::pull);
  EXPECT_EQ(mode.update(2), ToolMode::push);
  EXPECT_EQ(mode.update(0), ToolMode::push);
  EXPECT_EQ(mode.update(2), ToolMode::dry);
  EXPECT_EQ(mode.update(4), ToolMode::dry);  // others do nothing
}

/// A Magellan at the master's end of a pseudo-terminal.
class Controller {
 public:
  Controller() : m_master(posix_openpt(O_RDWR | O_NOCTTY)) {
    if (m_master < 0 || grantpt(m_master) != 0 || unlockpt(m_master) != 0) return;
    m_name = ptsname(m_master);
    m_slave =
        open(m_name.c_str(), O_RDWR | O_NOCTTY);  // kept, so that the master stays open between openings
    m_thread = std::thread([this] { answer(); });
  }
  ~Controller() {
    m_ends = true;
    if (m_thread.joinable()) m_thread.join();
    close(m_slave);
    close(m_master);
  }
  Controller(const Controller&) = delete;
  Controller& operator=(const Controller&) = delete;
  const std::string& name() const { return m_name; }
  bool is_known() const { return m_is_known; }

  void move(const std::array<int, 6>& axes) const {
    std::string line = "d";
    for (const int axis : axes)
      for (int shift = 12; shift >= 0; shift -= 4) line += nibble((axis + 0x8000) >> shift);
    say(line);
  }
  void press(unsigned buttons) const {
    std::string line = "k";
    for (int shift = 0; shift <= 8; shift += 4) line += nibble(static_cast<int>(buttons >> shift));
    say(line);
  }

 private:
  static char nibble(int value) { return static_cast<char>(0x40 | (value & 15)); }
  void say(const std::string& line) const {
    const std::string text = line + '\r';
    EXPECT_EQ(write(m_master, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  void answer() {
    std::string heard;
    while (!m_ends) {
      pollfd waited{m_master, POLLIN, 0};
      char piece[256];
      const ssize_t size = ::poll(&waited, 1, 20) > 0 ? read(m_master, piece, sizeof piece) : 0;
      if (size > 0) heard.append(piece, static_cast<std::size_t>(size));
      if (const std::size_t at = heard.find("vQ\r"); at != std::string::npos) {
        say("vMAGELLAN  Version 6.60  3D-Mouse");
        heard.erase(0, at + 3);
      }
      if (heard.find("m3\r") != std::string::npos) m_is_known = true;
    }
  }

  int m_master;
  int m_slave = -1;
  std::string m_name;
  std::atomic<bool> m_ends = false;
  std::atomic<bool> m_is_known = false;
  std::thread m_thread;
};

template <class Condition>
bool wait_until(Condition condition) {
  for (int i = 0; i < 3000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

bool exists(const std::string& file) {
  return access(file.c_str(), F_OK) == 0;
}

TEST(Spacenav, FollowsAControllerThatSpacenavdReads) {
  const std::string daemon = exists("/usr/sbin/spacenavd") ? "/usr/sbin/spacenavd" : "/usr/bin/spacenavd";
  if (!exists(daemon)) GTEST_SKIP() << "spacenavd is not installed";
  std::unique_ptr<HapticDevice> device;
  try {
    device = make_device("spacenav", {});
  } catch (const InputError& error) {
    GTEST_SKIP() << error.what();
  }

  Controller controller;
  // Debian's daemon makes its socket as run/spnav.sock where it is started; libspnav takes the place from the
  // environment.
  const test::TempFolder folder;
  const std::string socket = folder / "run/spnav.sock";
  mkdir((folder / "run").c_str(), 0700);
  setenv("SPNAV_SOCKET", socket.c_str(), 1);
  const std::string config = folder.write("spnavrc", "serial = " + controller.name() + "\nled = 0\n");
  test::ChildProcess server({daemon, "-d", "-c", config, "-l", folder / "log"}, folder / "");
  const bool found = wait_until([&] { return controller.is_known() && exists(socket); });
  if (!found && exists("/run/spnav.sock")) GTEST_SKIP() << "a spacenavd runs on this machine already";
  ASSERT_TRUE(found) << test::TempFolder::read(folder / "log");
  device->start();
  ASSERT_EQ(wait_until_ready(*device, 60.0), DeviceState::ready) << device->problem();
  EXPECT_FALSE(device->info().has_force);

  controller.move({300, 0, 0, 0, 0, 0});
  EXPECT_TRUE(wait_until([&] { return device->poll().sample.position.norm() > 0.02; }));
  controller.move({0, 0, 0, 0, 0, 0});
  const DeviceSample moved = device->poll().sample;
  EXPECT_NEAR(moved.position.cwiseAbs().maxCoeff(), moved.position.norm(), 1e-12);  // along one axis
  controller.press(1);
  EXPECT_TRUE(wait_until([&] { return device->poll().sample.mode == ToolMode::pull; }));
  EXPECT_EQ(device->state(), DeviceState::ready);

  kill(server.id(), SIGTERM);
  server.wait();
  EXPECT_TRUE(wait_until([&] { return device->state() == DeviceState::lost; }));
  EXPECT_NE(device->problem().find("spacenavd"), std::string::npos) << device->problem();
}

}  // namespace
}  // namespace argil::device
