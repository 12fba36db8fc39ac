// Every kilogram over a million steps of wetting, rest and drying, by every form of uptake and diffusion:
// mass − initial − added + removed below 1e-12 of what the body can hold, and S between 0 and 1 throughout.
#include <gtest/gtest.h>

#include <cmath>

#include "base/rng.h"
#include "support/shaken_block.h"
#include "support/touched_tets.h"
#include "water/water.h"

namespace argil::water {
namespace {

struct Case {
  const char* name;
  FluxForm flux;
  DiffusionScheme scheme;
  UptakeForm uptake;
  double exponent;
  int steps;
};

class Books : public testing::TestWithParam<Case> {};

TEST_P(Books, CloseThroughALongSequenceOfTools) {
  const Case& c = GetParam();
  const mesh::TetMesh mesh = test::make_shaken_block(2);
  const mesh::Topology topology = mesh::make_topology(mesh);
  WaterParams params;
  params.diffusivity = 5e-4;  // some steps fill or empty a tet
  params.diffusivity_exponent = c.exponent;
  params.flux = c.flux;
  params.scheme = c.scheme;
  params.uptake = c.uptake;
  params.wetting_flux = params.drying_flux = 20.0;
  params.saturation_increment = 0.013;
  PoreWater water(mesh, topology, params, Field::Constant(mesh.num_tets(), 0.1));
  Rng rng(8, c.name);
  const auto num_triangles = static_cast<double>(topology.boundary.cols());
  double worst = 0.0;
  for (int i = 0; i < c.steps; ++i) {
    const int triangle[] = {static_cast<int>(rng.uniform() * num_triangles),
                            static_cast<int>(rng.uniform() * num_triangles)};
    const std::vector<int> tets = test::find_tets_behind(topology, triangle);
    const double area[] = {1e-2 * rng.uniform(), 1e-9 * rng.uniform()};
    const int turn = (i / 5000) % 3;  // wet, dry, rest
    const int sign[] = {1, -1, 0};
    water.move({tets, area, sign[turn]}, c.scheme == DiffusionScheme::implicit_euler ? 10.0 : 0.01);
    if (i % 1000 == 0) worst = std::max(worst, std::abs(water.ledger_error()));
    if (i % 1000 == 0) {
      ASSERT_GE(water.saturation().minCoeff(), 0.0);
      ASSERT_LE(water.saturation().maxCoeff(), 1.0);
    }
  }
  worst = std::max(worst, std::abs(water.ledger_error()));
  std::printf("%s: %d steps, %.3g kg in, %.3g kg out, books off by %.2e of the capacity\n", c.name, c.steps,
              water.ledger().added, water.ledger().removed, worst);
  EXPECT_LT(worst, 1e-12);
  EXPECT_GT(water.ledger().added, 2.0 * water.capacity(0));
  EXPECT_GT(water.ledger().removed, 2.0 * water.capacity(0));
}

constexpr DiffusionScheme kExplicit = DiffusionScheme::explicit_euler;
constexpr DiffusionScheme kImplicit = DiffusionScheme::implicit_euler;
INSTANTIATE_TEST_SUITE_P(
    , Books,
    testing::Values(Case{"corrected", FluxForm::corrected, kExplicit, UptakeForm::flux, 0.0, 1000000},
                    Case{"two_point", FluxForm::two_point, kExplicit, UptakeForm::increment, 0.0, 1000000},
                    Case{"exponent", FluxForm::corrected, kExplicit, UptakeForm::flux, 3.0, 100000},
                    Case{"implicit", FluxForm::two_point, kImplicit, UptakeForm::flux, 0.0, 1000000},
                    Case{"implicit_corrected", FluxForm::corrected, kImplicit, UptakeForm::flux, 0.0, 100000},
                    Case{"implicit_exponent", FluxForm::corrected, kImplicit, UptakeForm::flux, 2.0, 20000}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace argil::water
