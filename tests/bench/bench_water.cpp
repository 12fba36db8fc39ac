// What a wetting step costs: water alone and a whole haptic tick of a wet tool on a body at rest, on bodies
// of 10 k, 100 k and 1 M tets (about a minute to set up).
//   build/bin/bench_water --benchmark_filter=touch
// Counters: `active` tets visited, `substeps` a step, `steps_per_s`.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>

#include "contact/tool_shape.h"
#include "sim/simulation.h"
#include "support/block_mesh.h"
#include "support/touched_tets.h"

namespace argil {
namespace {

constexpr double kStep = 0.01;  // water step [s]

/// Cube of 0.1 m with 6 n³ tets.
struct Cube {
  mesh::TetMesh mesh;
  mesh::Topology topology;
  explicit Cube(int n) : mesh(test::make_block(n, n, n, Vec3(0.1, 0.1, 0.1))) {
    topology = mesh::make_topology(mesh);
  }
};

water::WaterParams make_params() {
  water::WaterParams params;
  params.wetting_flux = params.drying_flux = 20.0;
  return params;
}

/// A tool that wets one spot for a while, then dries it, again and again. The spot is four faces, whatever
/// their size: a few tens of tets on every mesh.
void touch(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  const Cube cube(n);
  water::WaterParams params = make_params();
  params.diffusivity = 1e-9;
  params.scheme = static_cast<water::DiffusionScheme>(state.range(1));
  water::PoreWater water(cube.mesh, cube.topology, params, Field::Zero(cube.mesh.num_tets()));
  const std::vector<int> tets = test::find_tets_behind(cube.topology, std::array{0, 1, 2, 3});
  const double area[] = {1e-6, 1e-6, 1e-6, 1e-6};
  int step = 0, substeps = 0;
  for (auto _ : state) {
    substeps = water.move({tets, area, (step++ / 100) % 2 == 0 ? 1 : -1}, kStep);
    water.commit();
    benchmark::DoNotOptimize(water.saturation().data());
  }
  state.counters["tets"] = cube.mesh.num_tets();
  state.counters["active"] = water.num_active();
  state.counters["substeps"] = substeps;
  state.counters["steps_per_s"] = benchmark::Counter(step, benchmark::Counter::kIsRate);
}
BENCHMARK(touch)
    ->ArgNames({"edge", "implicit"})
    ->Args({12, 0})
    ->Args({26, 0})
    ->Args({55, 0})
    ->Unit(benchmark::kMicrosecond)
    ->UseRealTime();
BENCHMARK(touch)
    ->ArgNames({"edge", "implicit"})
    ->Args({12, 1})
    ->Unit(benchmark::kMicrosecond)
    ->Iterations(50);

/// The bottom of the cube is wet, a share of `percent` of its height: cost by the number of wet tets.
void layer(benchmark::State& state) {
  const Cube cube(12);
  water::WaterParams params = make_params();
  params.diffusivity = 1e-12;
  params.flux = static_cast<water::FluxForm>(state.range(1));
  Field start = Field::Zero(cube.mesh.num_tets());
  const double height = 0.001 * static_cast<double>(state.range(0));
  for (int t = 0; t < cube.mesh.num_tets(); ++t)
    if (cube.mesh.vertices(2, cube.mesh.tets(0, t)) < height - 1e-9) start(t) = 0.5 + 0.1 * (t % 2);
  water::PoreWater water(cube.mesh, cube.topology, params, start);
  int step = 0;
  for (auto _ : state) {
    water.diffuse(kStep);
    ++step;
  }
  state.counters["active"] = water.num_active();
  state.counters["steps_per_s"] = benchmark::Counter(step, benchmark::Counter::kIsRate);
}
BENCHMARK(layer)
    ->ArgNames({"percent", "two_point"})
    ->ArgsProduct({{10, 50, 100}, {0, 1}})
    ->Unit(benchmark::kMicrosecond);

/// Haptic ticks, each with contact and a water step, of a wet or a dry tool that rests on a body that rests.
void tick(benchmark::State& state) {
  const Cube cube(static_cast<int>(state.range(0)));
  sim::Body body;
  body.mesh = cube.mesh;
  body.topology = cube.topology;
  body.initial_saturation = Field::Zero(cube.mesh.num_tets());
  solid::Support floor;
  floor.region.kind = solid::Region::Kind::half_space;
  floor.region.offset = 1e-9;
  body.supports.push_back(floor);
  sim::Params params;
  params.elastic = {1e5, 0.3};
  params.contact = {50.0, 50.0};
  params.kernel.form = material::KernelForm::off;
  params.water = make_params();
  params.water.diffusivity = 1e-7;
  params.rates.water_period_ticks = 1;
  params.device.max_force = 10.0;
  params.device.max_force_rate = 1e9;
  device::DeviceSample sample;
  sample.position = {0.052, 0.047, 0.109};
  sample.mode = device::ToolMode::wet;
  sim::Simulation simulation(std::move(body), contact::make_sphere_tool(0.008, 2), params, sample);
  int step = 0;
  for (auto _ : state) {
    sample.position.z() = 0.1075 + 1e-5 * (step % 2);
    sample.mode = (step++ / 500) % 2 == 0 ? device::ToolMode::wet : device::ToolMode::dry;
    if (!simulation.tick(sample).is_ok()) state.SkipWithError("the step failed");
  }
  if (!simulation.body_state().is_at_rest || simulation.pore_water().mass() == 0.0)
    state.SkipWithError("no wet body at rest");
  state.counters["active"] = simulation.pore_water().num_active();
  state.counters["contacts"] = static_cast<double>(simulation.contacts().contacts.size());
  state.counters["steps_per_s"] = benchmark::Counter(step, benchmark::Counter::kIsRate);
}
BENCHMARK(tick)->ArgName("edge")->Arg(12)->Arg(26)->Arg(55)->Unit(benchmark::kMicrosecond)->UseRealTime();

}  // namespace
}  // namespace argil

BENCHMARK_MAIN();
