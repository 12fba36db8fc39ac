// Bullet's deformable body beside argil: the same box of tets, load and step, one backward Euler step with
// one linearised solve, single precision there and double here.
//   build/bin/bench_bullet --benchmark_filter=tets:10000
// A box of 0.1 m stands on its fixed bottom; gravity aside begins at once and bends it for 0.1 s in steps of
// 1 ms. Counters: `step` and `step_p99`, median and 99th percentile of a step [µs]; `top_mm`, how far the
// middle of the top has gone aside at the end. argil's step is a whole tick of the loop, with a tool that is
// far away.
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableLinearElasticityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <benchmark/benchmark.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <chrono>
#include <numeric>
#include <vector>

#include "contact/tool_shape.h"
#include "shapes/shapes.h"
#include "sim/simulation.h"

namespace argil {
namespace {

constexpr double kEdge = 0.1;                                      // [m]
constexpr double kYoung = 5e5, kPoisson = 0.4, kDensity = 1500.0;  // [Pa], [–], [kg/m³]
constexpr double kDamping = 0.002, kGravity = 50.0;                // [s] of stiffness, [m/s²] along x
constexpr double kStep = 1e-3;                                     // [s]
constexpr int kNumSteps = 100;
const double kMu = kYoung / (2.0 * (1.0 + kPoisson));
const double kLambda = kYoung * kPoisson / ((1.0 + kPoisson) * (1.0 - 2.0 * kPoisson));

bool is_fixed(const Vec3& x) {
  return x.z() < 1e-9;
}

/// The vertex nearest to the middle of the top.
int find_top(const mesh::TetMesh& mesh) {
  Eigen::Index top = 0;
  (mesh.vertices.colwise() - Vec3(0.0, 0.0, kEdge)).colwise().squaredNorm().minCoeff(&top);
  return static_cast<int>(top);
}

/// A quarter of each tet at its corners [kg].
Field lump_mass(const mesh::TetMesh& mesh) {
  Field mass = Field::Zero(mesh.num_vertices());
  for (int t = 0; t < mesh.num_tets(); ++t) {
    const auto corner = [&](int i) -> Vec3 { return mesh.vertices.col(mesh.tets(i, t)); };
    const double quarter =
        0.25 * kDensity * mesh::compute_tet_volume(corner(0), corner(1), corner(2), corner(3));
    for (const int v : mesh.tets.col(t)) mass(v) += quarter;
  }
  return mass;
}

/// The same mesh with the fixed vertices last: Bullet's implicit step takes the numbers of the free ones for
/// places.
mesh::TetMesh with_fixed_last(const mesh::TetMesh& mesh) {
  std::vector<int> order(static_cast<std::size_t>(mesh.num_vertices()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_partition(order.begin(), order.end(), [&](int v) { return !is_fixed(mesh.vertices.col(v)); });
  mesh::TetMesh sorted = mesh;
  std::vector<int> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    place[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
    sorted.vertices.col(static_cast<int>(i)) = mesh.vertices.col(order[i]);
  }
  for (int& v : sorted.tets.reshaped()) v = place[static_cast<std::size_t>(v)];
  return sorted;
}

/// One linearised solve a step, by as many iterations as it takes.
class BulletSolver : public btDeformableBodySolver {
 public:
  BulletSolver() {
    m_maxNewtonIterations = 1;
    m_cg.m_maxIterations = 5000;
    m_cr.m_maxIterations = 5000;
  }
};

class BulletBox {
 public:
  explicit BulletBox(const mesh::TetMesh& mesh)
      : m_dispatcher(&m_configuration),
        m_world(&m_dispatcher, &m_broadphase, &m_constraints, &m_configuration, &m_bodies),
        m_elasticity(static_cast<btScalar>(kMu), static_cast<btScalar>(kLambda), 0,
                     static_cast<btScalar>(kDamping)),
        m_load(btVector3(static_cast<btScalar>(kGravity), 0, 0)),
        m_top(find_top(mesh)),
        m_start(mesh.vertices(0, m_top)) {
    m_constraints.setDeformableSolver(&m_bodies);
    m_world.setImplicit(true);
    m_world.setLineSearch(false);
    m_world.setUseProjection(true);
    m_world.setGravity(btVector3(0, 0, 0));

    std::vector<btVector3> x;
    for (const auto column : mesh.vertices.colwise())
      x.emplace_back(static_cast<btScalar>(column(0)), static_cast<btScalar>(column(1)),
                     static_cast<btScalar>(column(2)));
    m_body = new btSoftBody(&m_world.getWorldInfo(), mesh.num_vertices(), x.data(), nullptr);
    for (int t = 0; t < mesh.num_tets(); ++t)
      m_body->appendTetra(mesh.tets(0, t), mesh.tets(1, t), mesh.tets(2, t), mesh.tets(3, t));
    const Field mass = lump_mass(mesh);
    for (int v = 0; v < mesh.num_vertices(); ++v)
      m_body->setMass(v, is_fixed(mesh.vertices.col(v)) ? 0 : static_cast<btScalar>(mass(v)));
    btSoftBodyHelpers::generateBoundaryFaces(m_body);
    m_body->initializeDmInverse();
    m_body->m_tetraScratches.resize(mesh.num_tets());
    m_body->m_tetraScratchesTn.resize(mesh.num_tets());
    m_body->m_cfg.collisions = 0;
    m_body->m_cfg.drag = 0;
    m_body->m_sleepingThreshold = 0;
    m_body->setActivationState(DISABLE_DEACTIVATION);
    m_world.addSoftBody(m_body);
    m_world.addForce(m_body, &m_elasticity);
    m_world.addForce(m_body, &m_load);
  }
  ~BulletBox() {
    m_world.removeSoftBody(m_body);
    delete m_body;
  }
  BulletBox(const BulletBox&) = delete;
  BulletBox& operator=(const BulletBox&) = delete;

  void step() { m_world.stepSimulation(static_cast<btScalar>(kStep), 1, static_cast<btScalar>(kStep)); }
  double top() const { return static_cast<double>(m_body->m_nodes[m_top].m_x.x()) - m_start; }

 private:
  btSoftBodyRigidBodyCollisionConfiguration m_configuration;
  btCollisionDispatcher m_dispatcher;
  btDbvtBroadphase m_broadphase;
  BulletSolver m_bodies;
  btDeformableMultiBodyConstraintSolver m_constraints;
  btDeformableMultiBodyDynamicsWorld m_world;
  btDeformableLinearElasticityForce m_elasticity;
  btDeformableGravityForce m_load;
  btSoftBody* m_body = nullptr;
  int m_top;
  double m_start;
};

sim::Simulation make_argil_box(const mesh::TetMesh& mesh, int threads) {
  sim::Body body;
  body.mesh = mesh;
  body.topology = mesh::make_topology(mesh);
  solid::Support bottom;
  bottom.region.kind = solid::Region::Kind::half_space;
  bottom.region.offset = 1e-9;
  body.supports.push_back(bottom);
  body.initial_saturation = Field::Zero(mesh.num_tets());
  sim::Params params;
  params.elastic = {kYoung, kPoisson};
  params.plasticity.enabled = false;
  params.kernel.form = material::KernelForm::off;
  params.solid.density = kDensity;
  params.solid.rayleigh_stiffness = kDamping;
  params.solid.gravity = Vec3(kGravity, 0.0, 0.0);
  params.contact = {100.0, 100.0};
  params.threads = threads;
  device::DeviceSample away;
  away.position = Vec3(0.0, 0.0, 3.0 * kEdge);
  return {std::move(body), contact::make_sphere_tool(0.01, 2), params, away};
}

/// Steps and measures; `step` advances by one, `top` says how far the top is aside [m].
template <class Step, class Top>
void measure(benchmark::State& state, const mesh::TetMesh& mesh, const Step& step, const Top& top) {
  std::vector<double> times;
  for (auto _ : state) {
    const auto begin = std::chrono::steady_clock::now();
    if (!step()) {
      state.SkipWithError("the step failed");
      return;
    }
    times.push_back(
        std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count());
  }
  std::sort(times.begin(), times.end());
  state.counters["step"] = times[times.size() / 2];
  state.counters["step_p99"] = times[(99 * (times.size() - 1)) / 100];
  state.counters["top_mm"] = 1e3 * top();
  state.counters["tets"] = mesh.num_tets();
}

mesh::TetMesh make_box(const benchmark::State& state) {
  return shapes::make_shape_mesh({shapes::ShapeKind::box, kEdge}, static_cast<int>(state.range(0)));
}

void bullet(benchmark::State& state) {
  const mesh::TetMesh mesh = with_fixed_last(make_box(state));
  BulletBox box(mesh);
  const auto step = [&] {
    box.step();
    return true;
  };
  measure(state, mesh, step, [&] { return box.top(); });
}

void argil_box(benchmark::State& state) {
  const mesh::TetMesh mesh = make_box(state);
  sim::Simulation simulation = make_argil_box(mesh, static_cast<int>(state.range(1)));
  const device::DeviceSample away = {simulation.hand_state().tool.position, Quat::Identity(),
                                     device::ToolMode::push};
  const int top = find_top(mesh);
  const double start = mesh.vertices(0, top);
  measure(
      state, mesh, [&] { return simulation.tick(away).is_ok(); },
      [&] { return simulation.body_state().solid.x(0, top) - start; });
}

BENCHMARK(bullet)
    ->ArgNames({"tets"})
    ->Args({2000})
    ->Args({10000})
    ->Args({40000})
    ->Iterations(kNumSteps)
    ->UseRealTime();
BENCHMARK(argil_box)
    ->Name("argil")
    ->ArgNames({"tets", "threads"})
    ->ArgsProduct({{2000, 10000, 40000}, {1, 2}})
    ->Iterations(kNumSteps)
    ->UseRealTime();

}  // namespace
}  // namespace argil

BENCHMARK_MAIN();
