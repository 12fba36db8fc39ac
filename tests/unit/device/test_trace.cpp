// Reading of traces: what is accepted, what is refused and with which words. Values by hand.
#include "device/trace.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/hash.h"
#include "support/temp_folder.h"

namespace argil::device {
namespace {

using test::TempFolder;

Trace read(const std::string& text, const TraceOptions& options = {}) {
  const TempFolder folder;
  return read_trace(folder.write("trace.csv", text), options);
}

void expect_refused(const std::string& text, const std::string& place, const std::string& problem,
                    const TraceOptions& options = {}) {
  ARGIL_EXPECT_THROW_WITH(read(text, options), InputError, "trace.csv: " + place);
  ARGIL_EXPECT_THROW_WITH(read(text, options), InputError, problem);
}

TEST(ReadTraceCsv, TakesTheColumnsByTheirNamesInAnyOrder) {
  const Trace trace = read("qw,z,y,x,mode,qx,qy,qz,t\n1,3,2,1,wet,0,0,0,0.5\n0,6,5,4,3,0,1,0,0.75\n");
  ASSERT_EQ(trace.samples.size(), 2U);
  EXPECT_EQ(trace.time[0], 0.5);
  EXPECT_EQ(trace.duration(), 0.25);
  EXPECT_EQ(trace.samples[0].position, Vec3(1, 2, 3));
  EXPECT_EQ(trace.samples[1].position, Vec3(4, 5, 6));
  EXPECT_EQ(trace.samples[1].orientation.coeffs(), Vec4(0, 1, 0, 0));
  EXPECT_EQ(trace.samples[0].mode, ToolMode::wet);
  EXPECT_EQ(trace.samples[1].mode, ToolMode::dry);
}

TEST(ReadTraceCsv, WithoutOrientationAndModeTakesNoRotationAndTheDefaultMode) {
  TraceOptions options;
  options.default_mode = ToolMode::pull;
  const Trace trace = read("t,x,y,z\n0,1,2,3\n1,4,5,6\n", options);
  EXPECT_EQ(trace.samples[1].orientation.coeffs(), Vec4(0, 0, 0, 1));
  EXPECT_EQ(trace.samples[1].mode, ToolMode::pull);
}

TEST(ReadTraceCsv, UnderstandsQuotesBlanksLineEndsAndAByteOrderMark) {
  const Trace trace = read("\xEF\xBB\xBF\"t\", x ,y,\"z\"\r\n0,1,2,+3\r\n\r\n\"1\",4,5,6e-1");
  EXPECT_EQ(trace.samples[0].position, Vec3(1, 2, 3));
  EXPECT_EQ(trace.samples[1].position, Vec3(4, 5, 0.6));
}

TEST(ReadTraceCsv, SaysWhichColumnsItLeftOut) {
  const Trace trace = read("t,x,y,z,vx,force\n0,1,2,3,9,9\n1,4,5,6,9,9\n");
  EXPECT_EQ(trace.ignored_columns, (std::vector<std::string>{"vx", "force"}));
}

TEST(ReadTraceCsv, TakesTheRateWhenThereIsNoTime) {
  TraceOptions options;
  options.default_rate_hz = 4.0;
  EXPECT_EQ(read("x,y,z\n0,0,0\n1,0,0\n2,0,0\n", options).time, (std::vector<double>{0.0, 0.25, 0.5}));
  EXPECT_EQ(read("# argil-trace: 1\n# rate_hz: 2\nx,y,z\n0,0,0\n1,0,0\n", options).time,
            (std::vector<double>{0.0, 0.5}));
  expect_refused("x,y,z\n0,0,0\n1,0,0\n", "no time column", "rate in Hz");
}

TEST(ReadTraceCsv, AppliesUnitHeaderTransformAndScenarioTransformInThisOrder) {
  TraceOptions options;
  options.device_to_world.translation = Vec3(0, 0, 1);
  // 100 cm along x = 1 m; scaled to 2 m, turned by 90° about z to (0, 2, 0), moved by (1, 0, 0), then by (0,
  // 0, 1).
  const Trace trace = read(
      "# argil-trace: 1\n# device: hand\n# units: cm\n# device_to_world_scale: 2\n"
      "# device_to_world_rotation_xyzw: 0 0 0.70710678118654752 0.70710678118654752\n"
      "# device_to_world_translation_m: 1 0 0\nt,x,y,z,qx,qy,qz,qw\n0,100,0,0,0,0,0,1\n1,100,0,0,1,0,0,0\n",
      options);
  EXPECT_EQ(trace.device, "hand");
  EXPECT_NEAR((trace.samples[0].position - Vec3(1, 2, 1)).norm(), 0.0, 1e-15);
  // The tool's x axis turned by 90° about the world's z axis points along y.
  EXPECT_NEAR((trace.samples[0].orientation * Vec3::UnitX() - Vec3::UnitY()).norm(), 0.0, 1e-15);
  EXPECT_NEAR((trace.samples[1].orientation * Vec3::UnitX() - Vec3::UnitY()).norm(), 0.0, 1e-15);
  EXPECT_NEAR((trace.samples[1].orientation * Vec3::UnitZ() + Vec3::UnitZ()).norm(), 0.0, 1e-15);
}

TEST(ReadTraceCsv, NormalisesWhatIsUnitWithinPrintedDigits) {
  const Trace trace = read("t,x,y,z,qx,qy,qz,qw\n0,0,0,0,0.7071,0,0,0.7071\n1,0,0,0,0,0,0,1\n");
  EXPECT_NEAR(trace.samples[0].orientation.norm(), 1.0, 1e-15);
  EXPECT_NEAR(trace.samples[0].orientation.x(), std::sqrt(0.5), 1e-15);
}

TEST(ReadTraceCsv, HashesTheFile) {
  const std::string text = "t,x,y,z\n0,1,2,3\n1,4,5,6\n";
  EXPECT_EQ(read(text).sha256, Sha256().add(text).hex_digest());
}

TEST(ReadTraceCsv, ColumnsNamedByTheUserReplaceTheHeaderRow) {
  TraceOptions options;
  options.columns = {"t", "-", "x", "y", "z", "", "qw", "qx", "qy", "qz"};
  const std::string rows = "0,9,1,2,3,9,0,1,0,0,9\n1,9,4,5,6,9,1,0,0,0,9\n";
  for (const std::string& text : {rows, "a,b,c,d,e,f,g,h,i,j,k\n" + rows}) {
    const Trace trace = read(text, options);
    ASSERT_EQ(trace.samples.size(), 2U);
    EXPECT_EQ(trace.samples[0].position, Vec3(1, 2, 3));
    EXPECT_EQ(trace.samples[0].orientation.coeffs(), Vec4(1, 0, 0, 0));
    EXPECT_EQ(trace.samples[1].orientation.coeffs(), Vec4(0, 0, 0, 1));
  }
}

TEST(ReadTraceCsv, RefusesQuaternionColumnsThatDoNotSayWhichIsTheScalar) {
  expect_refused("t,x,y,z,q0,q1,q2,q3\n0,0,0,0,0,0,0,1\n1,0,0,0,0,0,0,1\n", "line 1", "scalar part");
}

TEST(ReadTraceCsv, RefusesBadTimesByLine) {
  expect_refused("t,x,y,z\n0,0,0,0\n2,0,0,0\n1,0,0,0\n", "line 4", "1 s does not come after 2 s");
  expect_refused("t,x,y,z\n0,0,0,0\n1,0,0,0\n1,0,0,0\n", "line 4", "does not come after");
  expect_refused("t,x,y,z\n0,0,0,0\nnan,0,0,0\n2,0,0,0\n", "line 3, column 1", "'nan' is not finite");
}

TEST(ReadTraceCsv, RefusesAPauseOfMoreThanTenLongMedianIntervalsAndAcceptsOneOfTen) {
  const std::string start = "t,x,y,z\n0,0,0,0\n1,0,0,0\n2,0,0,0\n3,0,0,0\n";
  EXPECT_EQ(read(start + "13,0,0,0\n").samples.size(), 5U);
  expect_refused(start + "13.01,0,0,0\n", "line 6", "pause of 10.01 s");
}

TEST(ReadTraceCsv, RefusesAPlaceBeyondAKilometreByItsLine) {
  EXPECT_EQ(read("t,x,y,z\n0,0,0,0\n1,1000,0,0\n").samples.size(), 2U);
  for (const std::string far : {"1000.1", "-1e155", "1e308"})
    expect_refused("t,x,y,z\n0,0,0,0\n1,0," + far + ",0\n", "line 3", "m from the origin, more than 1000 m");
  expect_refused("# argil-trace: 1\n# units: mm\nt,x,y,z\n0,0,0,0\n1,0,2000000,0\n", "line 5",
                 "place 2000 m from the origin");
  // Infinite in the world, and no number once it is turned.
  expect_refused("# argil-trace: 1\n# device_to_world_scale: 1e308\nt,x,y,z\n0,0,0,0\n1,0,20,0\n", "line 5",
                 "m from the origin");
}

TEST(ReadTraceCsv, RefusesBadNumbersByLineAndColumn) {
  expect_refused("t,x,y,z\n0,0,0,0\n1,0,oops,0\n", "line 3, column 3", "'oops' is not a number");
  expect_refused("t,x,y,z\n0,0,0,0\n1,0,1.5m,0\n", "line 3, column 3", "'1.5m' is not a number");
  expect_refused("t,x,y,z\n0,0,0,0\n1,0,0,inf\n", "line 3, column 4", "'inf' is not finite");
  expect_refused("t,x,y,z\n0,0,0,0\n1,0,,0\n", "line 3, column 3", "'' is not a number");
  expect_refused("t,x,y,z\n0,0,0,0\n1,0,0\n", "line 3", "3 fields, not 4");
  expect_refused("t,x,y,z\n0,0,0,0\n1,0,\"0,0\n", "line 3", "quoted field is not closed");
}

TEST(ReadTraceCsv, RefusesBadQuaternionsByLine) {
  const std::string start = "t,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n";
  expect_refused(start + "1,0,0,0,0,0,0,0\n", "line 3", "quaternion is zero");
  expect_refused(start + "1,0,0,0,0,0,0,1.0011\n", "line 3", "norm 1.0011");
  expect_refused(start + "1,0,0,0,1e300,1e300,0,0\n", "line 3", "norm 1.41421356e+300");
  EXPECT_EQ(read(start + "1,0,0,0,0,0,0,1.0009\n").samples[1].orientation.w(), 1.0);
}

TEST(ReadTraceCsv, RefusesUnknownModes) {
  for (const std::string mode : {"poke", "4", "-1", "0.5", "nan", ""})
    expect_refused("t,x,y,z,mode\n0,0,0,0,push\n1,0,0,0," + mode + "\n", "line 3, column 5",
                   "mode '" + mode + "'");
}

TEST(ReadTraceCsv, RefusesMissingOrDoubleColumns) {
  expect_refused("t,x,y\n0,0,0\n1,0,0\n", "line 1", "no columns x, y, z");
  expect_refused("t,x,y,z,px\n0,0,0,0,0\n1,0,0,0,0\n", "line 1", "two columns for 'px'");
  expect_refused("t,x,y,z,qx,qy,qz\n0,0,0,0,0,0,0\n", "line 1", "some but not all");
  expect_refused("t|x|y|z\n0|0|0|0\n", "line 1", "no columns x, y, z among 't|x|y|z'");
}

TEST(ReadTraceCsv, RefusesFewerThanTwoSamples) {
  expect_refused("t,x,y,z\n", "0 samples", "two or more");
  expect_refused("t,x,y,z\n0,0,0,0\n", "1 samples", "two or more");
  expect_refused("", "0 samples", "two or more");
}

TEST(ReadTraceCsv, ReadsItsOwnHeaderStrictlyAndForeignCommentsNotAtAll) {
  const std::string body = "t,x,y,z\n0,0,0,0\n1,0,0,0\n";
  EXPECT_EQ(read("# made by hand, rate: high\n" + body).samples.size(), 2U);
  expect_refused("# argil-trace: 2\n" + body, "line 1", "format version '2'");
  expect_refused("# argil-trace: 1\n# devise: hand\n" + body, "line 2", "unknown header key 'devise'");
  expect_refused("# argil-trace: 1\n# units: inch\n" + body, "line 2", "'inch'");
  expect_refused("# argil-trace: 1\n# device_to_world_scale: 0\n" + body, "line 2", "scale 0");
  expect_refused("# argil-trace: 1\n# device_to_world_translation_m: 1 2\n" + body, "line 2",
                 "not 3 finite numbers");
  expect_refused("# argil-trace: 1\n# device_to_world_rotation_xyzw: 0 0 0 2\n" + body, "line 2",
                 "not of unit length");
  expect_refused("# argil-trace: 1\n# rate_hz: 1000\n" + body, "header", "median interval is 1 s");
}

TEST(ReadTraceCsv, RefusesABodyThatWasChangedAfterItWasHashed) {
  const std::string body = "t,x,y,z\n0,0,0,0\n1,0,0,0\n";
  const std::string header = "# argil-trace: 1\n# sha256: " + Sha256().add(body).hex_digest() + "\n";
  EXPECT_EQ(read(header + body).samples.size(), 2U);
  expect_refused(header + "t,x,y,z\n0,0,0,0\n1,0,0,1\n", "header", "the file was changed");
}

TEST(ReadTrace, NamesAFileThatCannotBeRead) {
  ARGIL_EXPECT_THROW_WITH(read_trace("/nowhere/t.csv", {}), IoError,
                          "/nowhere/t.csv: cannot be read: No such file");
  ARGIL_EXPECT_THROW_WITH(read_trace("/tmp", {}), IoError, "/tmp: cannot be read: Is a directory");
}

}  // namespace
}  // namespace argil::device
