#pragma once

// A small elastic body, its supports and loads, driven as sim/step.cpp drives it.

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "base/rng.h"
#include "solid/material_changes.h"
#include "solid/move.h"
#include "solid/statics.h"
#include "solid/step_solver.h"
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
  std::unique_ptr<solid::Body> owned_body;
  std::unique_ptr<solid::ActiveRegion> owned_region;
  solid::Body& solid;
  solid::ActiveRegion& region;
  solid::SolidState state;
  Points load;
  double time = 0.0;
  bool follows_turns = false;

  Scene(mesh::TetMesh m, std::vector<solid::Support> supports, const solid::SolidParams& p, double E,
        double nu, int threads = 1, bool restricts = false)
      : mesh(std::move(m)),
        params(p),
        owned_body(
            std::make_unique<solid::Body>(mesh, mesh::make_topology(mesh), std::move(supports), p, threads)),
        owned_region(std::make_unique<solid::ActiveRegion>(*owned_body, restricts)),
        solid(*owned_body),
        region(*owned_region),
        state(solid::make_rest_state(solid.model)) {
    load.setZero(3, state.x.cols());
    for (int t = 0; t < mesh.num_tets(); ++t) solid::set_material(solid, region, t, make_material(E, nu));
    EXPECT_TRUE(solid::update_kinematics(solid, region, state.x, 0).is_ok());
  }
  Scene(mesh::TetMesh m, std::initializer_list<int> fixed, const solid::SolidParams& p, double E, double nu,
        int threads = 1)
      : Scene(std::move(m), std::vector{hold_nodes(std::vector(fixed))}, p, E, nu, threads) {}

  int num_nodes() const { return static_cast<int>(state.x.cols()); }
  const Points& rest() const { return solid.model.elements.rest; }
  Points displacement() const { return state.x - rest(); }

  /// Velocities of the next step, before the body moves.
  StepStatus solve(double h, std::span<const solid::PointStiffness> contacts = {}) {
    solid::StepLoads loads{load, contacts};
    loads.follows_turns = follows_turns;
    ARGIL_TRY(solid::begin_step(solid, region, state, loads, {h, time += h, 0}));
    for (bool solved = false; !solved;) {
      solved = solid::assemble(solid, region, loads);
      if (!solved) ARGIL_TRY(solid::solve(solid, region, loads, 0, solved));
    }
    solid::take_velocity(solid, region.part(), state);
    return StepStatus::ok();
  }
  StepStatus step(double h, std::span<const solid::PointStiffness> contacts = {}) {
    ARGIL_TRY(solve(h, contacts));
    solid::move(solid, region.part(), state);
    ARGIL_TRY(solid::update_kinematics(solid, region, state.x, 0));
    solid::keep_start(solid, state);
    return StepStatus::ok();
  }
  StepStatus find_equilibrium() {
    return solid::find_equilibrium(solid, region.whole(), solid::StepLoads{load}, state);
  }
  double compute_elastic_energy() const {
    return solid::compute_elastic_energy(solid.strained(state.plastic_strain), solid.scratch.nodal.change);
  }

  /// Internal forces at positions x.
  Points compute_force(const Points& x) {
    solid::SolidState moved = state;
    moved.x = x;
    EXPECT_TRUE(solid::update_kinematics(solid, region, x, 0).is_ok());
    const solid::StepLoads loads{load};
    EXPECT_TRUE(solid::begin_step(solid, region, moved, loads, {1e-3, 0.0, 0}).is_ok());
    solid::assemble(solid, region, loads);
    return solid.forces.internal;
  }
};

}  // namespace argil::test
