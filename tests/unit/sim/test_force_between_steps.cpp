// What hand and body get between two steps, where the force of the last one changes under the hand.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/force_between_steps.h"

namespace argil::sim {
namespace {

/// A contact of that stiffness [N/m] on a surface whose outward side is up.
contact::Contact touch(double spring) {
  contact::Contact c;
  c.vertex = {0, -1, -1};
  c.weight = {1.0, 0.0, 0.0};
  c.normal = -Vec3::UnitZ();
  c.spring = spring;
  return c;
}

/// What the body is owed once all is over is what the hand has felt and the body has not got [N s].
TEST(ForceBetweenSteps, OwesWhatTheHandFeelsOfAChangedAnswer) {
  RateParams rates;
  rates.haptic_period = 1e-3;
  rates.physics_period_ticks = 4;
  for (const double lag : {0.0, 0.5}) {
    const contact::Contact touched = touch(1.0);
    contact::Contacts contacts;
    contacts.contacts.push_back(touched);
    ForceBetweenSteps between(rates, lag);
    between.tell(contacts, {}, {}, {});
    Vec3 felt = Vec3::Zero(), got = Vec3::Zero();
    const auto feel = [&](const Vec3& force, int ticks) {
      for (int k = 0; k < ticks; ++k, felt += rates.haptic_period * force) between.feel(force);
    };
    const auto answer = [&](const Vec3& force) {
      between.receive({force, Vec3::Zero()}, Vec3::Zero());
      got += rates.step_seconds() * force;
    };
    feel(Vec3::Zero(), 4);
    answer(Vec3(0, 1, 2));
    feel(Vec3(0, 1, 2.5), 1);
    between.change_answer({Vec3(0.5, 1, 1.5), Vec3::Zero()}, Vec3::Zero());
    feel(Vec3(0.5, 1, 1.75), 3);
    answer(Vec3(0.25, 1, 1.5));
    feel(Vec3(0.25, 1, 1.5), 4);
    answer(Vec3::Zero());
    feel(Vec3::Zero(), 4);
    answer(Vec3::Zero());
    Snapshot saved;
    Archive archive = Archive::make_saving(saved);
    between.serialize(archive);
    EXPECT_LT((Vec3(saved.at("between/owed").reshaped()) - (felt - got)).norm(), 1e-15) << lag;
    EXPECT_GT((felt - got).norm(), 1e-4);
  }
}

/// Clay that a stiff contact has left by a little, and that presses again in the step: the hand feels what
/// the step answers, not nothing until the next one. Where it answers nothing, nothing is carried on.
TEST(ForceBetweenSteps, OfAPointThatWasOnlyNearIsTheAnswer) {
  RateParams rates;
  rates.physics_period_ticks = 14;
  const contact::Contact near = touch(1e6);
  contact::Contacts contacts;
  contacts.near.push_back(near);
  const contact::Pose tool;
  for (const double answer : {1.2, 0.0}) {
    ForceBetweenSteps between(rates, 0.0);
    between.tell(contacts, {}, tool, tool);
    between.receive({Vec3(0.0, 0.0, answer), Vec3::Zero()}, Vec3::Zero());
    between.compare({Vec3::Zero(), 1e3});
    EXPECT_EQ(between.forecast(tool, {}).force, Vec3(0.0, 0.0, answer));
    contact::Pose deeper = tool;
    deeper.position.z() = -1e-3;
    EXPECT_NEAR(between.forecast(deeper, {}).force.z(), answer > 0.0 ? answer + 1.0 : 0.0, 1e-9);
  }
}

/// A tool that comes on clay between two steps is held back by what it presses on, and is not pushed on by it
/// where it has gone through.
TEST(ForceBetweenSteps, OfClayThatIsMetBetweenStepsIsNeverAlongTheWay) {
  RateParams rates;
  rates.physics_period_ticks = 14;
  ForceBetweenSteps between(rates, 0.0);
  contact::Pose above;
  above.position = Vec3(0.1, 0.2, 0.3);
  between.tell({}, {}, above, above);
  between.receive({}, Vec3::Zero());
  contact::Pose through = above;
  through.position.z() -= 0.02;
  ForceBetweenSteps::Limits limits;
  limits.unpressed.force = Vec3(0.0, 0.1, 2.0);
  EXPECT_EQ(between.forecast(through, limits).force, limits.unpressed.force);
  limits.unpressed.force = Vec3(0.0, 0.1, -2.0);
  EXPECT_EQ(between.forecast(through, limits).force, Vec3(0.0, 0.0, 0.0));
}

/// The same before any step has answered: from below, far from where all coordinates are 0.
TEST(ForceBetweenSteps, OfClayThatIsMetBeforeTheFirstAnswerIsNeverAlongTheWay) {
  RateParams rates;
  rates.physics_period_ticks = 14;
  ForceBetweenSteps between(rates, 0.0);
  contact::Pose below;
  below.position = Vec3(0.0, 0.0, -0.03);
  between.begin_at(below);
  contact::Pose through = below;
  through.position.z() = -0.003;
  ForceBetweenSteps::Limits limits;
  limits.unpressed.force = Vec3(0.0, 0.0, 2.0);
  EXPECT_EQ(between.forecast(through, limits).force, Vec3(0.0, 0.0, 0.0));
  limits.unpressed.force = Vec3(0.0, 0.0, -2.0);
  EXPECT_EQ(between.forecast(through, limits).force, limits.unpressed.force);
}

/// What a tool has gone through does not hold it the more, the farther it goes; what it draws back from
/// follows it.
TEST(ForceBetweenSteps, OfAToolThatHasPassedStaysTheAnswer) {
  RateParams rates;
  rates.physics_period_ticks = 14;
  contact::Contact met = touch(1e3);
  contact::Contacts contacts;
  contact::Pose above, beneath, farther;
  above.position.z() = 0.03;
  beneath.position.z() = -0.03;
  farther.position.z() = -0.04;
  for (const bool passes : {true, false}) {
    met.passes = passes;
    contacts.contacts = {met};
    ForceBetweenSteps between(rates, 0.0);
    between.tell(contacts, {}, above, beneath);
    PressedPatch pressed;
    pressed.compliance = 1e-3 * Mat3::Identity();
    between.receive({Vec3(0.0, 0.0, 0.5), Vec3::Zero()}, Vec3::Zero(), pressed);
    EXPECT_NEAR(between.forecast(farther, {}).force.z(), passes ? 0.5 : 0.5 + 0.5 * 1e3 * 0.01, 1e-12);
  }
  met.passes = true;  // drawn back from where it pressed
  contacts.contacts = {met};
  ForceBetweenSteps between(rates, 0.0);
  between.tell(contacts, {}, beneath, above);
  PressedPatch pressed;
  pressed.compliance = 1e-3 * Mat3::Identity();
  between.receive({Vec3(0.0, 0.0, 0.5), Vec3::Zero()}, Vec3::Zero(), pressed);
  contact::Pose higher = above;
  higher.position.z() += 4e-4;
  EXPECT_NEAR(between.forecast(higher, {}).force.z(), 0.5 - 0.5 * 1e3 * 4e-4, 1e-12);
}

/// A body that is soft sideways, as a column is, and goes on by itself: what a grip holds, and friction that
/// does not slide, follow its compliance C and the way that is left of the tool's: F − (C + 1/k)⁻¹ (way −
/// drift).
TEST(ForceBetweenSteps, GoesAsideAsTheBodyDoes) {
  RateParams rates;
  rates.physics_period_ticks = 2;
  const contact::Contact held = touch(1e4);
  contact::Contacts contacts;
  contacts.contacts.push_back(held);
  const Vec3 answer(0.0, 0.0, 1.0), way(3e-4, 0.0, -1e-4), drift(1e-4, 0.0, 0.0);
  const Vec3 stiffness(1.0 / (1e-2 + 1e-4), 1.0 / (5e-3 + 1e-4), 1.0 / (4e-4 + 1e-4));
  PressedPatch pressed;
  pressed.compliance = Vec3(1e-2, 5e-3, 4e-4).asDiagonal();
  pressed.drift = drift;
  for (const bool holds : {true, false}) {
    ForceBetweenSteps between(rates, 0.0);
    between.tell(contacts, {}, {}, {});
    between.receive({answer, Vec3::Zero()}, Vec3::Zero(), pressed);
    between.feel(answer);
    contact::Pose tool;
    tool.position = way;
    ForceBetweenSteps::Limits limits;
    limits.holds = holds;
    limits.friction = holds ? 0.0 : 0.5;
    const Vec3 expected = answer - stiffness.cwiseProduct(way - 0.5 * drift);
    EXPECT_LT((between.forecast(tool, limits).force - expected).norm(), 1e-12) << holds;
  }
}

/// Clay that is met between two steps on a body that gives way as a whole, as by a spring under it: Hertz's
/// force f(d) with that spring in series is the f for which f = f(d − c f).
TEST(ForceBetweenSteps, OfClayOnASoftBodyIsInSeriesWithIt) {
  constexpr double kHertz = 3e4, kDepth = 2e-3, kGive = 2e-3;  // f(d) = 3e4 d^{3/2}
  RateParams rates;
  rates.physics_period_ticks = 14;
  const contact::Contact near = touch(1e6);
  contact::Contacts contacts;
  contacts.near.push_back(near);
  const contact::Pose tool;
  ForceBetweenSteps between(rates, 0.0);
  between.tell(contacts, {}, tool, tool);
  PressedPatch pressed;
  pressed.compliance = kGive * Mat3::Identity();
  between.receive({}, Vec3::Zero(), pressed);
  ForceBetweenSteps::Limits limits;
  limits.unpressed = {Vec3(0.0, 0.0, kHertz * std::pow(kDepth, 1.5)), 1.5 * kHertz * std::sqrt(kDepth)};
  contact::Pose deeper = tool;
  deeper.position.z() = -kDepth;
  const double force = between.forecast(deeper, limits).force.z();
  EXPECT_GT(force, 0.1);
  EXPECT_NEAR(force, kHertz * std::pow(kDepth - kGive * force, 1.5), 1e-9);
}

}  // namespace
}  // namespace argil::sim
