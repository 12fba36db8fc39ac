// Figures of a run that a study judges it by: closed forms of sines, and of outcomes by their bounds.
#include "study/measure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "run/run.h"
#include "study/outcome.h"

namespace argil::study {
namespace {

TEST(ShareAbove, OfTwoSinesIsThatOfTheFasterOne) {
  // 2 N at 5 Hz and 1 N at 120 Hz: 1/√5 of the rms above 50 Hz.
  Points force(3, 2000);
  for (Eigen::Index k = 0; k < force.cols(); ++k) {
    const double t = 2.0 * std::numbers::pi * 1e-3 * static_cast<double>(k);
    force.col(k) = Vec3(2.0 * std::sin(5.0 * t), 0.0, std::sin(120.0 * t));
  }
  EXPECT_NEAR(compute_share_above(force, 1e-3, 50.0), 1.0 / std::sqrt(5.0), 1e-6);
  EXPECT_NEAR(compute_share_above(force, 1e-3, 200.0), 0.0, 1e-4);
  EXPECT_EQ(compute_share_above(Points::Zero(3, 10), 1e-3, 50.0), 0.0);
}

TEST(Classify, GoesByTheWorstThatHappened) {
  CaseResult result;
  RunFigures figures;
  RunErrors errors;
  EXPECT_EQ(classify(result, figures, errors, {}),
            Outcome::accurate);  // nothing to compare with, nor asked for
  OutcomeBounds bounds;
  bounds.compares = true;
  EXPECT_EQ(classify(result, figures, errors, bounds), Outcome::unknown);
  EXPECT_FALSE(is_known(Outcome::unknown));
  errors.force = 0.2;
  EXPECT_EQ(classify(result, figures, errors, {}), Outcome::wrong);
  EXPECT_TRUE(is_stable(Outcome::wrong));
  figures.chatter = 0.2;
  EXPECT_EQ(classify(result, figures, errors, {}), Outcome::chatter);
  EXPECT_FALSE(is_stable(Outcome::chatter));
  errors.true_chatter = 0.11;  // the hand itself trembles
  EXPECT_EQ(classify(result, figures, errors, {}), Outcome::wrong);
  errors.true_chatter = 0.09;
  EXPECT_EQ(classify(result, figures, errors, {}), Outcome::chatter);
  figures.energy_gain = 0.2;
  EXPECT_EQ(classify(result, figures, errors, {}), Outcome::growing_energy);
  result.exit_code = run::kRunFailed;
  result.reason = "tick 5, solid: volume ratio det F of a tet is -1, bound 0";
  EXPECT_EQ(classify(result, figures, errors, {}), Outcome::inverted);
  result.reason = "tick 5, solid: something new";
  EXPECT_EQ(classify(result, figures, errors, {}), Outcome::failed);
  result.exit_code = run::kInputRefused;
  EXPECT_EQ(classify(result, figures, errors, {}), Outcome::refused);
  result.exit_code = 128 + 9;
  EXPECT_EQ(classify(result, figures, errors, {}), Outcome::killed);
  EXPECT_EQ(to_string(Outcome::killed), "killed");
}

}  // namespace
}  // namespace argil::study
