// The summary for a person names what the records hold. Numbers worked out by hand from records.h.
#include "output/info.h"

#include <gtest/gtest.h>

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
    file.append_timing({{"total_s", 12.5}});
    file.finish(Failure{20, "solid", 3, "volume ratio", -0.5, 0.0});
  }
  const std::string text = describe_result(folder / "r.h5");
  for (const std::string words :
       {"failed: tick 20, solid: volume ratio is -0.5, bound 0, element 3", "5 vertices, 2 tets",
        "skin of 1 triangles", "1 × 1 × 1 m", "21 ticks of 0.001 s, 0.02 s",
        // ‖(1/23, 2, 60)‖ = 60.0333…
        "peak force  60.0333 N at 0.02 s (device 10 N)",
        "contact     18 ticks; modes push 6 pull 5 wet 5 dry 5", "physics     11 steps",
        "5 kg after the first step, 25 kg at the end; added 26 kg, removed 27 kg",
        "frames      3, last at tick 20", "total_s: 12.5 s"})
    EXPECT_NE(text.find(words), std::string::npos) << words << "\nin\n" << text;
}

TEST(DescribeResult, DescribesARunThatHasNothingYet) {
  const TempFolder folder;
  { const ResultFile file(folder / "r.h5", test::make_header()); }
  const std::string text = describe_result(folder / "r.h5");
  EXPECT_NE(text.find("not finished"), std::string::npos) << text;
  EXPECT_NE(text.find("0 ticks"), std::string::npos) << text;
}

}  // namespace
}  // namespace argil::output
