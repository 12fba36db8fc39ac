// Contacts that are alone press or do not as the conditions of complementarity say, however stiff and many
// they are.
#include <algorithm>
#include <vector>

#include "support/solid_scene.h"

namespace argil::solid {
namespace {

using test::Scene;

constexpr double kStep = 1e-3;
constexpr double kCell = 2e-3;
constexpr int kCells = 6;

SolidParams make_params(Iteration iteration) {
  SolidParams params;
  params.iteration = iteration;
  params.solver.kind = linear::SolverKind::cholesky;
  params.solver.tolerance = 1e-9;  // of what presses, that may draw
  params.rayleigh_stiffness = 2e-3;
  return params;
}

Scene make_block(const SolidParams& params) {
  const mesh::TetMesh mesh =
      test::make_block(kCells, kCells, 2, Vec3(kCells * kCell, kCells * kCell, 2 * kCell));
  std::vector<int> floor;
  for (int n = 0; n < mesh.vertices.cols(); ++n)
    if (mesh.vertices(2, n) < 1e-9) floor.push_back(n);
  return {mesh, {test::hold_nodes(floor)}, params, 3e4, 0.3};
}

/// Points of a rough plane on all faces of the top, up to `depth` inside it or as far outside.
std::vector<PointStiffness> make_contacts(Scene& scene, Rng& rng, double stiffness, double depth) {
  constexpr int kPointsOfFace = 6;
  std::vector<PointStiffness> list;
  const Triangles faces = mesh::make_topology(scene.mesh).boundary;
  for (Eigen::Index f = 0; f < faces.cols(); ++f)
    for (int p = 0; p < kPointsOfFace; ++p) {
      PointStiffness c;
      bool is_top = true;
      Vec3 weight(rng.uniform(0.0, 1.0), rng.uniform(0.0, 1.0), rng.uniform(0.0, 1.0));
      weight /= weight.sum();
      for (std::size_t k = 0; k < 3; ++k) {
        c.vertex[k] = faces(static_cast<Eigen::Index>(k), f);
        c.weight[k] = weight(static_cast<Eigen::Index>(k));
        is_top = is_top && scene.rest()(2, c.vertex[k]) > 2 * kCell - 1e-9;
      }
      if (!is_top) continue;
      c.normal = Vec3(rng.uniform(-0.4, 0.4), rng.uniform(-0.4, 0.4), -1.0).normalized();
      c.stiffness = stiffness * rng.uniform(0.2, 5.0);
      c.force = c.stiffness * depth * rng.uniform(-0.2, 1.0) * c.normal;
      c.is_near = c.force.dot(c.normal) < 0.0;
      c.group = static_cast<int>(list.size());
      c.counts = c.is_alone = true;
      list.push_back(c);
    }
  return list;
}

/// What the points press with where the body is: each with max(0, f − k n·u).
struct Pressing {
  Points force;      // on the nodes [N]
  double sum = 0.0;  // [N]
  int num_come = 0;  // near ones that press
  int num_gone = 0;  // that pressed and do not
};

Pressing find_pressing(const Scene& scene, const std::vector<PointStiffness>& list, const Points& before) {
  Pressing pressing{Points::Zero(3, scene.num_nodes())};
  for (const PointStiffness& c : list) {
    Vec3 u = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k)
      u += c.weight[k] * (scene.state.x.col(c.vertex[k]) - before.col(c.vertex[k]));
    const double trial = c.normal.dot(c.force - c.stiffness * u);
    spread(c, std::max(0.0, trial) * c.normal, pressing.force);
    pressing.sum += std::max(0.0, trial);
    pressing.num_come += c.is_near && trial > 0.0 ? 1 : 0;
    pressing.num_gone += !c.is_near && trial < 0.0 ? 1 : 0;
  }
  return pressing;
}

/// With the forces that the contacts press with at the start; near ones give none.
void load(Scene& scene, const std::vector<PointStiffness>& list) {
  for (const PointStiffness& c : list)
    if (!c.is_near) spread(c, c.force, scene.load);
}

class EveryIteration : public testing::TestWithParam<Iteration> {};

/// And nothing else acts on the body.
TEST_P(EveryIteration, PressesWhereItIsPressedOn) {
  int num_searched = 0;
  int num_come = 0;
  int num_gone = 0;
  for (const double stiffness : {1.0, 1e2, 1e4, 1e6}) {
    Rng rng(7);
    for (int round = 0; round < 6; ++round) {
      Scene scene = make_block(make_params(GetParam()));
      const std::vector<PointStiffness> list = make_contacts(scene, rng, stiffness, 5e-5);
      for (int n = 0; n < scene.num_nodes(); ++n) scene.load.col(n) = Vec3(0, 0, rng.uniform(0.0, 0.05));
      const Points others = scene.load;
      load(scene, list);
      Points force = scene.load;
      Points wanted = others;
      const Points before = scene.state.x;
      ASSERT_TRUE(scene.step(kStep, list).is_ok()) << stiffness << ' ' << round;
      num_searched += scene.solid.contacts.search.num_rounds > 0 ? 1 : 0;
      const Pressing pressing = find_pressing(scene, list, before);
      num_come += pressing.num_come;
      num_gone += pressing.num_gone;
      wanted += pressing.force;
      apply_contact_stiffness(scene.solid, list, force);
      EXPECT_LT((force - wanted).norm(), 1e-6 * pressing.sum) << stiffness << ' ' << round;
    }
  }
  EXPECT_GT(num_come, 20);
  EXPECT_GT(num_gone, 20);
  if (GetParam() == Iteration::one) {
    EXPECT_GT(num_searched, 3);
  }
}

/// As much as a solve may leave of its residual, contacts may leave of what presses: fewer solves, and a
/// force that is as far off.
TEST(ContactSearch, LeavesAsMuchAsTheSolve) {
  int num_solves[2] = {};
  double largest = 0.0;
  for (int round = 0; round < 20; ++round)
    for (const bool is_loose : {false, true}) {
      Rng rng(static_cast<std::uint64_t>(round));
      SolidParams params = make_params(Iteration::one);
      if (is_loose) params.solver.tolerance = 1e-3;
      Scene scene = make_block(params);
      const std::vector<PointStiffness> list = make_contacts(scene, rng, 1e2, 5e-5);
      load(scene, list);
      Points force = scene.load;
      const Points before = scene.state.x;
      ASSERT_TRUE(scene.step(kStep, list).is_ok()) << round;
      num_solves[is_loose ? 1 : 0] += scene.solid.newton.iterations;
      const Pressing pressing = find_pressing(scene, list, before);
      apply_contact_stiffness(scene.solid, list, force);
      const double off = (force - pressing.force).norm() / pressing.sum;
      EXPECT_LT(off, is_loose ? 1e-3 : 1e-6) << round;
      if (is_loose) largest = std::max(largest, off);
    }
  EXPECT_LT(num_solves[1], num_solves[0]);
  EXPECT_GT(largest, 0.0);
}

/// What pressed where a step begins presses in its first solve, and what did not does not.
TEST(ContactSearch, BeginsWithWhatHasPressed) {
  Rng rng(3);
  Scene scene = make_block(make_params(Iteration::one));
  std::vector<PointStiffness> list = make_contacts(scene, rng, 1e2, 5e-5);
  const auto start = [&] {
    scene.solid.contacts.start(list, scene.state.v, kStep);
    return scene.solid.contacts.acts;
  };
  const std::vector<char> first = start();
  for (std::size_t i = 0; i < list.size(); ++i) EXPECT_EQ(first[i] != 0, !list[i].is_near) << i;
  for (std::size_t i = 0; i < list.size(); ++i) list[i].begin_force = i % 3 == 0 ? 1.0 : 0.0;
  const std::vector<char> later = start();
  for (std::size_t i = 0; i < list.size(); ++i) EXPECT_EQ(later[i] != 0, i % 3 == 0) << i;
}

INSTANTIATE_TEST_SUITE_P(Iterations, EveryIteration, testing::Values(Iteration::one, Iteration::newton),
                         [](const auto& param) { return param.param == Iteration::one ? "one" : "newton"; });

/// A loose solve is corrected where the step may leave less. Contacts that pressed by the loose solution and
/// would draw by the corrected one are let go, and those that it comes to press.
TEST(ContactSearch, ACorrectedSolutionPressesWhereItIsPressedOn) {
  SolidParams params = make_params(Iteration::one);
  params.solver.kind = linear::SolverKind::pcg;
  params.solver.tolerance = 0.3;
  for (int round = 0; round < 6; ++round) {
    Rng rng(static_cast<std::uint64_t>(round));
    Scene scene = make_block(params);
    const std::vector<PointStiffness> list = make_contacts(scene, rng, 1e3, 5e-5);
    load(scene, list);
    Points force = scene.load;
    const Points before = scene.state.x;
    StepLoads loads{scene.load, list};
    loads.slack = loads.limit = 1e-7;
    ASSERT_TRUE(begin_step(scene.solid, scene.region, scene.state, loads, {kStep, kStep, 0}).is_ok());
    for (bool solved = false; !solved;) {
      solved = assemble(scene.solid, scene.region, loads);
      if (solved) break;
      ASSERT_TRUE(solve(scene.solid, scene.region, loads, 0, solved).is_ok());
    }
    take_velocity(scene.solid, scene.region.part(), scene.state);
    move(scene.solid, scene.region.part(), scene.state);
    const Pressing pressing = find_pressing(scene, list, before);
    apply_contact_stiffness(scene.solid, list, force);
    EXPECT_LT((force - pressing.force).norm(), 1e-6 * pressing.sum) << round;
    EXPECT_GT(pressing.num_gone, 0);
  }
}

}  // namespace
}  // namespace argil::solid
