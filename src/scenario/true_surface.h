#pragma once

#include <memory>

#include "embed/triangle_tree.h"
#include "mesh/bisection.h"
#include "mesh/curved.h"
#include "scenario/scenario.h"
#include "sim/state.h"

namespace argil::scenario {

/// Where the middle of an edge belongs on the boundary of a body that is fitted to a skin; where the body was
/// thickened, the skin is too far.
Vec3 find_on_skin(const embed::TriangleTree& skin, const Vec3& a, const Vec3& b);

/// Where the boundary of a body belongs: on its shape's own surface, or on the skin that it is fitted to.
/// None where that is flat, or the body comes from a file or only encloses a skin.
class TrueSurface {
 public:
  TrueSurface(const BodySpec& spec, const mesh::TriangleMesh& skin);

  bool has_any() const { return m_skin || m_of_shape; }
  /// New vertices: nothing where has_any is false. To be used while this lives.
  mesh::BoundaryPoint make_vertex_point() const;
  /// Nodes on edges.
  mesh::BoundaryPoint make_edge_point() const;

 private:
  mesh::BoundaryPoint m_of_shape;
  std::unique_ptr<embed::TriangleTree> m_skin;
};

/// Bends the edges of ten-node tets with the surface, and says how many in `notes`.
void bend_edges(const BodySpec& spec, sim::Body& body, std::vector<std::string>& notes);

}  // namespace argil::scenario
