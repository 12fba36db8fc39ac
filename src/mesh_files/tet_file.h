#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "mesh/tet_mesh.h"
#include "mesh_files/file_cursor.h"

namespace argil::mesh_files {

/// Tets of a file as they stand there: numbered by the file's own labels, not yet checked.
struct TetFile {
  std::vector<double> coordinates;           ///< 3 per vertex, in the file's unit
  std::vector<std::int64_t> vertex_labels;   ///< the file's number of every vertex
  std::vector<std::int64_t> corners;         ///< 4 vertex labels per tet
  std::vector<std::int64_t> tet_labels;      ///< the file's number of every tet
  std::vector<std::size_t> tet_offsets;      ///< where each tet begins, for messages; may be empty
  std::map<std::string, Field> cell_fields;  ///< in the order of the tets
};

/// Numbers vertices from 0 in the file's order, multiplies coordinates by `scale` and checks what every
/// format has in common: at least one tet, distinct labels, vertex labels in range, finite coordinates of
/// the vertices in use. The others stay, as they are. `cursor` is the file that holds the tets. Throws
/// InputError.
mesh::TetMesh make_tet_mesh(const TetFile& file, const FileCursor& cursor, double scale);

/// Finds where a label stands in a list: label − first when they run without gaps, a binary search otherwise.
class LabelIndex {
 public:
  /// Throws InputError that calls a label which appears twice a `kind` number.
  LabelIndex(const std::vector<std::int64_t>& labels, const FileCursor& cursor, const std::string& kind);
  /// Place of `label` in the list, or −1.
  int find(std::int64_t label) const;
  /// "1 to 8"
  std::string range() const;

 private:
  std::int64_t m_lowest = 0;
  std::int64_t m_highest = -1;
  bool m_is_gapless = true;
  std::vector<std::pair<std::int64_t, int>> m_sorted;
};

/// Adds a field to `fields`; refuses a name that is already there or that has control characters.
void add_cell_field(std::map<std::string, Field>& fields, const std::string& name, Field values,
                    const FileCursor& cursor);

/// Readers of one format each. Throw InputError or IoError.
mesh::TetMesh read_gmsh(const std::string& file, double scale);
mesh::TetMesh read_medit(const std::string& file, double scale);
/// `file` is the .node or the .ele file; the other lies beside it.
mesh::TetMesh read_tetgen(const std::string& file, double scale);
mesh::TetMesh read_vega(const std::string& file, double scale);
mesh::TetMesh read_vtk(const std::string& file, double scale);
mesh::TetMesh read_vtu(const std::string& file, double scale);

}  // namespace argil::mesh_files
