// Quantiles of counts in bins against those of the sorted values.
#include "live/distribution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "base/rng.h"

namespace argil::live {
namespace {

TEST(Distribution, QuantilesAreThoseOfTheSortedValuesWithinABin) {
  constexpr double kWidth = 1e-3;
  Distribution distribution(kWidth);
  std::vector<double> values;
  Rng rng(7, "distribution");
  for (int i = 0; i < 10000; ++i) {
    const double u = rng.uniform();
    values.push_back(u * u);
    distribution.add(values.back());
  }
  std::sort(values.begin(), values.end());
  for (const double p : {0.5, 0.99, 0.999}) {
    const double exact = values[static_cast<std::size_t>(p * 10000) - 1];
    EXPECT_GE(distribution.quantile(p), exact);
    EXPECT_LE(distribution.quantile(p), exact + kWidth);
  }
  EXPECT_EQ(distribution.largest(), values.back());
  EXPECT_EQ(distribution.total(), 10000);
}

TEST(Distribution, CountsWhatIsBeyondItsBinsAndKeepsTheLargest) {
  Distribution distribution(1.0, 10);
  for (const double value : {-1.0, 0.0, 3.0, 1e9}) distribution.add(value);
  EXPECT_EQ(distribution.largest(), 1e9);
  EXPECT_EQ(distribution.quantile(0.75), 4.0);
}

TEST(Distribution, OfNothingIsZero) {
  EXPECT_EQ(Distribution(1.0).quantile(0.5), 0.0);
}

}  // namespace
}  // namespace argil::live
