// Items that changed since the last commit, each named once.
#include "base/change_marks.h"

#include <gtest/gtest.h>

namespace argil {
namespace {

TEST(ChangeMarks, TellTheFirstChangeFromTheNext) {
  ChangeMarks marks;
  marks.resize(3);
  EXPECT_FALSE(marks.is_set(1));
  EXPECT_TRUE(marks.set(1));
  EXPECT_FALSE(marks.set(1));
  EXPECT_TRUE(marks.is_set(1));
  EXPECT_FALSE(marks.is_set(0));
  EXPECT_FALSE(marks.is_set(2));
}

TEST(ChangeMarks, AreNoneAfterClearing) {
  ChangeMarks marks;
  marks.resize(2);
  marks.set(0);
  marks.clear();
  EXPECT_FALSE(marks.is_set(0));
  EXPECT_TRUE(marks.set(0));
}

TEST(ChangeMarks, KeepThoseThatAreSetWhereMoreItemsCome) {
  ChangeMarks marks;
  marks.resize(1);
  marks.set(0);
  marks.resize(2);
  EXPECT_TRUE(marks.is_set(0));
  EXPECT_FALSE(marks.is_set(1));
}

}  // namespace
}  // namespace argil
