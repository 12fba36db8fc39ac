// Damping and friction of the tool on the body (src/contact/README.md, "Damping and friction").

#include <gtest/gtest.h>

#include "base/rng.h"
#include "scenes.h"

namespace argil::contact {
namespace {

constexpr double kK = 100.0;
constexpr double kTick = 0.001;

/// One vertex down: its force is that of one pair.
mesh::TriangleMesh make_spike() {
  mesh::TriangleMesh spike;
  spike.vertices.resize(3, 4);
  spike.vertices << 0, 0.004, -0.002, -0.002, 0, 0, 0.0035, -0.0035, 0, 0.02, 0.02, 0.02;
  spike.triangles.resize(3, 4);
  spike.triangles << 0, 0, 0, 1, 2, 3, 1, 2, 1, 2, 3, 3;
  return spike;
}

struct Rubbed {
  mesh::TriangleMesh body = test::make_flat_slab(2);
  ContactDetector detector;
  Pose pose;
  Contacts contacts;

  explicit Rubbed(const ContactParams& params, const mesh::TriangleMesh& tool = make_spike())
      : detector(body.triangles, body.num_vertices(), tool, params) {
    pose.position = Vec3(0.011, 0.007, 0.0005);
  }
  /// Mean force on the tool while it goes by `step`.
  Vec3 move(const Vec3& step) {
    Pose next = pose;
    next.position += step;
    detector.find_contacts(body.vertices, body.vertices, pose, next, contacts, {}, kTick);
    pose = next;
    return contacts.force_on_tool + contacts.resistance_on_tool;
  }
};

ContactParams make_params(double damping, double friction) {
  ContactParams params{kK, kK};
  params.damping = damping;
  params.friction = friction;
  return params;
}

TEST(Damping, IsHuntAndCrossleysForceInAPressAtConstantSpeed) {
  // Mean over a tick of k d (1 + λ v) for d from d₀ to d₁: k (d₀ + d₁)/2 (1 + λ v), exactly.
  constexpr double kLambda = 3.0;
  Rubbed scene(make_params(kLambda, 0.0));
  scene.move({0, 0, -0.001});  // the tip lies 0.5 mm deep
  for (const double v : {0.1, 0.02, 0.0, -0.05}) {
    const double d0 = -scene.pose.position.z();
    const double force = scene.move({0, 0, -v * kTick}).z();
    const double mean = d0 + 0.5 * v * kTick;
    EXPECT_NEAR(force, kK * mean * (1.0 + kLambda * v), 1e-13) << v;
  }
  // A hand that leaves faster than 1/λ feels nothing; it is never held back.
  EXPECT_EQ(scene.move({0, 0, 0.4 * kTick}).z(), 0.0);
}

TEST(Damping, MakesABouncingBallLoseWhatTheClosedFormSays) {
  // m ẍ = −k x (1 + λ ẋ) from the surface with speed v: it leaves with u, where
  // λ (v + u) = ln((1 + λ v)/(1 − λ u))  (first integral of the motion [Hunt1975]).
  constexpr double kLambda = 0.8, kMass = 0.05, kSpeed = 0.5;
  double low = 0.0, high = std::min(kSpeed, 1.0 / kLambda);
  for (int i = 0; i < 100; ++i) {
    const double u = 0.5 * (low + high);
    (std::log((1.0 + kLambda * kSpeed) / (1.0 - kLambda * u)) < kLambda * (kSpeed + u) ? low : high) = u;
  }
  Rubbed scene(make_params(kLambda, 0.0));
  scene.pose.position.z() = 1e-6;
  double v = -kSpeed;
  double force = 0.0;
  do {  // force of the last tick, path of this one: leapfrog, first order in the tick
    v += force / kMass * kTick / 20.0;
    Pose next = scene.pose;
    next.position.z() += v * kTick / 20.0;
    scene.detector.find_contacts(scene.body.vertices, scene.body.vertices, scene.pose, next, scene.contacts,
                                 {}, kTick / 20.0);
    scene.pose = next;
    force = (scene.contacts.force_on_tool + scene.contacts.resistance_on_tool).z();
  } while (scene.pose.position.z() <= 1e-6);
  EXPECT_NEAR(v, low, 2e-3 * low);  // from the tick, 1/2800 of the bounce
  EXPECT_LT(v, 0.9 * kSpeed);
}

TEST(Friction, SlidesAtMuTimesTheNormalForceAgainstTheMotion) {
  constexpr double kMu = 0.4;
  Rubbed scene(make_params(0.0, kMu), make_sphere_tool(0.008, 3));
  scene.pose.position.z() = 0.0085;
  scene.move({0, 0, -0.0015});
  // From rest all pairs slide alike. After a turn what they hold across the way dies out, by e^{-1} each μ d.
  for (const auto& [direction, rounding] : {std::pair{Vec3(1, 0, 0), 1e-12}, {Vec3(0.6, -0.8, 0), 1e-4}}) {
    for (int i = 0; i < 9; ++i) scene.move(3e-4 * direction);
    const Vec3 force = scene.move(3e-4 * direction);
    ASSERT_GT(force.z(), 0.1);
    EXPECT_LT((force - force.z() * (Vec3::UnitZ() - kMu * direction)).norm(), 10 * rounding * force.z());
  }
}

TEST(Friction, SticksByASpringUntilItSlides) {
  constexpr double kMu = 0.5;
  constexpr double kDepth = 5e-4;
  Rubbed scene(make_params(0.0, kMu));
  scene.move({0, 0, -2 * kDepth});
  scene.move({0, 0, 0});
  for (int i = 1; i <= 100; ++i) {
    const Vec3 force = scene.move({5e-6, 0, 0});
    EXPECT_NEAR(-force.x(), kK * std::min(5e-6 * i, kMu * kDepth), 1e-12) << i;
    EXPECT_NEAR(force.z(), kK * kDepth, 1e-12);
  }
  // At rest it holds what it held.
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(-scene.move({0, 0, 0}).x(), kK * kMu * kDepth, 1e-12);
  // And nothing is left of it after a lift.
  scene.move({0, 0, 3 * kDepth});
  scene.move({0, 0, -3 * kDepth});
  EXPECT_NEAR(scene.move({0, 0, 0}).x(), 0.0, 1e-12);
}

TEST(Resistance, TakesEnergyOnEveryClosedWay) {
  for (const auto& [damping, friction] : {std::pair{0.0, 0.0}, {2.0, 0.0}, {0.0, 0.6}, {2.0, 0.6}}) {
    Rubbed scene(make_params(damping, friction));
    Rng rng(3, "ways");
    double work = 0.0;  // of the hand on the body
    double total = 0.0;
    const auto go = [&](const Vec3& step) {
      const double w = -scene.move(step).dot(step);
      work += w;
      total += std::abs(w);
    };
    const Vec3 home = scene.pose.position;
    for (int i = 0; i < 2000; ++i) {
      Vec3 to = home + Vec3(rng.uniform(-1e-3, 1e-3), rng.uniform(-1e-3, 1e-3), rng.uniform(-2e-3, 2e-3));
      if (i % 20 == 19) to = home;
      go(to - scene.pose.position);
      if (i % 20 == 19) {
        EXPECT_GE(work, -1e-12 * total) << damping << ' ' << friction << ' ' << i;
      }
    }
    if (damping == 0.0 && friction == 0.0) {
      EXPECT_NEAR(work, 0.0, 1e-9 * total);
    } else {
      EXPECT_GT(work, 0.02 * total);
    }
  }
}

TEST(Resistance, IsEqualAndOppositeOnBodyAndTool) {
  Rubbed scene(make_params(1.0, 0.5), make_sphere_tool(0.008, 2));
  scene.body = test::make_slab(20, 0.1, 0.02, [](double x, double y) { return 0.01 * x + 0.3 * y * y; });
  scene.detector = ContactDetector(scene.body.triangles, scene.body.num_vertices(),
                                   make_sphere_tool(0.008, 2), make_params(1.0, 0.5));
  scene.pose.position = {0.011, 0.007, 0.0085};
  for (int i = 0; i < 15; ++i) {
    const Vec3 on_tool = scene.move({2e-4, 1e-4, -1.5e-4});
    Vec3 force = Vec3::Zero();
    Vec3 moment = Vec3::Zero();
    for (const Contact& c : scene.contacts.contacts)
      for (std::size_t k = 0; k < 3 && c.vertex[k] >= 0; ++k) {
        const Vec3 f = c.weight[k] * (c.force + c.resistance);
        force += f;
        moment += (Vec3(scene.body.vertices.col(c.vertex[k])) - scene.pose.position).cross(f);
      }
    EXPECT_LT((force + on_tool).norm(), 1e-13);
    EXPECT_LT((moment + scene.contacts.torque_on_tool + scene.contacts.resistance_torque_on_tool).norm(),
              1e-14);
  }
  EXPECT_GT(scene.contacts.resistance_on_tool.norm(), 0.1);
}

TEST(Resistance, GoesOnWithTheSameBitsFromAKeptState) {
  const mesh::TriangleMesh tool = make_sphere_tool(0.008, 2);
  const ContactParams params = make_params(1.0, 0.5);
  Rubbed one(params, tool);
  one.pose.position.z() = 0.0081;
  for (int i = 0; i < 20; ++i) one.move({1e-4, 0, i < 10 ? -1e-4 : 0.0});
  Rubbed two(params, tool);
  two.pose = one.pose;
  two.detector.restore(one.detector.state());
  for (int i = 0; i < 20; ++i) ASSERT_EQ(one.move({-2e-5, 3e-5, 0}), two.move({-2e-5, 3e-5, 0})) << i;
  EXPECT_GT(one.contacts.resistance_on_tool.norm(), 0.0);
}

}  // namespace
}  // namespace argil::contact
