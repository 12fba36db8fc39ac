#pragma once

#include <string>

#include "mesh/tet_mesh.h"

namespace argil::mesh_files {

/// Reads a tetrahedral mesh by its ending: Gmsh .msh 2 and 4.1 (ASCII, binary), Medit .mesh (ASCII), TetGen
/// .node/.ele (either name), legacy .vtk (ASCII, binary), .vtu (ASCII, base64 or raw, plain or zlib), Vega
/// .veg. `scale` > 0 multiplies coordinates to metres. One number per tet in the file becomes a cell field:
/// Gmsh $ElementData, VTK cell arrays of one component, TetGen attributes ("attribute 1", …). Vertices that
/// no tet uses are an error that lists them, unless the format mixes surface and volume (Gmsh): there they
/// are dropped with the order of the file's numbers kept. Volumes are not judged here: require_usable does.
/// Throws InputError or IoError.
mesh::TetMesh read_tet_mesh(const std::string& file, double scale = 1.0);

/// Reads a triangle surface: OBJ (polygons are fanned, negative indices allowed), STL (ASCII, binary; equal
/// corners merged), PLY (ASCII, binary both ways). Not closed or not manifold is no error here.
/// Throws InputError or IoError.
mesh::TriangleMesh read_triangle_mesh(const std::string& file, double scale = 1.0);

/// Writes Gmsh 4.1 ASCII with 17 digits, cell fields as $ElementData; reading it back gives the same bits.
/// Throws IoError.
void write_gmsh(const mesh::TetMesh& mesh, const std::string& file);

}  // namespace argil::mesh_files
