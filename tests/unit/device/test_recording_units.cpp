// Units, calendar times, pauses, buttons, orientations and steps of recordings. Values by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>
#include <string>

#include "unit/device/recordings.h"

namespace argil::device {
namespace {

using test::expect_refused;
using test::has_note;
using test::read;

/// `count` rows whose cells are functions of the row.
template <class Time, class Height>
std::string make_rows(const std::string& names, int count, Time time, Height height) {
  std::ostringstream text;
  text.precision(15);
  text << names << '\n';
  for (int i = 0; i < count; ++i) text << time(i) << ",0,0," << height(i) << '\n';
  return text.str();
}

double still(int) {
  return 0.25;
}

// Times 0, 1 and 2.5 ms.
TEST(RecordingUnits, OfTimeComeFromTheKeyTheNameOrTheRowUnderTheNames) {
  TraceOptions options;
  const auto expect_times = [&](const std::string& text) {
    const Trace trace = read(text, options);
    ASSERT_EQ(trace.time.size(), 3U) << text;
    EXPECT_EQ(trace.time[1], 0.001) << text;
    EXPECT_EQ(trace.time[2], 0.0025) << text;
  };
  for (const std::string name :
       {"t_ms", "t [ms]", "Time (ms)", "timestamp_ms", "time/ms", "time [milliseconds]"})
    expect_times(name + ",x,y,z\n0,0,0,0\n1,0,0,0\n2.5,0,0,0\n");
  for (const std::string name : {"t_us", "t [us]", "time [\xC2\xB5s]", "time (\xCE\xBCs)", "time [\xB5s]"})
    expect_times(name + ",x,y,z\n0,0,0,0\n1000,0,0,0\n2500,0,0,0\n");
  expect_times("t,x,y,z\nms,m,m,m\n0,0,0,0\n1,0,0,0\n2.5,0,0,0\n");
  options.time_unit = TimeUnit::ms;
  expect_times("t,x,y,z\n0,0,0,0\n1,0,0,0\n2.5,0,0,0\n");
  options.time_unit = TimeUnit::ns;
  expect_times("t,x,y,z\n0,0,0,0\n1000000,0,0,0\n2500000,0,0,0\n");
  EXPECT_TRUE(has_note(read("t_ms,x,y,z\n0,0,0,0\n1,0,0,0\n", options),
                       "/trace/time_unit is taken, not the unit 'ms'"));
  expect_refused("t [min],x,y,z\n0,0,0,0\n1,0,0,0\n", "line 2, column 1",
                 "unit of time 'min'; give s, ms, us or ns by /trace/time_unit");
}

// 19 digits do not fit a double, whose neighbours there are 256 ns apart.
TEST(RecordingUnits, NanosecondsSince1970KeepTheirLastDigit) {
  TraceOptions options;
  options.time_unit = TimeUnit::ns;
  const Trace trace = read(
      "t,x,y,z\n1700000000000000001,0,0,0\n1700000000001000002,0,0,0\n1700000000002000004,0,0,0\n", options);
  EXPECT_EQ(trace.time, (std::vector<double>{0.0, 0.001000001, 0.002000003}));
  EXPECT_TRUE(has_note(trace, "times count from 1700000000000000001"));
  EXPECT_EQ(read("t_s,x,y,z\n1700000000.25,0,0,0\n1700000000.375,0,0,0\n").duration(), 0.125);
}

TEST(RecordingUnits, OfLengthComeFromTheKeyTheNamesTheHeaderOrTheRowUnderTheNames) {
  TraceOptions options;
  const auto expect_place = [&](const std::string& text) {
    const Trace trace = read(text, options);
    EXPECT_NEAR((trace.samples[1].position - Vec3(0.012, -0.0345, 0.5)).norm(), 0.0, 1e-16) << text;
    EXPECT_FALSE(trace.is_length_assumed) << text;
  };
  const std::string rows = "\n0,0,0,0\n1,12,-34.5,500\n";
  for (const std::string names :
       {"t,x_mm,y_mm,z_mm", "t,X [mm],Y [mm],Z [mm]", "t,pos_x (mm),pos_y (mm),pos_z (mm)",
        "t,x,y,z\ns,mm,mm,mm", "t,x,y,z\n[s],[mm],[mm],[mm]"})
    expect_place(names + rows);
  expect_place("# argil-trace: 1\n# units: mm\nt,x,y,z" + rows);
  expect_place("t,x_cm,y_cm,z_cm\n0,0,0,0\n1,1.2,-3.45,50\n");
  expect_place("t,x_m,y_m,z_m\n0,0,0,0\n1,0.012,-0.0345,0.5\n");
  options.length_unit = LengthUnit::mm;
  expect_place("t,x,y,z" + rows);
  EXPECT_TRUE(
      has_note(read("t,x_m,y_m,z_m" + rows, options), "/trace/length_unit is taken, not the unit 'm'"));
  expect_refused("t,x_mm,y_cm,z_mm\n0,0,0,0\n1,0,0,0\n", "line 2", "columns x and y are in 'mm' and 'cm'");
  expect_refused("# argil-trace: 1\n# units: cm\nt,x_m,y_m,z_m\n0,0,0,0\n", "line 4",
                 "header's units are 'cm'");
  expect_refused("t,x [inch],y [inch],z [inch]\n0,0,0,0\n", "line 2",
                 "unit of length 'inch'; give m, cm, mm or um by /trace/length_unit");
}

TEST(RecordingUnits, ThatNobodyGaveAreRefusedWhereTheRateIsOutOfReason) {
  TraceOptions options;
  const std::string ms = make_rows(
      "t,x,y,z", 400, [](int i) { return i; }, still);
  expect_refused(ms, "", "400 samples at a median interval of 1 s are no recorded motion if times are in s");
  expect_refused(ms, "", "give the unit by /trace/time_unit: s, ms, us or ns, perhaps ms");
  expect_refused(make_rows(
                     "t,x,y,z", 60, [](int i) { return 1000 * i; }, still),
                 "", "perhaps us");
  const std::string days = make_rows(
      "t,x,y,z", 60, [](int i) { return i / 86400e3; }, still);
  expect_refused(days, "", "/trace/time_unit");
  EXPECT_EQ(read(make_rows(
                     "t_s,x,y,z", 400, [](int i) { return i; }, still))
                .duration(),
            399.0);
  options.time_unit = TimeUnit::s;
  EXPECT_EQ(read(ms, options).duration(), 399.0);
  options.time_unit = TimeUnit::ms;
  EXPECT_EQ(read(ms, options).duration(), 0.399);
}

// A press of 3 mm in 0.1 s, there and back, in mm: 30 "m/s".
TEST(RecordingUnits, ThatNobodyGaveAreRefusedWhereThePathIsOutOfReason) {
  TraceOptions options;
  const auto time = [](int i) { return 0.001 * i; };
  const auto press = [](int i) { return 73.0 - 0.03 * std::min(i, 200 - i); };
  const std::string mm = make_rows("t,x,y,z", 200, time, press);
  expect_refused(mm, "", "30 m/s fast in the mean");
  expect_refused(mm, "", "give the unit by /trace/length_unit");
  expect_refused(make_rows(
                     "t,x,y,z", 200, [](int i) { return 0.008 * i; }, press),
                 "", "/trace/length_unit");  // 3.75 m/s
  expect_refused(make_rows("t,x,y,z", 9000, time, [](int i) { return 0.001 * i; }), "",
                 "9");  // 1 m/s, but 9 m
  // A stab at 5 m/s and a jump of 0.5 m in a tick are fast, but not wide.
  EXPECT_TRUE(read(make_rows("t,x,y,z", 100, time, [](int i) { return 0.4 - 0.005 * i; })).is_length_assumed);
  EXPECT_TRUE(
      read(make_rows("t,x,y,z", 20, time, [](int i) { return i < 10 ? 0.5 : 0.0; })).is_length_assumed);
  options.length_unit = LengthUnit::mm;
  EXPECT_NEAR(read(mm, options).samples[100].position.z(), 0.070, 1e-15);
  options = {};
  options.device_to_world.scale = 0.001;
  EXPECT_FALSE(read(mm, options).is_length_assumed);
  EXPECT_TRUE(read(make_rows("t,x,y,z", 200, time, still)).is_length_assumed);
}

// A millimetre in 2 s, 70 "m" from the device's origin.
TEST(RecordingUnits, ThatNobodyGaveAreRefusedWhereThePlaceIsOutOfReason) {
  TraceOptions options;
  const auto at = [](double height) {
    return make_rows(
        "t,x,y,z", 200, [](int i) { return 0.01 * i; }, [=](int i) { return height - 0.005 * i; });
  };
  expect_refused(
      at(70.0), "line 2",
      "place 70 m from the device's origin if it is in m, where no hand's device reaches; give the unit "
      "by /trace/length_unit: m, cm, mm or um, perhaps mm");
  expect_refused(at(10.01), "line 2", "place 10 m from");
  for (const double room : {9.9, 5.1}) {
    EXPECT_TRUE(
        has_note(read(at(room)), "m from the device's origin if it is in m (line 2); give another unit"));
  }
  EXPECT_TRUE(read(at(4.9)).notes.empty());
  for (const auto& [unit, height] : {std::pair{LengthUnit::m, 70.0}, {LengthUnit::mm, 0.07}}) {
    options.length_unit = unit;
    EXPECT_NEAR(read(at(70.0), options).samples[0].position.z(), height, 1e-15);
  }
  // Moved in the world, it is still as near to its device.
  options = {};
  options.device_to_world.translation = Vec3(70, 0, 0);
  EXPECT_TRUE(read(at(0.5), options).notes.empty());
}

TEST(RecordingTimes, MayBeDates) {
  for (const std::string date :
       {"2024/01/02/12:00:", "2024-01-02T12:00:", "2024-01-02 12:00:", "2024.01.02 12:00:", "12:00:"}) {
    const Trace trace =
        read("time,x,y,z\n" + date + "59.250,0,0,0\n" + date.substr(0, date.size() - 3) + "01:00.5,0,0,0\n");
    EXPECT_EQ(trace.time, (std::vector<double>{0.0, 1.25})) << date;
    EXPECT_TRUE(has_note(trace, "calendar times, counted from the first")) << date;
  }
  // Across the end of a leap year's February, and of a year, and zones apart.
  EXPECT_EQ(read("t,x,y,z\n2024-02-28 23:59:59,0,0,0\n2024-03-01 00:00:00,0,0,0\n").duration(), 86401.0);
  EXPECT_EQ(read("t,x,y,z\n2023-12-31T23:59:59Z,0,0,0\n2024-01-01T00:00:00Z,0,0,0\n").duration(), 1.0);
  EXPECT_EQ(read("t,x,y,z\n2024-01-01T12:00:00+02:00,0,0,0\n2024-01-01T10:00:01Z,0,0,0\n").duration(), 1.0);
  EXPECT_EQ(read("t x y z\n12:00:00,5 0 0 0\n12:00:00,75 0 0 0\n").duration(), 0.25);
  expect_refused("t,x,y,z\n01/02/2024 12:00:00,0,0,0\n", "line 2, column 1",
                 "or a date and time like 2024-01-31 12:00:00.125");
  expect_refused("t,x,y,z\n12:00:00,0,0,0\n1,0,0,0\n", "line 3, column 1",
                 "'1' is not a calendar time as the first is");
  TraceOptions options;
  options.time_unit = TimeUnit::ms;
  expect_refused("t,x,y,z\n12:00:00,0,0,0\n", "line 2, column 1",
                 "is a calendar time, but /trace/time_unit is ms", options);
}

/// 1 kHz with one pause behind the tenth sample.
std::string with_pause(double pause) {
  return make_rows(
      "t,x,y,z", 40, [pause](int i) { return 0.001 * i + (i > 10 ? pause - 0.001 : 0.0); }, still);
}

TEST(RecordingPauses, AreBridgedAndSaidUpToALengthThatCanBeSet) {
  TraceOptions options;
  EXPECT_TRUE(read(with_pause(0.0025)).notes.empty());
  EXPECT_EQ(read(with_pause(0.012)).notes,
            (std::vector<std::string>{"pause of 0.012 s at 0.01 s (line 13), bridged by a straight line"}));
  EXPECT_EQ(read(with_pause(0.1)).notes.size(), 1U);
  expect_refused(with_pause(0.11), "line 13", "pause of 0.11 s, longer than /trace/max_gap_s, 0.1 s");
  options.max_gap = 0.2;
  EXPECT_EQ(read(with_pause(0.11), options).notes.size(), 1U);
  options.max_gap = 0.011;
  expect_refused(with_pause(0.012), "line 13",
                 "or bridge it by a straight line by /trace/max_gap_s, for instance 0.012", options);
}

// A hand that goes straight on: the place in the middle of the pause is the middle one.
TEST(RecordingPauses, AreStraightLines) {
  const Trace trace = read(
      "t,x,y,z\n0,0,0,0\n0.001,0,0,0.001\n0.002,0,0,0.002\n0.003,0,0,0.003\n0.023,0,0,0.023\n0.024,0,0,0."
      "024\n");
  EXPECT_NEAR(interpolate(trace, 0.013).position.z(), 0.013, 1e-15);
}

TEST(RecordingPauses, OfManyTheFirstAreSaidAndAllCounted) {
  const std::string text = make_rows(
      "t,x,y,z", 200, [](int i) { return 0.001 * i + 0.02 * (i / 20) + (i >= 100 ? 0.01 : 0.0); }, still);
  const Trace trace = read(text);
  ASSERT_EQ(trace.notes.size(), 6U);
  EXPECT_EQ(trace.notes[5], "9 pauses in all are bridged, the longest of 0.031 s (line 102)");
}

TEST(RecordingButtons, AreReadOnlyByTheirNames) {
  const std::string text = "t,x,y,z,button,mode\n0,0,0,0,0,dry\n1,0,0,0,1,dry\n2,0,0,0,0,dry\n";
  TraceOptions options;
  const Trace unread = read(text);
  for (const DeviceSample& sample : unread.samples) EXPECT_EQ(sample.mode, ToolMode::dry);
  EXPECT_TRUE(
      has_note(unread, "columns not used: button; a button is read where /trace/button/column names it"));
  options.button_column = "button";
  expect_refused(text, "", "/trace/button/mode is none", options);
  options.button_mode = ButtonMode::wet;
  const Trace trace = read(text, options);
  EXPECT_EQ(trace.samples[0].mode, ToolMode::dry);
  EXPECT_EQ(trace.samples[1].mode, ToolMode::wet);
  EXPECT_EQ(trace.samples[2].mode, ToolMode::dry);
  EXPECT_TRUE(trace.notes.empty());
  options.default_mode = ToolMode::push;
  options.button_mode = ButtonMode::pull;
  options.button_column = "Btn 1";
  for (const std::string pressed : {"1", "true", "Pressed", "DOWN", "4", "1.0"}) {
    const Trace words = read("t,x,y,z,Btn 1\n0,0,0,0,0\n1,0,0,0," + pressed + "\n2,0,0,0,False\n", options);
    EXPECT_EQ(words.samples[0].mode, ToolMode::push);
    EXPECT_EQ(words.samples[1].mode, ToolMode::pull) << pressed;
    EXPECT_EQ(words.samples[2].mode, ToolMode::push);
  }
  expect_refused("t,x,y,z,Btn 1\n0,0,0,0,maybe\n", "line 2, column 5", "button 'maybe'", options);
  expect_refused("t,x,y,z,a\n0,0,0,0,0\n", "line 1", "no column 'Btn 1' among 't', 'x', 'y', 'z', 'a'",
                 options);
}

Vec3 turned(const Trace& trace, const Vec3& axis) {
  return trace.samples[0].orientation * axis;
}

// Quarter turns about x and z.
TEST(RecordingAngles, TurnInTheOrderThatIsStated) {
  const std::string text = "t,x,y,z,rx,ry,rz\n0,0,0,0,90,0,90\n1,0,0,0,90,0,90\n";
  TraceOptions options;
  EXPECT_EQ(read(text).samples[0].orientation.coeffs(), Vec4(0, 0, 0, 1));
  EXPECT_TRUE(
      has_note(read(text),
               "columns not used: rx, ry, rz; angles are read where /trace/angle_order gives their order"));
  options.angle_order = AngleOrder::xyz;
  expect_refused(text, "line 2", "unit of the angles is not said; give rad or deg by /trace/angle_unit",
                 options);
  options.angle_unit = AngleUnit::deg;
  // R = R_z R_x: x -> y, y -> z, z -> R_z(-y) = x.
  EXPECT_NEAR((turned(read(text, options), Vec3::UnitX()) - Vec3::UnitY()).norm(), 0.0, 1e-15);
  EXPECT_NEAR((turned(read(text, options), Vec3::UnitY()) - Vec3::UnitZ()).norm(), 0.0, 1e-15);
  EXPECT_NEAR((turned(read(text, options), Vec3::UnitZ()) - Vec3::UnitX()).norm(), 0.0, 1e-15);
  // R = R_x R_z: x -> R_x y = z, y -> R_x(-x) = -x, z -> R_x z = -y.
  for (const AngleOrder order : {AngleOrder::XYZ, AngleOrder::zyx}) {
    options.angle_order = order;
    EXPECT_NEAR((turned(read(text, options), Vec3::UnitX()) - Vec3::UnitZ()).norm(), 0.0, 1e-15);
    EXPECT_NEAR((turned(read(text, options), Vec3::UnitY()) + Vec3::UnitX()).norm(), 0.0, 1e-15);
    EXPECT_NEAR((turned(read(text, options), Vec3::UnitZ()) + Vec3::UnitY()).norm(), 0.0, 1e-15);
  }
}

// About fixed axes the first turn stands on the right, about those that turn on the left.
TEST(RecordingAngles, TurnInEveryOrder) {
  const std::string text = "t,x,y,z,rx,ry,rz\n0,0,0,0,0.3,-0.5,0.7\n1,0,0,0,0.3,-0.5,0.7\n";
  const std::array<Mat3, 3> turn = {Eigen::AngleAxisd(0.3, Vec3::UnitX()).toRotationMatrix(),
                                    Eigen::AngleAxisd(-0.5, Vec3::UnitY()).toRotationMatrix(),
                                    Eigen::AngleAxisd(0.7, Vec3::UnitZ()).toRotationMatrix()};
  using enum AngleOrder;
  const std::map<std::string, std::array<AngleOrder, 2>> orders = {{"xyz", {xyz, XYZ}}, {"xzy", {xzy, XZY}},
                                                                   {"yxz", {yxz, YXZ}}, {"yzx", {yzx, YZX}},
                                                                   {"zxy", {zxy, ZXY}}, {"zyx", {zyx, ZYX}}};
  TraceOptions options;
  options.angle_unit = AngleUnit::rad;
  for (const auto& [axes, order] : orders) {
    const auto about = [&](std::size_t k) -> const Mat3& {
      return turn[static_cast<std::size_t>(axes[k] - 'x')];
    };
    options.angle_order = order[0];
    EXPECT_LT((read(text, options).samples[0].orientation.toRotationMatrix() - about(2) * about(1) * about(0))
                  .norm(),
              1e-14)
        << axes;
    options.angle_order = order[1];
    EXPECT_LT((read(text, options).samples[0].orientation.toRotationMatrix() - about(0) * about(1) * about(2))
                  .norm(),
              1e-14)
        << axes;
  }
}

// A third of a turn about (1, 1, 1) takes x to y, y to z, z to x; its vector is 2π/3 / √3 (1, 1, 1).
TEST(RecordingAngles, MayBeOneVector) {
  TraceOptions options;
  options.angle_order = AngleOrder::vector;
  const Trace trace = read(
      "t,x,y,z,rx [rad],ry [rad],rz "
      "[rad]\n0,0,0,0,1.2091995761561452,1.2091995761561452,1.2091995761561452\n1,0,0,0,0,0,0\n",
      options);
  EXPECT_NEAR((turned(trace, Vec3::UnitX()) - Vec3::UnitY()).norm(), 0.0, 1e-15);
  EXPECT_EQ(trace.samples[1].orientation.coeffs(), Vec4(0, 0, 0, 1));
}

TEST(RecordingAngles, AreRollPitchYawTooAndStandAboveAQuaternionWhereTheyAreAskedFor) {
  TraceOptions options;
  options.angle_order = AngleOrder::ZYX;
  const std::string text =
      "t,x,y,z,roll_deg,pitch_deg,yaw_deg,qx,qy,qz,qw\n0,0,0,0,0,0,90,1,0,0,0\n1,0,0,0,0,0,90,1,0,0,0\n";
  EXPECT_NEAR((turned(read(text, options), Vec3::UnitX()) - Vec3::UnitY()).norm(), 0.0, 1e-15);
  EXPECT_TRUE(has_note(read(text, options), "columns not used: qx, qy, qz, qw"));
  EXPECT_NEAR((turned(read(text), Vec3::UnitX()) - Vec3::UnitX()).norm(), 0.0, 1e-15);
  expect_refused("t,x,y,z,roll,yaw\n0,0,0,0,0,0\n", "line 1", "not all of the columns rx, ry, rz", options);
}

TEST(RecordingOrientations, WithNumberedColumnsAreReadInTheOrderThatIsStated) {
  TraceOptions options;
  for (const std::string names : {"q0,q1,q2,q3", "q1,q2,q3,q4", "quat_0,quat_1,quat_2,quat_3"}) {
    const std::string text = "t,x,y,z," + names + "\n0,0,0,0,1,0,0,0\n1,0,0,0,1,0,0,0\n";
    expect_refused(text, "line 1", "say it by /trace/quaternion_order: wxyz or xyzw");
    options.quaternion_order = QuaternionOrder::wxyz;
    EXPECT_EQ(read(text, options).samples[0].orientation.coeffs(), Vec4(0, 0, 0, 1)) << names;
    options.quaternion_order = QuaternionOrder::xyzw;
    EXPECT_EQ(read(text, options).samples[0].orientation.coeffs(), Vec4(1, 0, 0, 0)) << names;
  }
  expect_refused("t,x,y,z,q0,q1,q2\n0,0,0,0,1,0,0\n", "line 1", "a quaternion of 3 numbered columns",
                 options);
}

// The device's tip looks along its x, the scene's tool along z: a quarter turn about y takes z to x. The
// device's quarter turn about z takes that tip on to y.
TEST(RecordingOrientations, MayHaveATipAlongAnotherAxis) {
  TraceOptions options;
  options.device_to_world.tool_rotation = Quat(std::sqrt(0.5), 0, std::sqrt(0.5), 0);
  const std::string half = "0.70710678118654752";
  const Trace trace =
      read("t,x,y,z,qx,qy,qz,qw\n0,1,2,3,0,0," + half + "," + half + "\n1,1,2,3,0,0,0,1\n", options);
  EXPECT_NEAR((turned(trace, Vec3::UnitZ()) - Vec3::UnitY()).norm(), 0.0, 1e-15);
  EXPECT_NEAR((trace.samples[1].orientation * Vec3::UnitZ() - Vec3::UnitX()).norm(), 0.0, 1e-15);
  EXPECT_EQ(trace.samples[0].position, Vec3(1, 2, 3));
}

// 20 mm/s at 1 kHz: a new millimetre every 50 samples, 49 of 50 repeat.
TEST(RecordingSteps, OfACoarseSensorAreSaid) {
  const auto time = [](int i) { return 0.001 * i; };
  const Trace trace = read(make_rows("t,x,y,z", 2000, time, [](int i) { return 0.001 * (i / 50); }));
  ASSERT_EQ(trace.notes.size(), 1U);
  EXPECT_NE(trace.notes[0].find("places are in steps of 1 mm: while it moves, 98 % of the samples repeat"),
            std::string::npos)
      << trace.notes[0];
  EXPECT_NE(trace.notes[0].find("/hand/kind to simulated"), std::string::npos);
}

// 100 Hz written at 1 kHz: each place ten times, 90 % repeat; a place in the turn is held as long.
TEST(RecordingSteps, OfPlacesThatAreHeldAreSaid) {
  const auto time = [](int i) { return 0.001 * i; };
  const auto held = [](int i) { return 0.01 * std::sin(0.05 * (i / 10)); };
  const Trace trace = read(make_rows("t,x,y,z", 2000, time, held));
  ASSERT_EQ(trace.notes.size(), 1U);
  EXPECT_NE(
      trace.notes[0].find("places are held for 10 samples (median): while it moves, 90 % of the samples"),
      std::string::npos)
      << trace.notes[0];
}

TEST(RecordingSteps, AreNotSaidOfFineMotionsAndOfRest) {
  const auto time = [](int i) { return 0.001 * i; };
  EXPECT_TRUE(read(make_rows("t,x,y,z", 2000, time, still)).notes.empty());
  EXPECT_TRUE(read(make_rows("t,x,y,z", 2000, time, [](int i) {
                return 1e-6 * std::round(1e4 * std::sin(0.003 * i));
              })).notes.empty());
  // 1 mm/s to whole micrometres, half of the samples repeat; presses with rests between them.
  EXPECT_TRUE(read(make_rows("t,x,y,z", 2000, time, [](int i) { return 1e-6 * (i / 2); })).notes.empty());
  EXPECT_TRUE(read(make_rows("t,x,y,z", 8000, time, [](int i) {
                return 0.01 * std::min(1.0, 0.005 * (i % 1000));
              })).notes.empty());
}

}  // namespace
}  // namespace argil::device
