#pragma once

#include <string>
#include <vector>

#include "mesh_files/tet_file.h"

namespace argil::mesh_files {

/// One scalar per cell.
struct CellArray {
  std::string name;
  std::vector<double> values;
};

/// A VTK unstructured grid as its file holds it.
struct VtkGrid {
  std::vector<double> points;        ///< 3 per point
  std::vector<double> connectivity;  ///< point numbers, cell after cell
  std::vector<double> ends;          ///< where each cell ends in connectivity
  std::vector<double> types;         ///< VTK cell type of each cell
  std::vector<CellArray> cell_arrays;
};

/// The tets of a grid; vertices, edges and faces are left out. Refuses other volume cells, tets whose
/// points are not finite, and arrays whose lengths disagree. Errors count points and cells from 0.
mesh::TetMesh make_tet_mesh(const VtkGrid& grid, const FileCursor& cursor, double scale);

}  // namespace argil::mesh_files
