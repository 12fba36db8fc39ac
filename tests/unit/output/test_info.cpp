// The summary for a person names what the records hold. Numbers worked out by hand from records.h.
#include "output/info.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "output/text.h"
#include "records.h"
#include "support/temp_folder.h"

namespace argil::output {
namespace {

using argil::test::TempFolder;

TEST(DescribeResult, NamesOutcomeBodyPeakForceWaterAndTiming) {
  const TempFolder folder;
  {
    ResultFile file(folder / "r.h5", test::make_header());
    test::append_run(file, 0, 21);
    file.append_timing({{"water", 0.25}, {"total", 12.5}, {"cpu", 20.0}, {"solve", 9.0}});
    file.finish(Failure{20, "solid", 3, "volume ratio", -0.5, 0.0});
  }
  const std::string text = describe_result(ResultReader(folder / "r.h5"));
  for (const std::string words :
       {"failed: tick 20, solid: volume ratio is -0.5, bound 0, element 3", "5 vertices, 2 tets",
        "skin of 1 triangles", "1 m × 1 m × 1 m", "20 ms: 21 ticks of 1 ms, push 6, pull 5, wet 5, dry 5",
        // ‖(1/23, 2, 60)‖ = 60.0333…; tick 20 pushes; its torque is ‖(2, 0.2, 0.3)‖ = 2.0322…
        "peak force  60.03 N on the hand at 20 ms (push), 10 N as the device gives it, torque 2.032 N m",
        "contact     in 18 ticks; the oldest force was 13 ticks old; the device's limits acted in 19",
        "force error estimated 9.812 N at the peak: mesh 10 N, step 250 mN, contact -2.5 N, solver 2 N, left "
        "out 62.5 mN",
        "physics     11 steps", "a tet shrank to 50 % of its volume at worst; plastic strain up to 12.5 %",
        "kinetic 21 J, elastic 22 J; since the start dissipated by flow 23 J, given by contact 24 J",
        "5 kg after the first step, 25 kg at the end; the tool gave 26 kg and took 27 kg",
        "frames      3, last at tick 20", "12.5 s of wall clock, 625 times as long as the motion",
        "of it       solve 9 s, water 250 ms\n", "cpu         20 s of all processors together"})
    EXPECT_NE(text.find(words), std::string::npos) << words << "\nin\n" << text;
  EXPECT_EQ(text.find("\nleft out"), std::string::npos) << text;  // it computed all of the model
}

// Of five steps two sleep and one coasts. The second comes nearest to its bound, with an estimate that is not
// the largest.
TEST(DescribeResult, SaysWhatWasLeftOutAndHowNearToTheBound) {
  const TempFolder folder;
  ResultHeader header = test::make_header();
  header.fidelity = sim::FidelityMode::check;
  {
    ResultFile file(folder / "r.h5", header);
    const std::array<sim::FidelityRecord, 5> steps = {{{sim::Rung::asleep, 0.0, 0.0, 0.0, 0.0},
                                                       {sim::Rung::asleep, 0.02, 0.015, 0.004, 0.0},
                                                       {sim::Rung::coasting, 0.1, 0.05, 0.006, 0.01},
                                                       {sim::Rung::solved, 0.1, 0.0, 0.0, 0.07},
                                                       {sim::Rung::solved, 0.2, 0.0, 0.0, 0.05}}};
    for (std::size_t i = 0; i < steps.size(); ++i) {
      sim::PhysicsRecord record = test::make_physics(static_cast<Tick>(i));
      record.fidelity = steps[i];
      file.append(record);
    }
    file.finish(std::nullopt);
  }
  const std::string text = describe_result(ResultReader(folder / "r.h5"));
  EXPECT_NE(
      text.find("left out    2 of 5 steps asleep, 1 coasting; estimate at most 15 mN of bound 20 mN, error "
                "beside a full run at most 6 mN; large strain 7 %\n"),
      std::string::npos)
      << text;
}

TEST(WithPrefix, KeepsFourDigitsBetweenOneAndAThousand) {
  EXPECT_EQ(with_prefix(0.0021534, "N"), "2.153 mN");
  EXPECT_EQ(with_prefix(-1500.0, "g"), "-1.5 kg");
  EXPECT_EQ(with_prefix(999.97, "m"), "1 km");
  EXPECT_EQ(with_prefix(1.0, "m"), "1 m");
  EXPECT_EQ(with_prefix(1e-3, "s"), "1 ms");
  EXPECT_EQ(with_prefix(3e-11, "J"), "30 pJ");
  EXPECT_EQ(with_prefix(3e-14, "J"), "3e-14 J");  // no prefix would shorten it
  EXPECT_EQ(with_prefix(3e12, "Pa"), "3000 GPa");
  EXPECT_EQ(with_prefix(0.0, "J"), "0 J");
  EXPECT_EQ(with_prefix(std::nan(""), "J"), "nan J");
}

TEST(DescribeResult, DescribesARunThatHasNothingYet) {
  const TempFolder folder;
  { const ResultFile file(folder / "r.h5", test::make_header()); }
  const std::string text = describe_result(ResultReader(folder / "r.h5"));
  EXPECT_NE(text.find("not finished"), std::string::npos) << text;
  EXPECT_NE(text.find("0 ticks"), std::string::npos) << text;
}

}  // namespace
}  // namespace argil::output
