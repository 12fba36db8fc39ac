// Contacts in an implicit step let go instead of drawing: against every way of letting them go.
#include <optional>

#include "support/solid_scene.h"

namespace argil::solid {
namespace {

using test::Scene;

constexpr double kStep = 0.01;  // h [s]
constexpr int kNode = 7;

/// A cube without stiffness that moves in one corner alone: a point mass.
Scene make_point_mass(Integrator integrator, Iteration iteration) {
  SolidParams params;
  params.integrator = integrator;
  params.iteration = iteration;
  params.solver.kind = linear::SolverKind::cholesky;
  return Scene(test::make_block(1, 1, 1, Vec3(1, 1, 1)), {0, 1, 2, 3, 4, 5, 6}, params, 1e-9, 0.0);
}

Vec3 draw_vector(Rng& rng, double size) {
  return size * Vec3(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0));
}

/// Contact j of the list at the free corner.
PointStiffness make_contact(Rng& rng, double mass, int j) {
  PointStiffness contact{{kNode, -1, -1}, {1.0, 0.0, 0.0}, draw_vector(rng, 1.0).normalized()};
  contact.stiffness = rng.uniform(0.1, 10.0) * mass / (kStep * kStep);
  contact.force = mass * rng.uniform(0.0, 1.0) * contact.normal;
  contact.group = j;
  contact.counts = true;
  return contact;
}

/// Velocity of a mass after a step in which the contacts of `set` (bits) act, if that set is the right one:
/// what acts presses, what does not would draw. m (v' − v) = h Σ forces, at the end of the step, with x' − x
/// = h v' or, with Newmark's rule, ½ h (v + v').
std::optional<Vec3> find_velocity(const std::vector<PointStiffness>& contacts, unsigned set, double mass,
                                  const Vec3& v, const Vec3& load, bool is_newmark) {
  const double tau = is_newmark ? 0.5 * kStep : kStep;
  const Vec3 start = is_newmark ? Vec3(tau * v) : Vec3::Zero();  // x' − x = start + tau v'
  Vec3 right = mass * v + kStep * load;
  Mat3 left = mass * Mat3::Identity();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const PointStiffness& c = contacts[i];
    if ((set >> i & 1U) == 0) continue;
    const Mat3 K = c.stiffness * c.normal * c.normal.transpose();
    right += kStep * (c.force - K * start);
    left += kStep * tau * K;
  }
  const Vec3 after = left.inverse() * right;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const PointStiffness& c = contacts[i];
    const double force = c.normal.dot(c.force) - c.stiffness * c.normal.dot(start + tau * after);
    if ((force > 0.0) != ((set >> i & 1U) != 0)) return {};
  }
  return after;
}

TEST(Contacts, LetGoOrActAsTheOnlySetThatAgreesWithItself) {
  int num_let_go = 0, num_mixed = 0;
  for (const Integrator integrator : {Integrator::backward_euler, Integrator::bdf2, Integrator::newmark})
    for (const Iteration iteration : {Iteration::one, Iteration::newton}) {
      Rng rng(3);
      for (int round = 0; round < 100; ++round) {
        Scene scene = make_point_mass(integrator, iteration);
        const double mass = scene.solid.materials.mass()(kNode);
        std::vector<PointStiffness> contacts;
        for (int j = 0; j < 3; ++j) contacts.push_back(make_contact(rng, mass, j));
        const Vec3 v = scene.state.v.col(kNode) = draw_vector(rng, 0.03);
        const Vec3 load = draw_vector(rng, mass);
        scene.load.col(kNode) = load;
        for (const PointStiffness& c : contacts) scene.load.col(kNode) += c.force;
        Points force = scene.load;
        ASSERT_TRUE(scene.solve(kStep, contacts).is_ok());

        std::optional<Vec3> wanted;
        for (unsigned set = 0; set < 8; ++set) {
          const auto found = find_velocity(contacts, set, mass, v, load, integrator == Integrator::newmark);
          if (!found) continue;
          ASSERT_FALSE(wanted) << "two sets agree with themselves";
          wanted = found;
          num_let_go += set != 7U ? 1 : 0;
          num_mixed += set != 7U && set != 0U ? 1 : 0;
        }
        ASSERT_TRUE(wanted);
        const Vec3 after = scene.state.v.col(kNode);
        EXPECT_LT((after - *wanted).norm(), 1e-9) << round;
        // The books: what is said to have acted is what changed the momentum.
        apply_contact_stiffness(scene.solid, contacts, force);
        EXPECT_LT((kStep * force.col(kNode) - mass * (after - v)).norm(), 1e-9 * mass) << round;
      }
    }
  EXPECT_GT(num_let_go, 100);
  EXPECT_GT(num_mixed, 50);
}

TEST(Contacts, FrictionGoesWithTheContactThatCarriesIt) {
  // A mass that leaves upwards: neither its contact nor the spring of sticking holds it.
  for (const double speed : {-0.1, 0.1}) {
    Scene scene = make_point_mass(Integrator::backward_euler, Iteration::one);
    const double mass = scene.solid.materials.mass()(kNode);
    const double k = mass / (kStep * kStep);
    PointStiffness normal{
        {kNode, -1, -1}, {1.0, 0.0, 0.0}, Vec3::UnitZ(), k, mass * Vec3(0.3, 0.0, 1.0), 0, true};
    PointStiffness along{{kNode, -1, -1}, {1.0, 0.0, 0.0}, Vec3::UnitX(), k, Vec3::Zero(), 0};
    const std::vector<PointStiffness> contacts{normal, along};
    scene.state.v.col(kNode) = Vec3(0.2, 0.0, speed);
    scene.load.col(kNode) = normal.force;
    ASSERT_TRUE(scene.solve(kStep, contacts).is_ok());
    const Vec3 after = scene.state.v.col(kNode);
    // Up: free. Down: (m + h² k) v' = m v + h f along both.
    const Vec3 wanted =
        speed > 0.0 ? Vec3(0.2, 0.0, speed) : Vec3(0.5 * (0.2 + 0.3 * kStep), 0.0, 0.5 * (speed + kStep));
    EXPECT_LT((after - wanted).norm(), 1e-9) << speed;
  }
}

TEST(Contacts, WithoutAChangeOfSignTheyCostNoSecondSolve) {
  for (const double speed : {-0.1, 0.1}) {
    Scene scene = make_point_mass(Integrator::backward_euler, Iteration::one);
    const double mass = scene.solid.materials.mass()(kNode);
    const PointStiffness contact{
        {kNode, -1, -1}, {1.0, 0.0, 0.0}, Vec3::UnitZ(), 1e4 * mass, mass * Vec3::UnitZ(), 0, true};
    scene.state.v(2, kNode) = speed;
    scene.load.col(kNode) = contact.force;
    ASSERT_TRUE(scene.solve(kStep, std::span(&contact, 1)).is_ok());
    EXPECT_EQ(scene.solid.history.counters.newton_iterations, speed > 0.0 ? 2 : 1);
  }
}

}  // namespace
}  // namespace argil::solid
