// Medit .mesh, ASCII: keywords that are each followed by a count and by lines of numbers [Frey2001, INRIA
// RT-0253].
#include <cctype>

#include "base/lower_case.h"
#include "mesh_files/tet_file.h"

namespace argil::mesh_files {
namespace {

// Keywords of elements that a body of 4-node tets cannot contain.
bool is_other_volume(std::string_view keyword) {  // in small letters
  return keyword.starts_with("hexahedra") || keyword.starts_with("prisms") ||
         keyword.starts_with("pyramids") || keyword.starts_with("tetrahedrap");
}

void read_vertices(FileCursor& cursor, TetFile& out) {
  if (!out.vertex_labels.empty()) cursor.fail("a second section Vertices", "keep one");
  const std::int64_t count = cursor.count("the number of vertices", 8);  // "0 0 0 0" and a blank
  for (std::int64_t i = 1; i <= count; ++i) {
    for (int c = 0; c < 3; ++c) out.coordinates.push_back(cursor.any_number("a vertex coordinate"));
    cursor.integer("a vertex reference");
    out.vertex_labels.push_back(i);
  }
}

void read_tetrahedra(FileCursor& cursor, TetFile& out) {
  if (!out.tet_labels.empty()) cursor.fail("a second section Tetrahedra", "keep one");
  const std::int64_t count = cursor.count("the number of tetrahedra", 10);
  for (std::int64_t i = 1; i <= count; ++i) {
    out.corners.push_back(cursor.integer("a tet's vertex"));
    out.tet_offsets.push_back(cursor.last_offset());
    for (int c = 1; c < 4; ++c) out.corners.push_back(cursor.integer("a tet's vertex"));
    cursor.integer("a tet reference");
    out.tet_labels.push_back(i);
  }
}

// Numbers of a section that is not wanted, up to the next keyword.
void skip_section(FileCursor& cursor) {
  while (const auto word = cursor.peek_word()) {
    if (std::isalpha(static_cast<unsigned char>(word->front())) != 0) break;
    cursor.find_word();
  }
}

}  // namespace

mesh::TetMesh read_medit(const std::string& file, double scale) {
  FileCursor cursor(file);
  cursor.set_comment_mark('#');
  const auto header = cursor.find_word();
  if (!header || to_lower_case(*header) != "meshversionformatted")
    cursor.fail("does not begin with MeshVersionFormatted", "save it as ASCII Medit .mesh");
  const std::int64_t version = cursor.integer("the format version");
  if (version < 1 || version > 4)
    cursor.fail("format version " + std::to_string(version), "save it in version 1 to 4");
  TetFile out;
  while (const auto word = cursor.find_word()) {
    const std::string keyword = to_lower_case(*word);
    if (keyword == "end") break;
    if (keyword == "dimension") {
      const std::int64_t dimension = cursor.integer("the dimension");
      if (dimension != 3) cursor.fail("Dimension " + std::to_string(dimension), "a body needs dimension 3");
    } else if (keyword == "vertices") {
      read_vertices(cursor, out);
    } else if (keyword == "tetrahedra") {
      read_tetrahedra(cursor, out);
    } else if (is_other_volume(keyword)) {
      if (cursor.integer("the number of elements") != 0)
        cursor.fail("section " + std::string(*word) + " holds elements that are not 4-node tetrahedra",
                    "mesh the volume with first-order tetrahedra only");
    } else if (std::isalpha(static_cast<unsigned char>(keyword.front())) == 0) {
      cursor.fail("\"" + std::string(word->substr(0, 40)) + "\" where a keyword was expected",
                  "check the count of the section above");
    } else {
      skip_section(cursor);
    }
  }
  return make_tet_mesh(out, cursor, scale);
}

}  // namespace argil::mesh_files
