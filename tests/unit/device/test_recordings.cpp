// Recordings as other programs write them: separators, decimal commas, names of columns. Values by hand.
#include <gtest/gtest.h>

#include "support/utf16.h"
#include "unit/device/recordings.h"

namespace argil::device {
namespace {

using test::expect_refused;
using test::has_note;
using test::read;

/// t 0 and 0.5, places (1.5, -2, 3) and (4, 5, 0.25).
void expect_two_samples(const Trace& trace, const std::string& text) {
  ASSERT_EQ(trace.samples.size(), 2U) << text;
  EXPECT_EQ(trace.time, (std::vector<double>{0.0, 0.5})) << text;
  EXPECT_EQ(trace.samples[0].position, Vec3(1.5, -2, 3)) << text;
  EXPECT_EQ(trace.samples[1].position, Vec3(4, 5, 0.25)) << text;
}

TEST(Recordings, AreReadWithAnySeparator) {
  for (const std::string separator : {",", ";", "\t", " ", "   ", ", ", ",\t", " ; ", " \t "}) {
    std::string text = "t,x,y,z\n0,1.5,-2,3\n0.5,4,5,0.25\n";
    for (std::size_t at = 0; (at = text.find(',', at)) != std::string::npos; at += separator.size())
      text.replace(at, 1, separator);
    const Trace trace = read(text);
    expect_two_samples(trace, text);
    EXPECT_TRUE(trace.notes.empty()) << text;
  }
}

TEST(Recordings, MayHaveDecimalCommasWhereNoCommaSeparates) {
  for (const std::string text :
       {"t;x;y;z\n0,0;1,5;-2;3\n0,5;4;5;2,5e-1\n", "t\tx\ty\tz\n0\t1,5\t-2\t3\n0,5\t4\t5\t0,25\n",
        "t x y z\n0,0 1,5 -2,0 3,0\n0,5 4,0 5,0 0,25\n",
        "t,x,y,z\n\"0\",\"1,5\",\"-2\",\"3\"\n\"0,5\",4,5,\"0,25\"\n"}) {
    const Trace trace = read(text);
    expect_two_samples(trace, text);
    EXPECT_TRUE(has_note(trace, "decimal commas")) << text;
  }
}

TEST(Recordings, WithDecimalCommasAndPointsInOneFileAreRefused) {
  expect_refused("t;x;y;z\n0;1,250;0;0\n0.5;1,5;0;0\n", "line 3, column 1", "decimal commas (line 2)");
  expect_refused("t;x;y;z\n0;0;0;0\n1;1,234.5;0;0\n", "line 3, column 2", "'1,234.5' is not a number");
  expect_refused("t,x,y,z\n0,0,1,5,-2,0,3,0\n", "line 2", "8 fields, not 4");
}

TEST(Recordings, MayHaveASeparatorAtTheEndOfRows) {
  expect_two_samples(read("t,x,y,z,\n0,1.5,-2,3,\n0.5,4,5,0.25,\n"), "both");
  expect_two_samples(read("t;x;y;z\n0;1.5;-2;3;\n0.5;4;5;0.25;\n"), "rows");
  expect_refused("t,x,y,z\n0,1.5,-2,3,,\n", "line 2", "6 fields, not 4");
}

TEST(Recordings, NameTheirColumnsInTheUsualWays) {
  for (const std::string names :
       {"T,X,Y,Z", "Time,Pos_X,Pos_Y,Pos_Z", "timestamp,pos_x,pos_y,pos_z", "Time_s,PX,PY,PZ",
        "time [s],x [m],y [m],z [m]", "Time (s),Position X (m),Position Y (m),Position Z (m)",
        "t_s,x_m,y_m,z_m", "t,position.x,position.y,position.z",
        "%time,field.pose.position.x,field.pose.position.y,field.pose.position.z", "t,x_pos,y_pos,z_pos",
        "\"time, s\",\"x, m\",\"y, m\",\"z, m\"", "t,tip_x,tip_y,tip_z"}) {
    const Trace trace = read(names + "\n0,1.5,-2,3\n0.5,4,5,0.25\n");
    expect_two_samples(trace, names);
    EXPECT_TRUE(trace.ignored_columns.empty()) << names;
  }
  EXPECT_TRUE(
      has_note(read("T,X,Pos_Y,Z\n0,1,2,3\n1,2,3,4\n"), "columns read: t: 'T', x: 'X', y: 'Pos_Y', z: 'Z'"));
}

TEST(Recordings, AreReadWithNamesInTheCommentAboveTheNumbers) {
  for (const std::string text :
       {"# t x y z\n0 1.5 -2 3\n0.5 4 5 0.25\n", "% made by hand\n%time,x,y,z\n0,1.5,-2,3\n0.5,4,5,0.25\n"}) {
    const Trace trace = read(text);
    expect_two_samples(trace, text);
    EXPECT_TRUE(has_note(trace, "named by the comment in line")) << text;
  }
  expect_refused("# made by hand\n0,1.5,-2,3\n0.5,4,5,0.25\n", "line 2", "no columns x, y, z");
}

TEST(Recordings, AreReadWithNamesBehindAColonInAnyCommentAbove) {
  TraceOptions options;
  options.default_rate_hz = 2.0;
  const Trace trace = read(
      "% Columns are: x(m) y(m) z(m) yaw(rad) pitch(rad) roll(rad)\n% made by hand\n\n%---\n1.5 -2 3 0 0 "
      "0\n4 5 0.25 "
      "0 0 0\n",
      options);
  expect_two_samples(trace, "behind a colon");
  EXPECT_TRUE(has_note(trace, "named by the comment in line 1"));
}

/// What such numbers are, the user says; the message has what is likely, from how many they are, a first one
/// that grows and four of unit length.
TEST(Recordings, WithoutNamesAreRefusedWithLikelyOnes) {
  const auto expect_likely = [](const std::string& text, const std::string& names) {
    expect_refused(text, "line 1", "by /trace/columns, for instance [" + names + "]");
  };
  expect_likely("10.5 1 2 3 0 0 0.6 0.8\n10.6 1 2 3 0 0 0 1\n",
                R"("t", "x", "y", "z", "qx", "qy", "qz", "qw")");
  expect_likely("1 2 3 0 0 0.6 0.8\n2 2 3 0 0 0 1\n", R"("x", "y", "z", "qx", "qy", "qz", "qw")");
  expect_likely("0,1,2,3\n0.1,1,2,3\n", R"("t", "x", "y", "z")");
  expect_likely("1,2,3\n1,2,4\n", R"("x", "y", "z")");
}

/// Two sensors take turns in one table, with a row above the names that says which is which. Rows end where
/// the sensor's cells do.
TEST(Recordings, OfSeveralSensorsAreReadByTheColumnsThatTheMessageProposes) {
  const std::string text =
      ",a,a,a,b,b,b,\nTime (s),Pos_x (mm), Pos_y (mm), Pos_z (mm),Pos_x (mm), Pos_y (mm), Pos_z (mm),\n"
      "0,1500,-2000,3000,\n0.25,,,,7,8,9,\n0.5,4000,5000,250,\n";
  expect_refused(text, "line 2", R"~(for instance ["Time (s)", "Pos_x (mm)", "Pos_y (mm)", "Pos_z (mm)"])~");
  TraceOptions options;
  options.columns = {"Time (s)", "Pos_x (mm)", "Pos_y (mm)", "Pos_z (mm)"};
  options.max_gap = 1.0;
  const Trace trace = read(text, options);
  expect_two_samples(trace, "two sensors");
  EXPECT_TRUE(has_note(trace, "1 line above the table, from line 1, is not used"));
  EXPECT_TRUE(has_note(trace, "rows without a place, left out: 1, the first in line 4"));
  EXPECT_TRUE(has_note(trace, "rows that lack columns which are not used: 2, the first in line 3"));
  // A row that was cut in what is read is no such row.
  expect_refused(text + "0.75,1,2,3", "line 6", "4 fields, not 7", options);
}

TEST(Recordings, WithColumnsNamedByTheUserStillTakeTheRowOfUnits) {
  TraceOptions options;
  options.columns = {"t", "x", "y", "z"};
  options.max_gap = 1.0;
  expect_two_samples(read("a,b,c,d\n(s),(mm),(mm),(mm)\n0,1500,-2000,3000\n0.5,4000,5000,250\n", options),
                     "units");
}

TEST(Recordings, SpellQuaternionsInTheUsualWays) {
  // A quarter turn about x.
  for (const std::string names :
       {"rotation.w,rotation.x,rotation.y,rotation.z", "rot_w,rot_x,rot_y,rot_z", "ow,ox,oy,oz",
        "transform.rotation.w,transform.rotation.x,transform.rotation.y,transform.rotation.z", "Q0,Qx,Qy,Qz",
        "qw,qx,qy,qz", "QW,QX,QY,QZ", "q_w,q_x,q_y,q_z", "Quat_w,Quat_x,Quat_y,Quat_z",
        "orientation.w,orientation.x,orientation.y,orientation.z", "qr,qi,qj,qk",
        "pose.orientation.w,pose.orientation.x,pose.orientation.y,pose.orientation.z"}) {
    const Trace trace = read("t,x,y,z," + names + "\n0,0,0,0,0.7071068,0.7071068,0,0\n1,0,0,0,1,0,0,0\n");
    EXPECT_NEAR(trace.samples[0].orientation.w(), std::sqrt(0.5), 1e-15) << names;
    EXPECT_NEAR(trace.samples[0].orientation.x(), std::sqrt(0.5), 1e-15) << names;
    EXPECT_EQ(trace.samples[1].orientation.coeffs(), Vec4(0, 0, 0, 1)) << names;
    EXPECT_TRUE(trace.ignored_columns.empty()) << names;
  }
}

TEST(Recordings, TakeAFamilyOfNamesForAQuaternionOnlyWhereItHasAScalar) {
  const Trace bare = read("t,px,py,pz,w,x,y,z\n0,1,2,3,0,1,0,0\n1,4,5,6,1,0,0,0\n");
  EXPECT_EQ(bare.samples[0].position, Vec3(1, 2, 3));
  EXPECT_EQ(bare.samples[0].orientation.coeffs(), Vec4(1, 0, 0, 0));
  // A place with a weight, and angles.
  const Trace place = read("t,x,y,z,w,rot_x,rot_y,rot_z\n0,1,2,3,1,1,0,0\n1,4,5,6,1,1,0,0\n");
  EXPECT_EQ(place.samples[0].position, Vec3(1, 2, 3));
  EXPECT_EQ(place.ignored_columns, (std::vector<std::string>{"w", "rot_x", "rot_y", "rot_z"}));
  TraceOptions options;
  options.angle_order = AngleOrder::xyz;
  expect_refused("t,x,y,z,rot_x,rot_y,rot_z,rot_w\n0,0,0,0,0,0,0,1\n", "line 1",
                 "/trace/angle_order is given, but not all of the columns rx, ry, rz", options);
}

TEST(Recordings, SayOnceWhichColumnsAreNotUsed) {
  const Trace trace = read("t,x,y,z,vx,Force\n0,0,0,0,9,9\n1,4,5,6,9,9\n");
  EXPECT_EQ(trace.notes, (std::vector<std::string>{"columns not used: vx, Force"}));
}

TEST(Recordings, WithAPlainNameAndAnotherOfItsKindTakeThePlainOne) {
  const Trace trace = read("timestamp,t,pos_x,x,y,z\n7,0,9,1.5,-2,3\n7,0.5,9,4,5,0.25\n");
  expect_two_samples(trace, "plain");
  EXPECT_EQ(trace.ignored_columns, (std::vector<std::string>{"timestamp", "pos_x"}));
  expect_refused("t,X,pos_x,y,z\n0,0,0,0,0\n", "line 1", "two columns for 'pos_x': it and 'X'");
}

TEST(Recordings, InUtf16AreRead) {
  const std::string text = "t,x,y,z\n0,1.5,-2,3\n0.5,4,5,0.25\n";
  expect_two_samples(read("\xFF\xFE" + argil::test::to_utf16(text, false)), "little");
  expect_two_samples(read("\xFE\xFF" + argil::test::to_utf16(text, true)), "big");
}

}  // namespace
}  // namespace argil::device
