#pragma once

#include "sim/state.h"
#include "support/block_mesh.h"

namespace argil::test {

/// A block with one corner at the origin, nx·ny·nz cells, of one saturation [–]. Its bottom is held, or free.
inline sim::Body make_block_body(int nx, int ny, int nz, const Vec3& size, double saturation = 0.0,
                                 bool is_fixed = true) {
  sim::Body body;
  body.mesh = make_block(nx, ny, nz, size);
  body.topology = mesh::make_topology(body.mesh);
  if (is_fixed) {
    solid::Support bottom;
    bottom.region.kind = solid::Region::Kind::half_space;
    bottom.region.offset = 1e-9;
    body.supports.push_back(bottom);
  }
  body.initial_saturation = Field::Constant(body.mesh.num_tets(), saturation);
  return body;
}

}  // namespace argil::test
