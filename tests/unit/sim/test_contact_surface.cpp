// The skin as what is touched: what acts on it acts on the nodes alike, and it is met where it is seen.
#include "sim/contact_surface.h"

#include <gtest/gtest.h>

#include "base/rng.h"
#include "contact/tool_shape.h"
#include "sim/simulation.h"
#include "support/skin_body.h"

namespace argil::sim {
namespace {

constexpr double kToolRadius = 0.008;
const Vec3 kSize(0.04, 0.04, 0.02);

using test::make_skin_block;

Params make_params(SurfaceKind kind) {
  Params p;
  p.elastic = {1e5, 0.3};
  p.plasticity.enabled = false;
  p.kernel.form = material::KernelForm::off;
  p.contact = {50.0, 50.0};
  p.contact_surface = kind;
  p.solid.solver.kind = linear::SolverKind::cholesky;
  p.water.wetting_flux = 20.0;
  p.device.max_force = 100.0;
  p.device.max_force_rate = 1e9;
  return p;
}

device::DeviceSample at_height(double tip, device::ToolMode mode = device::ToolMode::push) {
  device::DeviceSample sample;
  sample.position = {0.0211, 0.0197, tip + kToolRadius};
  sample.mode = mode;
  return sample;
}

Simulation start(const Params& params, double scale) {
  return Simulation(make_skin_block(scale), contact::make_sphere_tool(kToolRadius, 2), params,
                    at_height(0.025));
}

class EverySurface : public testing::TestWithParam<std::pair<SurfaceKind, solid::ElementKind>> {};

TEST_P(EverySurface, CarriesForceAndTorqueToTheNodesToRounding) {
  const auto [kind, element] = GetParam();
  const Body body = make_skin_block(0.8);
  const solid::Elements elements = solid::make_elements(body.mesh, body.topology, element);
  const ContactSurface surface(kind, contact::ContactLaw::pairs, body, elements);
  Rng rng(5, "surface");
  Points x = elements.rest;
  for (Eigen::Index v = 0; v < x.cols(); ++v)
    for (Eigen::Index k = 0; k < 3; ++k) x(k, v) += 2e-4 * (rng.uniform() - 0.5);
  contact::ContactParams params{50.0, 50.0};
  params.damping = 0.5;
  params.friction = 0.4;
  contact::ContactDetector detector(surface.triangles(), surface.num_vertices(),
                                    contact::make_sphere_tool(kToolRadius, 2), params);
  Points places;
  surface.find_positions(x, places);
  contact::Contacts contacts;
  contact::Pose from, to;
  from.position = at_height(0.021).position;
  to.position = at_height(0.0165).position;
  detector.find_contacts(places, places, from, to, contacts, {}, 1e-3);
  contact::Pose aside = to;
  aside.position += Vec3(2e-4, -1e-4, -2e-4);
  aside.orientation = Eigen::AngleAxisd(0.02, Vec3::UnitZ());
  detector.find_contacts(places, places, to, aside, contacts, {}, 1e-3);
  const Vec3 on_tool = contacts.force_on_tool + contacts.resistance_on_tool;
  const Vec3 torque_on_tool = contacts.torque_on_tool + contacts.resistance_torque_on_tool;
  ASSERT_GT(contacts.force_on_tool.norm(), 0.01);
  ASSERT_GT(contacts.resistance_on_tool.head<2>().norm(), 0.001);

  NodalForce on_body(x.cols());
  for (const contact::Contact& c : contacts.contacts)
    surface.add_force({c.vertex, c.weight, c.force + c.resistance}, on_body);
  const Points& force = on_body.at;
  Vec3 torque = Vec3::Zero();
  for (Eigen::Index v = 0; v < x.cols(); ++v) torque += (x.col(v) - aside.position).cross(Vec3(force.col(v)));
  const double scale = on_tool.norm();
  EXPECT_LT((force.rowwise().sum() + on_tool).norm(), 1e-13 * scale);
  // Embedded places are right to rounding of the block's size.
  EXPECT_LT((torque + torque_on_tool).norm(), 1e-13 * scale * kSize.norm());

  // All the stiffness arrives, and every entry lies within one tet.
  std::vector<solid::PointStiffness> stiffness;
  double given = 0.0;
  for (const contact::Contact& c : contacts.contacts) {
    surface.add_stiffness(c, c.normal, c.stiffness, elements, stiffness);
    given += c.stiffness;
  }
  double sum = 0.0;
  for (const solid::PointStiffness& s : stiffness) {
    sum += s.stiffness;
    double weight = 0.0;
    for (std::size_t i = 0; i < s.count(); ++i) weight += s.weight[i];
    EXPECT_NEAR(weight, 1.0, 1e-8);
  }
  EXPECT_NEAR(sum, given, 1e-12 * given);
}

INSTANTIATE_TEST_SUITE_P(Every, EverySurface,
                         testing::Values(std::pair{SurfaceKind::cage, solid::ElementKind::p1},
                                         std::pair{SurfaceKind::skin, solid::ElementKind::p1},
                                         std::pair{SurfaceKind::skin, solid::ElementKind::p2}));

TEST(Skin, ThatIsTheBoundaryItselfGivesTheSameRun) {
  Simulation cage = start(make_params(SurfaceKind::cage), 1.0);
  Simulation skin = start(make_params(SurfaceKind::skin), 1.0);
  double largest = 0.0;
  for (int k = 1; k <= 150; ++k) {
    const device::DeviceSample sample = at_height(0.025 - 5e-5 * k);
    ASSERT_TRUE(cage.tick(sample).is_ok() && skin.tick(sample).is_ok());
    largest = std::max(largest, cage.hand_state().hand_force.norm());
    ASSERT_LE((cage.hand_state().hand_force - skin.hand_state().hand_force).norm(), 1e-10 * largest) << k;
  }
  EXPECT_GT(largest, 0.1);
  EXPECT_LT((cage.body_state().solid.x - skin.body_state().solid.x).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Skin, IsMetWhereItIsSeen) {
  // The skin's top lies at 0.01 + 0.8 · 0.01 = 0.018, the cage's at 0.02.
  for (const auto& [kind, top] : {std::pair{SurfaceKind::cage, 0.02}, std::pair{SurfaceKind::skin, 0.018}}) {
    Simulation simulation = start(make_params(kind), 0.8);
    double met = 0.0;
    for (double tip = 0.0249; tip > 0.016 && met == 0.0; tip -= 1e-5) {
      ASSERT_TRUE(simulation.tick(at_height(tip)).is_ok());
      if (simulation.hand_state().hand_force.norm() > 0.0) met = tip;
    }
    EXPECT_NEAR(met, top,
                2e-5);  // one tick's way, and the tool's lowest facet lies that much above its sphere
  }
}

TEST(Skin, AFreeBodyTakesUpTheMomentumThatTheHandGives) {
  // With the contact's stiffness in the solve: what its nodes yield, the hand feels too. Also of what
  // resists.
  for (const auto& [damping, friction] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {0.0, 0.5}, {1.0, 0.5}}) {
    Body body = make_skin_block(0.8);
    body.supports.clear();
    Params params = make_params(SurfaceKind::skin);
    params.contact.damping = damping;
    params.contact.friction = friction;
    Simulation simulation(std::move(body), contact::make_sphere_tool(kToolRadius, 2), params,
                          at_height(0.019));
    Vec3 impulse = Vec3::Zero();
    for (int k = 1; k <= 60; ++k) {
      device::DeviceSample sample = at_height(0.019 - 5e-5 * k);
      sample.position.x() += 3e-5 * k;
      ASSERT_TRUE(simulation.tick(sample).is_ok());
      impulse -= params.rates.haptic_period * simulation.hand_state().hand_force;
    }
    const Vec3 momentum = simulation.body_state().solid.v * simulation.solid().materials.mass();
    EXPECT_LT(momentum.z(), -1e-5);
    EXPECT_EQ(momentum.x() > 1e-6, friction > 0.0) << momentum.transpose();
    EXPECT_LT((momentum - impulse).norm(), 1e-12 * impulse.norm() + 1e-17) << damping << ' ' << friction;
  }
}

TEST(Skin, AFreeBodyTakesUpTheAngularMomentumThatTheHandGives) {
  // One step from rest, into the body at once: its stiffness turns nothing about the places at rest, so that
  // Σ X × m v' is the torque's impulse, about the hand's point and with the yield and all that resists.
  for (const SurfaceKind kind : {SurfaceKind::cage, SurfaceKind::skin})
    for (const auto& [damping, friction] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {0.0, 0.5}, {1.0, 0.5}}) {
      Body body = make_skin_block(0.8);
      body.supports.clear();
      const Points X = body.mesh.vertices;
      Params params = make_params(kind);
      params.solid.model = solid::StrainModel::linear;
      params.contact.damping = damping;
      params.contact.friction = friction;
      Simulation simulation(std::move(body), contact::make_sphere_tool(kToolRadius, 2), params,
                            at_height(0.0201));
      device::DeviceSample sample = at_height(0.0165);
      sample.position += Vec3(0.004, -0.003, 0.0);
      sample.orientation = Eigen::AngleAxisd(0.1, Vec3::UnitZ());
      ASSERT_TRUE(simulation.tick(sample).is_ok());
      Vec3 momentum = Vec3::Zero();
      for (Eigen::Index v = 0; v < X.cols(); ++v)
        momentum += simulation.solid().materials.mass()(v) *
                    (X.col(v) - sample.position).cross(Vec3(simulation.body_state().solid.v.col(v)));
      const double h = params.rates.haptic_period;
      const HandState& state = simulation.hand_state();
      EXPECT_GT(state.hand_torque.norm(), 1e-5);
      EXPECT_LT((momentum + h * state.hand_torque).norm(), 1e-11 * h * state.hand_force.norm() * kSize.norm())
          << static_cast<int>(kind) << ' ' << damping << ' ' << friction;
    }
}

TEST(Skin, TakesUpWater) {
  Simulation simulation = start(make_params(SurfaceKind::skin), 0.8);
  for (int k = 1; k <= 100; ++k)
    ASSERT_TRUE(simulation.tick(at_height(0.025 - 8e-5 * k, device::ToolMode::wet)).is_ok());
  EXPECT_GT(simulation.pore_water().ledger().added, 1e-7);
  EXPECT_LT(std::abs(simulation.pore_water().ledger_error()), 1e-15);
}

}  // namespace
}  // namespace argil::sim
