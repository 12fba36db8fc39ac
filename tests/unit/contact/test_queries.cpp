// Reading of query tables: quotients are rounded correctly, and every fault is named with file and line.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "base/error.h"
#include "contact/queries.h"
#include "support/temp_folder.h"

namespace argil::contact {
namespace {

TEST(Quotient, SmallIntegersDivideAsIeeeDoes) {
  // IEEE 754 division of exactly representable integers is correctly rounded: an independent reference.
  for (int n = -40; n <= 40; ++n)
    for (int d = 1; d <= 40; ++d)
      EXPECT_EQ(compute_quotient(std::to_string(n), std::to_string(d)), double(n) / double(d))
          << n << "/" << d;
}

TEST(Quotient, LongIntegersGiveTheDoubleTheyWereMadeFrom) {
  // 2^112 = 5192296858534827628530496329220096.
  EXPECT_EQ(compute_quotient("-5936450128420645", "649037107316853453566312041152512"),
            -std::ldexp(5936450128420645.0, -109));
  EXPECT_EQ(compute_quotient("5192296858534827628530496329220096", "1"), std::ldexp(1.0, 112));
  EXPECT_EQ(compute_quotient("0", "649037107316853453566312041152512"), 0.0);
}

TEST(Quotient, TiesGoToEvenAndWhatLiesBeyondATieGoesUp) {
  // 2^53 + 1 lies half way between two doubles; 2^53 + 3 as well.
  EXPECT_EQ(compute_quotient("9007199254740993", "1"), 9007199254740992.0);
  EXPECT_EQ(compute_quotient("9007199254740995", "1"), 9007199254740996.0);
  EXPECT_EQ(compute_quotient("90071992547409930000000000000000001", "10000000000000000000"),
            9007199254740994.0);
  // All ones round up into the next power of two.
  EXPECT_EQ(compute_quotient("18014398509481983", "1"), 18014398509481984.0);
}

TEST(Quotient, IntegersWhoseQuotientWouldTakeForeverAreRefused) {
  const std::string longest(10000, '7');
  EXPECT_EQ(compute_quotient(longest, longest), 1.0);
  EXPECT_THROW(compute_quotient(longest + "7", "1"), std::invalid_argument);
  EXPECT_THROW(compute_quotient("1", std::string(20000000, '7')), std::invalid_argument);
}

TEST(Quotient, SubnormalResultsAreRoundedOnce) {
  const std::string two_1074 = [] {  // 2^1074 by doubling a decimal string
    std::string digits = "1";
    for (int i = 0; i < 1074; ++i) {
      int carry = 0;
      for (auto it = digits.rbegin(); it != digits.rend(); ++it) {
        const int value = 2 * (*it - '0') + carry;
        *it = static_cast<char>('0' + value % 10);
        carry = value / 10;
      }
      if (carry != 0) digits.insert(digits.begin(), '1');
    }
    return digits;
  }();
  const double smallest = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(compute_quotient("1", two_1074), smallest);
  EXPECT_EQ(compute_quotient("3", two_1074), 3.0 * smallest);
  EXPECT_EQ(compute_quotient("1", two_1074 + "0"), 0.0);              // a tenth of the smallest
  EXPECT_EQ(compute_quotient("25", two_1074 + "0"), 2.0 * smallest);  // 2.5: tie to even
  EXPECT_EQ(compute_quotient("26", two_1074 + "0"), 3.0 * smallest);
}

TEST(Quotient, RefusesWhatIsNoQuotient) {
  EXPECT_THROW(compute_quotient("1", "0"), std::invalid_argument);
  EXPECT_THROW(compute_quotient("1", "-2"), std::invalid_argument);
  EXPECT_THROW(compute_quotient("1.5", "2"), std::invalid_argument);
  EXPECT_THROW(compute_quotient("", "2"), std::invalid_argument);
  EXPECT_THROW(compute_quotient("-", "2"), std::invalid_argument);
  EXPECT_THROW(compute_quotient("1" + std::string(309, '0'), "1"), std::invalid_argument);
}

class Queries : public ::testing::Test {
 protected:
  std::string write(const std::string& text) { return m_folder.write("q.csv", text); }
  std::string message(const std::string& text) {
    const std::string file = write(text);
    try {
      read_queries(file);
    } catch (const InputError& error) {
      return std::string(error.what()).substr(file.size());
    }
    return "accepted";
  }
  static std::string rows(int count, const std::string& row) {
    std::string text;
    for (int i = 0; i < count; ++i) text += row + "\n";
    return text;
  }
  test::TempFolder m_folder;
};

TEST_F(Queries, ReadsPointsInOrderWithAndWithoutTruth) {
  std::string text;
  for (int i = 0; i < 8; ++i) text += std::to_string(i) + ",2, 1,4 ,-1,1,1\r\n";
  const QueryFile file = read_queries(write(text + "\n"));
  ASSERT_EQ(file.paths.size(), 1U);
  ASSERT_EQ(file.truth.size(), 1U);
  EXPECT_TRUE(file.truth[0]);
  EXPECT_EQ(file.paths[0].t0[3], Vec3(1.5, 0.25, -1.0));
  EXPECT_EQ(file.paths[0].t1[0], Vec3(2.0, 0.25, -1.0));
  EXPECT_TRUE(read_queries(write(rows(16, "1,1,1,1,1,1"))).truth.empty());
}

TEST_F(Queries, NamesLineAndColumnOfEveryFault) {
  const std::string good = "1,1,1,1,1,1";
  EXPECT_NE(message(rows(2, good) + "1,1,1,0,1,1\n").find(": line 3, column 3: the denominator is 0"),
            std::string::npos);
  EXPECT_NE(message("1,1,x,1,1,1\n").find("line 1, column 3: \"x\" is not an integer"), std::string::npos);
  EXPECT_NE(message("1,1,1,1\n").find("line 1: has 4 columns"), std::string::npos);
  EXPECT_NE(message(rows(9, good)).find("line 9: the last query has 1 of its 8 rows"), std::string::npos);
  EXPECT_NE(message(rows(7, good + ",1") + good + ",0\n").find("line 8: the truth differs"),
            std::string::npos);
  EXPECT_NE(message(rows(8, good + ",1") + rows(8, good)).find("line 9: some queries have a truth"),
            std::string::npos);
  EXPECT_NE(message(good + ",2\n").find("line 1, column 7: truth is \"2\""), std::string::npos);
  EXPECT_THROW(read_queries(m_folder / "absent.csv"), IoError);
}

}  // namespace
}  // namespace argil::contact
