// When a device's thread wakes, by hand; and what the system lets it be.
#include "device/attached.h"

#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>

#include "base/realtime.h"
#include "device/devices.h"

namespace argil::device {
namespace {

using internal::find_next_deadline;

TEST(Deadlines, KeepToTheirGridHoweverLateAThreadIs) {
  EXPECT_EQ(find_next_deadline(7.0, 1.0, 7.0), 8.0);
  EXPECT_EQ(find_next_deadline(7.0, 1.0, 7.75), 8.0);
  // A sleep that ends late and an answer that comes late cost no period: the next is due at once.
  EXPECT_EQ(find_next_deadline(7.0, 1.0, 8.5), 8.0);
}

TEST(Deadlines, MakeUpForOnePeriodAtMost) {
  EXPECT_EQ(find_next_deadline(7.0, 1.0, 19.5), 18.5);
}

#ifdef __linux__
/// Threads of this process whose real-time priority is that [proc(5), stat, fields 40 and 41].
int count_threads(int priority) {
  int count = 0;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream file(task.path() / "stat");
    std::string text;
    std::getline(file, text);
    std::istringstream fields(text.substr(text.rfind(')') + 2));  // from field 3
    std::string field;
    for (int number = 3; number < 40; ++number) fields >> field;
    int found_priority = 0, policy = 0;
    fields >> found_priority >> policy;
    if ((policy & ~SCHED_RESET_ON_FORK) == SCHED_FIFO && found_priority == priority) ++count;
  }
  return count;
}

TEST(AttachedDevice, RunsBeforeOrdinaryThreadsWhereThatIsGranted) {
  bool is_granted = false;
  std::thread([&] { is_granted = make_realtime(pthread_self(), kDevicePriority); }).join();
  if (!is_granted) GTEST_SKIP() << "SCHED_FIFO is not granted";
  const auto device = make_device("plugin:" ARGIL_EXAMPLE_PLUGIN, {});
  device->start();
  ASSERT_EQ(wait_until_ready(*device, 60.0), DeviceState::ready);
  for (const int priority : {kDevicePriority, kHandPriority}) {     // of the device, and who watches it
    for (int k = 0; k < 1000 && count_threads(priority) == 0; ++k)  // it may not have run yet
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_EQ(count_threads(priority), 1);
  }
}
#endif

}  // namespace
}  // namespace argil::device
