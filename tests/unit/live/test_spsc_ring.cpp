// A queue between two threads: order, fullness, nothing lost.
#include "base/spsc_ring.h"

#include <gtest/gtest.h>

#include <memory>
#include <thread>

namespace argil {
namespace {

TEST(SpscRing, RefusesWhatDoesNotFitAndKeepsIt) {
  SpscRing<std::unique_ptr<int>> ring(2);
  EXPECT_TRUE(ring.push(std::make_unique<int>(1)));
  EXPECT_TRUE(ring.push(std::make_unique<int>(2)));
  auto third = std::make_unique<int>(3);
  EXPECT_FALSE(ring.push(std::move(third)));
  ASSERT_TRUE(third);
  std::unique_ptr<int> out;
  ASSERT_TRUE(ring.pop(out));
  EXPECT_EQ(*out, 1);
  EXPECT_TRUE(ring.push(std::move(third)));
  ASSERT_TRUE(ring.pop(out));
  ASSERT_TRUE(ring.pop(out));
  EXPECT_EQ(*out, 3);
  EXPECT_FALSE(ring.pop(out));
}

TEST(SpscRing, GivesEveryValueOnceAndInOrder) {
  constexpr int kCount = 2000;
  SpscRing<int> ring(64);
  std::thread writer([&] {
    for (int i = 0; i < kCount; ++i)
      while (!ring.push(int{i})) std::this_thread::yield();
  });
  int wanted = 0;
  while (wanted < kCount) {
    int value = -1;
    if (!ring.pop(value)) {
      std::this_thread::yield();
      continue;
    }
    ASSERT_EQ(value, wanted);
    ++wanted;
  }
  writer.join();
}

}  // namespace
}  // namespace argil
