// What a study refuses before it runs, by the message; and one whose runs are all refused.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "run/run.h"
#include "scenario/study_file.h"
#include "study/chart.h"
#include "study/stability.h"
#include "study_scene.h"

namespace argil::study {
namespace {

class StudyInput : public Study {
 protected:
  /// The study is refused with all `parts` in the message, and writes nothing.
  void expect_refused(const std::string& json, const std::vector<std::string>& parts, bool is_map) const {
    try {
      is_map ? map_stability(options(json), "") : chart(options(json));
      ADD_FAILURE() << json;
    } catch (const InputError& error) {
      for (const std::string& part : parts)
        EXPECT_NE(std::string(error.what()).find(part), std::string::npos)
            << part << " not in " << error.what();
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "table.csv"));
  }
  /// A chart's curves.
  void expect_curves_refused(const std::string& curves, const std::vector<std::string>& parts) const {
    expect_refused(
        R"({"about": "x", "scenario": "scene.json", "refined": {"/haptics/period_s": 5e-4}, "curves": [)" +
            curves + "]}",
        parts, false);
  }
  /// What a map has besides its scene.
  void expect_map_refused(const std::string& rest, const std::vector<std::string>& parts) const {
    expect_refused(R"({"about": "x", "scenario": "scene.json", )" + rest + "}", parts, true);
  }
};

const std::string kX =
    R"("x": {"name": "x", "pointers": ["/material/poissons_ratio"], "values": [0.1, 0.2]})";

TEST_F(StudyInput, HasTheKeysOfAStudy) {
  const auto expect = [&](const std::string& json, const std::vector<std::string>& parts,
                          bool is_map = false) { expect_refused(json, parts, is_map); };
  const std::string head = R"({"about": "x", "scenario": "scene.json", )";
  expect(head + R"("curves": [{"name": "a"}]})", {"/refined", "is missing"});
  expect(head + R"("refined": {"/haptics/period_s": 1}, "curves": []})", {"/curves", "is not a list"});
  expect(head + R"("refined": {"a": 1}, "curves": [{"name": "a"}]})",
         {"/refined", "\"a\" is no JSON pointer"});
  expect(head + R"("refined": {"/haptics/period_s": 1}, "curves": [{"name": "a",
         "along": {"/body/loads/gravity_m_per_s2/0": [1, 2], "/trace/start_s": [1]}}]})",
         {"/curves/0/along", "/trace/start_s has 1 values, the first axis 2"});
  expect(head + R"("repeats": 2.5, "refined": {"/haptics/period_s": 1}, "curves": [{"name": "a"}]})",
         {"/repeats: 2.5 is not whole"});
  expect(head + R"("refined": {"/haptics/perod_s": 1}, "curves": [{"name": "a"}]})",
         {"/refined", "\"/haptics/perod_s\" is no key of a scenario", "did you mean /haptics/period_s?"});
  expect(head + R"("refined": {"/haptics/period_s": 1}, "curve": [], "curves": [{"name": "a"}]})",
         {"/curve", "is not a known key", "did you mean curves?"});
  expect(head + R"("x": {"name": "x", "pointers": ["/trace/start_s"], "values": [2, 1]}})",
         {"/x/values", "do not increase"}, true);
  expect(
      head + R"("x": {"name": "x", "pointers": ["/trace/start_s"], "logarithmic": true, "values": [0, 1]}})",
      {"/x/values", "logarithm"}, true);
  expect(head + R"("x": {"name": "x", "pointers": ["/material/poisons_ratio"], "values": [0.1]}})",
         {"/x/pointers", "is no key of a scenario", "did you mean /material/poissons_ratio?"}, true);
  expect(
      head + R"("x": {"name": "x", "pointers": ["/trace/start_s"], "integers": true, "values": [1, 1.4]}})",
      {"/x/values", "not whole"}, true);
  expect(
      head +
          R"("refined": {"/about": "the same"}, "reference": {"/about": "the same"}, "curves": [{"name": "a"}]})",
      {"/refined", "same run as /reference"});
}

TEST_F(StudyInput, NamesEachCurveAndOnlyIt) {
  expect_curves_refused(R"({"name": ""})",
                        {"study.json: /curves/0/name: is empty; give what the legend calls it"});
  expect_curves_refused(R"({"name": "a"}, {"name": " "})", {"/curves/1/name: is empty"});
  expect_curves_refused(R"({"name": "a"}, {"name": "b"}, {"name": "a"})",
                        {"study.json: /curves/2/name: \"a\" is the name of /curves/0, too; give each curve"});
  expect_curves_refused(R"({"name": "reference"})",
                        {"/curves/0/name: \"reference\" is the name of a run of the reference"});
  expect_map_refused(R"("x": {"name": "", "pointers": ["/trace/start_s"], "values": [1]})",
                     {"/x/name: is empty"});
}

TEST_F(StudyInput, SetsAKeyOnce) {
  expect_curves_refused(
      R"({"name": "a", "settings": {"/material/poissons_ratio": 0.2},
                            "along": {"/material/poissons_ratio": [0.1]}})",
      {"study.json: /curves/0/settings: \"/material/poissons_ratio\" is set by along, too; leave"});
  const std::string y = R"(, "y": {"name": "y", "values": [1], "pointers": )";
  expect_map_refused(kX + y + R"(["/trace/start_s", "/material/poissons_ratio"]})",
                     {"study.json: /y/pointers: \"/material/poissons_ratio\" is set by /x, too; leave"});
  expect_map_refused(kX + y + R"(["/trace/start_s", "/trace/start_s"]})",
                     {"study.json: /y/pointers: \"/trace/start_s\" stands twice; leave"});
}

TEST_F(StudyInput, SaysWhichSettingsDoNothing) {
  const std::string file =
      test::write_text(folder / "study.json", R"({"about": "x", "scenario": "scene.json", )" + kX +
                                                  R"(, "settings": {"/material/poissons_ratio": 0.3}})");
  EXPECT_EQ(
      scenario::read_stability_study(file).notes,
      std::vector<std::string>{file + ": /settings: \"/material/poissons_ratio\" is set by /x, too, whose "
                                      "values count; leave it out here"});
}

TEST_F(StudyInput, SetsNoElementOfAListThatIsNotThere) {
  const std::string absent =
      "/trace/device_to_world/translation_m is not set, so it has no element 2; set the whole list";
  const std::string element = "/trace/device_to_world/translation_m/2";
  expect_map_refused(R"("x": {"name": "x", "pointers": [")" + element + R"("], "values": [1]})",
                     {"study.json: /x/pointers: " + element + " cannot be set in ", "scene.json: " + absent});
  expect_map_refused(kX + R"(, "settings": {")" + element + R"(": 1})", {"/settings: " + element, absent});
  expect_map_refused(kX + R"(, "reference": {")" + element + R"(": 1})", {"/reference: " + element, absent});
  expect_curves_refused(R"({"name": "a", "along": {")" + element + R"(": [1]}})",
                        {"/curves/0/along: ", absent});
  expect_curves_refused(R"({"name": "a", "settings": {")" + element + R"(": 1}})",
                        {"/curves/0/settings: ", absent});
  expect_map_refused(R"("x": {"name": "x", "pointers": ["/body/fixed/2/offset_m"], "values": [1]})",
                     {"/body/fixed has 1 elements, so none of number 2, counted from 0"});
  // Where the study sets the list itself, an axis may take an element of it.
  EXPECT_EQ(map_stability(options(R"({"about": "x", "scenario": "scene.json",
              "settings": {"/trace/device_to_world/translation_m": [0, 0, 0]}, "x": {"name": "x", "pointers": [")" +
                                  element + R"("], "values": [0]}})"),
                          ""),
            run::kDone);
}

TEST_F(StudyInput, HasItsScene) {
  for (const bool is_map : {false, true}) {
    const std::string rest =
        is_map ? kX : R"("refined": {"/haptics/period_s": 5e-4}, "curves": [{"name": "a"}])";
    expect_refused(R"({"about": "x", "scenario": "nowhere.json", )" + rest + "}",
                   {"study.json: /scenario: \"", "nowhere.json\" does not exist; check the path"}, is_map);
  }
}

TEST(StudiesOfTheProject, AreAccepted) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(ARGIL_SOURCE_DIR "/scenarios/studies")) {
    const std::string file = entry.path().string();
    if (entry.path().stem().string().rfind("chart_", 0) == 0) {
      EXPECT_NO_THROW(scenario::read_chart_study(file)) << file;
    } else {
      EXPECT_NO_THROW(scenario::read_stability_study(file)) << file;
    }
    ++count;
  }
  EXPECT_GT(count, 12);
}

TEST_F(StudyInput, IsNotWrittenOver) {
  StudyOptions o = options(R"({"about": "x", "scenario": "scene.json", )" + kX + "}");
  o.output = folder / "press";  // the scene's motion is press.csv
  EXPECT_THROW(map_stability(o, ""), InputError);
  EXPECT_NE(read_text(folder / "press.csv").find("t,x,y,z"), std::string::npos);
}

TEST_F(StudyInput, OfRunsThatAreAllRefusedSaysSo) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(map_stability(options(R"({"about": "x", "scenario": "scene.json", "x": {"name": "x",
              "pointers": ["/material/poissons_ratio"], "values": [0.6, 0.7]}})"),
                          ""),
            run::kRunFailed);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("all 2 runs of "), std::string::npos);
  ASSERT_EQ(table().size(), 2U);
  EXPECT_EQ(table()[1].at("outcome"), "refused");
  EXPECT_NE(table()[1].at("reason").find("/material/poissons_ratio"), std::string::npos);
  EXPECT_EQ(chart(options(R"({"about": "x", "scenario": "scene.json", "refined": {"/haptics/period_s": 5e-4},
              "curves": [{"name": "a", "settings": {"/material/poissons_ratio": 0.7}}]})")),
            run::kRunFailed);
}

}  // namespace
}  // namespace argil::study
