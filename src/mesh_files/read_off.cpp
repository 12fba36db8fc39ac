// Object File Format of Geomview: vertices and polygons; normals, colours and texture are passed over.
#include <array>

#include "mesh_files/surface_file.h"

namespace argil::mesh_files {
namespace {

// Next line that says something, without its comment.
std::string_view next_line(FileCursor& cursor, std::string_view what) {
  while (const auto line = cursor.find_line()) {
    const std::string_view text = trim(drop_comment(*line));
    if (!text.empty()) return text;
  }
  cursor.fail_truncated(what);
}

// Numbers of vertices and faces. The keyword may be left out, and may stand before them in one line.
std::array<std::int64_t, 2> read_counts(FileCursor& cursor) {
  constexpr std::string_view kWhat = "the numbers of vertices, faces and edges";
  std::string_view line = next_line(cursor, kWhat);
  if (const std::size_t at = line.find("OFF"); at != std::string_view::npos) {
    const std::string_view prefix = line.substr(0, at);  // of what follows x y z: ST, C, N
    if (prefix.find_first_not_of("STCN") != std::string_view::npos)
      cursor.fail("keyword \"" + std::string(line.substr(0, 40)) + "\"",
                  "save it with x, y and z, as \"OFF\"");
    line = trim(line.substr(at + 3));
    if (line.starts_with("BINARY")) cursor.fail("is a binary OFF", "save it as text, or as PLY");
    if (line.empty()) line = next_line(cursor, kWhat);
  }
  WordsOf words(line);
  std::array<std::int64_t, 2> counts{};
  for (std::int64_t& count : counts) {
    count = cursor.parse_integer(words.next(), kWhat);
    if (count < 0) cursor.fail("a count is " + std::to_string(count), "it is 0 or more");
  }
  return counts;
}

}  // namespace

mesh::TriangleMesh read_off(const std::string& file, double scale) {
  FileCursor cursor(file);
  SurfaceFile out;
  const auto [num_vertices, num_faces] = read_counts(cursor);
  for (std::int64_t v = 0; v < num_vertices; ++v) {
    WordsOf words(next_line(cursor, "a vertex"));
    out.vertex_offsets.push_back(cursor.last_offset());
    for (int c = 0; c < 3; ++c)
      out.coordinates.push_back(cursor.parse_any_number(words.next(), "a vertex coordinate"));
  }
  std::vector<std::int64_t> polygon;
  for (std::int64_t f = 0; f < num_faces; ++f) {
    WordsOf words(next_line(cursor, "a face"));
    const std::int64_t length = cursor.parse_integer(words.next(), "a face's number of vertices");
    if (length < 3)
      cursor.fail("a face of " + std::to_string(length) + " vertices", "a face has at least 3; remove it");
    polygon.clear();
    for (std::int64_t i = 0; i < length; ++i)
      polygon.push_back(cursor.parse_integer(words.next(), "a face's vertex number"));
    add_fan(polygon, cursor.last_offset(), out);
  }
  return make_triangle_mesh(out, cursor, scale);
}

}  // namespace argil::mesh_files
