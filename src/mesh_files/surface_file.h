#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "mesh/tet_mesh.h"
#include "mesh_files/file_cursor.h"

namespace argil::mesh_files {

/// Triangles of a file as they stand there, not yet checked.
struct SurfaceFile {
  std::vector<double> coordinates;          ///< 3 per vertex, in the file's unit
  std::vector<std::int64_t> corners;        ///< 3 vertex numbers per triangle, from 0
  std::vector<std::size_t> offsets;         ///< where each triangle's polygon begins, for messages
  std::vector<std::size_t> vertex_offsets;  ///< where each vertex begins, for messages; may be empty
  std::int64_t first_number = 0;            ///< what the format calls the first vertex, for messages
};

/// Adds a polygon as a fan of triangles around its first corner.
void add_fan(const std::vector<std::int64_t>& polygon, std::size_t offset, SurfaceFile& out);

/// Multiplies coordinates by `scale` and checks what every format has in common: at least one triangle,
/// vertex numbers in range, finite coordinates of the vertices in use. Throws InputError.
mesh::TriangleMesh make_triangle_mesh(const SurfaceFile& file, const FileCursor& cursor, double scale);

/// Readers of one format each. Throw InputError or IoError.
mesh::TriangleMesh read_obj(const std::string& file, double scale);
mesh::TriangleMesh read_off(const std::string& file, double scale);
mesh::TriangleMesh read_stl(const std::string& file, double scale);
mesh::TriangleMesh read_ply(const std::string& file, double scale);

}  // namespace argil::mesh_files
