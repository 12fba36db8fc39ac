#pragma once

// What every cage must satisfy, for surfaces small and large.

#include <gtest/gtest.h>

#include <string>

#include "embed/cage.h"
#include "embed/embedding.h"
#include "support/mesh_measures.h"

namespace argil::embed {

inline void expect_good_cage(const mesh::TriangleMesh& surface, int target, const std::string& name) {
  SCOPED_TRACE(testing::Message() << name << ", " << target);
  const Cage cage = make_cage(surface, {target}, name);
  EXPECT_NEAR(cage.mesh.num_tets(), target, 0.15 * target);
  EXPECT_EQ(cage.report.num_tets, cage.mesh.num_tets());
  EXPECT_EQ(cage.report.enclosed_vertices, surface.num_vertices());
  EXPECT_NO_THROW(make_embedding(cage.mesh, surface.vertices, name));
  EXPECT_GT(mesh::compute_volumes(cage.mesh.vertices, cage.mesh.tets).minCoeff(), 0.0);
  const test::AngleRange range = test::compute_dihedral_range(cage.mesh);
  EXPECT_NEAR(cage.report.min_dihedral_degrees, range.smallest,
              1e-6);  // acos near 0 and 180 degrees loses half
  EXPECT_NEAR(cage.report.max_dihedral_degrees, range.largest, 1e-6);  // the digits
  EXPECT_GT(range.smallest, 10.0);
  EXPECT_LT(range.largest, 165.0);
  EXPECT_TRUE(
      test::compute_surface_facts(cage.mesh.vertices, mesh::make_topology(cage.mesh).boundary).is_manifold);
}

}  // namespace argil::embed
