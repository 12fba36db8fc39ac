#pragma once

#include <string>

#include "mesh/tet_mesh.h"

namespace argil::contact {

// Closed tool surfaces in the tool frame [m]: the hand's point is the origin, the tool's tip lies towards −z.

/// Sphere around the origin: an icosahedron split `subdivisions` times, every vertex on the sphere.
mesh::TriangleMesh make_sphere_tool(double radius, int subdivisions);

/// Capsule along z: half-spheres of `radius` around (0, 0, 0) and (0, 0, length). `segments` around the axis.
mesh::TriangleMesh make_capsule_tool(double radius, double length, int segments);

/// Stylus: a tip of `tip_radius` around the origin that widens as a cone to `radius` at (0, 0, length),
/// closed flat.
mesh::TriangleMesh make_stylus_tool(double tip_radius, double radius, double length, int segments);

/// Throws InputError naming `file` and the first edge or triangle at fault unless the surface can be touched:
/// at least a tetrahedron, finite, every edge shared by two triangles that run along it in opposite
/// directions (closed, manifold and oriented alike), no triangle without area, and normals pointing out
/// (positive volume).
void require_closed_surface(const mesh::TriangleMesh& surface, const std::string& file);

}  // namespace argil::contact
