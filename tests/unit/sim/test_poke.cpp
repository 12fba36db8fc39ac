// A fast poke into a thin plate: it yields in front of the tool and is never passed through.
#include <gtest/gtest.h>

#include "contact/tool_shape.h"
#include "sim/simulation.h"
#include "support/skin_body.h"

namespace argil::sim {
namespace {

constexpr double kToolRadius = 0.006;
constexpr double kThickness = 0.002;
constexpr double kWidth = 0.04;

Simulation make_plate(int physics_period_ticks, SurfaceKind surface) {
  Body body = test::make_skin_body(test::make_block(10, 10, 2, Vec3(kWidth, kWidth, kThickness)), 1.0);
  for (const Vec3& normal : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)})
    body.supports.push_back(test::hold_half_space(normal, normal.sum() > 0.0 ? 1e-9 : -kWidth + 1e-9));
  Params p;
  p.elastic = {1e5, 0.3};
  p.plasticity.enabled = false;
  p.kernel.form = material::KernelForm::off;
  p.contact = {300.0, 300.0};
  p.contact_surface = surface;
  p.rates.physics_period_ticks = physics_period_ticks;
  p.rates.water_period_ticks = physics_period_ticks;
  p.solid.solver.kind = linear::SolverKind::cholesky;
  p.device.max_force = 100.0;
  p.device.max_force_rate = 1e9;
  device::DeviceSample start;
  start.position = {0.021, 0.0195, kThickness + kToolRadius + 0.0015};
  return Simulation(std::move(body), contact::make_sphere_tool(kToolRadius, 2), p, start);
}

class Poke : public testing::TestWithParam<std::pair<int, SurfaceKind>> {};

TEST_P(Poke, AtAMetreASecondIsNotMissedAndDoesNotPopThrough) {
  const auto [period, surface] = GetParam();
  Simulation simulation = make_plate(period, surface);
  device::DeviceSample sample;
  sample.position = simulation.hand_state().tool.position;
  double largest = 0.0;
  for (int k = 1; k <= 40; ++k) {
    if (k <= 8)
      sample.position.z() -= 0.001;  // 1 m/s, to 6.5 mm below the plate's top: through, were it rigid
    const StepStatus status = simulation.tick(sample);
    ASSERT_TRUE(status.is_ok()) << k << ' ' << status.failure().quantity;
    // The plate springs ahead of the tool and comes back later; while it is being pushed, it pushes.
    if (k % period == 0 && k >= 4 && k <= 8) {
      EXPECT_GT(simulation.hand_state().hand_force.z(), 0.0) << k;
    }
    largest = std::max(largest, simulation.hand_state().hand_force.z());
  }
  // What lay under the tool still lies in front of it, the plate swinging a little.
  const Vec3& tool = simulation.hand_state().tool.position;
  const Points& x = simulation.body_state().solid.x;
  int under = 0;
  for (Eigen::Index v = 0; v < x.cols(); ++v) {
    const Vec3 from = x.col(v) - tool;
    if (from.head<2>().norm() > 0.5 * kToolRadius) continue;
    ++under;
    EXPECT_LT(from.z(), 0.0) << "behind the tool";
    EXPECT_GT(from.norm(), 0.5 * kToolRadius) << "deep in the tool";
  }
  EXPECT_GE(under, 3);
  EXPECT_GT(largest, 0.05);
}

INSTANTIATE_TEST_SUITE_P(Every, Poke,
                         testing::Values(std::pair{1, SurfaceKind::cage}, std::pair{4, SurfaceKind::cage},
                                         std::pair{1, SurfaceKind::skin}));

}  // namespace
}  // namespace argil::sim
