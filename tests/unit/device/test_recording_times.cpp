// Dates, times of day and times in two columns; motions far too slow. Values by hand.
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "unit/device/recordings.h"

namespace argil::device {
namespace {

using test::expect_refused;
using test::has_note;
using test::read;

TEST(RecordingTimes, InAColumnOfDatesAndOneOfTimesOfDayAreRead) {
  for (const std::string text :
       {"date,time,x,y,z\n2024-02-29,23:59:59.75,0,0,0\n2024-03-01,00:00:00.25,0,0,0\n",
        "date time x y z\n2024-02-29 23:59:59.75 0 0 0\n2024-03-01 00:00:00.25 0 0 0\n",
        "Date;Time;X;Y;Z\n2024/02/29;23:59:59,75;0;0;0\n2024/03/01;00:00:00,25;0;0;0\n",
        "time x y z\n2024-02-29 23:59:59.75 0 0 0\n2024-03-01 00:00:00.25 0 0 0\n",
        "t,x,y,z\n2024-02-29,23:59:59.75,0,0,0\n2024-03-01,00:00:00.25,0,0,0\n"}) {
    const Trace trace = read(text);
    EXPECT_EQ(trace.time, (std::vector<double>{0.0, 0.5})) << text;
    EXPECT_TRUE(trace.ignored_columns.empty()) << text;
  }
  expect_refused("date,time,x,y,z\n2024-01-02,12:00:00,0,0,0\nnever,12:00:01,0,0,0\n", "line 3, column 2",
                 "'never 12:00:01' is not a calendar time as the first is");
}

TEST(RecordingTimes, BesideADateThatIsNoneAreReadWithoutIt) {
  for (const std::string text : {"date,t,x,y,z\n2024-01-02,0,0,0,0\n2024-01-02,0.5,0,0,0\n",
                                 "date,time,x,y,z\n1/2/24,12:00:00,0,0,0\n1/2/24,12:00:00.5,0,0,0\n"}) {
    const Trace trace = read(text);
    EXPECT_EQ(trace.time, (std::vector<double>{0.0, 0.5})) << text;
    EXPECT_EQ(trace.ignored_columns, (std::vector<std::string>{"date"})) << text;
  }
}

TEST(RecordingTimes, OfDayThatPassMidnightGoOn) {
  const Trace once = read("t,x,y,z\n23:59:59.75,0,0,0\n00:00:00,0,0,0\n00:00:00.5,0,0,0\n");
  EXPECT_EQ(once.time, (std::vector<double>{0.0, 0.25, 0.75}));
  EXPECT_TRUE(has_note(once, "times of day pass midnight in line 3: a day is added"));
  TraceOptions options;
  options.max_gap = 86400.0;
  const Trace twice =
      read("t;x;y;z\n23:30:00,5;0;0;0\n00:15:00,5;0;0;0\n23:45:00,5;0;0;0\n00:00:00,5;0;0;0\n", options);
  EXPECT_EQ(twice.time, (std::vector<double>{0.0, 2700.0, 87300.0, 88200.0}));
  EXPECT_TRUE(has_note(twice, "pass midnight 2 times, first in line 3"));
  // A step back of some hours is no midnight.
  expect_refused("t,x,y,z\n23:00:00.9,0,0,0\n23:00:00.999,0,0,0\n01:00:00,0,0,0\n", "line 4",
                 "does not come after 0.099 s");
}

TEST(RecordingTimes, InSecondsAndNanosecondsAreOne) {
  for (const std::string names :
       {"secs,nsecs", "sec,nanosec", "header.stamp.secs,header.stamp.nsecs",
        "field.header.stamp.sec,field.header.stamp.nanosec", "tv_sec,tv_nsec", "seconds,nanoseconds"}) {
    const Trace trace = read(names + ",x,y,z\n1700000000,999000001,0,0,0\n1700000001,1000003,0,0,0\n");
    EXPECT_EQ(trace.time[0], 0.0) << names;
    EXPECT_NEAR(trace.time[1], 0.002000002, 1e-15) << names;  // rounding of numbers near 1
    EXPECT_TRUE(trace.ignored_columns.empty()) << names;
    EXPECT_TRUE(has_note(trace, "times count from 1700000000 s and 999000001 ns")) << names;
  }
  EXPECT_EQ(read("secs,nsecs,x,y,z\n0,0,0,0,0\n1,500000000,0,0,0\n").time[1], 1.5);
  const Trace plain = read("t,secs,nsecs,x,y,z\n0,7,7,0,0,0\n1,7,8,0,0,0\n");
  EXPECT_EQ(plain.time[1], 1.0);
  EXPECT_EQ(plain.ignored_columns, (std::vector<std::string>{"secs", "nsecs"}));
  TraceOptions options;
  options.time_unit = TimeUnit::ms;
  expect_refused("secs,nsecs,x,y,z\n0,0,0,0,0\n", "line 2, column 1",
                 "time is in seconds and nanoseconds, but /trace/time_unit is ms", options);
}

// 0.02 mm a sample.
TEST(RecordingTimes, OfAMotionSlowerThanAnyHandsAreDoubted) {
  const auto write = [](double interval) {
    std::ostringstream text;
    text << "time [s],x,y,z\n";
    for (int i = 0; i < 20; ++i) text << interval * i << ",0,0," << 2e-5 * i << '\n';
    return text.str();
  };
  EXPECT_TRUE(
      has_note(read(write(1.0)),
               "samples are 1 s apart (median) and the motion is 0.02 mm/s fast in the mean, slower than "
               "a hand; perhaps times are in ms: give the unit by /trace/time_unit"));
  EXPECT_FALSE(has_note(read(write(0.01)), "slower than a hand"));
  TraceOptions options;
  options.time_unit = TimeUnit::s;
  EXPECT_FALSE(has_note(read(write(1.0), options), "slower than a hand"));
}

}  // namespace
}  // namespace argil::device
