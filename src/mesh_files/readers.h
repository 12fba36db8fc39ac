#pragma once

#include <string>
#include <vector>

#include "mesh/tet_mesh.h"

namespace argil::mesh_files {

/// The vertices of a file and those of the mesh made of it: without the ones that no tet or triangle uses,
/// which make no clay.
struct FileVertices {
  int num_in_file = 0;
  std::vector<int>
      kept;  ///< place in the file, from 0, of each vertex of the mesh, increasing; empty: all are
  bool is_mirrored = false;  ///< every tet of the file had a negative volume, and two corners were swapped
  int num_left_out() const { return kept.empty() ? 0 : num_in_file - static_cast<int>(kept.size()); }
  /// Number in the mesh of the file's vertex at `place`; −1 where it was left out.
  int find(int place) const;
  /// "3 of its 12 vertices belong to no tet and are left out, the first is number 4 from 0"; empty without
  /// any. And a word of mirrored tets.
  std::string describe(const std::string& file, const std::string& element) const;
};

/// By its ending: does read_triangle_mesh read the file?
bool is_surface(const std::string& file);

/// Reads a tetrahedral mesh by its ending: Gmsh .msh 2 and 4.1 (ASCII, binary), Medit .mesh (ASCII), TetGen
/// .node/.ele (either name), legacy .vtk (ASCII, binary), .vtu (ASCII, base64 or raw, plain or zlib), Vega
/// .veg. `scale` > 0 multiplies coordinates to metres. One number per tet in the file becomes a cell field:
/// Gmsh $ElementData, VTK cell arrays of one component, TetGen attributes ("attribute 1", …). Vertices that
/// no tet uses are left out, the others keep their order; `vertices` says which. Where every tet has a
/// negative volume, two corners of each are swapped. Volumes are not judged besides: require_usable does.
/// Throws InputError or IoError.
mesh::TetMesh read_tet_mesh(const std::string& file, double scale = 1.0, FileVertices* vertices = nullptr);

/// Reads a triangle surface: OBJ (polygons are fanned, negative indices allowed), OFF (text), STL (ASCII,
/// binary; equal corners merged), PLY (ASCII, binary both ways). Vertices that no triangle uses are left out.
/// Not closed or not manifold is no error here. Throws InputError or IoError.
mesh::TriangleMesh read_triangle_mesh(const std::string& file, double scale = 1.0,
                                      FileVertices* vertices = nullptr);

/// Writes Gmsh 4.1 ASCII with 17 digits, cell fields as $ElementData; reading it back gives the same bits.
/// Throws IoError.
void write_gmsh(const mesh::TetMesh& mesh, const std::string& file);

}  // namespace argil::mesh_files
