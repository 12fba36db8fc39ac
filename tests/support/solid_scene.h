#pragma once

// A small elastic body, its supports and loads, driven as sim/step.cpp drives it.

#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "base/rng.h"
#include "solid/solid.h"
#include "support/block_mesh.h"

namespace argil::test {

/// λ and μ from E and ν; no yield.
inline solid::TetMaterial make_material(double E, double nu) {
  return {E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu)), 1e9};
}

/// Block whose nodes are moved at random by up to `amount` of a cell, those of a face within their plane.
inline mesh::TetMesh make_irregular_block(int nx, int ny, int nz, const Vec3& size, double amount = 0.2) {
  mesh::TetMesh mesh = make_block(nx, ny, nz, size);
  const Vec3 cell(size.x() / nx, size.y() / ny, size.z() / nz);
  Rng rng(11);
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v)
    for (int k = 0; k < 3; ++k) {
      const double shift = rng.uniform(-amount, amount) * cell(k);
      const double x = mesh.vertices(k, v);
      if (x > 1e-9 * size(k) && x < (1.0 - 1e-9) * size(k)) mesh.vertices(k, v) += shift;
    }
  return mesh;
}

inline solid::Support hold_nodes(std::vector<int> nodes, std::array<bool, 3> fixes = {true, true, true}) {
  solid::Support support;
  support.region.kind = solid::Region::Kind::nodes;
  support.region.nodes = std::move(nodes);
  support.fixes = fixes;
  return support;
}

struct Scene {
  mesh::TetMesh mesh;
  solid::SolidParams params;
  solid::Solid solid;
  solid::SolidState state;
  Points load;
  double time = 0.0;

  Scene(mesh::TetMesh m, std::vector<solid::Support> supports, const solid::SolidParams& p, double E,
        double nu, int threads = 1)
      : mesh(std::move(m)),
        params(p),
        solid(mesh, mesh::make_topology(mesh), std::move(supports), p, threads),
        state(solid.make_rest_state()) {
    load.setZero(3, state.x.cols());
    for (int t = 0; t < mesh.num_tets(); ++t) solid.set_material(t, make_material(E, nu));
    EXPECT_TRUE(solid.update_kinematics(state.x, 0).is_ok());
  }
  Scene(mesh::TetMesh m, std::initializer_list<int> fixed, const solid::SolidParams& p, double E, double nu,
        int threads = 1)
      : Scene(std::move(m), std::vector{hold_nodes(std::vector(fixed))}, p, E, nu, threads) {}

  int num_nodes() const { return static_cast<int>(state.x.cols()); }
  const Points& rest() const { return solid.elements().rest; }
  Points displacement() const { return state.x - rest(); }

  /// Velocities of the next step, before the body moves.
  StepStatus solve(double h, std::span<const solid::PointStiffness> contacts = {}) {
    const solid::StepLoads loads{load, contacts};
    ARGIL_TRY(solid.begin_step(state, loads, h, time += h, 0));
    for (bool solved = false; !solved;) {
      solved = solid.assemble(loads);
      if (!solved) ARGIL_TRY(solid.solve(loads, 0, solved));
    }
    solid.finish_step(state);
    return StepStatus::ok();
  }
  StepStatus step(double h, std::span<const solid::PointStiffness> contacts = {}) {
    ARGIL_TRY(solve(h, contacts));
    solid.move(state);
    ARGIL_TRY(solid.update_kinematics(state.x, 0));
    solid.keep_start(state);
    return StepStatus::ok();
  }
  StepStatus find_equilibrium() { return solid.find_equilibrium(state, solid::StepLoads{load}); }

  /// Internal forces at positions x.
  Points compute_force(const Points& x) {
    solid::SolidState moved = state;
    moved.x = x;
    EXPECT_TRUE(solid.update_kinematics(x, 0).is_ok());
    const solid::StepLoads loads{load};
    EXPECT_TRUE(solid.begin_step(moved, loads, 1e-3, 0.0, 0).is_ok());
    solid.assemble(loads);
    return solid.internal_force();
  }
};

}  // namespace argil::test
