// Wavefront OBJ: vertices and polygons; texture, normals, groups and materials are passed over.
#include "base/lower_case.h"
#include "mesh_files/surface_file.h"

namespace argil::mesh_files {
namespace {

// The vertex number of "7", "7/1", "7/1/3" or "7//3"; negative numbers count back from the last vertex so
// far.
std::int64_t parse_corner(std::string_view word, std::int64_t num_vertices, const FileCursor& cursor) {
  const std::int64_t number = cursor.parse_integer(word.substr(0, word.find('/')), "a face's vertex number");
  if (number == 0) cursor.fail("a face names vertex 0", "OBJ counts vertices from 1");
  if (number < -num_vertices)
    cursor.fail("a face names vertex " + std::to_string(number) + " of the " + std::to_string(num_vertices) +
                    " so far",
                "a negative number counts back from the last vertex above the face");
  return number > 0 ? number - 1 : num_vertices + number;
}

}  // namespace

mesh::TriangleMesh read_obj(const std::string& file, double scale) {
  FileCursor cursor(file);
  SurfaceFile out;
  out.first_number = 1;
  std::vector<std::int64_t> polygon;
  std::string joined;
  while (const auto line = cursor.find_line()) {
    const std::size_t offset = cursor.last_offset();
    if (line->find('\r') != std::string_view::npos)
      cursor.fail("a carriage return stands within the line", "save it with one kind of line end");
    joined = *line;
    while (joined.ends_with('\\')) {  // the line goes on in the next one
      joined.back() = ' ';
      const auto more = cursor.find_line();
      if (!more) break;
      joined += *more;
    }
    WordsOf words(drop_comment(joined));
    const std::string keyword = to_lower_case(words.next());
    if (keyword == "v") {
      out.vertex_offsets.push_back(offset);
      for (int c = 0; c < 3; ++c) {
        const std::string_view word = words.next();
        if (word.empty()) cursor.fail("a vertex of " + std::to_string(c) + " coordinates", "give x, y and z");
        out.coordinates.push_back(cursor.parse_any_number(word, "a vertex coordinate"));
      }
    } else if (keyword == "f") {
      polygon.clear();
      const auto num_vertices = static_cast<std::int64_t>(out.coordinates.size() / 3);
      for (std::string_view word = words.next(); !word.empty(); word = words.next())
        polygon.push_back(parse_corner(word, num_vertices, cursor));
      if (polygon.size() < 3)
        cursor.fail("a face of " + std::to_string(polygon.size()) + " vertices",
                    "a face has at least 3; remove it");
      add_fan(polygon, offset, out);
    }
  }
  return make_triangle_mesh(out, cursor, scale);
}

}  // namespace argil::mesh_files
