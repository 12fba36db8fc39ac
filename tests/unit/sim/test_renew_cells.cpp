// A body that gets new cells under the tool: where they are the old ones in their present shape, the hand
// goes on feeling what a body feels that was left alone.
#include <gtest/gtest.h>

#include "contact/tool_shape.h"
#include "sim/simulation.h"
#include "support/block_body.h"

namespace argil::sim {
namespace {

constexpr double kRadius = 0.008;
constexpr double kTop = 0.02;

Params make_clay(BetweenFrames between = BetweenFrames::hold, int ticks_of_step = 1) {
  Params p;
  p.rates.between_frames = between;
  p.rates.physics_period_ticks = p.rates.water_period_ticks = ticks_of_step;
  p.elastic = {1.2e6, 0.3};
  p.plasticity.form = material::FlowForm::j2;
  p.plasticity.strength = 15e3;
  p.kernel.form = material::KernelForm::off;
  p.contact.law = contact::ContactLaw::pressure;
  p.contact.round_tool = contact::RoundTool{kRadius, 0.0, kRadius, false};
  p.contact.grip_strength = 1e9;
  p.solid.model = solid::StrainModel::hencky;
  p.solid.solver.tolerance = 1e-8;
  p.water.initial_saturation = 0.3;
  p.device.max_force = 1e3;
  return p;
}

device::DeviceSample place(double depth, device::ToolMode mode = device::ToolMode::push) {
  device::DeviceSample at;
  at.position = {0.0212, 0.0195, kTop + kRadius - depth};
  at.mode = mode;
  return at;
}

struct Pressed {
  explicit Pressed(const Params& p = make_clay(), int cells = 10) : params(p), num_cells(cells) {}

  const Params params;
  const int num_cells;  // along each long edge
  Simulation simulation{
      test::make_block_body(num_cells, num_cells, num_cells / 2, Vec3(0.04, 0.04, kTop), 0.3),
      contact::make_sphere_tool(kRadius, 2), params, place(-1e-3)};

  void go(double from, double to, int ticks, device::ToolMode mode = device::ToolMode::push) {
    for (int k = 1; k <= ticks; ++k)
      ASSERT_TRUE(simulation.tick(place(from + (to - from) * k / ticks, mode)).is_ok()) << k;
  }
  /// The cells that it has, in the shape that they have now.
  void renew() {
    Body body;
    body.mesh = simulation.body().mesh;
    body.mesh.vertices = simulation.body_state().solid.x.leftCols(body.mesh.num_vertices());
    body.topology = mesh::make_topology(body.mesh);
    body.epoch = simulation.body().epoch + 1;
    simulation.renew_cells(std::move(body));
  }
  Vec3 force() const { return simulation.hand_state().hand_force; }
};

TEST(NewCells, AreFeltAsTheOldOnesWhereTheyAreThose) {
  Pressed alone, renewed;
  for (Pressed* p : {&alone, &renewed}) p->go(-1e-3, 2e-3, 60);
  ASSERT_GT(alone.force().z(), 1.0);
  renewed.renew();
  EXPECT_EQ(renewed.force(), alone.force());
  for (int i = 0; i < 5; ++i) {
    for (Pressed* p : {&alone, &renewed}) p->go(2e-3 + 1e-4 * i, 2e-3 + 1e-4 * (i + 1), 10);
    EXPECT_NEAR(renewed.force().z(), alone.force().z(), 0.01 * alone.force().z()) << i;
  }
  for (Pressed* p : {&alone, &renewed}) p->go(2.5e-3, -1e-3, 60);  // dents that are left
  EXPECT_LT((renewed.simulation.body_state().solid.x - alone.simulation.body_state().solid.x)
                .colwise()
                .norm()
                .maxCoeff(),
            2e-5);
}

TEST(NewCells, OfTenNodesKeepWhatIsBooked) {
  Params params = make_clay();
  params.solid.element = solid::ElementKind::p2;
  Pressed p(params, 6);
  p.go(-1e-3, 1e-3, 20);
  const PhysicsRecord before = p.simulation.physics_record();
  ASSERT_GT(before.plastic_dissipation, 0.0);
  p.renew();
  const PhysicsRecord after = p.simulation.physics_record();
  EXPECT_NEAR(after.water_mass, before.water_mass, 1e-12 * before.water_mass);
  EXPECT_EQ(after.plastic_dissipation, before.plastic_dissipation);
  EXPECT_EQ(after.contact_work, before.contact_work);
  EXPECT_EQ(after.epoch, 1);
}

TEST(NewCells, KeepWhatIsBooked) {
  Pressed p;
  p.go(-1e-3, 2e-3, 60);
  const PhysicsRecord before = p.simulation.physics_record();
  p.renew();
  const PhysicsRecord after = p.simulation.physics_record();
  EXPECT_NEAR(after.water_mass, before.water_mass, 1e-12 * before.water_mass);
  EXPECT_EQ(after.plastic_dissipation, before.plastic_dissipation);
  EXPECT_EQ(after.contact_work, before.contact_work);
  EXPECT_NEAR(after.elastic_energy, before.elastic_energy, 0.03 * before.elastic_energy);
  EXPECT_EQ(after.epoch, 1);
}

/// Of a tensor that is turned the norm stays.
TEST(NewCells, ShowTheFlowThatThereWas) {
  Pressed p;
  p.go(-1e-3, 2e-3, 60);
  const TensorField before = p.simulation.make_frame().plastic_strain;
  const double largest = p.simulation.physics_record().max_plastic_strain;
  ASSERT_GT(largest, 0.1);
  p.renew();
  const Snapshot snapshot = p.simulation.take_snapshot();
  const TensorField after = p.simulation.make_frame().plastic_strain;
  EXPECT_LT((after.colwise().norm() - before.colwise().norm()).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_NEAR(p.simulation.physics_record().max_plastic_strain, largest, 1e-12);
  p.go(2e-3, 2.2e-3, 10);
  EXPECT_GE(p.simulation.physics_record().max_plastic_strain, 0.99 * largest);
  p.simulation.restore(snapshot, "renewed");
  EXPECT_EQ(p.simulation.make_frame().plastic_strain, after);
}

TEST(NewCells, HangOnAToolThatPulls) {
  Pressed alone, renewed;
  for (Pressed* p : {&alone, &renewed}) {
    p->go(-1e-3, 2e-3, 60);
    p->go(2e-3, 1.4e-3, 20, device::ToolMode::pull);
  }
  ASSERT_LT(alone.force().z(), -0.5);  // drawn down by the clay
  renewed.renew();
  for (Pressed* p : {&alone, &renewed}) p->go(1.4e-3, 1.2e-3, 10, device::ToolMode::pull);
  EXPECT_NEAR(renewed.force().z(), alone.force().z(), 0.02 * std::abs(alone.force().z()));
}

TEST(NewCells, AreFeltBetweenStepsToo) {
  const Params params = make_clay(BetweenFrames::re_evaluate, 4);
  Pressed alone(params), renewed(params);
  for (Pressed* p : {&alone, &renewed}) p->go(-1e-3, 2e-3, 60);
  renewed.renew();
  for (int i = 0; i < 8; ++i) {
    for (Pressed* p : {&alone, &renewed}) p->go(2e-3, 2e-3 + 1e-5, 1);
    EXPECT_NEAR(renewed.force().z(), alone.force().z(), 0.05 * alone.force().z()) << i;
  }
}

TEST(NewCells, StandWhereTheyAreHeld) {
  Pressed p;
  p.go(-1e-3, 4e-3, 20);  // fast
  p.renew();
  const Points before = p.simulation.body_state().solid.x;
  p.go(4e-3, 4.5e-3, 20);
  const auto& support = p.simulation.solid().model.constraints.support;
  double moved = 0.0;
  int num_held = 0;
  for (Eigen::Index n = 0; n < support.cols(); ++n)
    for (Eigen::Index k = 0; k < 3; ++k) {
      if (support(k, n) < 0) continue;
      ++num_held;
      moved = std::max(moved, std::abs(p.simulation.body_state().solid.x(k, n) - before(k, n)));
    }
  EXPECT_GT(num_held, 100);
  EXPECT_EQ(moved, 0.0);
}

TEST(NewCells, WithoutTheToolLieStill) {
  Pressed p;
  p.go(-1e-3, 2e-3, 60);
  p.go(2e-3, -2e-3, 60);
  ASSERT_EQ(p.simulation.hand_state().num_contacts, 0);
  const Points before = p.simulation.body_state().solid.x;
  p.renew();
  p.go(-2e-3, -2e-3, 50);
  EXPECT_LT((p.simulation.body_state().solid.x - before).cwiseAbs().maxCoeff(), 1e-6);
}

}  // namespace
}  // namespace argil::sim
