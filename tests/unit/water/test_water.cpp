// Uptake, ledger and diffusion: conservation laws, bounds and limits that hold whatever the mesh.
#include "water/water.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/rng.h"
#include "support/block_mesh.h"
#include "support/mirrored_mesh.h"
#include "support/shaken_block.h"
#include "support/touched_tets.h"

namespace argil::water {
namespace {

constexpr FluxForm kBoth[] = {FluxForm::corrected, FluxForm::two_point};

WaterParams make_params(FluxForm flux) {
  WaterParams p;
  p.diffusivity = 1e-6;
  p.flux = flux;
  p.wetting_flux = 0.5;
  p.drying_flux = 0.3;
  return p;
}

/// Water that goes through a whole block of 0.1 m in the time that play_tools takes, and is all taken again.
WaterParams make_fast_params(FluxForm flux) {
  WaterParams p = make_params(flux);
  p.diffusivity = 1e-3;
  p.wetting_flux = p.drying_flux = 50.0;
  return p;
}

struct Body {
  mesh::TetMesh mesh;
  mesh::Topology topology;
  explicit Body(mesh::TetMesh m) : mesh(std::move(m)), topology(mesh::make_topology(mesh)) {}
  PoreWater make(const WaterParams& params, double saturation) const {
    return PoreWater(mesh, topology, params, Field::Constant(mesh.num_tets(), saturation));
  }
  Field make_random(double low, double high) const {
    Rng rng(11, "field");
    Field field(mesh.num_tets());
    for (Eigen::Index i = 0; i < field.size(); ++i) field(i) = rng.uniform(low, high);
    return field;
  }
};

/// Wetting, drying and rest in random turn on random triangles.
void play_tools(const Body& body, PoreWater& water, int steps, std::uint64_t seed) {
  Rng rng(seed, "tool");
  const auto num_triangles = static_cast<double>(body.topology.boundary.cols());
  for (int i = 0; i < steps; ++i) {
    const std::array<int, 3> triangle = {static_cast<int>(rng.uniform() * num_triangles),
                                         static_cast<int>(rng.uniform() * num_triangles),
                                         static_cast<int>(rng.uniform() * num_triangles)};
    const std::vector<int> tets = test::find_tets_behind(body.topology, triangle);
    const std::array<double, 3> area = {1e-2 * rng.uniform(), 1e-5 * rng.uniform(), 1e-9 * rng.uniform()};
    const double kind = rng.uniform();
    const int sign = (i / 5000) % 2 == 0 ? 1 : -1;
    water.move({tets, area, kind < 0.7 ? sign : 0}, 0.01);
  }
}

TEST(PoreWater, BooksEveryGramOverAHundredThousandSteps) {
  const Body body(test::make_shaken_block(2));
  for (const FluxForm flux : kBoth) {
    PoreWater water = body.make(make_fast_params(flux), 0.1);
    play_tools(body, water, 100000, 5);
    EXPECT_LT(std::abs(water.ledger_error()), 1e-13);  // 1e-12 is the requirement
    EXPECT_GT(water.ledger().added, 10.0 * water.capacity(0));
    EXPECT_GT(water.ledger().removed, 10.0 * water.capacity(0));
    // The booked mass against a plain sum of what the tets hold.
    double mass = 0.0;
    for (int t = 0; t < body.mesh.num_tets(); ++t) mass += water.capacity(t) * water.saturation()(t);
    EXPECT_NEAR(mass, water.ledger().initial + water.ledger().added - water.ledger().removed, 1e-12 * 0.4);
  }
}

TEST(PoreWater, SameBitsOnAnyNumberOfThreads) {
  const Body body(test::make_shaken_block(7));
  for (const FluxForm flux : kBoth) {
    WaterParams params = make_params(flux);
    params.diffusivity_exponent = 2.0;
    const Field start = (body.make_random(0.0, 1.0).array() < 0.3).select(body.make_random(0.1, 0.9), 0.0);
    PoreWater alone(body.mesh, body.topology, params, start);
    play_tools(body, alone, 200, 17);
    ASSERT_GT(alone.num_active(), 1500);  // enough for a second one
    for (const int threads : {2, 3, 7}) {
      PoreWater shared(body.mesh, body.topology, params, start, threads);
      play_tools(body, shared, 200, 17);
      EXPECT_TRUE((shared.saturation().array() == alone.saturation().array()).all()) << threads;
      EXPECT_EQ(shared.ledger().added, alone.ledger().added) << threads;
    }
  }
}

TEST(PoreWater, KeepsSaturationBetweenZeroAndOneExactly) {
  const Body body(test::make_shaken_block(3));
  for (const FluxForm flux : kBoth) {
    PoreWater water = body.make(make_fast_params(flux), 0.0);
    for (std::uint64_t i = 0; i < 200; ++i) {
      play_tools(body, water, 50, 100 + i);
      EXPECT_GE(water.saturation().minCoeff(), 0.0);
      EXPECT_LE(water.saturation().maxCoeff(), 1.0);
    }
  }
}

TEST(PoreWater, CapacityIsDensityTimesPorosityTimesVolume) {
  const Body body(test::make_block(1, 1, 1, Vec3(0.1, 0.2, 0.3)));
  WaterParams params = make_params(FluxForm::two_point);
  params.porosity = 0.35;
  const PoreWater water = body.make(params, 0.5);
  for (int t = 0; t < 6; ++t) EXPECT_NEAR(water.capacity(t), 1000.0 * 0.35 * 0.001, 1e-15);
  EXPECT_NEAR(water.mass(), 0.5 * 1000.0 * 0.35 * 0.006, 1e-14);
  EXPECT_EQ(water.ledger().initial, water.mass());
}

TEST(PoreWater, TakesUpFluxTimesAreaTimesTimeUntilFull) {
  // Without diffusion a tet is a bucket.
  const Body body(test::make_block(1, 1, 1, Vec3(0.1, 0.1, 0.1)));
  WaterParams params = make_params(FluxForm::two_point);
  params.diffusivity = 0.0;
  PoreWater water = body.make(params, 0.0);
  const std::vector<int> tets = {body.topology.boundary_tet[0]};
  const double area[] = {2e-3};
  const int tet = body.topology.boundary_tet[0];
  water.move({tets, area, 1}, 0.01);
  EXPECT_DOUBLE_EQ(water.ledger().added, 0.5 * 2e-3 * 0.01);
  EXPECT_DOUBLE_EQ(water.saturation()(tet), 1e-5 / water.capacity(tet));
  for (int i = 0; i < 100000; ++i) water.move({tets, area, 1}, 0.01);
  EXPECT_EQ(water.saturation()(tet), 1.0);
  EXPECT_NEAR(water.ledger().added, water.capacity(tet), 1e-15);  // what did not fit stayed with the tool
  water.move({tets, area, -1}, 0.01);
  EXPECT_DOUBLE_EQ(water.ledger().removed, 0.3 * 2e-3 * 0.01);  // the dry tool's own flux
  for (int i = 0; i < 100000; ++i) water.move({tets, area, -1}, 0.01);
  EXPECT_EQ(water.saturation()(tet), 0.0);
  EXPECT_NEAR(water.ledger().removed, water.capacity(tet), 1e-15);
  EXPECT_EQ(water.saturation().sum(), 0.0);
}

TEST(PoreWater, UptakeBelowTheLastPlaceOfSaturationIsNotLost) {
  const Body body(test::make_block(1, 1, 1, Vec3(0.1, 0.1, 0.1)));
  WaterParams params = make_params(FluxForm::two_point);
  params.diffusivity = 0.0;
  params.wetting_flux = 1.0;
  PoreWater water = body.make(params, 0.75);
  const std::vector<int> tets = {body.topology.boundary_tet[0]};
  const double area[] = {1e-18 *
                         water.capacity(0)};  // 1e-18 of saturation; the last place of 0.75 is 1.1e-16
  for (int i = 0; i < 100000; ++i) water.move({tets, area, 1}, 1.0);
  EXPECT_NEAR(water.saturation()(body.topology.boundary_tet[0]) - 0.75, 1e-13, 1.2e-16);
  EXPECT_LT(std::abs(water.ledger_error()), 2e-16);
}

TEST(PoreWater, InPaperFormEachTouchedTetGetsOneStepOfSaturation) {
  const Body body(test::make_block(1, 1, 1, Vec3(0.1, 0.1, 0.1)));
  WaterParams params = make_params(FluxForm::two_point);
  params.uptake = UptakeForm::increment;
  params.saturation_increment = 0.3;
  PoreWater water = body.make(params, 0.0);
  std::vector<int> all(static_cast<std::size_t>(body.topology.boundary.cols()));
  std::iota(all.begin(), all.end(), 0);  // 12 triangles of 6 tets: each tet twice
  const std::vector<int> tets = test::find_tets_behind(body.topology, all);
  const std::vector<double> area(all.size(), 1e-4);
  for (const double expected : {0.3, 0.6, 0.9, 1.0, 1.0}) {
    water.move({tets, area, 1}, 0.01);
    for (int t = 0; t < 6; ++t) EXPECT_NEAR(water.saturation()(t), expected, 1e-15);
  }
  water.move({tets, area, -1}, 123.0);
  EXPECT_NEAR(water.saturation()(0), 0.7, 1e-15);
}

TEST(PoreWater, DiffusionStaysWithinTheRangeOfTheField) {
  const Body body(test::make_shaken_block(4));
  for (const FluxForm flux : kBoth) {
    PoreWater water(body.mesh, body.topology, make_params(flux), body.make_random(0.2, 0.7));
    double low = water.saturation().minCoeff(), high = water.saturation().maxCoeff();
    for (int i = 0; i < 300; ++i) {
      water.diffuse(water.monotone_step());
      EXPECT_GE(water.saturation().minCoeff(), low);
      EXPECT_LE(water.saturation().maxCoeff(), high);
      low = water.saturation().minCoeff();
      high = water.saturation().maxCoeff();
    }
    EXPECT_LT(high - low, 0.35);
    EXPECT_LT(std::abs(water.ledger_error()), 1e-15);
  }
}

TEST(PoreWater, AUniformFieldStaysUniform) {
  const Body body(test::make_shaken_block(3));
  for (const FluxForm flux : kBoth) {
    PoreWater water = body.make(make_params(flux), 0.37);
    water.diffuse(100.0);
    EXPECT_EQ(water.saturation(), Field::Constant(body.mesh.num_tets(), 0.37));
  }
}

TEST(Stencil, MonotoneStepIsTheLimitAndNotABitMore) {
  // Hostile field: full where V/Σk is least, dry elsewhere. One explicit step of h leaves 1 − h Σk/V there.
  const Body body(test::make_shaken_block(3));
  const Stencil stencil = make_stencil(body.mesh, body.topology, 1e-6, FluxForm::two_point);
  Eigen::Index worst = 0;
  (stencil.volume.array() / stencil.conductance.colwise().sum().transpose().array()).minCoeff(&worst);
  const auto step = [&](double h) {
    return 1.0 - h * stencil.conductance.col(worst).sum() / stencil.volume(worst);
  };
  EXPECT_LT(step(stencil.monotone_step * (1.0 + 1e-9)), 0.0);
  EXPECT_GT(step(stencil.monotone_step * (1.0 - 1e-9)), 0.0);
  PoreWater water = body.make(make_params(FluxForm::two_point), 0.5);
  EXPECT_EQ(water.monotone_step(), stencil.monotone_step);
  EXPECT_EQ(water.diffuse(0.89 * stencil.monotone_step), 1);
  EXPECT_EQ(water.diffuse(0.91 * stencil.monotone_step), 2);  // a tenth is kept for rounding
  EXPECT_EQ(water.diffuse(90.0 * stencil.monotone_step * (1.0 - 1e-9)), 100);
}

TEST(PoreWater, TakesSubstepsByTheDiffusivityOfTheWettestTet) {
  // D(S) = D₀ e^{βS} and the monotone limit falls with it: e³ = 20.0855 and e^{1.5} = 4.4817 as many
  // substeps.
  const Body body(test::make_shaken_block(3));
  WaterParams params = make_params(FluxForm::two_point);
  params.diffusivity_exponent = 3.0;
  Field start = Field::Constant(body.mesh.num_tets(), 0.2);
  for (const auto& [wettest, substeps] : {std::pair(1.0, 2009), std::pair(0.5, 449)}) {
    start(7) = wettest;
    PoreWater water(body.mesh, body.topology, params, start);
    EXPECT_EQ(water.diffuse(90.0 * water.monotone_step()), substeps);  // ⌈100 e^{3S}⌉
  }
}

TEST(Stencil, BothSidesOfAFaceHoldTheSameBits) {
  const Body body(test::make_shaken_block(3));
  const Stencil s = make_stencil(body.mesh, body.topology, 1e-6, FluxForm::corrected);
  for (int t = 0; t < body.mesh.num_tets(); ++t)
    for (int corner = 0; corner < 4; ++corner) {
      const int other = s.neighbours(corner, t);
      if (other < 0) {
        EXPECT_EQ(s.conductance(corner, t), 0.0);
        continue;
      }
      int back = 0;
      while (s.neighbours(back, other) != t) ++back;
      EXPECT_EQ(s.conductance(corner, t), s.conductance(back, other));
      EXPECT_EQ(Vec3(s.tangent.col(t).segment<3>(3 * corner)),
                Vec3(-s.tangent.col(other).segment<3>(3 * back)));
    }
}

TEST(Stencil, CorrectedFlowOfALinearFieldIsExactInside) {
  // Away from the wall, D ∇S·A through every face and no change of S at all.
  const Body body(test::make_shaken_block(5));
  const Stencil s = make_stencil(body.mesh, body.topology, 1.0, FluxForm::corrected);
  const Vec3 g(1.0, -2.0, 0.5);
  Field S(body.mesh.num_tets());
  for (int t = 0; t < S.size(); ++t) {
    Vec3 centre = Vec3::Zero();
    for (int i = 0; i < 4; ++i) centre += 0.25 * body.mesh.vertices.col(body.mesh.tets(i, t));
    S(t) = g.dot(centre);
  }
  int tested = 0;
  for (int t = 0; t < S.size(); ++t) {
    double flow = 0.0, two_point = 0.0, scale = 0.0;
    bool inside = (s.neighbours.col(t).array() >= 0).all();
    Vec3 gradient = Vec3::Zero();
    for (int c = 0; inside && c < 4; ++c) {
      const int other = s.neighbours(c, t);
      two_point += s.conductance(c, t) * (S(other) - S(t));
      flow += s.tangent.col(t).segment<3>(3 * c).dot(g);
      scale += s.conductance(c, t) * std::abs(S(other) - S(t));
      gradient += (S(other) - S(t)) * s.gradient.col(t).segment<3>(3 * c);
    }
    if (!inside) continue;
    ++tested;
    EXPECT_LT((gradient - g).norm(), 1e-11);
    EXPECT_LT(std::abs(flow + two_point), 1e-12 * scale) << t;
  }
  EXPECT_GT(tested, 300);
}

TEST(PoreWater, SpreadsSymmetricallyFromASymmetricSource) {
  // A mesh that is its own mirror image, wetted in the two tets mirrored in x.
  const Body body(test::make_mirrored_block(4, 4, 4, Vec3(0.1, 0.1, 0.1)));
  const auto find = [&](const Vec3& at) {
    for (int t = 0; t < body.mesh.num_tets(); ++t) {
      Vec3 centre = Vec3::Zero();
      for (int i = 0; i < 4; ++i) centre += 0.25 * body.mesh.vertices.col(body.mesh.tets(i, t));
      if ((centre - at).norm() < 1e-9) return t;
    }
    return -1;
  };
  std::vector<int> image(static_cast<std::size_t>(body.mesh.num_tets()));
  for (int t = 0; t < body.mesh.num_tets(); ++t) {
    Vec3 centre = Vec3::Zero();
    for (int i = 0; i < 4; ++i) centre += 0.25 * body.mesh.vertices.col(body.mesh.tets(i, t));
    centre.x() = 0.1 - centre.x();
    image[static_cast<std::size_t>(t)] = find(centre);
    ASSERT_GE(image[static_cast<std::size_t>(t)], 0);
  }
  for (const FluxForm flux : kBoth) {
    Field start = Field::Zero(body.mesh.num_tets());
    start(100) = start(image[100]) = 0.8;
    PoreWater water(body.mesh, body.topology, make_params(flux), start);
    for (int i = 0; i < 100; ++i) water.diffuse(5.0);
    for (int t = 0; t < body.mesh.num_tets(); ++t)
      EXPECT_NEAR(water.saturation()(t), water.saturation()(image[static_cast<std::size_t>(t)]), 1e-13);
    EXPECT_GT(water.saturation().minCoeff(), 1e-9);
  }
}

TEST(PoreWater, ALocalTouchTouchesFewTetsHoweverLongTheBody) {
  int counts[2];
  for (const int length : {100, 400}) {
    const Body body(test::make_block(length, 2, 2, Vec3(0.01 * length, 0.02, 0.02)));
    WaterParams params = make_params(FluxForm::corrected);
    params.diffusivity = 1e-8;
    PoreWater water = body.make(params, 0.0);
    const std::vector<int> tets = {body.topology.boundary_tet[0]};
    const double area[] = {1e-5};
    EXPECT_EQ(water.num_active(), 0);
    for (int i = 0; i < 20000; ++i) {
      water.move({tets, area, i < 100 ? 1 : 0}, 0.01);
    }
    counts[length == 400] = water.num_active();
    EXPECT_LT(water.num_active(), 400);  // 200 s: √(4Dt) is 3 mm, a third of a cell
    EXPECT_LT(std::abs(water.ledger_error()), 1e-15);
  }
  EXPECT_EQ(counts[0], counts[1]);
}

TEST(PoreWater, RollsBackToTheLastCommit) {
  const Body body(test::make_shaken_block(3));
  for (const FluxForm flux : kBoth) {
    PoreWater water = body.make(make_fast_params(flux), 0.0);
    PoreWater straight = body.make(make_fast_params(flux), 0.0);
    for (std::uint64_t i = 0; i < 20; ++i) {
      play_tools(body, water, 400, 40 + i);
      play_tools(body, straight, 400, 40 + i);
      water.commit();
      play_tools(body, water, 30, 900 + i);  // wets and dries elsewhere
      ASSERT_NE(water.saturation(), straight.saturation());
      water.roll_back();
      ASSERT_EQ(water.saturation(), straight.saturation());
      ASSERT_EQ(water.state().carry, straight.state().carry);
      ASSERT_EQ(water.mass(), straight.mass());
      ASSERT_EQ(water.ledger_error(), straight.ledger_error());
    }
  }
}

TEST(PoreWater, GoesOnWithTheSameBitsFromAKeptState) {
  const Body body(test::make_shaken_block(3));
  for (const FluxForm flux : kBoth) {
    PoreWater water = body.make(make_fast_params(flux), 0.0);
    play_tools(body, water, 7000, 1);  // wet, then dried to 0 in places
    PoreWater resumed = body.make(make_fast_params(flux), 0.0);
    resumed.restore(water.state());
    for (std::uint64_t i = 0; i < 20; ++i) {
      play_tools(body, water, 50, 40 + i);
      play_tools(body, resumed, 50, 40 + i);
      ASSERT_EQ(water.saturation(), resumed.saturation());
      ASSERT_EQ(water.mass(), resumed.mass());
      ASSERT_EQ(water.ledger_error(), resumed.ledger_error());
    }
  }
}

TEST(PoreWaterDeathTest, RefusesWhatTheScenarioShouldHaveRefused) {
  const Body body(test::make_block(1, 1, 1, Vec3(0.1, 0.1, 0.1)));
  EXPECT_DEATH(body.make(make_params(FluxForm::corrected), 1.5), "initial_saturation");
  EXPECT_DEATH(body.make(make_params(FluxForm::corrected), std::nan("")), "initial_saturation");
  PoreWater water = body.make(make_params(FluxForm::corrected), 0.5);
  EXPECT_DEATH(water.diffuse(1e9), "kMostSubsteps");
  const std::vector<int> tets = {body.topology.boundary_tet[0]};
  const double area[] = {std::nan("")};
  EXPECT_DEATH(water.move({tets, area, 1}, 0.01), "isfinite");
}

}  // namespace
}  // namespace argil::water
