// The effective medium of a scene over every φ that its water can reach: refused, warned of, or written down.
#include <gtest/gtest.h>

#include <filesystem>

#include "base/error.h"
#include "hdf5/file.h"
#include "study/run.h"
#include "support/scene_files.h"
#include "support/temp_folder.h"

namespace argil {
namespace {

/// A ball of wet clay with pores full of water that cannot leave: a scene that the paper's law turns
/// indefinite.
class SoakedBall : public testing::Test {
 protected:
  test::TempFolder folder;

  study::RunOptions make_options(const std::vector<std::string>& settings) {
    study::RunOptions options;
    options.quiet = true;
    const std::string trace = test::write_press_trace(folder / "press.csv", 0.048, 0.0435, 0.1, "push");
    options.scenario = test::write_text(folder / "scene.json", test::make_ball_scenario(trace));
    options.output = folder / "out.h5";
    options.settings = {"/material/effective_medium/fluid_bulk_modulus_Pa=2.2e9", "/water/porosity=0.65",
                        "/body/initial_saturation=1", "/dynamics/element=p1_nodal", "/trace/duration_s=0.05"};
    options.settings.insert(options.settings.end(), settings.begin(), settings.end());
    return options;
  }
};

TEST_F(SoakedBall, OfThePapersLawIsRefusedWithPhiModeAndRemedy) {
  try {
    study::run(make_options({"/material/effective_medium/scheme=dilute"}));
    FAIL() << "was not refused";
  } catch (const InputError& error) {
    const std::string text = error.what();
    // The pole of eq. 6: φ = α + K_M/(K_I − K_M), α = 13/21 at ν = 0.3.
    for (const char* part : {"/material/effective_medium/scheme", "not positive definite", "mode \"bulk\"",
                             "phi = 0.61908", "undrained", "porosity = 0.65", "mori_tanaka", "up to 0.61"})
      EXPECT_NE(text.find(part), std::string::npos) << part << "\nis not in\n" << text;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "out.h5"));
}

TEST_F(SoakedBall, OfMoriTanakaRunsAndSaysSoInItsFile) {
  EXPECT_EQ(study::run(make_options({"/material/effective_medium/scheme=mori_tanaka"})), study::kDone);
  const hdf5::File file = hdf5::File::open_for_reading(folder / "out.h5");
  const std::string status =
      file.root().open_group("provenance").open_dataset("effective_medium").read_string();
  EXPECT_EQ(status, "effective medium (undrained): ok; checked for phi from 0 to 0.65");
}

TEST_F(SoakedBall, AboveTheVoigtBoundRunsWithAWarning) {
  // β = 2(4−5ν)/(15(1−ν)) = 10/21 at ν = 0.3: shear leaves the bound there, long before the bulk modulus.
  const scenario::Scenario s =
      study::load(make_options({"/material/effective_medium/scheme=dilute", "/water/porosity=0.5"}));
  EXPECT_NE(s.medium_status.find("above_voigt in mode \"shear\" from phi = 0.47619"), std::string::npos)
      << s.medium_status;
  ASSERT_EQ(s.warnings.size(), 1U);
  EXPECT_NE(s.warnings[0].find(s.medium_status), std::string::npos);
}

}  // namespace
}  // namespace argil
