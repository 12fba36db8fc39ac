// Packed results: every value reads as before, in less room.
#include "output/pack.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "base/error.h"
#include "output/compare.h"
#include "output/result_file.h"
#include "output/result_reader.h"
#include "records.h"
#include "support/temp_folder.h"

namespace argil::output {
namespace {

using argil::test::TempFolder;
namespace fs = std::filesystem;

constexpr int kTets = 5000;  // fields of 40 kB: compressed
constexpr int kSkin = 2000;  // and positions of 48 kB
constexpr int kFrames = 40;  // chunks of 16 frames: two, and a part

/// Of vertices in disorder one of a hundred moves from frame to frame; saturation changes at one frame alone.
sim::Frame make_pressed_frame(int number) {
  sim::Frame frame = test::make_frame(Tick{10} * number);
  const auto place = [&](int i, int j) { return 0.1 * std::sin(37.0 * j + i); };
  const auto moved = [&](int i, int j) { return j % 100 == 0 ? 1e-3 * std::sin(0.1 * number + i) : 0.0; };
  frame.position = Points::NullaryExpr(3, kSkin, [&](auto i, auto j) {
    return place(static_cast<int>(i), static_cast<int>(j)) + moved(static_cast<int>(i), static_cast<int>(j));
  });
  frame.saturation = Field::Constant(kTets, number < 7 ? 0.25 : 0.5);
  frame.plastic_strain = TensorField::NullaryExpr(6, kTets, [&](auto i, auto j) {
    return j < 5 * number ? 0.1 / static_cast<double>(1 + i + 7 * j) : 0.0;
  });
  frame.skin_position = frame.position;
  frame.skin_saturation = Field::Constant(kSkin, 0.1);
  frame.skin_influence = Field::Constant(kSkin, 0.0);
  return frame;
}

/// A run of `precision`; one that was interrupted is not packed. `later_skin`: vertices of the last ten
/// frames.
void write_run(const std::string& name, FramePrecision precision, bool is_interrupted,
               int later_skin = kSkin) {
  ResultHeader header = test::make_header();
  header.rest_position = make_pressed_frame(0).position;
  header.tets = Tets::Zero(4, kTets);
  header.frame_precision = precision;
  ResultFile file(name, header);
  for (int i = 0; i < kFrames; ++i) {
    sim::Frame frame = make_pressed_frame(i);
    if (i >= kFrames - 10) frame.skin_position.conservativeResize(3, later_skin);
    file.append(frame);
  }
  file.write_checkpoint({{"state", Eigen::MatrixXd::Constant(1000, 100, 0.5)}});  // 0.8 MB
  file.finish(std::nullopt, is_interrupted);
}

std::string read_bytes(const std::string& name) {
  std::ifstream file(name, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void expect_equal_frames(const std::string& a, const std::string& b) {
  const ResultReader first(a), second(b);
  const std::vector<FrameInfo> list = first.read_frame_list();
  ASSERT_EQ(list.size(), static_cast<std::size_t>(kFrames));
  for (const FrameInfo& info : list) {
    const sim::Frame x = first.read_frame(info), y = second.read_frame(info);
    EXPECT_TRUE(x.position == y.position && x.saturation == y.saturation) << info.name;
    EXPECT_TRUE(x.plastic_strain == y.plastic_strain && x.skin_position == y.skin_position) << info.name;
    EXPECT_TRUE(x.skin_saturation == y.skin_saturation && x.skin_influence == y.skin_influence) << info.name;
  }
}

TEST(Pack, KeepsEveryValueAndComparesEqual) {
  const TempFolder folder;
  for (const int later_skin : {kSkin, kSkin - 100}) {
    const FramePrecision precision = later_skin == kSkin ? FramePrecision::picture : FramePrecision::single;
    write_run(folder / "plain.h5", precision, true, later_skin);
    write_run(folder / "packed.h5", precision, false, later_skin);
    expect_equal_frames(folder / "plain.h5", folder / "packed.h5");
    const hdf5::File file = hdf5::File::open_for_reading(folder / "packed.h5");
    EXPECT_TRUE(file.root().open_dataset("frames/000020/position").is_view());
    const hdf5::Dataset array = file.root().open_dataset("frames/000020/skin_position");
    EXPECT_TRUE(array.is_view());
    EXPECT_EQ(array.read_text("units"), "m");
    CompareOptions options;  // one was interrupted and the other not: what they say of that alone differs
    for (const Difference& each :
         compare_results(folder / "plain.h5", folder / "packed.h5", options).differences)
      EXPECT_TRUE(each.object.starts_with("/ attribute")) << each.object << ": " << each.what;
  }
}

TEST(Pack, TakesTheRoomOfWhatChangesAndNoneOfTheCheckpoint) {
  const TempFolder folder;
  write_run(folder / "plain.h5", FramePrecision::picture, true);
  write_run(folder / "packed.h5", FramePrecision::picture, false);
  const auto size = [&](const char* name) { return fs::file_size(folder / name); };
  // 40 frames with two arrays of 6000 places of 16 and 22 bits each, of which deflate saves little; of the
  // packed ones three in 16 are new, and one place of a hundred.
  EXPECT_GT(size("plain.h5"), 800'000U + 40 * 6000 * (16 + 22) / 8);
  constexpr std::uintmax_t kMesh = 4 * 4 * kTets + 3 * 8 * kSkin;
  EXPECT_LT(size("packed.h5"), kMesh + 3 * 6000 * (16 + 22) / 8 + 40 * 10'000U);
}

TEST(Pack, KeepsWhatFramesShare) {
  const TempFolder folder;
  write_run(folder / "r.h5", FramePrecision::picture, false);
  const hdf5::File file = hdf5::File::open_for_reading(folder / "r.h5");
  const auto place = [&](const std::string& path) { return file.root().open_dataset(path).find_identity(); };
  EXPECT_EQ(place("frames/000006/saturation"), place("frames/000000/saturation"));
  EXPECT_NE(place("frames/000007/saturation"), place("frames/000006/saturation"));
  EXPECT_EQ(place("frames/000039/saturation"), place("frames/000007/saturation"));
  EXPECT_FALSE(file.root().open_dataset("frames/000000/skin_saturation").is_view());  // one for all frames
}

TEST(Pack, GivesEqualBytesForEqualRunsAndLeavesNothingBeside) {
  const TempFolder folder;
  write_run(folder / "a.h5", FramePrecision::picture, false);
  write_run(folder / "b.h5", FramePrecision::picture, false);
  EXPECT_EQ(read_bytes(folder / "a.h5"), read_bytes(folder / "b.h5"));
  EXPECT_EQ(std::distance(fs::directory_iterator(fs::path(folder / "a.h5").parent_path()), {}), 2);
}

TEST(Pack, LeavesAFileThatCannotBeCopiedAsItIs) {
  const TempFolder folder;
  write_run(folder / "r.h5", FramePrecision::picture, true);
  const std::string before = read_bytes(folder / "r.h5");
  fs::create_directories(folder / "r.h5.packing/taken");
  EXPECT_THROW(pack(folder / "r.h5"), IoError);
  try_to_pack(folder / "r.h5");
  EXPECT_EQ(read_bytes(folder / "r.h5"), before);
  fs::remove_all(folder / "r.h5.packing");
  pack(folder / "r.h5");
  EXPECT_LT(fs::file_size(folder / "r.h5"), before.size());
  EXPECT_THROW(pack(folder / "none.h5"), IoError);
}

TEST(Pack, OtherProgramsReadTheSame) {
  const TempFolder folder;
  write_run(folder / "plain.h5", FramePrecision::picture, true);
  write_run(folder / "packed.h5", FramePrecision::picture, false);
  const auto run = [](const std::string& command) { return std::system(command.c_str()); };
  if (run("/usr/bin/python3 -c 'import h5py, numpy' 2>/dev/null") == 0) {
    EXPECT_EQ(run("/usr/bin/python3 -c \"import h5py, sys; a, b = map(h5py.File, sys.argv[1:]); "
                  "sys.exit(any((a['frames'][n][k][...] != b['frames'][n][k][...]).any() "
                  "for n in a['frames'] for k in a['frames'][n]))\" '" +
                  folder / "plain.h5" + "' '" + folder / "packed.h5" + "'"),
              0);
  }
  const std::string pvbatch = std::string("'") + ARGIL_SOURCE_DIR + "/scripts/pvbatch' ";
  if (run(pvbatch + "--version > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "needs ParaView and its Python modules";
  for (const char* name : {"plain", "packed"})
    write_xdmf(folder / (std::string(name) + ".h5"), folder / (std::string(name) + ".xdmf"));
  const std::string script = std::string(ARGIL_SOURCE_DIR) + "/tests/unit/output/check_packed_in_paraview.py";
  EXPECT_EQ(
      run(pvbatch + "'" + script + "' '" + folder / "plain.xdmf" + "' '" + folder / "packed.xdmf" + "' 0.2"),
      0);
}

TEST(Pack, IsNotForFramesOfAllBits) {
  const TempFolder folder;
  write_run(folder / "r.h5", FramePrecision::whole, false);
  EXPECT_FALSE(ResultReader(folder / "r.h5").root().has("packed"));
}

}  // namespace
}  // namespace argil::output
