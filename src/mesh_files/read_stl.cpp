// STL, ASCII and binary: triangles that share no vertices; corners with equal coordinates become one vertex.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/lower_case.h"
#include "mesh_files/surface_file.h"

namespace argil::mesh_files {
namespace {

constexpr std::size_t kHeader = 80;
constexpr std::size_t kTriangle = 50;  // normal and three corners of three floats, and two bytes

void add_triangle(std::size_t offset, SurfaceFile& out) {
  const auto next = static_cast<std::int64_t>(out.corners.size());
  add_fan({next, next + 1, next + 2}, offset, out);
}

// Numbers equal corners alike, in order of first appearance. −0 equals 0.
void merge_equal(SurfaceFile& file) {
  const std::size_t count = file.corners.size();
  const auto corner = [&](std::size_t i) {
    return std::array<double, 3>{file.coordinates[3 * i], file.coordinates[3 * i + 1],
                                 file.coordinates[3 * i + 2]};
  };
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return corner(a) < corner(b); });
  std::vector<std::size_t> first(count);  // the earliest corner at the same place
  for (std::size_t i = 0; i < count; ++i)
    first[order[i]] = i > 0 && corner(order[i - 1]) == corner(order[i]) ? first[order[i - 1]] : order[i];
  std::vector<double> coordinates;
  for (std::size_t i = 0; i < count; ++i) {
    if (first[i] == i) {
      file.corners[i] = static_cast<std::int64_t>(coordinates.size() / 3);
      for (const double x : corner(i)) coordinates.push_back(x);
    } else {
      file.corners[i] = file.corners[first[i]];
    }
  }
  file.coordinates = std::move(coordinates);
}

// solid name / facet normal x y z / outer loop / vertex x y z (3) / endloop / endfacet / endsolid name, in
// letters of either case; several solids may follow each other.
void read_ascii(FileCursor& cursor, SurfaceFile& out) {
  bool is_open = false;
  bool has_begun = false;
  while (const auto word = cursor.find_word()) {
    const std::string keyword = to_lower_case(*word);
    const std::size_t offset = cursor.last_offset();
    if (keyword == "solid" || (has_begun && keyword == "endsolid")) {
      has_begun = true;
      is_open = keyword == "solid";
      cursor.find_line();
    } else if (has_begun && keyword == "facet") {
      cursor.expect_keyword("normal");
      for (int c = 0; c < 3; ++c) cursor.word("a facet's normal");  // may be anything; the corners decide
      cursor.expect_keyword("outer");
      cursor.expect_keyword("loop");
      for (int v = 0; v < 3; ++v) {
        cursor.expect_keyword("vertex");
        for (int c = 0; c < 3; ++c) out.coordinates.push_back(cursor.number("a corner's coordinate"));
      }
      cursor.expect_keyword("endloop");
      cursor.expect_keyword("endfacet");
      add_triangle(offset, out);
    } else {
      cursor.fail("\"" + std::string(word->substr(0, 40)) + "\" where " +
                      (has_begun ? "facet or endsolid" : "solid") + " was expected",
                  "write the file again");
    }
  }
  if (is_open) cursor.fail_truncated("endsolid");
}

void read_binary(FileCursor& cursor, SurfaceFile& out) {
  cursor.set_binary();
  cursor.take(kHeader, "the header");
  const std::uint32_t count = cursor.binary<std::uint32_t>("the number of triangles");
  cursor.require_room(count, kTriangle, "the number of triangles");
  if (cursor.remaining() != count * kTriangle)
    cursor.fail(std::to_string(count) + " triangles take " + std::to_string(count * kTriangle) +
                    " bytes, but " + std::to_string(cursor.remaining()) + " follow",
                "the count is wrong or this is not STL; write it again");
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::size_t offset = cursor.offset();
    cursor.take(12, "a normal");
    for (int c = 0; c < 9; ++c) {
      const auto value = static_cast<double>(cursor.binary<float>("a corner's coordinate"));
      if (!std::isfinite(value)) cursor.fail("a corner's coordinate is not finite", "give a finite number");
      out.coordinates.push_back(value);
    }
    cursor.take(2, "the attribute bytes");
    add_triangle(offset, out);
  }
}

// Binary headers may begin with "solid" too, and a text may by chance have the size that its bytes 80 to 83
// announce. But a text holds no zero, and the count of a binary one does.
bool is_binary_stl(FileCursor& cursor) {
  const std::string_view bytes = cursor.bytes();
  const std::string_view head = bytes.substr(0, 1024);
  if (head.find('\0') == std::string_view::npos) return false;
  if (bytes.size() >= kHeader + 4) {
    const auto count = load_bytes<std::uint32_t>(bytes.data() + kHeader, std::endian::little);
    if (bytes.size() - kHeader - 4 == count * kTriangle) return true;
  }
  // A text in whose head stands a stray zero.
  const bool is_solid = to_lower_case(cursor.peek_word().value_or("")) == "solid";
  return !(is_solid && to_lower_case(head).find("facet") != std::string::npos);
}

}  // namespace

mesh::TriangleMesh read_stl(const std::string& file, double scale) {
  FileCursor cursor(file);
  SurfaceFile out;
  is_binary_stl(cursor) ? read_binary(cursor, out) : read_ascii(cursor, out);
  merge_equal(out);
  return make_triangle_mesh(out, cursor, scale);
}

}  // namespace argil::mesh_files
