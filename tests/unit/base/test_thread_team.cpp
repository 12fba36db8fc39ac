// Work shared among threads: every item once, all of one loop before the next, also by threads that slept or
// are many more than the processors.
#include "base/thread_team.h"

#include <gtest/gtest.h>

#include <chrono>
#include <numeric>
#include <thread>
#include <vector>

#include "base/parallel.h"

namespace argil {
namespace {

class Threads : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Few, Threads, testing::Values(1, 2, 3, 7));

TEST_P(Threads, TakeEveryItemOnce) {
  for (const std::ptrdiff_t count : {0, 1, 2, 6, 7, 8, 1000}) {
    std::vector<int> taken(static_cast<std::size_t>(count), 0);
    parallel_for(count, GetParam(), [&](std::ptrdiff_t i) { ++taken[static_cast<std::size_t>(i)]; });
    EXPECT_EQ(taken, std::vector<int>(static_cast<std::size_t>(count), 1));
  }
}

// Pascal's triangle, a loop a row: each entry is the sum of two of the row before, which another thread may
// have made. Row n adds up to 2ⁿ.
TEST_P(Threads, SeeInALoopWhatAllWroteInTheOneBefore) {
  constexpr std::ptrdiff_t kRows = 50;
  for (int repeat = 0; repeat < 100; ++repeat) {
    std::vector<std::int64_t> row(kRows + 1, 0);
    std::vector<std::int64_t> next(kRows + 1, 0);
    row[0] = 1;
    for (std::ptrdiff_t n = 0; n < kRows; ++n) {
      parallel_for(kRows + 1, GetParam(), [&](std::ptrdiff_t k) {
        const auto at = static_cast<std::size_t>(k);
        next[at] = row[at] + (k > 0 ? row[at - 1] : 0);
      });
      row.swap(next);
    }
    ASSERT_EQ(std::accumulate(row.begin(), row.end(), std::int64_t{0}), std::int64_t{1} << kRows);
  }
}

TEST(ThreadTeam, WakesHelpersThatSleepAndItsMakerThatWaits) {
  for (int repeat = 0; repeat < 20; ++repeat) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));  // they look for a tenth of one
    const std::thread::id maker = std::this_thread::get_id();
    std::vector<int> taken(64, 0);
    parallel_for(64, 2, [&](std::ptrdiff_t i) {
      // The maker takes all else and waits, asleep, for what the other has taken.
      if (std::this_thread::get_id() != maker) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      ++taken[static_cast<std::size_t>(i)];
    });
    ASSERT_EQ(taken, std::vector<int>(64, 1));
  }
}

TEST(ThreadTeam, DoesAllItselfWhereAHelperIsHeldUp) {
  const std::thread::id maker = std::this_thread::get_id();
  int by_maker = 0;
  parallel_for(80, 2, [&](std::ptrdiff_t) {
    if (std::this_thread::get_id() == maker)
      ++by_maker;
    else
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
  });
  EXPECT_GE(by_maker, 70);  // all but the one chunk of eight that the helper may hold
}

TEST(ThreadTeam, IsKeptByTheThreadThatAsksForItAndIsAnothersNot) {
  ThreadTeam* const mine = &ThreadTeam::of_this_thread(2);
  EXPECT_EQ(&ThreadTeam::of_this_thread(2), mine);
  ThreadTeam* other = nullptr;
  std::thread([&] { other = &ThreadTeam::of_this_thread(2); }).join();
  EXPECT_NE(other, mine);
  EXPECT_EQ(ThreadTeam::of_this_thread(4).size(), 4);
}

}  // namespace
}  // namespace argil
