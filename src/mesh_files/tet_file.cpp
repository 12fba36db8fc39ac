#include "mesh_files/tet_file.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/error.h"

namespace argil::mesh_files {
namespace {

[[noreturn]] void fail_at_tet(const TetFile& file, const FileCursor& cursor, std::size_t tet,
                              std::int64_t vertex, const std::string& range) {
  const std::string problem = "tet " + std::to_string(file.tet_labels[tet]) + " names vertex " +
                              std::to_string(vertex) + "; vertices run from " + range;
  constexpr const char* kRemedy = "correct the number or add the vertex";
  if (file.tet_offsets.empty()) throw InputError(cursor.file(), "", problem, kRemedy);
  cursor.fail_at(file.tet_offsets[tet], problem, kRemedy);
}

}  // namespace

LabelIndex::LabelIndex(const std::vector<std::int64_t>& labels, const FileCursor& cursor,
                       const std::string& kind) {
  if (labels.empty()) return;
  m_lowest = labels.front();
  // No difference of labels: that of the two ends of the integers does not fit into one.
  constexpr std::int64_t kLast = std::numeric_limits<std::int64_t>::max();
  for (std::size_t i = 1; i < labels.size(); ++i)
    m_is_gapless = m_is_gapless && labels[i - 1] != kLast && labels[i] == labels[i - 1] + 1;
  m_highest = labels.back();
  if (m_is_gapless) return;
  m_sorted.reserve(labels.size());
  for (const std::int64_t label : labels) m_sorted.emplace_back(label, static_cast<int>(m_sorted.size()));
  std::sort(m_sorted.begin(), m_sorted.end());
  const auto twice = std::adjacent_find(m_sorted.begin(), m_sorted.end(),
                                        [](const auto& a, const auto& b) { return a.first == b.first; });
  if (twice != m_sorted.end())
    throw InputError(cursor.file(), "", kind + " number " + std::to_string(twice->first) + " appears twice",
                     "number each once");
  m_lowest = m_sorted.front().first;
  m_highest = m_sorted.back().first;
}

int LabelIndex::find(std::int64_t label) const {
  if (label < m_lowest || label > m_highest) return -1;
  if (m_is_gapless) return static_cast<int>(label - m_lowest);
  const auto at = std::lower_bound(m_sorted.begin(), m_sorted.end(), std::pair<std::int64_t, int>(label, 0));
  return at != m_sorted.end() && at->first == label ? at->second : -1;
}

std::string LabelIndex::range() const {
  return std::to_string(m_lowest) + " to " + std::to_string(m_highest) + (m_is_gapless ? "" : " with gaps");
}

mesh::TetMesh make_tet_mesh(const TetFile& file, const FileCursor& cursor, double scale) {
  ARGIL_ASSERT(scale > 0.0 && std::isfinite(scale), scale);
  const std::size_t num_vertices = file.vertex_labels.size();
  const std::size_t num_tets = file.corners.size() / 4;
  ARGIL_ASSERT(file.coordinates.size() == 3 * num_vertices && file.tet_labels.size() == num_tets, num_tets);
  if (num_tets == 0)
    throw InputError(cursor.file(), "", "holds no tetrahedra",
                     "save the volume elements of the mesh with it");
  if (num_vertices == 0) throw InputError(cursor.file(), "", "holds no vertices", "write the file again");
  constexpr std::size_t kMost = std::numeric_limits<int>::max() / 4;  // 4·tet + corner is an int
  if (num_tets > kMost || num_vertices > kMost)
    throw InputError(cursor.file(), "",
                     std::to_string(num_tets) + " tets and " + std::to_string(num_vertices) + " vertices",
                     "at most " + std::to_string(kMost) + " of each can be numbered");

  mesh::TetMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(num_vertices));
  for (std::size_t i = 0; i < file.coordinates.size(); ++i)
    mesh.vertices.data()[i] = scale * file.coordinates[i];
  const LabelIndex index(file.vertex_labels, cursor, "vertex");
  mesh.tets.resize(4, static_cast<Eigen::Index>(num_tets));
  for (std::size_t i = 0; i < file.corners.size(); ++i) {
    const int vertex = index.find(file.corners[i]);
    if (vertex < 0) fail_at_tet(file, cursor, i / 4, file.corners[i], index.range());
    if (!mesh.vertices.col(vertex).allFinite())
      cursor.fail_at_vertex(file.corners[i], &file.coordinates[3 * static_cast<std::size_t>(vertex)]);
    mesh.tets.data()[i] = vertex;
  }
  mesh.cell_fields = file.cell_fields;
  return mesh;
}

void add_cell_field(std::map<std::string, Field>& fields, const std::string& name, Field values,
                    const FileCursor& cursor) {
  if (name.empty() || std::any_of(name.begin(), name.end(), [](char c) { return c >= '\0' && c < ' '; }))
    cursor.fail("a cell field has an empty name or one with control characters", "name it in plain text");
  if (!fields.emplace(name, std::move(values)).second)
    cursor.fail("cell field \"" + name + "\" appears twice", "keep one; of a time series, one time step");
}

}  // namespace argil::mesh_files
