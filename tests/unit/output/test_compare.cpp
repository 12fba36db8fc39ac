// The comparison must find every kind of difference: each test makes one on purpose.
#include "output/compare.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "base/error.h"
#include "hdf5/file.h"
#include "output/result_reader.h"
#include "records.h"
#include "support/temp_folder.h"

namespace argil::output {
namespace {

using argil::test::TempFolder;

/// Two equal runs, the second with records and frames changed on their way into the file.
struct Pair {
  TempFolder folder;
  std::string a = folder / "a.h5";
  std::string b = folder / "b.h5";
  std::function<void(sim::HapticRecord&)> change_haptic = [](sim::HapticRecord&) {};
  std::function<void(sim::Frame&)> change_frame = [](sim::Frame&) {};
  ResultHeader header_b = test::make_header();
  Tick ticks_b = 40;

  CompareReport compare(const CompareOptions& options = {}) const {
    test::write_run(a, 40);
    ResultFile file(b, header_b);
    for (Tick tick = 0; tick < ticks_b; ++tick) {
      sim::HapticRecord record = test::make_haptic(tick);
      change_haptic(record);
      file.append(record);
      if (tick % 2 == 0) file.append(test::make_physics(tick));
      sim::Frame frame = test::make_frame(tick);
      change_frame(frame);
      if (tick % 10 == 0) file.append(frame);
    }
    file.append_timing({{"total_s", static_cast<double>(ticks_b)}});
    file.finish(std::nullopt);
    return compare_results(a, b, options);
  }
};

TEST(CompareResults, FindsEqualRunsEqualAndIgnoresTiming) {
  const Pair pair;
  const CompareReport report = pair.compare();
  EXPECT_TRUE(report.is_equal()) << to_string(report);
  EXPECT_GT(report.num_compared, 60U);
  EXPECT_EQ(to_string(report).substr(0, 6), "equal:");
}

TEST(CompareResults, FindsOneChangedLastBitAndNamesTickAndDataset) {
  Pair pair;
  pair.change_haptic = [](sim::HapticRecord& record) {
    if (record.tick == 17) record.force.y() = std::nextafter(record.force.y(), 3.0);
  };
  const CompareReport report = pair.compare();
  ASSERT_EQ(report.differences.size(), 1U);
  EXPECT_EQ(report.differences[0].object, "/haptic/force");
  EXPECT_EQ(report.differences[0].tick, 17);
  EXPECT_EQ(report.differences[0].count, 1U);
  EXPECT_NE(to_string(report).find("first at tick 17 in /haptic/force"), std::string::npos)
      << to_string(report);
}

TEST(CompareResults, TellsMinusZeroFromZero) {
  Pair pair;
  pair.change_haptic = [](sim::HapticRecord& record) { record.device_force.y() = 0.0; };  // −0 in the first
  EXPECT_EQ(pair.compare().differences.at(0).count, 40U);
}

TEST(CompareResults, PutsTheEarliestTickFirst) {
  Pair pair;
  pair.change_haptic = [](sim::HapticRecord& record) {
    if (record.tick >= 30) record.force.x() = 7.0;
    if (record.tick >= 21) record.torque.x() = 7.0;
  };
  const CompareReport report = pair.compare();
  ASSERT_EQ(report.differences.size(), 2U);
  EXPECT_EQ(report.differences[0].object, "/haptic/torque");
  EXPECT_EQ(report.differences[0].tick, 21);
}

TEST(CompareResults, AcceptsDifferencesWithinAToleranceAndNoLarger) {
  Pair pair;
  pair.change_haptic = [](sim::HapticRecord& record) { record.force.y() = 2.0 + 0x1p-20; };
  CompareOptions options;
  options.tolerances = {{"/haptic/f*ce", 0.0, 0x1p-20}};
  EXPECT_TRUE(pair.compare(options).is_equal());
  options.tolerances = {{"/haptic/force", 0x1p-21, 0.0}};  // 2^-21 · 2 = 2^-20
  EXPECT_TRUE(pair.compare(options).is_equal());
  options.tolerances = {{"/haptic/force", 0x1p-22, 0.0}};
  EXPECT_FALSE(pair.compare(options).is_equal());
  options.tolerances = {{"/haptic/torque", 1.0, 1.0}};  // of another dataset
  EXPECT_FALSE(pair.compare(options).is_equal());
}

TEST(CompareResults, AcceptsAShareOfTheLargestValueOfItsDataset) {
  // Every force is (0.25 tick, 2, 3) or so; one component of one tick moves by 2^-8. The largest of 40 ticks
  // is known.
  Pair pair;
  pair.change_haptic = [](sim::HapticRecord& record) {
    if (record.tick == 0) record.force.y() += 0x1p-8;
  };
  double largest = 0.0;
  for (Tick tick = 0; tick < 40; ++tick)
    largest = std::max(largest, test::make_haptic(tick).force.cwiseAbs().maxCoeff());
  ASSERT_GT(largest, 2.0 * std::abs(test::make_haptic(0).force.y()));  // not the value itself
  CompareOptions options;
  options.tolerances = {{"/haptic/force", 0.0, 0.0, 1.001 * 0x1p-8 / largest}};
  EXPECT_TRUE(pair.compare(options).is_equal());
  options.tolerances[0].of_largest = 0.999 * 0x1p-8 / largest;
  EXPECT_FALSE(pair.compare(options).is_equal());
  options.tolerances = {{"/haptic/torque", 0.0, 0.0, 1.0}};  // of another dataset
  EXPECT_FALSE(pair.compare(options).is_equal());
}

TEST(CompareResults, AValueThatIsNotFiniteWidensNoTolerance) {
  Pair pair;
  pair.change_haptic = [](sim::HapticRecord& record) {
    if (record.tick == 3) record.force.x() = std::numeric_limits<double>::infinity();
    if (record.tick == 5) record.force.y() += 1.0;
  };
  CompareOptions options;
  options.tolerances = {{"/haptic/force", 0.0, 0.0, 1e-3}};
  EXPECT_EQ(pair.compare(options).differences.at(0).count, 2U);
  EXPECT_EQ(compare_results(pair.b, pair.a, options).differences.at(0).count, 2U);  // also as the first file
}

TEST(CompareResults, AnInfinityIsWithinNoToleranceOfAnythingElse) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  CompareOptions options;
  options.tolerances = {{"/haptic/force", 1e-3, 1e-3}};
  for (const double value : {1.0, -kInfinity, kInfinity}) {
    Pair pair;
    pair.change_haptic = [&](sim::HapticRecord& record) {
      if (record.tick == 3) record.force.x() = value;
    };
    pair.compare();
    Pair other;
    other.change_haptic = [&](sim::HapticRecord& record) {
      if (record.tick == 3) record.force.x() = kInfinity;
    };
    other.compare();
    const bool is_equal = value == kInfinity;
    EXPECT_EQ(compare_results(pair.b, other.b, options).is_equal(), is_equal) << value;
    EXPECT_EQ(compare_results(other.b, pair.b, options).is_equal(), is_equal) << value;
  }
}

TEST(CompareResults, ComparesIntegersThatADoubleCannotTellApart) {
  constexpr std::int64_t kLast = std::int64_t{1} << 53;  // 2^53 + 1 is no double
  CompareOptions options;
  options.tolerances = {{"*", 0.0, 0.0}};
  Pair pair;
  pair.compare();
  for (const auto& [file, value] : {std::pair(pair.a, kLast), std::pair(pair.b, kLast + 1)}) {
    const hdf5::File opened = hdf5::File::open_for_writing(file);
    opened.root().write_attribute("count", value);
    opened.root().write_array("counts", &value, {}, false, {"1", "a number"});
  }
  const CompareReport report = compare_results(pair.a, pair.b, options);
  ASSERT_EQ(report.differences.size(), 2U) << to_string(report);
  EXPECT_EQ(report.differences[0].what, "is 9007199254740992 and 9007199254740993");
  EXPECT_NE(report.differences[1].what.find("9007199254740992 and 9007199254740993; largest difference 1"),
            std::string::npos)
      << report.differences[1].what;
}

TEST(CompareResults, NeverTakesNaNForEqual) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  Pair pair;
  pair.change_haptic = [&](sim::HapticRecord& record) {
    record.force.x() = record.tick == 3 ? kNaN : record.force.x();
  };
  CompareOptions loose;
  loose.tolerances = {{"*", 1e300, 1e300}};
  EXPECT_FALSE(pair.compare().is_equal());
  EXPECT_FALSE(pair.compare(loose).is_equal());
  EXPECT_EQ(pair.compare(loose).differences.at(0).tick, 3);
  EXPECT_NE(pair.compare(loose).differences.at(0).what.find("largest difference nan"), std::string::npos);
  EXPECT_FALSE(compare_results(pair.b, pair.b, {}).is_equal());  // not even a file with itself
}

TEST(CompareResults, FindsAShorterRunAndTheTickWhereItEnds) {
  Pair pair;
  pair.ticks_b = 35;
  const CompareReport report = pair.compare();
  ASSERT_FALSE(report.is_equal());
  for (const Difference& difference : report.differences)
    EXPECT_TRUE(difference.tick == 35 || difference.tick == 36);
  EXPECT_NE(to_string(report).find("first at tick 35 in /haptic/"), std::string::npos) << to_string(report);
  EXPECT_NE(to_string(report).find("shape (40, 3) and (35, 3)"), std::string::npos);
}

TEST(CompareResults, FindsAMissingFrameAndAChangedFrame) {
  Pair pair;
  pair.ticks_b = 30;
  EXPECT_NE(to_string(pair.compare()).find("/frames/000003: is missing in " + pair.b), std::string::npos);
  pair.ticks_b = 40;
  pair.change_frame = [](sim::Frame& frame) {
    if (frame.tick == 20) frame.saturation[1] = 0.5;
  };
  const CompareReport report = pair.compare();
  ASSERT_EQ(report.differences.size(), 1U);
  EXPECT_EQ(report.differences[0].object, "/frames/000002/saturation");
  EXPECT_EQ(report.differences[0].tick, 20);
}

TEST(CompareResults, FindsAChangedStateHashUnlessATolerancePermitsChanges) {
  Pair pair;
  pair.change_frame = [](sim::Frame& frame) { frame.state_hash[0] = 'b'; };
  EXPECT_EQ(pair.compare().differences.size(), 4U);
  CompareOptions options;
  options.tolerances = {{"/frames/*/position", 1e-9, 0.0}};
  EXPECT_TRUE(pair.compare(options).is_equal());
}

TEST(CompareResults, KeepsTheStateHashWhereNoToleranceLoosensItsFrame) {
  Pair pair;
  pair.change_frame = [](sim::Frame& frame) { frame.state_hash[0] = 'b'; };
  CompareOptions options;
  options.tolerances = {{"/haptic/force", 1e-9, 0.0}};  // of no frame
  EXPECT_EQ(pair.compare(options).differences.size(), 4U);
  options.tolerances = {{"/frames/*", 0.0, 0.0}};  // of frames, and allows nothing
  EXPECT_EQ(pair.compare(options).differences.size(), 4U);
  options.tolerances = {{"/frames/000002/position", 1e-9, 0.0}};  // of one frame
  EXPECT_EQ(pair.compare(options).differences.size(), 3U);
  options.tolerances = {{"/frames/*/position", 0.0, 0.0}, {"/frames/*/position", 1e-9, 0.0}};  // first counts
  EXPECT_EQ(pair.compare(options).differences.size(), 4U);
  options.tolerances.clear();
  options.ignore = {"/frames/* attribute state_hash"};
  EXPECT_TRUE(pair.compare(options).is_equal());
}

TEST(CompareResults, SaysHowManyHashesItCompared) {
  const Pair pair;
  EXPECT_EQ(pair.compare().num_hashes, 4U);  // frames of the ticks 0, 10, 20, 30
  CompareOptions options;
  options.tolerances = {{"/frames/*/position", 1e-9, 0.0}};
  EXPECT_EQ(pair.compare(options).num_hashes, 0U);
}

TEST(CompareResults, RefusesARuleThatFitsNothing) {
  const Pair pair;
  CompareOptions options;
  options.file = "near.json";
  options.tolerances = {{"/haptic/*", 1.0}, {"/haptic/farce", 1.0}};
  ARGIL_EXPECT_THROW_WITH(pair.compare(options), InputError, "\"/haptic/farce\" fits no dataset");
  ARGIL_EXPECT_THROW_WITH(pair.compare(options), InputError, "near.json: /tolerances/1/dataset");
  options.tolerances = {{"/haptic", 1.0}};  // a group has no values
  ARGIL_EXPECT_THROW_WITH(pair.compare(options), InputError, "\"/haptic\" fits no dataset");
  options.tolerances.clear();
  options.ignore = {"/haptic", "/provenence"};
  ARGIL_EXPECT_THROW_WITH(pair.compare(options), InputError, "/ignore/1");
}

TEST(CompareResults, ARuleMayFitInTheSecondFileAlone) {
  Pair pair;
  pair.compare();
  {
    const hdf5::File file = hdf5::File::open_for_writing(pair.b);
    const double one = 1.0;
    file.root().write_array("extra", &one, {}, false, {"1", "a number"});
  }
  CompareOptions options;
  options.tolerances = {{"/extra", 1.0}};
  EXPECT_EQ(compare_results(pair.a, pair.b, options).differences.size(), 1U);
}

TEST(CompareResults, MatchesAPatternOfManyStarsAtOnce) {
  const Pair pair;
  CompareOptions options;
  options.tolerances = {{std::string(60, '*') + "x", 1.0}};
  ARGIL_EXPECT_THROW_WITH(pair.compare(options), InputError, "fits no dataset");  // none ends in x
  std::string stars;
  for (int i = 0; i < 30; ++i) stars += "*a";
  options.tolerances = {{stars + "*", 1.0}};
  ARGIL_EXPECT_THROW_WITH(pair.compare(options), InputError, "fits no dataset");
}

TEST(CompareResults, AStarStandsForAnyTextAlsoNone) {
  Pair pair;
  pair.change_haptic = [](sim::HapticRecord& record) { record.force.y() += 1.0; };
  pair.compare();
  const auto accepts = [&](const std::string& pattern) {
    CompareOptions options;
    options.tolerances = {{pattern, 0.0, 2.0}, {"*", 0.0, 0.0}};
    return compare_results(pair.a, pair.b, options).is_equal();
  };
  for (const char* fits : {"/haptic/force", "*", "**", "/haptic/force*", "*/haptic/force", "/h*c/f*e",
                           "*force", "/*/*", "/haptic/*rce", "/haptic/f*o*r*c*e", "*c*c*"})
    EXPECT_TRUE(accepts(fits)) << fits;
  // Each fits another dataset, so that it is not refused.
  for (const char* other : {"/haptic/tor*", "*torque", "*/position", "/physics/*"})
    EXPECT_FALSE(accepts(other)) << other;
}

TEST(CompareResults, FindsChangedMeshAndProvenanceAndLeavesOutWhatIsIgnored) {
  Pair pair;
  pair.header_b.tets(0, 0) = 4;
  pair.header_b.provenance[0].second = "{}";
  pair.header_b.provenance.emplace_back("extra", "x");
  const CompareReport report = pair.compare();
  ASSERT_EQ(report.differences.size(), 3U) << to_string(report);
  CompareOptions options;
  options.ignore = {"/provenance", "/mesh/te*"};
  EXPECT_TRUE(pair.compare(options).is_equal());
}

TEST(CompareResults, FindsMissingDatasetsAndChangedAttributes) {
  const Pair pair;
  pair.compare();
  {
    const hdf5::File file = hdf5::File::open_for_writing(pair.b);
    file.root().remove("haptic/torque");
    file.root().open_dataset("haptic/force").write_attribute("units", "lbf");
    file.root().write_attribute("format_version", std::int64_t{1});
    file.root().write_attribute("extra", 1.0);
  }
  const CompareReport report = compare_results(pair.a, pair.b, {});
  ASSERT_EQ(report.differences.size(), 3U) << to_string(report);
  const std::string text = to_string(report);
  EXPECT_NE(text.find("/haptic/torque: is missing in " + pair.b), std::string::npos) << text;
  EXPECT_NE(text.find("/haptic/force attribute units: is 'N' and 'lbf'"), std::string::npos) << text;
  EXPECT_NE(text.find("attribute extra: is missing in " + pair.a), std::string::npos) << text;
}

TEST(CompareResults, RefusesANegativeTolerance) {
  CompareOptions options;
  options.tolerances = {{"/haptic/force", -1.0, 0.0}};
  ARGIL_EXPECT_THROW_WITH(compare_results("a", "b", options), InputError, "/haptic/force");
  options.tolerances = {{"/haptic/force", std::numeric_limits<double>::quiet_NaN(), 0.0}};
  ARGIL_EXPECT_THROW_WITH(compare_results("a", "b", options), InputError, "/haptic/force");
}

}  // namespace
}  // namespace argil::output
