// What a device keeps when its library goes wrong (tests/support/hostile_plugin.cpp) is zero force, soon, and
// nothing waits for it for ever. Deadlines are generous; what is asserted is what the device renders.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "device/devices.h"
#include "device/release_guard.h"
#include "support/hostile_plugin.h"
#include "support/temp_folder.h"

namespace argil::device {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// A device that goes wrong after its first samples, and a hand that pushes with 1 N and 0.01 N m.
class Hostile : public testing::Test {
 protected:
  void attach(const std::string& mode) {
    const std::string file = m_folder.write("rendered", std::string(sizeof(test::RenderedForce), '\0'));
    const int descriptor = open(file.c_str(), O_RDWR);
    m_rendered = static_cast<test::RenderedForce*>(
        mmap(nullptr, sizeof(test::RenderedForce), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0));
    close(descriptor);
    ASSERT_NE(static_cast<void*>(m_rendered), MAP_FAILED);
    m_device = make_device("plugin:" ARGIL_HOSTILE_PLUGIN "," + mode + ":" + file, {});
    m_device->start();
  }
  const test::RenderedForce& rendered() const { return *m_rendered; }
  bool is_forced() const { return rendered().force[2] != 0.0 || rendered().torque[0] != 0.0; }

  /// A minute at most; false then.
  template <class Condition>
  bool push_until(Condition condition) {
    for (const auto begin = Clock::now(); seconds_since(begin) < 60.0;) {
      m_last = m_device->poll();
      m_device->send({Vec3(0.0, 0.0, 1.0), Vec3(0.01, 0.0, 0.0)});
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }
  bool push_until_wrong() {
    return push_until([&] { return rendered().is_wrong != 0 && rendered().largest_force > 0.0; });
  }
  bool is_let_go_soon() {
    return push_until([&] { return !is_forced(); });
  }
  /// Goes on until the device is lost; the words why.
  std::string push_until_lost() {
    return push_until([&] { return m_last.state == DeviceState::lost; }) ? m_device->problem() : "never lost";
  }

  test::TempFolder m_folder;
  test::RenderedForce* m_rendered = nullptr;
  std::unique_ptr<HapticDevice> m_device;
  DevicePoll m_last;
};

TEST_F(Hostile, IsLetGoThenLostWhenItsReadBlocksAndIsLeftAtTheEnd) {
  attach("blocks");
  ASSERT_TRUE(push_until_wrong());
  EXPECT_TRUE(is_let_go_soon());
  EXPECT_GT(rendered().releases, 0);
  EXPECT_NE(push_until_lost().find("hostile: does not come back"), std::string::npos) << m_device->problem();
  EXPECT_FALSE(is_forced());
  const auto begin = Clock::now();
  m_device->stop();
  m_device.reset();
  EXPECT_LT(seconds_since(begin), 30.0);  // 1 s for each of both, on a machine that has time
}

TEST_F(Hostile, IsLetGoByStopAlthoughItsReadBlocks) {
  attach("blocks");
  ASSERT_TRUE(push_until_wrong());
  m_device->stop();
  EXPECT_FALSE(is_forced());
  EXPECT_EQ(m_device->state(), DeviceState::stopped);
  m_device->start();
  EXPECT_EQ(m_device->state(), DeviceState::lost);
  EXPECT_NE(m_device->problem().find("start the program again"), std::string::npos) << m_device->problem();
}

TEST_F(Hostile, IsLetGoWhenItsWriteBlocks) {
  attach("write_blocks");
  ASSERT_TRUE(push_until_wrong());
  EXPECT_TRUE(is_let_go_soon());
  EXPECT_NE(push_until_lost().find("does not come back"), std::string::npos);
}

TEST_F(Hostile, CanBeLeftWhileItOpens) {
  attach("open_blocks");
  m_device->stop();
  EXPECT_EQ(m_device->state(), DeviceState::stopped);
}

TEST_F(Hostile, IsLostWhenItThrowsOrAnswersWhatIsNone) {
  for (const auto& [mode, words] : std::initializer_list<std::pair<const char*, const char*>>{
           {"throws", "threw"}, {"write_throws", "threw"}, {"unknown", "7 is no argil_plugin_result"}}) {
    attach(mode);
    EXPECT_NE(push_until_lost().find(words), std::string::npos) << mode << ": " << m_device->problem();
    EXPECT_GT(rendered().largest_force, 0.0) << mode;
    EXPECT_FALSE(is_forced()) << mode;
  }
}

TEST_F(Hostile, IsRefusedWhenItDeclaresNoNumber) {
  attach("nan_limit");
  EXPECT_NE(push_until_lost().find("a limit is negative or not finite"), std::string::npos);
}

// The command that is on its way while the device is released must not be the last.
TEST_F(Hostile, IsReleasedAgainAfterACommandThatWasOnItsWay) {
  attach("slow_write");
  ASSERT_TRUE(push_until_wrong());
  ASSERT_TRUE(push_until([&] { return rendered().is_writing != 0; }));
  m_device->release();
  while (rendered().is_writing != 0) std::this_thread::yield();
  EXPECT_FALSE(is_forced());
}

TEST_F(Hostile, IsReleasedWhenItsThreadsStackOverflows) {
  const std::string name = m_folder / "rendered";
  const pid_t child = fork();
  if (child == 0) {
    const rlimit no_core{0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    std::signal(SIGSEGV, SIG_DFL);  // sanitizers have handlers of their own
    attach("overflows");
    const ReleaseGuard guard(*m_device);
    push_until([] { return false; });
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WTERMSIG(status), SIGSEGV);
  std::ifstream file(name, std::ios::binary);
  test::RenderedForce last{};
  file.read(reinterpret_cast<char*>(&last), sizeof last);
  EXPECT_GT(last.largest_force, 0.0);
  EXPECT_GT(last.releases, 0);
  EXPECT_EQ(last.force[2], 0.0);
}

}  // namespace
}  // namespace argil::device
