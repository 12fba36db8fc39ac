// Frames: what is stored once, what is rounded, and what never is.
#include "output/frame_writer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "output/result_reader.h"
#include "records.h"
#include "support/temp_folder.h"

namespace argil::output {
namespace {

using argil::test::TempFolder;

constexpr int kTets = 5000;  // fields of 40 kB: compressed
constexpr int kSkin = 2000;  // and positions of 48 kB

/// Beyond the small run of records.h: arrays that are large enough to be compressed, no two values alike.
sim::Frame make_large_frame(Tick tick) {
  sim::Frame frame = test::make_frame(tick);
  const double t = static_cast<double>(tick);
  frame.position = Points::NullaryExpr(
      3, kSkin, [&](auto i, auto j) { return 1.0 / (3.0 + static_cast<double>(i + 3 * j) + t); });
  frame.saturation = Field::LinSpaced(kTets, 0.0, 1.0 / 3.0);
  frame.plastic_strain = TensorField::NullaryExpr(
      6, kTets, [](auto i, auto j) { return 0.1 / static_cast<double>(1 + i + 7 * j); });
  frame.skin_position = frame.position;
  frame.skin_saturation = Field::LinSpaced(kSkin, 0.1, 0.3);
  frame.skin_influence = Field::Constant(kSkin, t);
  return frame;
}

ResultHeader make_large_header(FramePrecision precision) {
  ResultHeader header = test::make_header();
  header.rest_position = make_large_frame(0).position;
  header.tets = Tets::Zero(4, kTets);
  header.frame_precision = precision;
  return header;
}

hdf5::Dataset open(const hdf5::File& file, const std::string& path) {
  return file.root().open_dataset(path);
}

TEST(FrameWriter, StoresAnArrayThatEqualsTheLastFramesOnce) {
  const TempFolder folder;
  const std::string name = folder / "r.h5";
  {
    ResultFile file(name, test::make_header());
    test::append_run(file, 0, 31);  // four frames: saturation and plastic strain stay
    sim::Frame changed = test::make_frame(40);
    changed.saturation(1) = std::nextafter(changed.saturation(1), 1.0);
    file.append(changed);
    file.append(test::make_frame(50));
  }
  const hdf5::File file = hdf5::File::open_for_reading(name);
  const auto place = [&](const std::string& path) { return open(file, path).find_identity(); };
  for (const char* frame : {"1", "2", "3"}) {
    const std::string group = std::string("frames/00000") + frame;
    EXPECT_EQ(place(group + "/saturation"), place("frames/000000/saturation")) << frame;
    EXPECT_EQ(place(group + "/plastic_strain"), place("frames/000000/plastic_strain")) << frame;
    EXPECT_NE(place(group + "/position"), place("frames/000000/position")) << frame;
  }
  EXPECT_NE(place("frames/000004/saturation"), place("frames/000000/saturation"));  // by its last bit
  EXPECT_NE(place("frames/000005/saturation"), place("frames/000004/saturation"));
  EXPECT_EQ(open(file, "frames/000004/saturation").read<double>()[1], std::nextafter(0.75, 1.0));
  EXPECT_EQ(open(file, "frames/000005/saturation").read<double>()[1], 0.75);
  EXPECT_EQ(open(file, "frames/000003/saturation").read_text("units"), "1");
}

TEST(FrameWriter, GoesOnFromTheLastFrameOfAFileThatIsContinued) {
  const TempFolder folder;
  const std::string name = folder / "r.h5";
  {
    ResultFile file(name, test::make_header());
    test::append_run(file, 0, 41);
  }
  {
    ResultFile file(name, Tick{25}, 3, FramePrecision::whole);
    file.append(test::make_frame(30));
    file.finish(std::nullopt);
  }
  const hdf5::File file = hdf5::File::open_for_reading(name);
  EXPECT_EQ(file.root().open_group("frames").names().size(), 4U);
  EXPECT_EQ(open(file, "frames/000003/saturation").find_identity(),
            open(file, "frames/000000/saturation").find_identity());
  EXPECT_EQ(open(file, "frames/000003/saturation").read<double>(), (std::vector<double>{0.25, 0.75}));
}

TEST(FrameWriter, KeepsEveryBitOfTheCageAndTwentyFourOfLargeFields) {
  const TempFolder folder;
  const sim::Frame wanted = make_large_frame(0);
  for (const FramePrecision precision : {FramePrecision::single, FramePrecision::whole}) {
    const std::string name = folder / "r.h5";
    ResultFile file(name, make_large_header(precision));
    file.append(wanted);
    file.finish(std::nullopt);
    const ResultReader reader(name);
    const sim::Frame read = reader.read_frame(reader.read_frame_list().at(0));
    EXPECT_TRUE(read.position == wanted.position);
    const bool is_whole = precision == FramePrecision::whole;
    EXPECT_EQ(read.saturation == wanted.saturation, is_whole);
    EXPECT_EQ(read.plastic_strain == wanted.plastic_strain, is_whole);
    EXPECT_EQ(read.skin_position == wanted.skin_position, is_whole);
    // Half a step of 2^-24 of the power of two above the largest: of 1/3, 0.1 and 1/3 that is 1/2, 1/8, 1/2.
    EXPECT_LE((read.saturation - wanted.saturation).cwiseAbs().maxCoeff(), std::ldexp(1.0, -26));
    EXPECT_LE((read.plastic_strain - wanted.plastic_strain).cwiseAbs().maxCoeff(), std::ldexp(1.0, -28));
    EXPECT_LE((read.skin_position - wanted.skin_position).cwiseAbs().maxCoeff(), std::ldexp(1.0, -26));
  }
}

TEST(FrameWriter, KeepsForAPictureWhatTheFormatSays) {
  const TempFolder folder;
  const sim::Frame wanted = make_large_frame(0);
  ResultFile file(folder / "r.h5", make_large_header(FramePrecision::picture));
  file.append(wanted);
  file.finish(std::nullopt);
  const ResultReader reader(folder / "r.h5");
  const sim::Frame read = reader.read_frame(reader.read_frame_list().at(0));
  // Half a step, as above: 2^-22 for the cage, 2^-16 for the skin, 2^-12 for fields. Less would be too dear.
  const auto expect_bits = [](double error, double largest, int bits) {
    int exponent = 0;
    std::frexp(largest, &exponent);
    const double half_step = std::ldexp(0.5, exponent - bits);
    EXPECT_LE(error, half_step) << bits;
    EXPECT_GT(error, 0.9 * half_step) << bits;
  };
  expect_bits((read.position - wanted.position).cwiseAbs().maxCoeff(), 1.0 / 3.0, 22);
  expect_bits((read.skin_position - wanted.skin_position).cwiseAbs().maxCoeff(), 1.0 / 3.0, 16);
  expect_bits((read.saturation - wanted.saturation).cwiseAbs().maxCoeff(), 1.0 / 3.0, 12);
  expect_bits((read.plastic_strain - wanted.plastic_strain).cwiseAbs().maxCoeff(), 0.1, 12);
  EXPECT_EQ(read.state_hash, wanted.state_hash);
}

TEST(FrameWriter, MakesLargeFilesSmallerBySingleThanByDouble) {
  const TempFolder folder;
  const auto find_size = [&](FramePrecision precision) {
    ResultFile file(folder / "r.h5", make_large_header(precision));
    for (Tick tick = 0; tick < 10; ++tick) file.append(make_large_frame(tick));
    file.finish(std::nullopt);
    return std::filesystem::file_size(folder / "r.h5");
  };
  // Ten skins of 48 kB whose bits are half noise, half zero.
  EXPECT_LT(find_size(FramePrecision::single) + 150000, find_size(FramePrecision::whole));
}

TEST(RoundToBits, KeepsTheLargestAsSinglePrecisionDoesAndRepeatsItself) {
  std::vector<double> values{0.7, -0.1, 1e-9, -1e-9, 0.0, -0.0, std::ldexp(1.0, -24)};
  round_to_bits(values, 24);
  EXPECT_EQ(values[0], static_cast<double>(0.7F));
  EXPECT_NEAR(values[1], -0.1, std::ldexp(1.0, -25));
  EXPECT_EQ(values[2], 0.0);
  EXPECT_FALSE(std::signbit(values[3]) || std::signbit(values[5]));
  EXPECT_EQ(values[6], std::ldexp(1.0, -24));
  std::vector<double> again = values;
  round_to_bits(again, 24);
  EXPECT_EQ(again, values);
}

TEST(RoundToBits, LeavesWhatItCannotRound) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const std::vector<double>& values : {std::vector<double>{0.1, infinity},
                                            {0.1, -infinity},
                                            {1e-300, 3e-301},
                                            {0.1, 1e300},
                                            {0.0, 0.0},
                                            {}}) {
    std::vector<double> same = values;
    round_to_bits(same, 24);
    EXPECT_EQ(same, values);
  }
  std::vector<double> with_nan{0.1, std::numeric_limits<double>::quiet_NaN()};
  round_to_bits(with_nan, 24);
  EXPECT_EQ(with_nan[0], 0.1);
}

}  // namespace
}  // namespace argil::output
