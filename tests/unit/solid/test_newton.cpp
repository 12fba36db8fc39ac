// Solvers against each other, and Newton's method: its order, its line search, its refusals.
#include "support/laws.h"
#include "support/solid_scene.h"

namespace argil::solid {
namespace {

using test::Scene;

/// A block on a slide that moves, held at a corner, pressed by two contacts, damped.
struct Pressed {
  Scene scene;
  std::vector<PointStiffness> contacts;

  static std::vector<Support> make_supports(const SolidParams& params) {
    Support slide;
    slide.region.kind = Region::Kind::plane;
    slide.fixes = {false, false, true};
    slide.displacement = Vec3(0, 0, -0.01);
    slide.ramp_end = 0.03;
    Support corner;
    corner.region.kind = Region::Kind::sphere;
    corner.region.radius = 0.01;
    return params.element == ElementKind::p2 ? std::vector{corner, slide} : std::vector{slide, corner};
  }
  explicit Pressed(const SolidParams& params)
      : scene(test::make_irregular_block(2, 2, 2, Vec3(0.2, 0.15, 0.1)), make_supports(params), params, 1e5,
              0.42) {
    const Triangles& surface = scene.solid.model.elements.surface;
    for (const Eigen::Index f : {surface.cols() - 1, surface.cols() / 2}) {
      PointStiffness contact{
          {surface(0, f), surface(1, f), surface(2, f), -1}, {0.2, 0.5, 0.3}, Vec3(1, 2, -2) / 3.0, 3e4};
      for (int k = 0; k < 3; ++k)
        scene.load.col(surface(k, f)) += contact.weight[static_cast<std::size_t>(k)] * Vec3(4, -3, -9);
      contacts.push_back(contact);
    }
  }
  Points run() {
    for (int k = 0; k < 4; ++k) {
      const StepStatus status = scene.step(0.01, contacts);
      EXPECT_TRUE(status.is_ok()) << status.failure().quantity << ' ' << status.failure().value;
    }
    return scene.displacement();
  }
};

using SolverCase = std::tuple<StrainModel, ElementKind, Iteration>;
class Solvers : public testing::TestWithParam<SolverCase> {};

TEST_P(Solvers, AgreeOnEveryStep) {
  SolidParams params;
  std::tie(params.model, params.element, params.iteration) = GetParam();
  params.rayleigh_mass = 3.0;
  params.rayleigh_stiffness = 2e-3;
  params.gravity = Vec3(0, 0, -9.81);
  params.solver.tolerance = 1e-12;
  params.solver.kind = linear::SolverKind::cholesky;
  const Points expected = Pressed(params).run();
  ASSERT_GT(expected.norm(), 1e-3);
  for (const linear::SolverKind kind :
       {linear::SolverKind::pcg_cholesky, linear::SolverKind::pcg_jacobi, linear::SolverKind::pcg_matrix_free,
        linear::SolverKind::supernodal}) {
    params.solver.kind = kind;
    EXPECT_LT((Pressed(params).run() - expected).norm(), 1e-9 * expected.norm()) << static_cast<int>(kind);
  }
}

INSTANTIATE_TEST_SUITE_P(Every, Solvers,
                         testing::Combine(testing::ValuesIn(test::every_model()),
                                          testing::Values(ElementKind::p1, ElementKind::p1_nodal,
                                                          ElementKind::p2),
                                          testing::Values(Iteration::one, Iteration::newton)));

/// A bar held at one end and pulled and bent at the other.
Scene make_bar(SolidParams params, double force) {
  params.solver.kind = linear::SolverKind::cholesky;
  Support wall;
  wall.region.kind = Region::Kind::plane;
  wall.region.normal = Vec3::UnitX();
  Scene scene(test::make_irregular_block(4, 2, 2, Vec3(0.4, 0.1, 0.1)), std::vector{wall}, params, 1e5, 0.3);
  for (int n = 0; n < scene.num_nodes(); ++n)
    if (scene.rest()(0, n) > 0.399) scene.load.col(n) = force * Vec3(3.0, 0.4, 1.0);
  return scene;
}

/// What a bar's law has beyond isotropic elasticity.
enum class History { plastic, anisotropic };

void give_history(History history, Scene& scene) {
  Rng rng(4);
  if (history == History::plastic)
    for (Eigen::Index i = 0; i < scene.state.plastic_strain.size(); ++i)
      scene.state.plastic_strain(i) = rng.uniform(-0.05, 0.05);
  if (history != History::anisotropic) return;
  Mat6 C = make_isotropic_stiffness(6e4, 4e4);
  C.topLeftCorner<1, 1>() *= 3.0;
  C(3, 3) *= 0.3;
  C(2, 4) = C(4, 2) = 1e4;
  for (int t = 0; t < scene.mesh.num_tets(); ++t) set_stiffness(scene.solid, t, C);
}

/// Hencky's law has no equilibrium above a pull of E/e over the rest area, where a bar necks; the 25 nodes of
/// a p2 bar's end pull by 0.45 E at a load of 6.
double find_bearable_load(const SolidParams& params) {
  return params.model == StrainModel::hencky ? 3.0 : 6.0;
}

/// Relative residual after one step of Newton's method from `distance` off the equilibrium.
double find_residual_near(SolidParams params, History history, double distance) {
  const double load = find_bearable_load(params);
  Scene solved = make_bar(params, load);
  give_history(history, solved);
  EXPECT_TRUE(solved.step(1e4).is_ok());  // one long step of a light body: statics
  params.newton_max_iterations = 1;
  Scene scene = make_bar(params, load);
  give_history(history, scene);
  scene.state.x = solved.state.x;
  Rng rng(5);
  for (int n = 0; n < scene.num_nodes(); ++n)
    if (scene.rest()(0, n) > 1e-9)
      for (int k = 0; k < 3; ++k) scene.state.x(k, n) += distance * rng.uniform(-1.0, 1.0);
  EXPECT_TRUE(update_kinematics(scene.solid, scene.region, scene.state.x, 0).is_ok());
  const StepStatus status = scene.step(1e4);
  EXPECT_FALSE(status.is_ok());
  return status.is_ok() ? 0.0 : status.failure().value;
}

/// Relative residuals before each of Newton's steps: what is reported when it may take no more.
std::vector<double> find_residuals(SolidParams params, bool is_static) {
  std::vector<double> residuals;
  for (params.newton_max_iterations = 0; params.newton_max_iterations < 30; ++params.newton_max_iterations) {
    Scene scene = make_bar(params, find_bearable_load(params));
    // Statics would go on in shares of the load; one long step of a light body is the same task without.
    const StepStatus status = is_static ? scene.step(1e4) : scene.step(0.05);
    if (status.is_ok()) break;
    residuals.push_back(status.failure().value);
  }
  return residuals;
}

/// Two successive orders above rounding, in the last three steps: the better one is Newton's.
void expect_quadratic(const std::vector<double>& r) {
  ASSERT_GE(r.size(), 3U);
  ASSERT_LT(r.size(), 20U);
  double order = 0.0;
  for (std::size_t k = r.size() - 1; k + 3 >= r.size() && k >= 2; --k)
    order = std::max(order, std::log(r[k] / r[k - 1]) / std::log(r[k - 1] / r[k - 2]));
  EXPECT_GT(order, 1.7) << testing::PrintToString(r);
}

TEST(Newton, ConvergesQuadratically) {
  for (const StrainModel model : test::every_nonlinear_model())
    for (const ElementKind element : {ElementKind::p1, ElementKind::p1_nodal, ElementKind::p2})
      for (const bool is_static : {true, false}) {
        SCOPED_TRACE(testing::Message() << static_cast<int>(model) << static_cast<int>(element) << is_static);
        SolidParams params;
        params.model = model;
        params.element = element;
        params.iteration = Iteration::newton;
        expect_quadratic(find_residuals(params, is_static));
      }
}

TEST(Newton, ConvergesQuadraticallyWithPlasticStrainAndAnisotropicStiffness) {
  for (const StrainModel model : test::every_nonlinear_model())
    for (const ElementKind element : {ElementKind::p1, ElementKind::p1_nodal, ElementKind::p2})
      for (const History history : {History::plastic, History::anisotropic}) {
        if (history == History::anisotropic &&
            (!find_law(model).takes_full_stiffness || element == ElementKind::p1_nodal))
          continue;  // isotropic only
        SCOPED_TRACE(testing::Message()
                     << static_cast<int>(model) << static_cast<int>(element) << static_cast<int>(history));
        SolidParams params;
        params.model = model;
        params.element = element;
        params.iteration = Iteration::newton;
        const double far = find_residual_near(params, history, 5e-5);
        const double near = find_residual_near(params, history, 2.5e-5);
        EXPECT_NEAR(std::log2(far / near), 2.0, 0.05) << far << " " << near;
      }
}

TEST(Newton, FindsTheSameEquilibriumFromABadStart) {
  for (const StrainModel model : test::every_nonlinear_model())
    for (const ElementKind element : {ElementKind::p1, ElementKind::p1_nodal, ElementKind::p2}) {
      SolidParams params;
      params.model = model;
      params.element = element;
      Scene good = make_bar(params, 3.0);
      ASSERT_TRUE(good.find_equilibrium().is_ok());
      Scene bad = make_bar(params, 3.0);
      Rng rng(9);
      for (int n = 0; n < bad.num_nodes(); ++n)
        if (bad.solid.model.constraints.is_free(n))
          bad.state.x.col(n) += 0.006 * Vec3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
      ASSERT_TRUE(bad.find_equilibrium().is_ok());
      EXPECT_LT((bad.state.x - good.state.x).norm(), 1e-7 * good.displacement().norm())
          << static_cast<int>(model) << static_cast<int>(element);
    }
}

TEST(Newton, DampedTurningBodyConverges) {
  // Damping turns with the body; in a step its frame is that of the start, or there is no potential to fall.
  for (const StrainModel model : test::every_nonlinear_model()) {
    SolidParams params;
    params.model = model;
    params.element = ElementKind::p1_nodal;
    params.iteration = Iteration::newton;
    params.rayleigh_stiffness = 0.01;
    params.solver.kind = linear::SolverKind::cholesky;
    Scene scene(test::make_irregular_block(3, 2, 2, Vec3(0.3, 0.2, 0.2)), {}, params, 1e5, 0.45);
    for (int n = 0; n < scene.num_nodes(); ++n)
      scene.state.v.col(n) = Vec3(3, 10, 5).cross(scene.rest().col(n) - Vec3(0.15, 0.1, 0.1));
    for (int k = 0; k < 10; ++k) {
      const StepStatus status = scene.step(0.03);
      ASSERT_TRUE(status.is_ok()) << status.failure().quantity << status.failure().value;
    }
    EXPECT_LT(scene.solid.history.counters.newton_iterations, 15);
  }
}

TEST(Newton, FindsABodyAtRestAtRest) {
  for (const StrainModel model : test::every_model()) {
    SolidParams params;
    params.model = model;
    Scene scene = make_bar(params, 0.0);
    ASSERT_TRUE(scene.find_equilibrium().is_ok());
    EXPECT_LT(scene.displacement().norm(), 1e-14);
  }
}

/// A second linearisation, about where the first one came to, leaves a small part of what the first one did.
class FollowedTurns : public testing::TestWithParam<std::tuple<StrainModel, ElementKind>> {};

TEST_P(FollowedTurns, BringAStepNearToNewtons) {
  const auto run = [](Iteration iteration, bool follows_turns) {
    SolidParams params;
    std::tie(params.model, params.element) = GetParam();
    params.iteration = iteration;
    params.rayleigh_mass = 3.0;
    params.solver.tolerance = 1e-9;
    Pressed pressed(params);
    pressed.scene.follows_turns = follows_turns;
    return pressed.run();
  };
  const Points exact = run(Iteration::newton, false);
  const double once = (run(Iteration::one, false) - exact).norm();
  ASSERT_GT(once, 1e-4 * exact.norm());
  EXPECT_LT((run(Iteration::one, true) - exact).norm(), 0.2 * once);
}

INSTANTIATE_TEST_SUITE_P(
    LawsAndElements, FollowedTurns,
    testing::Combine(testing::Values(StrainModel::corotational, StrainModel::hencky, StrainModel::curnier),
                     testing::Values(ElementKind::p1, ElementKind::p2, ElementKind::p1_nodal)));

TEST(Newton, ThatMayNotGoOnReportsItAndLeavesTheState) {
  SolidParams params;
  params.iteration = Iteration::newton;
  params.newton_max_iterations = 2;
  Scene scene = make_bar(params, 6.0);
  const SolidState before = scene.state;
  const StepStatus status = scene.step(0.05);
  ASSERT_FALSE(status.is_ok());
  EXPECT_EQ(status.failure().quantity, "Newton's relative residual");
  EXPECT_GT(status.failure().value, params.newton_tolerance);
  EXPECT_EQ(status.failure().bound, params.newton_tolerance);
  EXPECT_TRUE((scene.state.x.array() == before.x.array()).all());
  EXPECT_TRUE((scene.state.v.array() == before.v.array()).all());
}

TEST(Solve, ThatDoesNotConvergeReportsItAndLeavesTheState) {
  for (const linear::SolverKind kind :
       {linear::SolverKind::pcg_jacobi, linear::SolverKind::pcg_matrix_free}) {
    SolidParams params;
    params.solver.kind = kind;
    params.solver.max_iterations = 2;
    Scene scene(test::make_block(3, 2, 2, Vec3(0.3, 0.2, 0.2)), {0, 1, 2}, params, 1e5, 0.3);
    scene.load.col(20) = Vec3(1, 2, 3);
    const StepStatus status = scene.step(0.1);
    ASSERT_FALSE(status.is_ok());
    EXPECT_EQ(status.failure().quantity, "relative residual of the linear solve");
    EXPECT_EQ(scene.displacement().norm(), 0.0);
    EXPECT_EQ(scene.state.v.norm(), 0.0);
  }
}

TEST(FindEquilibrium, CountsTheIterationsOfAllSharesOfTheLoad) {
  // A share may take the limit and one more, which is refused; a load that needs several takes more together.
  SolidParams params;
  params.newton_max_iterations = 4;
  Scene scene = make_bar(params, 60.0);
  ASSERT_TRUE(scene.find_equilibrium().is_ok());
  EXPECT_GT(scene.solid.history.counters.newton_iterations, params.newton_max_iterations + 1);
}

TEST(FindEquilibrium, ThatFailsKeepsTheLastShareOfTheLoad) {
  SolidParams params;
  params.newton_max_iterations = 4;
  Scene scene = make_bar(params, 200.0);
  const StepStatus status = scene.find_equilibrium();
  ASSERT_FALSE(status.is_ok());
  // In balance with a part of the load, of which a 1024th is the least.
  const Points force = scene.compute_force(scene.state.x);
  const double share = force.cwiseProduct(scene.load).sum() / scene.load.squaredNorm();
  EXPECT_GT(share, 1.0 / 1024.0 - 1e-9);
  EXPECT_LT(share, 1.0);
  double largest = 0.0;
  for (int n = 0; n < scene.num_nodes(); ++n)
    if (scene.solid.model.constraints.is_free(n))
      largest = std::max(largest, (force.col(n) - share * scene.load.col(n)).norm());
  EXPECT_LT(largest, 1e-8 * scene.load.norm());
}

}  // namespace
}  // namespace argil::solid
