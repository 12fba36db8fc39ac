// TetGen .node and .ele (tetgen.org, "File formats"), and Vega .veg, which took over their lines.
#include <algorithm>
#include <array>
#include <filesystem>

#include "base/error.h"
#include "mesh_files/tet_file.h"

namespace argil::mesh_files {
namespace {

// <number of vertices> <dimension> <attributes> <boundary marker>, then lines <number> <x> <y> <z> …
void read_vertex_lines(FileCursor& cursor, TetFile& out) {
  const std::int64_t count = cursor.count("the number of vertices", 1);
  const std::int64_t dimension = cursor.integer("the dimension");
  if (dimension != 3) cursor.fail("dimension " + std::to_string(dimension), "a body needs dimension 3");
  const std::int64_t attributes = cursor.count("the number of vertex attributes", 1);
  const std::int64_t markers = cursor.count("the number of boundary markers", 1);
  const std::size_t bytes_each =
      static_cast<std::size_t>(7 + 2 * (attributes + markers));  // "0 0 0 0" at least
  cursor.require_room(count, bytes_each, "the number of vertices");
  for (std::int64_t i = 0; i < count; ++i) {
    out.vertex_labels.push_back(cursor.integer("a vertex number"));
    for (int c = 0; c < 3; ++c) out.coordinates.push_back(cursor.any_number("a vertex coordinate"));
    for (std::int64_t c = 0; c < attributes + markers; ++c) cursor.any_number("a vertex attribute");
  }
}

// <number of tets> <nodes per tet> <attributes>, then lines <number> <4 vertices> …
void read_tet_lines(FileCursor& cursor, TetFile& out) {
  const std::int64_t count = cursor.count("the number of tets", 1);
  const std::int64_t nodes = cursor.integer("the number of nodes per tet");
  if (nodes != 4)
    cursor.fail(std::to_string(nodes) + " nodes per element",
                "only 4-node tetrahedra can be used; TetGen: no -o2");
  const std::int64_t attributes = cursor.count("the number of tet attributes", 1);
  cursor.require_room(count, static_cast<std::size_t>(9 + 2 * attributes), "the number of tets");
  std::vector<Field> values(static_cast<std::size_t>(attributes), Field(count));
  for (std::int64_t i = 0; i < count; ++i) {
    out.tet_labels.push_back(cursor.integer("a tet number"));
    out.tet_offsets.push_back(cursor.last_offset());
    for (int c = 0; c < 4; ++c) out.corners.push_back(cursor.integer("a tet's vertex"));
    for (Field& field : values) field(i) = cursor.any_number("a tet attribute");
  }
  for (std::size_t a = 0; a < values.size(); ++a)
    add_cell_field(out.cell_fields, "attribute " + std::to_string(a + 1), std::move(values[a]), cursor);
}

// TetGen numbers from 0 or from 1, in both files alike and without gaps.
void require_running_numbers(const std::vector<std::int64_t>& labels, const FileCursor& cursor,
                             const char* kind) {
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const std::int64_t expected = labels.front() + static_cast<std::int64_t>(i);
    if (labels[i] != expected || labels.front() < 0 || labels.front() > 1)
      throw InputError(cursor.file(), "",
                       std::string(kind) + " number " + std::to_string(labels[i]) + " is in place " +
                           std::to_string(i) + " counted from 0",
                       "number them from 0 or from 1 without gaps");
  }
}

}  // namespace

mesh::TetMesh read_tetgen(const std::string& file, double scale) {
  const std::filesystem::path path(file);
  FileCursor nodes(std::filesystem::path(path).replace_extension(".node").string());
  FileCursor elements(std::filesystem::path(path).replace_extension(".ele").string());
  nodes.set_comment_mark('#');
  elements.set_comment_mark('#');
  TetFile out;
  read_vertex_lines(nodes, out);
  require_running_numbers(out.vertex_labels, nodes, "vertex");
  if (const auto word = nodes.find_word())
    nodes.fail("\"" + std::string(*word) + "\" after the last vertex", "correct the count in the first line");
  read_tet_lines(elements, out);
  require_running_numbers(out.tet_labels, elements, "tet");
  if (const auto word = elements.find_word())
    elements.fail("\"" + std::string(*word) + "\" after the last tet",
                  "correct the counts in the first line");
  return make_tet_mesh(out, elements, scale);
}

mesh::TetMesh read_vega(const std::string& file, double scale) {
  FileCursor cursor(file);
  cursor.set_comment_mark('#');
  TetFile out;
  bool has_vertices = false;
  bool has_elements = false;
  while (const auto word = cursor.find_word()) {
    if (*word == "*VERTICES") {
      if (has_vertices) cursor.fail("a second section *VERTICES", "keep one");
      has_vertices = true;
      read_vertex_lines(cursor, out);
      require_running_numbers(out.vertex_labels, cursor, "vertex");
    } else if (*word == "*ELEMENTS") {
      if (has_elements) cursor.fail("a second section *ELEMENTS", "keep one");
      has_elements = true;
      const std::string kind(cursor.word("TET"));
      if (kind != "TET" && kind != "TETS")
        cursor.fail("*ELEMENTS " + kind, "only 4-node tetrahedra (TET) can be used");
      read_tet_lines(cursor, out);
      require_running_numbers(out.tet_labels, cursor, "tet");
    } else if (*word == "*INCLUDE") {
      cursor.fail("*INCLUDE is not followed", "put the included text into the file itself");
    } else if (word->starts_with('*')) {
      // Materials, sets and regions of other programs: skipped to the next section.
      for (auto next = cursor.peek_word(); next && !next->starts_with('*'); next = cursor.peek_word())
        cursor.find_word();
    } else {
      cursor.fail(
          "\"" + std::string(word->substr(0, 40)) + "\" where a section such as *VERTICES was expected",
          "check the count of the section above, or save it as Vega .veg");
    }
  }
  if (!has_vertices || !has_elements)
    throw InputError(file, "", std::string("has no section ") + (has_vertices ? "*ELEMENTS" : "*VERTICES"),
                     "save it as ASCII Vega .veg");
  return make_tet_mesh(out, cursor, scale);
}

}  // namespace argil::mesh_files
