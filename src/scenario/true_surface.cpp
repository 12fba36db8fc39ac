#include "scenario/true_surface.h"

#include <sstream>

#include "embed/bent_edges.h"
#include "embed/skin_shape.h"
#include "shapes/shapes.h"

namespace argil::scenario {

Vec3 find_on_skin(const embed::TriangleTree& skin, const Vec3& a, const Vec3& b) {
  constexpr double kNear = 0.25;  // of the edge's length
  const Vec3 middle = 0.5 * (a + b);
  const embed::TriangleTree::Nearest nearest = skin.find_nearest(middle, kNear * (b - a).norm());
  return nearest.triangle >= 0 ? nearest.point : middle;
}

TrueSurface::TrueSurface(const BodySpec& spec, const mesh::TriangleMesh& skin) {
  const bool has_skin = skin.num_triangles() > 0;
  if (spec.kind == BodyKind::shape && !has_skin) m_of_shape = shapes::make_boundary_point(spec.shape);
  if (has_skin && spec.fit == embed::Fit::surface) m_skin = std::make_unique<embed::TriangleTree>(skin);
}

mesh::BoundaryPoint TrueSurface::make_vertex_point() const {
  if (!m_skin) return m_of_shape;
  return [skin = m_skin.get()](const Vec3& a, const Vec3& b) { return find_on_skin(*skin, a, b); };
}

mesh::BoundaryPoint TrueSurface::make_edge_point() const {
  if (!m_skin) return m_of_shape;
  return [skin = m_skin.get()](const Vec3& a, const Vec3& b) { return embed::find_bent_middle(*skin, a, b); };
}

void bend_edges(const BodySpec& spec, sim::Body& body, std::vector<std::string>& notes) {
  const TrueSurface surface(spec, body.skin);
  if (!surface.has_any()) return;
  const mesh::CurvedEdges edges = mesh::curve_boundary(surface.make_edge_point(), body.topology, body.mesh);
  if (edges.num_curved + edges.num_straight == 0) return;
  std::ostringstream text;
  text << "cells: " << edges.num_curved << " edges bend with the surface";
  if (edges.num_straight > 0)
    text << ", " << edges.num_straight << " stay straight, as tets at them do not bear it";
  if (body.skin.num_triangles() > 0 && embed::is_closed(body.skin)) {
    text.precision(4);
    text << "; volume " << mesh::compute_rest_volumes(body.mesh).sum() / embed::compute_skin_volume(body.skin)
         << " of the surface's";
  }
  notes.push_back(text.str());
}

}  // namespace argil::scenario
