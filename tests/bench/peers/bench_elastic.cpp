// The bare elastic step on a task that other programs have, too: a box of 0.1 m on its fixed bottom, E = 500
// kPa, ν = 0.4, 1500 kg/m³, damping 0.002 s of stiffness, pressed by 60 N in a patch that wanders over its
// top; corotational, one linearised backward Euler step of 1 ms. No contact, no water, no flow.
//   build/bin/bench_elastic BOX.msh TOLERANCE STEPS THREADS
// BOX.msh: Gmsh 2.2, a unit box on z = 0 about the axis. Prints a row: tets, threads, tolerance, median and
// least time of a step [ms], iterations a step, how far the patch has gone down at the end [mm].
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

#include "mesh/order.h"
#include "mesh/topology.h"
#include "mesh_files/readers.h"
#include "solid/material_changes.h"
#include "solid/move.h"
#include "solid/step_solver.h"

namespace argil {
namespace {

constexpr double kEdge = 0.1;                                      // [m]
constexpr double kYoung = 5e5, kPoisson = 0.4;                     // [Pa], [–]
constexpr double kForce = 60.0, kRamp = 0.05;                      // [N], [s]
constexpr double kPatch = 0.01, kWander = 0.02, kFrequency = 1.0;  // [m] deviation, [m], [Hz]
constexpr double kStep = 1e-3;                                     // [s]

/// Share of each node in the load at a time.
Field weigh(const Points& rest, double time) {
  const Vec3 centre(kWander * std::sin(2.0 * M_PI * kFrequency * time), 0.0, kEdge);
  Field weight = Field::Zero(rest.cols());
  for (Eigen::Index n = 0; n < rest.cols(); ++n)
    if (rest(2, n) > 0.8 * kEdge)
      weight(n) = std::exp(-(rest.col(n) - centre).squaredNorm() / (2.0 * kPatch * kPatch));
  return weight / weight.sum();
}

StepStatus run(const mesh::TetMesh& mesh, double tolerance, int num_steps, int threads) {
  solid::SolidParams params;
  params.rayleigh_stiffness = 0.002;
  params.solver.tolerance = tolerance;
  solid::Support bottom;
  bottom.region.kind = solid::Region::Kind::plane;
  solid::Body solid(mesh, mesh::make_topology(mesh), {bottom}, params, threads);
  solid::ActiveRegion region(solid);
  const double mu = kYoung / (2.0 * (1.0 + kPoisson));
  const double lambda = 2.0 * mu * kPoisson / (1.0 - 2.0 * kPoisson);
  for (int t = 0; t < mesh.num_tets(); ++t) solid::set_material(solid, region, t, {lambda, mu, 0.0});
  solid::SolidState state = solid::make_rest_state(solid.model);
  ARGIL_TRY(solid::update_kinematics(solid, region, state.x, 0));
  std::this_thread::sleep_for(
      std::chrono::milliseconds(300));  // until threads that libraries start have come to rest
  Points force = Points::Zero(3, state.x.cols());
  const solid::StepLoads loads{force};
  std::vector<double> seconds;
  int iterations = 0;
  for (int k = 1; k <= num_steps; ++k) {
    const double time = k * kStep;
    force.row(2) = -std::min(1.0, time / kRamp) * kForce * weigh(solid.model.elements.rest, time).transpose();
    const auto begin = std::chrono::steady_clock::now();
    ARGIL_TRY(solid::begin_step(solid, region, state, loads, {kStep, time, k}));
    for (bool solved = false; !solved;) {
      solved = solid::assemble(solid, region, loads);
      if (!solved) ARGIL_TRY(solid::solve(solid, region, loads, k, solved));
    }
    solid::take_velocity(solid, region.part(), state);
    solid::move(solid, region.part(), state);
    ARGIL_TRY(solid::update_kinematics(solid, region, state.x, k));
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    iterations += solid.history.counters.linear_iterations;
  }
  std::sort(seconds.begin(), seconds.end());
  const double down = weigh(solid.model.elements.rest, 0.0)
                          .dot((state.x - solid.model.elements.rest).row(2).transpose().matrix());
  std::printf("%d,%d,%g,%.3f,%.3f,%.1f,%.6g\n", mesh.num_tets(), threads, tolerance,
              1e3 * seconds[seconds.size() / 2], 1e3 * seconds.front(),
              static_cast<double>(iterations) / num_steps, 1e3 * down);
  return StepStatus::ok();
}

}  // namespace
}  // namespace argil

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: bench_elastic BOX.msh TOLERANCE STEPS THREADS\n");
    return 2;
  }
  argil::mesh::TetMesh mesh = argil::mesh_files::read_tet_mesh(argv[1], argil::kEdge);
  argil::mesh::sort_tets(mesh);  // as scenarios do
  const argil::StepStatus status =
      argil::run(mesh, std::strtod(argv[2], nullptr), std::atoi(argv[3]), std::atoi(argv[4]));
  if (!status.is_ok()) std::fprintf(stderr, "%s\n", argil::to_string(status.failure()).c_str());
  return status.is_ok() ? 0 : 1;
}
