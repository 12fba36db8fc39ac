// One error line names file, place, value and remedy; a failed assertion names the expression and its values.
#include "base/error.h"

#include <gtest/gtest.h>

#include "base/check.h"
#include "base/status.h"

namespace argil {
namespace {

TEST(InputError, NamesFilePlaceProblemAndRemedyInOneLine) {
  const InputError error("a.json", "/tool/radius_m", "-1 is outside (0, 1] m", "give a positive radius");
  EXPECT_STREQ(error.what(), "a.json: /tool/radius_m: -1 is outside (0, 1] m; give a positive radius");
}

TEST(AssertionDeathTest, NamesTheExpressionAndItsValues) {
  EXPECT_DEATH(ARGIL_ASSERT(1 + 1 == 3, "sum", 2), "1 \\+ 1 == 3 is false; sum 2");
}

StepStatus fail_at(Tick tick) {
  ARGIL_TRY(StepStatus::ok());
  ARGIL_TRY(StepStatus::failed({tick, "solid", 7, "volume ratio", -0.5, 0.0}));
  return StepStatus::ok();
}

TEST(StepStatus, HandsTheFirstFailureUp) {
  const StepStatus status = fail_at(12);
  ASSERT_FALSE(status.is_ok());
  EXPECT_EQ(to_string(status.failure()), "tick 12, solid: volume ratio is -0.5, bound 0, element 7");
}

}  // namespace
}  // namespace argil
