#pragma once

#include "mesh/tet_mesh.h"

namespace argil::embed {

// Of triangle surfaces as they come: with holes, doubled or degenerate faces.

/// With a triangle of three equal corners for every vertex that no triangle uses.
mesh::TriangleMesh with_all_vertices(const mesh::TriangleMesh& surface);

/// The same surface with edges no longer than `longest` [m], so that it can be looked at and thickened in
/// places. Where two triangles share an edge, they share its middle.
mesh::TriangleMesh split_long_edges(const mesh::TriangleMesh& surface, double longest);

/// What the triangles enclose [m³], whichever way all of them are turned.
double compute_skin_volume(const mesh::TriangleMesh& skin);

/// Has every edge another that goes along it the other way?
bool is_closed(const mesh::TriangleMesh& skin);

}  // namespace argil::embed
