// A recorded motion is read back to the bit, by way of CSV and of HDF5; recordings of real hands are read
// whole.
#include "device/trace.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <sstream>

#include "base/error.h"
#include "base/rng.h"
#include "hdf5/file.h"
#include "support/shared_data.h"
#include "support/temp_folder.h"
#include "support/trace_csv.h"

namespace argil::device {
namespace {

using test::TempFolder;

Trace random_trace(int count) {
  Rng rng(11, "recorder");
  Trace trace;
  trace.device = "made up, by a test";
  for (int i = 0; i < count; ++i) {
    trace.time.push_back(i * 0.001);
    DeviceSample sample;
    sample.position = Vec3(rng.uniform(-1, 1), rng.uniform(-1e-300, 1e-300), i % 2 == 0 ? -0.0 : 1.0 / 3.0);
    sample.orientation = make_unit(Quat(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1), 0.5));
    sample.mode = static_cast<ToolMode>(i % kNumToolModes);
    trace.samples.push_back(sample);
  }
  return trace;
}

bool same_bits(const double* a, const double* b, std::size_t count) {
  return std::memcmp(a, b, count * sizeof(double)) == 0;
}

void expect_same_motion(const Trace& a, const Trace& b) {
  ASSERT_EQ(a.samples.size(), b.samples.size());
  EXPECT_EQ(a.time, b.time);
  for (std::size_t i = 0; i < a.samples.size(); ++i) {
    ASSERT_TRUE(same_bits(a.samples[i].position.data(), b.samples[i].position.data(), 3)) << i;
    ASSERT_TRUE(
        same_bits(a.samples[i].orientation.coeffs().data(), b.samples[i].orientation.coeffs().data(), 4))
        << i;
    ASSERT_EQ(a.samples[i].mode, b.samples[i].mode);
  }
}

TEST(ReadTraceCsv, ReadsSeventeenDigitsBackToTheBit) {
  const TempFolder folder;
  const Trace trace = random_trace(500);
  const Trace read = read_trace(folder.write("t.csv", test::print_trace_csv(trace, 1000.0)), {});
  expect_same_motion(trace, read);
  EXPECT_EQ(read.device, "made up, by a test");
}

TEST(ReadTraceCsv, ReadsARecordingThatWasNeverFinished) {
  const TempFolder folder;
  const Trace trace = random_trace(20);
  expect_same_motion(trace,
                     read_trace(folder.write("t.csv", test::print_trace_csv(trace, 1000.0, false)), {}));
}

TEST(ReadTraceCsv, RefusesAChangedRecording) {
  const TempFolder folder;
  std::string text = test::print_trace_csv(random_trace(20), 1000.0);
  text[text.size() - 3] ^= 1;
  ARGIL_EXPECT_THROW_WITH(read_trace(folder.write("u.csv", text), {}), InputError, "the file was changed");
}

// Writes a trace in HDF5 as its own groups or as the /haptic of a result file.
void write_hdf5(const std::string& file, const Trace& trace, const std::string& folder,
                const std::string& prefix) {
  std::vector<double> position;
  std::vector<double> orientation;
  std::vector<std::uint8_t> mode;
  for (const DeviceSample& sample : trace.samples) {
    position.insert(position.end(), sample.position.data(), sample.position.data() + 3);
    const Vec4 q = sample.orientation.coeffs();
    orientation.insert(orientation.end(), q.data(), q.data() + 4);
    mode.push_back(static_cast<std::uint8_t>(sample.mode));
  }
  const hdf5::File made = hdf5::File::create(file);
  const hdf5::Group group = folder.empty() ? made.root() : made.root().create_group(folder);
  const std::uint64_t rows = trace.time.size();
  group.write_array("time", trace.time.data(), {rows}, false, {"s", "-"});
  group.write_array(prefix + "position", position.data(), {rows, 3}, false, {"m", "-"});
  group.write_array(prefix + "orientation", orientation.data(), {rows, 4}, false, {"1", "-"});
  group.write_array("mode", mode.data(), {rows}, false, {"1", "-"});
}

TEST(ReadTraceHdf5, ReadsATraceFileAndAResultFileToTheBit) {
  const TempFolder folder;
  const Trace trace = random_trace(300);
  write_hdf5(folder / "t.h5", trace, "", "");
  expect_same_motion(trace, read_trace(folder / "t.h5", {}));
  write_hdf5(folder / "r.h5", trace, "haptic", "tool_");
  expect_same_motion(trace, read_trace(folder / "r.h5", {}));
}

// A result has the tool's places, to which the scenario's keys were applied when it was made.
TEST(ReadTraceHdf5, AResultIsNotPlacedAgain) {
  const TempFolder folder;
  const Trace trace = random_trace(50);
  write_hdf5(folder / "r.h5", trace, "haptic", "tool_");
  TraceOptions options;
  options.length_unit = LengthUnit::mm;
  options.time_unit = TimeUnit::ms;
  options.device_to_world.scale = 0.5;
  options.device_to_world.translation = Vec3(1, 2, 3);
  options.device_to_world.tool_rotation = Quat(0.0, 1.0, 0.0, 0.0);
  const Trace read = read_trace(folder / "r.h5", options);
  expect_same_motion(trace, read);
  EXPECT_TRUE(read.is_in_world);
  ASSERT_EQ(read.notes.size(), 1U);
  EXPECT_NE(read.notes[0].find("/trace/device_to_world are not applied to them again"), std::string::npos);
  EXPECT_TRUE(read_trace(folder / "r.h5", {}).notes.empty());
}

TEST(ReadTraceHdf5, AppliesUnitsAndTransform) {
  const TempFolder folder;
  const Trace trace = random_trace(4);
  write_hdf5(folder / "t.h5", trace, "", "");
  {
    const hdf5::File file = hdf5::File::open_for_writing(folder / "t.h5");
    file.root().open_dataset("position").write_attribute("units", "mm");
    file.root().write_attribute("device_to_world_scale", 2.0);
    file.root().write_attribute("device", "stylus");
  }
  const Trace read = read_trace(folder / "t.h5", {});
  EXPECT_EQ(read.device, "stylus");
  EXPECT_NEAR(read.samples[1].position.z(), 2.0 * 0.001 / 3.0, 1e-18);
}

TEST(ReadTraceHdf5, RefusesWrongShapesModesAndQuaternionsByRow) {
  const TempFolder folder;
  Trace trace = random_trace(5);
  trace.samples[3].mode = static_cast<ToolMode>(9);
  write_hdf5(folder / "mode.h5", trace, "", "");
  ARGIL_EXPECT_THROW_WITH(read_trace(folder / "mode.h5", {}), InputError, "mode, row 3: mode 9");
  trace = random_trace(5);
  trace.samples[2].orientation.coeffs().setZero();
  write_hdf5(folder / "zero.h5", trace, "", "");
  ARGIL_EXPECT_THROW_WITH(read_trace(folder / "zero.h5", {}), InputError, "row 2: quaternion is zero");
  trace = random_trace(5);
  trace.samples[4].position.x() = NAN;
  write_hdf5(folder / "nan.h5", trace, "", "");
  ARGIL_EXPECT_THROW_WITH(read_trace(folder / "nan.h5", {}), InputError, "row 4: position is not finite");
  trace = random_trace(5);
  trace.time.pop_back();
  write_hdf5(folder / "bare.h5", trace, "", "");
  hdf5::File::open_for_writing(folder / "bare.h5").root().remove("time");
  ARGIL_EXPECT_THROW_WITH(read_trace(folder / "bare.h5", {}), InputError, "has no time and position");
}

TEST(ReadTraceHdf5, RefusesArraysOfUnequalLength) {
  const TempFolder folder;
  const Trace trace = random_trace(5);
  write_hdf5(folder / "t.h5", trace, "", "");
  {
    const hdf5::File file = hdf5::File::open_for_writing(folder / "t.h5");
    file.root().remove("time");
    file.root().write_array("time", trace.time.data(), {4}, false, {"s", "-"});
  }
  ARGIL_EXPECT_THROW_WITH(read_trace(folder / "t.h5", {}), InputError,
                          "/position: does not have the shape 4 × 3");
}

TraceOptions robot_columns() {
  TraceOptions options;
  options.columns = {"t", "x", "y", "z", "-", "-", "-", "qw", "qx", "qy", "qz"};
  return options;
}

// The recordings also hold the angular velocity that the robot measured, in world axes: turning the
// quaternion by it must give the next one. This is what shows that the scalar comes first in these files.
TEST(RecordedHands, QuaternionsTurnAsTheRecordedAngularVelocitySays) {
  const std::string name = "traces/unscrewing_prim02_02.csv";  // has a sign flip
  ARGIL_NEED_SHARED_DATA(name);
  const Trace trace = read_trace(test::shared_data(name), robot_columns());
  TraceOptions velocity_columns;
  velocity_columns.columns = {"t", "", "", "", "", "", "", "", "", "", "", "x", "y", "z"};
  velocity_columns.length_unit = LengthUnit::m;  // else such places would be refused
  const Trace velocity = read_trace(test::shared_data(name), velocity_columns);
  ASSERT_EQ(trace.samples.size(), 1965U);
  double worst = 0.0;
  double travelled = 0.0;
  for (std::size_t i = 5; i + 5 < trace.samples.size(); ++i) {
    const double h = trace.time[i + 5] - trace.time[i - 5];
    Vec4 q = (trace.samples[i + 5].orientation * trace.samples[i - 5].orientation.conjugate()).coeffs();
    if (q[3] < 0.0) q = -q;
    const Vec3 turned = 2.0 * q.head<3>();  // rotation vector, to third order
    const Vec3 wanted = h * velocity.samples[i].position;
    worst = std::max(worst, (turned - wanted).norm());
    travelled = std::max(travelled, turned.norm());
  }
  EXPECT_GT(travelled, 0.05);
  EXPECT_LT(worst, 0.2 * travelled);
}

TEST(RecordedHands, InterpolateWithoutAJumpAcrossSignFlips) {
  for (int file = 1; file <= 6; ++file) {
    const std::string name = "traces/unscrewing_prim02_0" + std::to_string(file) + ".csv";
    ARGIL_NEED_SHARED_DATA(name);
    TraceOptions options = robot_columns();
    options.device_to_world.scale = 0.5;
    options.device_to_world.translation = Vec3(0, 0, 0.1);
    const Trace trace = read_trace(test::shared_data(name), options);
    DeviceSample last = trace.samples[0];
    for (double t = 0.0; t < trace.duration(); t += 0.001) {
      const DeviceSample now = interpolate(trace, t);
      ASSERT_LT(now.orientation.angularDistance(last.orientation), 0.02) << name << ' ' << t;  // 20 rad/s
      ASSERT_LT((now.position - last.position).norm(), 0.001) << name << ' ' << t;             // 1 m/s
      last = now;
    }
  }
}

// Nine motions of 1000 samples: x y z [cm], quaternion w x y z, no time. NumPy's format: a header of text,
// then doubles. q and −q are one rotation: with every third sign turned the motion must stay the same.
TEST(RecordedHands, WithoutTimesAreReadByARateAndDoNotDependOnTheQuaternionsSigns) {
  ARGIL_NEED_SHARED_DATA("traces/pouring.npy");
  const std::string bytes = TempFolder::read(test::shared_data("traces/pouring.npy"));
  constexpr std::size_t kNumbers = 9 * 1000 * 7;
  std::vector<double> values(kNumbers);
  std::memcpy(values.data(), bytes.data() + bytes.size() - kNumbers * sizeof(double),
              kNumbers * sizeof(double));
  TraceOptions options;
  options.columns = {"x", "y", "z", "qw", "qx", "qy", "qz"};
  options.default_rate_hz = 100.0;
  options.device_to_world.scale = 0.01;
  const TempFolder folder;
  const auto read = [&](std::size_t motion, std::size_t flip_every) {
    std::ostringstream text;
    text.precision(17);
    for (std::size_t i = 0; i < 7000; ++i) {
      const bool is_flipped = i % 7 >= 3 && (i / 7) % flip_every == 1;
      text << (is_flipped ? -1.0 : 1.0) * values[motion * 7000 + i] << (i % 7 == 6 ? '\n' : ',');
    }
    return read_trace(folder.write("m.csv", text.str()), options);
  };
  for (std::size_t motion = 0; motion < 9; ++motion) {
    const Trace trace = read(motion, 10000);
    const Trace flipped = read(motion, 3);
    ASSERT_EQ(trace.samples.size(), 1000U);
    EXPECT_NEAR(trace.samples[1].position.x(), 0.01 * values[motion * 7000 + 7], 1e-15);
    for (double t = 0.0; t < trace.duration(); t += 0.0031) {
      const Mat3 R = interpolate(trace, t).orientation.toRotationMatrix();
      ASSERT_NEAR((R - interpolate(flipped, t).orientation.toRotationMatrix()).norm(), 0.0, 1e-14)
          << motion << ' ' << t;
    }
  }
}

TEST(RecordedHands, AreRefusedWithoutSayingWhichColumnIsTheScalar) {
  ARGIL_NEED_SHARED_DATA("traces/unscrewing_prim02_01.csv");
  ARGIL_EXPECT_THROW_WITH(read_trace(test::shared_data("traces/unscrewing_prim02_01.csv"), {}), InputError,
                          "scalar part");
}

}  // namespace
}  // namespace argil::device
