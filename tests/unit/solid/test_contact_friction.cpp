// Friction of a contact in an implicit step: it sticks as a spring below Coulomb's cone and slides on the
// cone beyond it, at any stiffness of the spring. Expected: the closed form of a point mass, and momentum.
#include "support/solid_scene.h"

namespace argil::solid {
namespace {

using test::Scene;

constexpr double kStep = 0.01;  // h [s]
constexpr double kConeTolerance = 2e-3;
constexpr double kSpringStiffnesses[] = {1e2, 1e3, 1e4, 1e5, 1e6, 1e7};  // [N/m]

/// A pressed point and the friction that it carries. `trial`: what its spring would carry if nothing moved.
void add_pressed_point(std::vector<PointStiffness>& contacts, int node, const Vec3& normal, double stiffness,
                       const Vec3& pressing, double friction, const Vec3& trial) {
  PointStiffness press{{node, -1, -1}, {1.0, 0.0, 0.0}, normal, stiffness, pressing};
  press.group = static_cast<int>(contacts.size());
  press.counts = press.is_alone = true;
  PointStiffness rub = press;
  rub.is_alone = false;
  rub.partner = press.group;
  rub.group = -1;
  rub.friction = friction;
  rub.force = trial;
  rub.counts = false;
  contacts.push_back(press);
  contacts.push_back(rub);
}

/// A cube without stiffness that moves in one corner alone: a point mass.
struct PointMass {
  static constexpr int kNode = 7;
  Scene scene{
      test::make_block(1, 1, 1, Vec3(0.02, 0.02, 0.02)), {0, 1, 2, 3, 4, 5, 6}, make_params(), 1e-9, 0.0};
  double mass = scene.solid.materials.mass()(kNode);

  static SolidParams make_params() {
    SolidParams params;
    params.solver.kind = linear::SolverKind::cholesky;
    return params;
  }
};

Vec3 draw_vector(Rng& rng, double size) {
  return size * Vec3(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0));
}

/// m (v' − v) = h (N n + T) with N = n·f − k n·u ≥ 0, T = a − k u_t or μN along it, u = h v'. Both are linear
/// in v', and T is along a − k h v_t whatever it carries.
TEST(ContactFriction, OfAPointMassHasItsClosedForm) {
  int num_stuck = 0, num_slid = 0;
  for (const double k : kSpringStiffnesses) {
    Rng rng(29);
    for (int round = 0; round < 60; ++round) {
      PointMass point;
      const double per_mass = k * kStep * kStep / point.mass;
      const Vec3 normal = draw_vector(rng, 1.0).normalized();
      const auto along = [&](const Vec3& v) { return Vec3(v - normal.dot(v) * normal); };
      const Vec3 v = draw_vector(rng, 0.02);
      const double pressing = rng.uniform(0.1, 2.0) + std::max(0.0, k * kStep * normal.dot(v));
      const double friction = rng.uniform(0.1, 1.0);
      const double N = (pressing - k * kStep * normal.dot(v)) / (1.0 + per_mass);
      const Vec3 stuck = rng.uniform(0.0, 2.0) * friction * N * along(draw_vector(rng, 1.0)).normalized();
      const Vec3 trial = (1.0 + per_mass) * stuck + k * kStep * along(v);
      std::vector<PointStiffness> contacts;
      add_pressed_point(contacts, PointMass::kNode, normal, k, pressing * normal, friction, trial);
      point.scene.state.v.col(PointMass::kNode) = v;
      for (const PointStiffness& c : contacts) point.scene.load.col(PointMass::kNode) += c.force;
      ASSERT_TRUE(point.scene.solve(kStep, contacts).is_ok());

      const bool sticks = stuck.norm() <= friction * N;
      if (std::abs(stuck.norm() / (friction * N) - 1.0) < 0.01) continue;
      (sticks ? num_stuck : num_slid) += 1;
      const Vec3 T = sticks ? stuck : Vec3(friction * N * stuck.normalized());
      const Vec3 momentum = point.mass * (point.scene.state.v.col(PointMass::kNode) - v) / kStep;
      ASSERT_NEAR(normal.dot(momentum), N, kConeTolerance * N) << k << " " << round;
      ASSERT_LT((along(momentum) - T).norm(), kConeTolerance * friction * N)
          << k << " " << round << (sticks ? " sticks" : " slides");
    }
  }
  EXPECT_GT(num_stuck, 50);
  EXPECT_GT(num_slid, 50);
}

/// An elastic block whose top is pressed in all nodes; friction drags it.
struct RubbedBlock {
  static constexpr double kFriction = 0.3;
  static constexpr double kPressing = 0.02;  // of a node [N]
  Scene scene;
  std::vector<PointStiffness> contacts;
  Vec3 drag;

  RubbedBlock(double stiffness, const Vec3& trial, bool is_held,
              linear::SolverKind solver = linear::SolverKind::cholesky)
      : scene(test::make_irregular_block(4, 4, 2, Vec3(0.04, 0.04, 0.02)),
              is_held ? std::vector{hold_bottom()} : std::vector<Support>{}, make_params(solver), 3e4, 0.3),
        drag(trial) {
    for (int v = 0; v < scene.num_nodes(); ++v)
      if (scene.rest()(2, v) > 0.02 - 1e-9)
        add_pressed_point(contacts, v, -Vec3::UnitZ(), stiffness, -kPressing * Vec3::UnitZ(), kFriction,
                          drag);
    for (const PointStiffness& c : contacts) spread(c, c.force, scene.load);
  }
  static SolidParams make_params(linear::SolverKind solver) {
    SolidParams params;
    params.solver.kind = solver;
    params.solver.tolerance = 1e-8;
    return params;
  }
  static Support hold_bottom() {
    Support bottom;
    bottom.region.kind = Region::Kind::half_space;
    bottom.region.offset = 1e-9;
    return bottom;
  }
  Vec3 acting(std::size_t i) const {
    return contacts[i].force + compute_contact_change(scene.solid, contacts, i);
  }
};

/// Every point carries its spring's force within the cone, or μN along the spring's force beyond it. The sum
/// of what is off is within the tolerance of the sum of the limits.
void expect_coulomb(const RubbedBlock& block, int& num_stuck, int& num_slid) {
  double error = 0.0, limits = 0.0;
  const StepContacts step = block.scene.solid.step_contacts(block.contacts);
  for (std::size_t i = 0; i < block.contacts.size(); i += 2) {
    const double N = -block.acting(i).z();
    ASSERT_GE(N, 0.0);
    const Vec3 T = block.acting(i + 1);
    ASSERT_NEAR(T.z(), 0.0, 1e-12);
    const Vec3 u = step.displacement(i, block.scene.solid.trial.x);
    const Vec3 spring = block.drag - block.contacts[i + 1].stiffness * Vec3(u.x(), u.y(), 0.0);
    const double limit = RubbedBlock::kFriction * N;
    const bool sticks = spring.norm() <= limit;
    (sticks ? num_stuck : num_slid) += 1;
    error += (T - (sticks ? spring : Vec3(limit * spring.normalized()))).norm();
    limits += limit;
  }
  EXPECT_LE(error, kConeTolerance * limits) << block.contacts.front().stiffness << " " << block.drag.norm();
}

TEST(ContactFriction, OnABlockSticksWithinTheConeAndSlidesOnIt) {
  int num_stuck = 0, num_slid = 0;
  for (const bool is_held : {true, false})
    for (const double k : kSpringStiffnesses)
      for (const double drag : {0.1, 1.0, 10.0, 1e3, 1e5}) {  // of the limit at the start
        RubbedBlock block(k, drag * RubbedBlock::kFriction * RubbedBlock::kPressing * Vec3(0.8, -0.6, 0.0),
                          is_held);
        ASSERT_TRUE(block.scene.solve(kStep, block.contacts).is_ok());
        expect_coulomb(block, num_stuck, num_slid);
      }
  EXPECT_GT(num_stuck, 100);
  EXPECT_GT(num_slid, 100);
}

/// Rough solves find which points slide. What is left in the end is as little as the tolerance allows, and
/// the solves of a direct solver, which are never rough, are few.
TEST(ContactFriction, IsFoundByFewSolvesAndTheLastIsExact) {
  constexpr int kFewSolves = 10;
  for (const double k : kSpringStiffnesses)
    for (const double drag : {0.5, 3.0}) {
      const Vec3 trial = drag * RubbedBlock::kFriction * RubbedBlock::kPressing * Vec3(0.8, -0.6, 0.0);
      RubbedBlock direct(k, trial, true);
      RubbedBlock iterative(k, trial, true, linear::SolverKind::pcg);
      ASSERT_TRUE(direct.scene.solve(kStep, direct.contacts).is_ok());
      ASSERT_TRUE(iterative.scene.solve(kStep, iterative.contacts).is_ok());
      const Points expected = direct.scene.solid.trial.x - direct.scene.rest();
      const Points error = iterative.scene.solid.trial.x - direct.scene.solid.trial.x;
      EXPECT_LT(error.norm(), 5e-3 * expected.norm()) << k << " " << drag;
      EXPECT_LE(direct.scene.solid.history.counters.newton_iterations, kFewSolves) << k << " " << drag;
    }
}

/// What the contacts say that they carried is what a free block's momentum has become.
TEST(ContactFriction, GivesTheBlockTheMomentumThatItSays) {
  for (const double k : kSpringStiffnesses)
    for (const double drag : {0.5, 20.0}) {
      RubbedBlock block(k, drag * RubbedBlock::kFriction * RubbedBlock::kPressing * Vec3(0.8, -0.6, 0.0),
                        false);
      ASSERT_TRUE(block.scene.solve(kStep, block.contacts).is_ok());
      Vec3 impulse = Vec3::Zero();
      for (std::size_t i = 0; i < block.contacts.size(); ++i) impulse += kStep * block.acting(i);
      const Vec3 momentum = block.scene.state.v * block.scene.solid.materials.mass().matrix();
      // A stiff spring leaves little of its load: what cancels leaves rounding.
      const double rounding = 1e-9 * kStep * block.scene.load.colwise().norm().sum();
      EXPECT_LT((momentum - impulse).norm(), 1e-6 * impulse.norm() + rounding) << k << " " << drag;
    }
}

}  // namespace
}  // namespace argil::solid
