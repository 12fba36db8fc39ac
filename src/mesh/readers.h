#pragma once

#include <string>

#include "mesh/tet_mesh.h"

namespace argil::mesh {

/// Reads a tetrahedral mesh by its ending and content: Gmsh .msh 2.2 and 4.1 (ASCII, binary), Medit .mesh,
/// TetGen .node/.ele (either name), legacy .vtk, .vtu (ASCII or appended/base64), Vega .veg. `scale` multiplies coordinates to metres.
/// Vertices that no tet uses are an error that lists them, unless the format mixes surface and volume (Gmsh): there
/// they are dropped with the numbering kept in order. Throws InputError or IoError.
TetMesh read_tet_mesh(const std::string& file, double scale = 1.0);

/// Reads a triangle surface: OBJ (polygons are fanned, negative indices allowed), STL (ASCII, binary; equal
/// corners merged), PLY (ASCII, binary both ways).
TriangleMesh read_triangle_mesh(const std::string& file, double scale = 1.0);

/// Writes Gmsh 4.1 ASCII with 17 digits; reading it back gives the same bits.
void write_gmsh(const TetMesh& mesh, const std::string& file);

/// Writes OBJ with 17 digits.
void write_obj(const TriangleMesh& mesh, const std::string& file);

}  // namespace argil::mesh
