#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "base/ordered_loops.h"

namespace argil {
namespace {

constexpr std::ptrdiff_t kCount = 1000;

double term(std::ptrdiff_t i) {
  return std::sin(static_cast<double>(i)) + 1.0;
}

TEST(OrderedItems, VisitsAllOrThoseOfAList) {
  OrderedItems items(2);
  std::vector<int> visits(kCount, 0);
  const auto visit = [&] {
    items.each(kCount, [&](std::ptrdiff_t i) { ++visits[static_cast<std::size_t>(i)]; });
  };
  visit();
  EXPECT_EQ(visits, std::vector<int>(kCount, 1));
  const std::vector<int> some = {3, 500, 999};
  items.restrict_to(&some);
  visit();
  EXPECT_EQ(std::accumulate(visits.begin(), visits.end(), 0), kCount + 3);
  for (const int i : some) EXPECT_EQ(visits[static_cast<std::size_t>(i)], 2);
}

TEST(OrderedItems, SumsAndFindsTheSameOnAnyNumberOfThreads) {
  double sum = 0.0, largest = 0.0;
  for (std::ptrdiff_t i = 0; i < kCount; ++i) {
    sum += term(i);
    largest = std::max(largest, term(i));
  }
  const OrderedItems one(1);
  EXPECT_NEAR(one.sum(kCount, term), sum, 1e-12 * sum);
  EXPECT_EQ(one.find_largest(kCount, term), largest);
  for (const int threads : {2, 3}) {
    const OrderedItems more(threads);
    EXPECT_EQ(more.sum(kCount, term), one.sum(kCount, term)) << threads;
    EXPECT_EQ(more.find_largest(kCount, term), largest) << threads;
  }
}

TEST(OrderedItems, OfNoneAreNothing) {
  OrderedItems items(2);
  const std::vector<int> none;
  items.restrict_to(&none);
  EXPECT_EQ(items.sum(kCount, term), 0.0);
  EXPECT_EQ(items.find_largest(kCount, term), 0.0);
}

}  // namespace
}  // namespace argil
