// Motion between samples against closed forms: straight lines, rotations about a fixed axis by a known angle.
#include <gtest/gtest.h>

#include <cmath>

#include "base/rng.h"
#include "device/trace.h"

namespace argil::device {
namespace {

Quat turn(const Vec3& axis, double angle) {
  return Quat(Eigen::AngleAxisd(angle, axis.normalized()));
}

DeviceSample sample(const Vec3& position, const Quat& orientation = Quat::Identity(),
                    ToolMode mode = ToolMode::push) {
  return {position, orientation, mode};
}

Trace make_trace(std::vector<double> time, std::vector<DeviceSample> samples) {
  Trace trace;
  trace.time = std::move(time);
  trace.samples = std::move(samples);
  return trace;
}

TEST(Interpolate, IsLinearInPosition) {
  const Trace trace =
      make_trace({10.0, 10.5, 11.5}, {sample({0, 0, 0}), sample({1, 2, 3}), sample({5, 2, 3})});
  EXPECT_NEAR((interpolate(trace, 0.125).position - Vec3(0.25, 0.5, 0.75)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((interpolate(trace, 0.75).position - Vec3(2, 2, 3)).norm(), 0.0, 1e-15);
}

TEST(Interpolate, HoldsTheEndsOutsideTheTrace) {
  const Trace trace =
      make_trace({1.0, 2.0}, {sample({0, 0, 0}), sample({1, 0, 0}, Quat::Identity(), ToolMode::dry)});
  EXPECT_EQ(interpolate(trace, -5.0).position, Vec3(0, 0, 0));
  EXPECT_EQ(interpolate(trace, 1.0).position, Vec3(1, 0, 0));
  EXPECT_EQ(interpolate(trace, 99.0).mode, ToolMode::dry);
}

TEST(Interpolate, KeepsTheModeUntilTheNextSampleIsReached) {
  const Trace trace = make_trace(
      {0, 1, 2}, {sample({0, 0, 0}), sample({0, 0, 0}, Quat::Identity(), ToolMode::wet), sample({0, 0, 0})});
  EXPECT_EQ(interpolate(trace, 0.999).mode, ToolMode::push);
  EXPECT_EQ(interpolate(trace, 1.0).mode, ToolMode::wet);
  EXPECT_EQ(interpolate(trace, 1.999).mode, ToolMode::wet);
  EXPECT_EQ(interpolate(trace, 2.0).mode, ToolMode::push);
}

TEST(Interpolate, GivesTheSamplesOwnBitsAtTickTimes) {
  Rng rng(3, "ticks");
  std::vector<double> time;
  std::vector<DeviceSample> samples;
  constexpr int kStart = 1234567;  // a recording that does not begin at tick 0
  for (int i = 0; i < 5000; ++i) {
    time.push_back((kStart + i) * 0.001);
    const Vec3 axis(rng.uniform(-1, 1), rng.uniform(-1, 1), 1.0);
    samples.push_back(sample({rng.uniform(), rng.uniform(), -0.0}, turn(axis, rng.uniform(-3, 3))));
  }
  const Trace trace = make_trace(time, samples);
  for (int i = 0; i < 5000; ++i) {
    const DeviceSample at = interpolate(trace, i * 0.001);
    const DeviceSample& wanted = samples[static_cast<std::size_t>(i)];
    ASSERT_EQ(at.position, wanted.position) << i;
    ASSERT_EQ(at.orientation.coeffs(), wanted.orientation.coeffs()) << i;
    ASSERT_TRUE(std::signbit(at.position.z()));
  }
}

TEST(Slerp, TurnsAboutTheCommonAxisByTheFractionOfTheAngle) {
  const Vec3 axis(1, 2, -2);
  for (const double angle : {3.0, 1.0, 0.1, 1e-3, 1e-5, 3e-6, 1e-6, 1e-7, 1e-9}) {
    const Quat a = turn(Vec3(0, 1, 1), 0.7);
    const Quat b = turn(axis, angle) * a;
    for (const double s : {0.0, 0.1, 0.5, 0.9, 1.0}) {
      const Quat wanted = turn(axis, s * angle) * a;
      const Quat got = slerp_shorter(a, b, s);
      EXPECT_NEAR((got.coeffs() - wanted.coeffs()).norm(), 0.0, 1e-15) << angle << ' ' << s;
      EXPECT_NEAR(got.norm(), 1.0, 4e-16);
    }
  }
}

TEST(Slerp, TakesTheShorterArcWhateverTheSign) {
  const Quat a = turn(Vec3::UnitZ(), 0.2);
  const Quat b(Vec4(-turn(Vec3::UnitZ(), 0.6).coeffs()));  // the same rotation, opposite sign
  const Vec3 x = slerp_shorter(a, b, 0.25) * Vec3::UnitX();
  EXPECT_NEAR(x.x(), std::cos(0.3), 1e-15);
  EXPECT_NEAR(x.y(), std::sin(0.3), 1e-15);
}

TEST(Slerp, IsExactBetweenEqualAndOppositeQuaternions) {
  const Quat a = turn(Vec3(1, 1, 0), 1.1);
  EXPECT_NEAR((slerp_shorter(a, a, 0.3).coeffs() - a.coeffs()).norm(), 0.0, 2e-16);
  EXPECT_NEAR((slerp_shorter(a, Quat(Vec4(-a.coeffs())), 0.3).coeffs() - a.coeffs()).norm(), 0.0, 2e-16);
}

TEST(Slerp, TurnsHalfWayOverAHalfTurn) {
  // From no rotation to 180° about x both arcs are as long; either way x stays and z is turned by ±90°.
  const Vec3 z = slerp_shorter(Quat::Identity(), Quat(0, 1, 0, 0), 0.5) * Vec3::UnitZ();
  EXPECT_NEAR(std::abs(z.y()), 1.0, 1e-15);
  EXPECT_NEAR(z.z(), 0.0, 1e-15);
}

TEST(MakeUnit, KeepsTheBitsOfUnitQuaternionsAndIsIdempotent) {
  Rng rng(5, "unit");
  for (int i = 0; i < 2000; ++i) {
    const Quat raw(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(0.1, 1));
    const Quat once = make_unit(raw);
    ASSERT_NEAR(once.norm(), 1.0, 1e-15);
    ASSERT_EQ(make_unit(once).coeffs(), once.coeffs());
  }
}

}  // namespace
}  // namespace argil::device
