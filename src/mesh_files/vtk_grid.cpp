#include "mesh_files/vtk_grid.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/text_encoding.h"

namespace argil::mesh_files {
namespace {

constexpr int kTet = 10;
// Vertices, lines and faces of first and second order (vtkCellType.h): not part of a body's volume.
constexpr std::array<int, 16> kSkipped = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 21, 22, 23, 28, 34, 36};

const char* name_of(int type) {
  switch (type) {
    case 11:
      return "voxel";
    case 12:
      return "hexahedron";
    case 13:
      return "wedge";
    case 14:
      return "pyramid";
    case 24:
      return "10-node tetrahedron";
    case 42:
      return "polyhedron";
    case 71:
      return "Lagrange tetrahedron";
    case 78:
      return "Bézier tetrahedron";
    default:
      return "not a 4-node tetrahedron";
  }
}

[[noreturn]] void refuse(const FileCursor& cursor, const std::string& place, const std::string& problem,
                         const char* remedy = "write the file again") {
  throw InputError(cursor.file(), to_printable(place), problem, remedy);
}

std::string cell_place(std::size_t cell) {
  return "cell " + std::to_string(cell);
}

// A point number, or a place in the connectivity: 0 to 2⁵³.
std::int64_t to_index(double value, const FileCursor& cursor, std::size_t cell) {
  if (!(value >= 0.0 && value <= 0x1p53 && value == std::floor(value)))
    refuse(cursor, cell_place(cell), "a point number or offset is " + std::to_string(value),
           "give whole numbers from 0");
  return static_cast<std::int64_t>(value);
}

std::vector<std::size_t> find_tets(const VtkGrid& grid, const FileCursor& cursor) {
  std::vector<std::size_t> tets;
  for (std::size_t cell = 0; cell < grid.types.size(); ++cell) {
    const bool is_byte = grid.types[cell] >= 0.0 && grid.types[cell] <= 255.0;
    const int type = is_byte ? static_cast<int>(grid.types[cell]) : -1;
    if (type == kTet) {
      tets.push_back(cell);
    } else if (std::find(kSkipped.begin(), kSkipped.end(), type) == kSkipped.end()) {
      refuse(cursor, cell_place(cell), "cell type " + std::to_string(type) + " (" + name_of(type) + ")",
             "only 4-node tetrahedra (type 10) can be used; split or mesh again at first order");
    }
  }
  return tets;
}

}  // namespace

mesh::TetMesh make_tet_mesh(const VtkGrid& grid, const FileCursor& cursor, double scale) {
  if (grid.points.size() % 3 != 0) refuse(cursor, "points", "their coordinates are not three each");
  if (grid.ends.size() != grid.types.size())
    refuse(
        cursor, "cells",
        std::to_string(grid.ends.size()) + " cells but " + std::to_string(grid.types.size()) + " cell types");
  TetFile out;
  out.coordinates = grid.points;
  for (std::size_t p = 0; p < grid.points.size() / 3; ++p)
    out.vertex_labels.push_back(static_cast<std::int64_t>(p));
  const std::vector<std::size_t> tets = find_tets(grid, cursor);
  for (const std::size_t cell : tets) {
    const std::int64_t begin = cell == 0 ? 0 : to_index(grid.ends[cell - 1], cursor, cell);
    const std::int64_t end = to_index(grid.ends[cell], cursor, cell);
    if (end - begin != 4)
      refuse(cursor, cell_place(cell), "a tetrahedron of " + std::to_string(end - begin) + " points",
             "a tetrahedron has 4");
    if (end > static_cast<std::int64_t>(grid.connectivity.size()))
      refuse(cursor, cell_place(cell), "lies outside the connectivity list");
    for (std::int64_t i = begin; i < end; ++i)
      out.corners.push_back(to_index(grid.connectivity[static_cast<std::size_t>(i)], cursor, cell));
    out.tet_labels.push_back(static_cast<std::int64_t>(cell));
  }
  for (const CellArray& array : grid.cell_arrays) {
    if (array.values.size() != grid.types.size())
      refuse(cursor, "cell array \"" + array.name + "\"",
             std::to_string(array.values.size()) + " values for " + std::to_string(grid.types.size()) +
                 " cells");
    Field values(static_cast<Eigen::Index>(tets.size()));
    for (std::size_t t = 0; t < tets.size(); ++t)
      values(static_cast<Eigen::Index>(t)) = array.values[tets[t]];
    add_cell_field(out.cell_fields, array.name, std::move(values), cursor);
  }
  return make_tet_mesh(out, cursor, scale);
}

}  // namespace argil::mesh_files
