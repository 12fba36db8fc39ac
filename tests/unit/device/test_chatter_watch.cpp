// A force that trembles, against the closed form of the filter that finds it.
#include "device/chatter_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

namespace argil::device {
namespace {

constexpr double kPeriod = 0.001;  // [s]
constexpr double kLimit = 0.3;

using Force = std::function<double(double)>;  // [N] along z at a time [s]

/// Tick in which the watch says so, within `seconds`.
std::optional<int> find_chatter(ChatterWatch& watch, const Force& force, double seconds, int first = 1,
                                double period = kPeriod) {
  const int last = static_cast<int>(std::lround(seconds / period));
  for (int k = first; k <= last; ++k) {
    watch.add({0.0, 0.0, force(k * period)});
    if (watch.is_chattering()) return k;
  }
  return std::nullopt;
}

std::optional<int> find_chatter(const Force& force, double seconds, double limit = kLimit) {
  ChatterWatch watch(limit, kPeriod);
  return find_chatter(watch, force, seconds);
}

/// 1 N and a sine of so much on top.
Force tremble(double amplitude, double frequency) {
  return [=](double t) { return 1.0 + amplitude * std::sin(2.0 * std::numbers::pi * frequency * t); };
}

/// |H| of a Butterworth filter of fourth order, bilinear, and from it the share of tremble().
double compute_share(double amplitude, double frequency) {
  const auto warp = [](double f) { return std::tan(std::numbers::pi * f * kPeriod); };
  const double gain = 1.0 / std::sqrt(1.0 + std::pow(warp(50.0) / warp(frequency), 8));
  const double square = 0.5 * amplitude * amplitude;
  return gain * std::sqrt(square / (1.0 + square));
}

TEST(ChatterWatch, FindsTheShareOfASineAboveASteadyForce) {
  for (const auto& [amplitude, frequency] :
       {std::pair(0.6, 100.0), {1.0, 50.0}, {2.0, 250.0}, {3.0, 200.0 / 3.0}}) {
    const double share = compute_share(amplitude, frequency);
    // Whole periods in a stretch: the sums are those of the closed form; the first one sees the force begin.
    EXPECT_FALSE(find_chatter(tremble(amplitude, frequency), 3.0, 1.02 * share)) << frequency;
    ChatterWatch watch(0.98 * share, kPeriod);
    const auto tick = find_chatter(watch, tremble(amplitude, frequency), 3.0);
    ASSERT_TRUE(tick) << frequency;
    EXPECT_LE(*tick, 420);
    EXPECT_NEAR(watch.share(), share, 0.02 * share);
  }
}

TEST(ChatterWatch, TakesThreeTenthsOfASecondOfIt) {
  EXPECT_EQ(find_chatter(tremble(2.0, 200.0), 3.0), 300);
  // A sixth of a second, then still twice as long, again and again: never.
  const Force now_and_then = [](double t) {
    return std::fmod(t, 0.5) < 0.166 ? tremble(2.0, 200.0)(t) : 1.0;
  };
  EXPECT_FALSE(find_chatter(now_and_then, 6.0));
}

TEST(ChatterWatch, LetsAHandPokeAndShake) {
  // 5 ms of touch every 0.7 s are all above 50 Hz, and no chatter; neither is what a hand can shake by
  // itself.
  const Force poke = [](double t) { return std::fmod(t, 0.7) < 0.005 ? 5.0 : 0.0; };
  EXPECT_FALSE(find_chatter(poke, 7.0));
  EXPECT_FALSE(find_chatter(tremble(1.0, 12.0), 7.0));
  EXPECT_FALSE(find_chatter(tremble(5.0, 25.0), 7.0));
}

TEST(ChatterWatch, DoesNotCountWhatIsSmallBesideTheTouchBefore) {
  const auto after_a_press = [](double newton) {
    return
        [newton](double t) { return t < 0.5 ? 5.0 : newton * std::sin(2.0 * std::numbers::pi * 200.0 * t); };
  };
  EXPECT_FALSE(find_chatter(after_a_press(0.3), 3.0));  // rms of 0.21 N, a twentieth of 5 N is 0.25 N
  EXPECT_TRUE(find_chatter(after_a_press(0.4), 3.0));
}

TEST(ChatterWatch, DoesNotCountWhatNoHandFeels) {
  // The floor is an rms of 2 mN above 50 Hz: a sine of 2.83 mN, whatever its share of the force. Far above
  // 50 Hz the filter lets all of it through.
  const auto alone = [](double newton, double frequency) {
    return [=](double t) { return newton * std::sin(2.0 * std::numbers::pi * frequency * t); };
  };
  constexpr double kLeastAmplitude = 2e-3 * std::numbers::sqrt2;
  EXPECT_FALSE(find_chatter(alone(1e-9, 200.0), 3.0));
  EXPECT_FALSE(find_chatter(alone(0.98 * kLeastAmplitude, 250.0), 3.0));
  EXPECT_TRUE(find_chatter(alone(1.02 * kLeastAmplitude, 250.0), 3.0));
  // A share of 0.3 and more of a force of a few millinewton.
  const Force tiny = [](double t) { return 2e-3 + 1e-3 * std::sin(2.0 * std::numbers::pi * 100.0 * t); };
  EXPECT_FALSE(find_chatter(tiny, 3.0));
  const Force a_thousandfold = [&](double t) { return 1000.0 * tiny(t); };
  EXPECT_TRUE(find_chatter(a_thousandfold, 3.0));
}

TEST(ChatterWatch, SeesNothingWhereItIsOffOrHasNoSuchFrequencies) {
  EXPECT_FALSE(find_chatter(tremble(2.0, 200.0), 3.0, 1.0));
  ChatterWatch slow(kLimit, 0.01);
  EXPECT_FALSE(find_chatter(slow, tremble(2.0, 33.0), 20.0, 1, 0.01));
}

TEST(ChatterWatch, GoesOnFromASnapshotToTheSameBits) {
  const Force force = tremble(1.2, 71.0);
  ChatterWatch whole(kLimit, kPeriod);
  ChatterWatch first(kLimit, kPeriod);
  ASSERT_FALSE(find_chatter(whole, force, 0.2));
  ASSERT_FALSE(find_chatter(first, force, 0.2));
  Snapshot snapshot;
  Archive saving = Archive::make_saving(snapshot);
  first.serialize(saving);
  ChatterWatch second(kLimit, kPeriod);
  Archive restoring = Archive::make_restoring(snapshot, "a snapshot");
  second.serialize(restoring);
  const auto tick = find_chatter(whole, force, 3.0, 201);
  ASSERT_TRUE(tick);
  EXPECT_EQ(find_chatter(second, force, 3.0, 201), tick);
  EXPECT_EQ(second.share(), whole.share());
}

}  // namespace
}  // namespace argil::device
