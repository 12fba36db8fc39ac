#pragma once

#include <utility>

#include "sim/simulation.h"
#include "support/block_mesh.h"

namespace argil::test {

/// A dry body whose skin is its boundary shrunk by `scale` towards the middle of its box; 1: the boundary.
inline sim::Body make_skin_body(mesh::TetMesh mesh, double scale) {
  sim::Body body;
  body.mesh = std::move(mesh);
  body.topology = mesh::make_topology(body.mesh);
  body.initial_saturation = Field::Zero(body.mesh.num_tets());
  const Points& x = body.mesh.vertices;
  const Vec3 middle = 0.5 * (x.rowwise().minCoeff() + x.rowwise().maxCoeff());
  body.skin.triangles = body.topology.boundary;
  body.skin.vertices = ((scale * (x.colwise() - middle)).colwise() + middle).eval();
  body.skin_embedding = embed::make_embedding(body.mesh, body.skin.vertices, "skin");
  return body;
}

/// Holds what lies in normal·x ≤ offset.
inline solid::Support hold_half_space(const Vec3& normal, double offset) {
  solid::Support support;
  support.region.kind = solid::Region::Kind::half_space;
  support.region.normal = normal;
  support.region.offset = offset;
  return support;
}

/// Block on the ground.
inline sim::Body make_skin_block(double scale) {
  sim::Body body = make_skin_body(make_block(6, 6, 3, Vec3(0.04, 0.04, 0.02)), scale);
  body.supports.push_back(hold_half_space(Vec3(0, 0, 1), 1e-9));
  return body;
}

}  // namespace argil::test
