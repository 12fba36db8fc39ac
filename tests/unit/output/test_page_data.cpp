// The numbers of a page: which frames it shows, and what a reader of its block gets back.
#include "output/page_data.h"

#include <gtest/gtest.h>

#include <cstring>

#include "base/error.h"
#include "output/html_page.h"
#include "records.h"
#include "support/temp_folder.h"

namespace argil::output {
namespace {

using argil::test::TempFolder;

std::vector<FrameInfo> make_frames(int count) {
  std::vector<FrameInfo> frames;
  for (int i = 0; i < count; ++i) frames.push_back({std::to_string(i), 10 * i, 0.01 * i, ""});
  return frames;
}

std::vector<Tick> ticks_of(const std::vector<FrameInfo>& frames) {
  std::vector<Tick> ticks;
  for (const FrameInfo& frame : frames) ticks.push_back(frame.tick);
  return ticks;
}

TEST(ChooseFrames, KeepsAllThatFit) {
  EXPECT_EQ(choose_frames(make_frames(5), 5, 0).size(), 5U);
}

TEST(ChooseFrames, KeepsFirstLastAndEqualDistances) {
  EXPECT_EQ(ticks_of(choose_frames(make_frames(101), 5, 500)), (std::vector<Tick>{0, 250, 500, 750, 1000}));
}

TEST(ChooseFrames, PutsTheFrameOfTheWantedTickInPlaceOfTheNearest) {
  EXPECT_EQ(ticks_of(choose_frames(make_frames(101), 5, 604)), (std::vector<Tick>{0, 250, 600, 750, 1000}));
}

TEST(ChooseFrames, OfTwoKeepsFirstAndLast) {
  EXPECT_EQ(ticks_of(choose_frames(make_frames(101), 2, 604)), (std::vector<Tick>{0, 1000}));
}

template <class T>
std::vector<T> read_section(const PageBlock& block, const std::string& name) {
  for (const PageSection& section : block.sections())
    if (section.name == name) {
      std::vector<T> values(section.length);
      std::memcpy(values.data(), block.bytes().data() + section.offset, section.length * sizeof(T));
      return values;
    }
  ADD_FAILURE() << "no section " << name;
  return {};
}

TEST(AddForce, GivesTheRangeOfAsManyTicksAsDoNotFit) {
  std::vector<sim::HapticRecord> records(8001);
  for (std::size_t i = 0; i < records.size(); ++i) {
    records[i].time = 0.001 * static_cast<double>(i);
    records[i].force = Vec3(0, 0, -static_cast<double>(i));  // its size is the tick's number
  }
  PageBlock block;
  ASSERT_EQ(add_force(block, records), 3U);  // 8001 over 4000, rounded up
  const std::vector<float> time = read_section<float>(block, "force_time");
  const std::vector<float> low = read_section<float>(block, "force_low");
  const std::vector<float> high = read_section<float>(block, "force_high");
  ASSERT_EQ(time.size(), 2667U);
  EXPECT_FLOAT_EQ(time[1], 0.003F);
  EXPECT_EQ(low[1], 3.0F);
  EXPECT_EQ(high[1], 5.0F);
  EXPECT_EQ(high.back(), 8000.0F);
}

TEST(AddForce, GivesTheBandOfTheEstimatedErrorOnlyWhereThereIsOne) {
  std::vector<sim::HapticRecord> records(3);
  for (sim::HapticRecord& record : records) record.force = Vec3(0, 0, 4);
  PageBlock without;
  add_force(without, records);
  for (const PageSection& section : without.sections()) EXPECT_NE(section.name, "error_low");
  records[1].error = {1.0, 0.25, -0.5, 0.125, 0.0};   // found too large by ½, or by ⅜ either way
  records[2].error = {0.5, 0.25, -1.0, 0.125, 0.25};  // too small by ½, or by ⅝ either way
  PageBlock block;
  add_force(block, records);
  EXPECT_EQ(read_section<float>(block, "error_low"), (std::vector<float>{4.0F, 3.125F, 3.375F}));
  EXPECT_EQ(read_section<float>(block, "error_high"), (std::vector<float>{4.0F, 4.375F, 5.125F}));
}

TEST(AddPath, GoesFromTheFirstTickToTheLast) {
  std::vector<sim::HapticRecord> records(8003);
  for (std::size_t i = 0; i < records.size(); ++i)
    records[i].tool_position = Vec3(static_cast<double>(i), 0.5, -1.0);
  PageBlock block;
  add_path(block, records);
  const std::vector<float> path = read_section<float>(block, "tool_path");
  ASSERT_EQ(path.size(), 3U * 2669U);  // every third of 8003, and tick 8002
  EXPECT_EQ(path[3], 3.0F);
  EXPECT_EQ(path[4], 0.5F);
  EXPECT_EQ(path[path.size() - 6], 8001.0F);
  EXPECT_EQ(path[path.size() - 3], 8002.0F);
  PageBlock empty;
  add_path(empty, {});
  EXPECT_TRUE(read_section<float>(empty, "tool_path").empty());
}

TEST(AddSurface, DifferencesAddUpToTheRoundedSkin) {
  const TempFolder folder;
  test::write_run(folder / "run.h5", 21, false);
  const ResultReader reader(folder / "run.h5");
  const SurfaceFrames surface(reader, false);
  PageBlock block;
  const PageSurface page = add_surface(block, surface, surface.frames());
  std::vector<std::uint16_t> position = read_section<std::uint16_t>(block, "position");
  const std::vector<std::uint16_t> at_rest = read_section<std::uint16_t>(block, "rest");
  const std::size_t row = 3 * static_cast<std::size_t>(surface.num_vertices());
  ASSERT_EQ(position.size(), 3 * row);
  for (std::size_t i = row; i < position.size(); ++i)
    position[i] = static_cast<std::uint16_t>(position[i] + position[i - row]);
  // records.h: the boundary's vertices are 0, 1, 2, 4 in the order 0 1 2, … of its triangles, all moved by
  // 0.001 times the tick.
  const Points rest = test::make_header(false).rest_position;
  const int vertices[] = {0, 2, 1, 4};
  for (std::size_t frame = 0; frame < 3; ++frame)
    for (std::size_t v = 0; v < 4; ++v)
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(at_rest[3 * v + k], position[3 * v + k]);  // the run begins at rest
        const double expected = rest(static_cast<int>(k), vertices[v]) + 0.01 * static_cast<double>(frame);
        const double seen = page.low(static_cast<int>(k)) + page.step * position[frame * row + 3 * v + k];
        EXPECT_NEAR(seen, expected, 0.5001 * page.step) << frame << ' ' << v << ' ' << k;
      }
}

// A static result has one frame, which is not at rest. A unit tet that is twice as large in it: its skin's
// vertex at (0.5, 0.5, 0.5)/2 of the deformed body was at half of that.
TEST(SurfaceFrames, RestsWhereTheMeshDoesThoughNoFrameDoes) {
  const TempFolder folder;
  for (const bool has_skin : {false, true}) {
    ResultHeader header = test::make_header(has_skin);
    {
      ResultFile file(folder / "run.h5", header);
      sim::Frame frame = test::make_frame(0, has_skin);
      frame.position = 2.0 * header.rest_position;
      if (has_skin) frame.skin_position = Points::Constant(3, 3, 0.25);
      file.append(frame);
      file.finish(std::nullopt);
    }
    const ResultReader reader(folder / "run.h5");
    const SurfaceFrames surface(reader, false);
    const Points expected = has_skin ? Points(Points::Constant(3, 3, 0.125))
                                     : Points(header.rest_position(Eigen::all, {0, 2, 1, 4}));
    EXPECT_LT((surface.rest_position() - expected).cwiseAbs().maxCoeff(), 1e-15);
  }
}

TEST(WriteHtml, SaysWhatEndedAFailedRun) {
  const TempFolder folder;
  {
    ResultFile file(folder / "run.h5", test::make_header());
    test::append_run(file, 0, 1);
    file.finish(Failure{20, "solid", 3, "volume ratio", -0.5, 0.0});
  }
  const std::string viewer = folder.write("viewer.html", "<!-- argil:data -->");
  const std::vector<std::string> notes = write_html(folder / "run.h5", folder / "page.html", {viewer});
  EXPECT_EQ(notes.front(), "Shows its 1 frame");
  EXPECT_NE(TempFolder::read(folder / "page.html")
                .find("run failed: tick 20, solid: volume ratio is -0.5, bound 0, element 3"),
            std::string::npos);
}

TEST(WriteHtml, RefusesAViewerWithoutAPlaceForData) {
  const TempFolder folder;
  test::write_run(folder / "run.h5", 11);
  const std::string viewer = folder.write("viewer.html", "<html></html>");
  ARGIL_EXPECT_THROW_WITH(write_html(folder / "run.h5", folder / "page.html", {viewer}), InputError,
                          "run scripts/build_viewer again");
}

TEST(WriteHtml, RefusesAResultWithoutFrames) {
  const TempFolder folder;
  test::write_run(folder / "run.h5", 0);
  const std::string viewer = folder.write("viewer.html", "<!-- argil:data -->");
  ARGIL_EXPECT_THROW_WITH(write_html(folder / "run.h5", folder / "page.html", {viewer}), InputError,
                          "/frames: has no frames");
}

TEST(WriteHtml, SaysWhyItCannotWrite) {
  const TempFolder folder;
  test::write_run(folder / "run.h5", 11, false);
  const std::string viewer = folder.write("viewer.html", "<!-- argil:data -->");
  ARGIL_EXPECT_THROW_WITH(write_html(folder / "run.h5", "/dev/full", {viewer}), IoError, "No space left");
}

}  // namespace
}  // namespace argil::output
