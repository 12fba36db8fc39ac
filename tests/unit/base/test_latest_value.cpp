// The newest value between two threads: what is taken was put, whole, and never older than what was taken
// before.
#include "base/latest_value.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <thread>

namespace argil {
namespace {

TEST(LatestValue, GivesWhatWasPutLastAndOnce) {
  LatestValue<int> latest;
  int value = -1;
  EXPECT_FALSE(latest.take(value));
  EXPECT_EQ(value, -1);
  latest.put(1);
  latest.put(2);
  EXPECT_TRUE(latest.take(value));
  EXPECT_EQ(value, 2);
  EXPECT_FALSE(latest.take(value));
  latest.put(3);
  EXPECT_TRUE(latest.take(value));
  EXPECT_EQ(value, 3);
}

struct Pair {
  std::int64_t count = 0;
  std::int64_t square = 0;
};

TEST(LatestValue, NeverGivesAHalfOrAnOldValueAcrossThreads) {
  constexpr std::int64_t kLast = 200000;
  LatestValue<Pair> latest;
  std::thread writer([&] {
    for (std::int64_t i = 1; i <= kLast; ++i) latest.put({i, i * i});
  });
  Pair pair;
  std::int64_t before = 0;
  std::int64_t faults = 0;
  while (pair.count < kLast) {
    if (!latest.take(pair)) {
      std::this_thread::yield();
      continue;
    }
    faults += pair.count <= before || pair.square != pair.count * pair.count ? 1 : 0;
    before = pair.count;
  }
  writer.join();
  EXPECT_EQ(faults, 0);
}

}  // namespace
}  // namespace argil
