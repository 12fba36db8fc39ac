#include "mesh_files/surface_file.h"

#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/error.h"

namespace argil::mesh_files {

void add_fan(const std::vector<std::int64_t>& polygon, std::size_t offset, SurfaceFile& out) {
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    out.corners.insert(out.corners.end(), {polygon[0], polygon[i - 1], polygon[i]});
    out.offsets.push_back(offset);
  }
}

mesh::TriangleMesh make_triangle_mesh(const SurfaceFile& file, const FileCursor& cursor, double scale) {
  ARGIL_ASSERT(scale > 0.0 && std::isfinite(scale), scale);
  const auto num_vertices = static_cast<std::int64_t>(file.coordinates.size() / 3);
  if (file.corners.empty())
    throw InputError(cursor.file(), "", "holds no faces", "save the surface's faces with it");
  constexpr std::int64_t kMost = std::numeric_limits<int>::max() / 3;
  if (num_vertices > kMost || static_cast<std::int64_t>(file.offsets.size()) > kMost)
    throw InputError(
        cursor.file(), "",
        std::to_string(file.offsets.size()) + " triangles and " + std::to_string(num_vertices) + " vertices",
        "at most " + std::to_string(kMost) + " of each can be numbered");
  mesh::TriangleMesh mesh;
  mesh.vertices.resize(3, num_vertices);
  for (std::size_t i = 0; i < file.coordinates.size(); ++i)
    mesh.vertices.data()[i] = scale * file.coordinates[i];
  mesh.triangles.resize(3, static_cast<Eigen::Index>(file.offsets.size()));
  for (std::size_t i = 0; i < file.corners.size(); ++i) {
    const std::int64_t vertex = file.corners[i];
    if (vertex < 0 || vertex >= num_vertices)
      cursor.fail_at(file.offsets[i / 3],
                     "a face names vertex " + std::to_string(vertex + file.first_number) +
                         "; vertices run from " + std::to_string(file.first_number) + " to " +
                         std::to_string(num_vertices - 1 + file.first_number),
                     "correct the number or add the vertex");
    const auto v = static_cast<std::size_t>(vertex);
    if (!mesh.vertices.col(vertex).allFinite())
      cursor.fail_at_vertex(
          vertex + file.first_number, &file.coordinates[3 * v],
          file.vertex_offsets.empty() ? std::nullopt : std::optional(file.vertex_offsets[v]));
    mesh.triangles.data()[i] = static_cast<int>(vertex);
  }
  return mesh;
}

}  // namespace argil::mesh_files
