// Gmsh .msh 2 and 4.1, ASCII and binary [Gmsh reference manual, "MSH file format" and "(Legacy)"].
#include <algorithm>
#include <array>
#include <numeric>

#include "base/error.h"
#include "mesh_files/tet_file.h"

namespace argil::mesh_files {
namespace {

struct ElementType {
  int code;
  int num_nodes;
  bool is_volume;
  const char* name;
};

constexpr int kTet4 = 4;
constexpr std::array<ElementType, 33> kElementTypes = {{
    {1, 2, false, "2-node line"},
    {2, 3, false, "3-node triangle"},
    {3, 4, false, "4-node quadrangle"},
    {kTet4, 4, true, "4-node tetrahedron"},
    {5, 8, true, "8-node hexahedron"},
    {6, 6, true, "6-node prism"},
    {7, 5, true, "5-node pyramid"},
    {8, 3, false, "3-node line"},
    {9, 6, false, "6-node triangle"},
    {10, 9, false, "9-node quadrangle"},
    {11, 10, true, "10-node tetrahedron"},
    {12, 27, true, "27-node hexahedron"},
    {13, 18, true, "18-node prism"},
    {14, 14, true, "14-node pyramid"},
    {15, 1, false, "point"},
    {16, 8, false, "8-node quadrangle"},
    {17, 20, true, "20-node hexahedron"},
    {18, 15, true, "15-node prism"},
    {19, 13, true, "13-node pyramid"},
    {20, 9, false, "9-node triangle"},
    {21, 10, false, "10-node triangle"},
    {22, 12, false, "12-node triangle"},
    {23, 15, false, "15-node triangle"},
    {24, 15, false, "15-node triangle"},
    {25, 21, false, "21-node triangle"},
    {26, 4, false, "4-node line"},
    {27, 5, false, "5-node line"},
    {28, 6, false, "6-node line"},
    {29, 20, true, "20-node tetrahedron"},
    {30, 35, true, "35-node tetrahedron"},
    {31, 56, true, "56-node tetrahedron"},
    {92, 64, true, "64-node hexahedron"},
    {93, 125, true, "125-node hexahedron"},
}};

// A number of the file in the encoding its header announced. Integers are `int` in the binary form of both
// versions except where 4.1 says size_t.
class GmshCursor : public FileCursor {
 public:
  explicit GmshCursor(const std::string& file) : FileCursor(file) {}

  void read_header() {
    if (find_line() != "$MeshFormat")
      fail("does not begin with $MeshFormat", "save it as Gmsh .msh 4.1 or 2.2");
    const std::string version(word("the format version"));
    m_is_4 = version == "4.1";
    if (!m_is_4 && version != "2" && version != "2.1" && version != "2.2")
      fail("format version \"" + version.substr(0, 40) + "\"",
           "save it as 4.1 or 2.2 (Gmsh: -format msh41 or msh22)");
    const std::int64_t kind = integer("the file type");
    if (kind != 0 && kind != 1) fail("file type " + std::to_string(kind), "0 is ASCII and 1 is binary");
    const std::int64_t size = integer("the data size");
    if (size != 8) fail("data size " + std::to_string(size), "save it with 8-byte numbers");
    if (kind == 1) {
      find_line();
      m_is_binary = true;
      set_binary();
      if (binary<std::int32_t>("the byte order mark") != 1)
        fail("the byte order is not this machine's", "save it as ASCII, or on a little-endian machine");
    }
    expect_word("$EndMeshFormat");
    find_line();
  }

  bool is_4() const { return m_is_4; }
  bool is_in_binary() const { return m_is_binary; }
  std::int64_t small(std::string_view what) {
    return m_is_binary ? binary<std::int32_t>(what) : integer(what);
  }
  std::int64_t large(std::string_view what) {
    return m_is_binary ? binary<std::int64_t>(what) : integer(what);
  }
  /// Tags of nodes and elements: size_t since 4.
  std::int64_t tag(std::string_view what) { return m_is_4 ? large(what) : small(what); }
  /// It may be NaN or infinite.
  double real(std::string_view what) { return m_is_binary ? binary<double>(what) : any_number(what); }
  /// Refuses `count` things of `numbers` numbers each that do not fit into what is left of the file. `bytes`
  /// is what one such thing takes in the binary form.
  void require_items(std::int64_t count, std::int64_t numbers, std::int64_t bytes,
                     std::string_view what) const {
    require_room(count,
                 static_cast<std::size_t>(m_is_binary ? bytes : std::max<std::int64_t>(2 * numbers - 1, 1)),
                 what);
  }
  /// Passes the line break between text and binary numbers.
  void begin_numbers() {
    if (m_is_binary) find_line();
  }

 private:
  bool m_is_4 = false;
  bool m_is_binary = false;
};

const ElementType& find_type(std::int64_t code, const GmshCursor& cursor) {
  const auto type = std::find_if(kElementTypes.begin(), kElementTypes.end(),
                                 [&](const ElementType& candidate) { return candidate.code == code; });
  if (type == kElementTypes.end())
    cursor.fail("element type " + std::to_string(code) + " is not known", "mesh with 4-node tetrahedra");
  if (type->is_volume && type->code != kTet4)
    cursor.fail("element type " + std::to_string(code) + " (" + type->name + ")",
                "only 4-node tetrahedra can be used; Gmsh: Mesh.ElementOrder = 1, no recombination");
  return *type;
}

void read_coordinates(GmshCursor& cursor, TetFile& out) {
  for (int c = 0; c < 3; ++c) out.coordinates.push_back(cursor.real("a node coordinate"));
}

void read_nodes_2(GmshCursor& cursor, TetFile& out) {
  const std::int64_t count = cursor.integer("the number of nodes");
  cursor.begin_numbers();
  cursor.require_items(count, 4, 28, "the number of nodes");
  for (std::int64_t i = 0; i < count; ++i) {
    out.vertex_labels.push_back(cursor.tag("a node number"));
    read_coordinates(cursor, out);
  }
}

void read_nodes_4(GmshCursor& cursor, TetFile& out) {
  const std::int64_t num_blocks = cursor.large("the number of node blocks");
  const std::int64_t total = cursor.large("the number of nodes");
  for (int skipped = 0; skipped < 2; ++skipped) cursor.large("the range of node numbers");
  cursor.require_items(num_blocks, 4, 20, "the number of node blocks");
  cursor.require_items(total, 4, 32, "the number of nodes");
  for (std::int64_t block = 0; block < num_blocks; ++block) {
    const std::int64_t dimension = cursor.small("an entity's dimension");
    if (dimension < 0 || dimension > 3)
      cursor.fail("entity dimension " + std::to_string(dimension), "it is 0 to 3");
    cursor.small("an entity's number");
    const bool is_parametric = cursor.small("the parametric flag") != 0;
    const std::int64_t count = cursor.large("the number of nodes of a block");
    cursor.require_items(count, 4, 32, "the number of nodes of a block");
    for (std::int64_t i = 0; i < count; ++i) out.vertex_labels.push_back(cursor.tag("a node number"));
    for (std::int64_t i = 0; i < count; ++i) {
      read_coordinates(cursor, out);
      for (std::int64_t p = 0; is_parametric && p < dimension; ++p) cursor.real("a node parameter");
    }
  }
  if (static_cast<std::int64_t>(out.vertex_labels.size()) != total)
    cursor.fail("the blocks hold " + std::to_string(out.vertex_labels.size()) + " nodes, $Nodes announces " +
                    std::to_string(total),
                "write the file again");
}

// One element after its tags: kept when it is a tet.
void read_element_nodes(GmshCursor& cursor, const ElementType& type, std::int64_t label, std::size_t begin,
                        TetFile& out) {
  for (int n = 0; n < type.num_nodes; ++n) {
    const std::int64_t node = cursor.tag("an element's node");
    if (type.code == kTet4) out.corners.push_back(node);
  }
  if (type.code != kTet4) return;
  out.tet_labels.push_back(label);
  out.tet_offsets.push_back(begin);
}

void read_elements_2(GmshCursor& cursor, TetFile& out) {
  const std::int64_t total = cursor.integer("the number of elements");
  cursor.begin_numbers();
  cursor.require_items(total, 4, 8, "the number of elements");  // a point: number, (type, tags,) node
  std::int64_t done = 0;
  while (done < total) {
    // In ASCII each element stands for itself: number, type, tags. In binary a head serves a row of them.
    std::int64_t label = cursor.is_in_binary() ? 0 : cursor.integer("an element number");
    std::size_t begin = cursor.last_offset();
    const ElementType& type = find_type(cursor.small("an element type"), cursor);
    const std::int64_t row = cursor.is_in_binary() ? cursor.small("the number of elements of a row") : 1;
    if (row < 1 || row > total - done)
      cursor.fail(
          std::to_string(row) + " elements in a row where " + std::to_string(total - done) + " are left",
          "write the file again");
    const std::int64_t num_tags = cursor.small("the number of tags");
    cursor.require_items(num_tags, 1, 4, "the number of tags");
    for (std::int64_t i = 0; i < row; ++i, ++done) {
      if (cursor.is_in_binary()) {
        label = cursor.small("an element number");
        begin = cursor.last_offset();
      }
      for (std::int64_t t = 0; t < num_tags; ++t) cursor.small("an element tag");
      read_element_nodes(cursor, type, label, begin, out);
    }
  }
}

void read_elements_4(GmshCursor& cursor, TetFile& out) {
  const std::int64_t num_blocks = cursor.large("the number of element blocks");
  const std::int64_t total = cursor.large("the number of elements");
  for (int skipped = 0; skipped < 2; ++skipped) cursor.large("the range of element numbers");
  cursor.require_items(num_blocks, 4, 20, "the number of element blocks");
  cursor.require_items(total, 2, 16, "the number of elements");
  std::int64_t done = 0;
  for (std::int64_t block = 0; block < num_blocks; ++block) {
    cursor.small("an entity's dimension");
    cursor.small("an entity's number");
    const ElementType& type = find_type(cursor.small("an element type"), cursor);
    const std::int64_t count = cursor.large("the number of elements of a block");
    cursor.require_items(count, 1 + type.num_nodes, 8 * (1 + type.num_nodes),
                         "the number of elements of a block");
    for (std::int64_t i = 0; i < count; ++i) {
      const std::int64_t label = cursor.tag("an element number");
      read_element_nodes(cursor, type, label, cursor.last_offset(), out);
    }
    done += count;
  }
  if (done != total)
    cursor.fail(
        "the blocks hold " + std::to_string(done) + " elements, $Elements announces " + std::to_string(total),
        "write the file again");
}

// Text between the first and the last quotation mark of a line.
std::string unquote(std::string_view line) {
  const std::size_t begin = line.find('"');
  const std::size_t end = line.rfind('"');
  return std::string(begin < end ? line.substr(begin + 1, end - begin - 1) : line);
}

// $ElementData: a name, a time, and one or more numbers for some elements. One number for every tet is a cell
// field; vectors and tensors, and data of surfaces only, are not.
void read_element_data(GmshCursor& cursor, TetFile& out) {
  std::string name;
  const std::int64_t num_names = cursor.count("the number of string tags", 1);
  cursor.find_line();
  for (std::int64_t i = 0; i < num_names; ++i) {
    const auto line = cursor.find_line();
    if (!line) cursor.fail_truncated("a field's name");
    if (i == 0) name = unquote(*line);
  }
  for (std::int64_t i = cursor.count("the number of real tags", 1); i > 0; --i)
    cursor.any_number("a real tag");
  const std::int64_t num_tags = cursor.count("the number of integer tags", 1);
  if (num_tags < 3)
    cursor.fail(std::to_string(num_tags) + " integer tags", "step, components, elements are needed");
  cursor.integer("the time step");
  const std::int64_t components = cursor.count("the number of components", 1);
  const std::int64_t count = cursor.integer("the number of elements");
  for (std::int64_t i = 3; i < num_tags; ++i) cursor.integer("an integer tag");
  cursor.begin_numbers();
  cursor.require_items(count, 1 + components, 4 + 8 * components, "the number of elements");

  if (out.tet_labels.empty()) cursor.fail("$ElementData stands before $Elements", "write the elements first");
  const LabelIndex tets(out.tet_labels, cursor, "element");
  Field values = Field::Zero(static_cast<Eigen::Index>(out.tet_labels.size()));
  std::vector<bool> is_given(out.tet_labels.size(), false);
  for (std::int64_t i = 0; i < count; ++i) {
    const int tet = tets.find(cursor.small("an element number"));
    for (std::int64_t c = 0; c < components; ++c) {
      const double value = cursor.real("a cell value");
      if (tet >= 0) values(tet) = value;
    }
    if (tet >= 0) is_given[static_cast<std::size_t>(tet)] = true;
  }
  const auto missing = std::find(is_given.begin(), is_given.end(), false);
  if (components != 1 || std::find(is_given.begin(), is_given.end(), true) == is_given.end()) return;
  if (missing != is_given.end())
    cursor.fail("cell field \"" + name + "\" has no value for tet " +
                    std::to_string(out.tet_labels[static_cast<std::size_t>(missing - is_given.begin())]),
                "give every tet a value");
  add_cell_field(out.cell_fields, name, std::move(values), cursor);
}

template <std::size_t kEach, class T>
void reorder(std::vector<T>& values, const std::vector<std::size_t>& order) {
  std::vector<T> sorted;
  sorted.reserve(values.size());
  for (const std::size_t i : order)
    sorted.insert(sorted.end(), &values[kEach * i], &values[kEach * i] + kEach);
  values = std::move(sorted);
}

// The file's numbers give the order, so that one mesh reads the same in every version: 4.1 groups nodes and
// elements by entity.
template <class Reorder>
void sort_by_label(std::vector<std::int64_t>& labels, Reorder reorder_rest) {
  if (std::is_sorted(labels.begin(), labels.end())) return;
  std::vector<std::size_t> order(labels.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return labels[a] < labels[b]; });
  reorder<1>(labels, order);
  reorder_rest(order);
}

// To "$End…" of a section that is not wanted.
void skip_section(GmshCursor& cursor, const std::string& name) {
  const std::string end = "$End" + name.substr(1);
  const std::size_t at = cursor.bytes().find(end, cursor.offset());
  if (at == std::string_view::npos) cursor.fail_truncated(end);
  cursor.seek(at);
}

}  // namespace

mesh::TetMesh read_gmsh(const std::string& file, double scale) {
  GmshCursor cursor(file);
  cursor.read_header();
  TetFile out;
  while (const auto word = cursor.find_word()) {
    const std::string section(*word);
    if (!section.starts_with('$') || section.starts_with("$End"))
      cursor.fail("\"" + section.substr(0, 40) + "\" where a section such as $Nodes was expected",
                  "check the counts of the section above");
    if ((section == "$Nodes" && !out.vertex_labels.empty()) ||
        (section == "$Elements" && !out.tet_labels.empty()))
      cursor.fail("a second section " + section, "keep one");
    if (section == "$ParametricNodes")
      cursor.fail("section $ParametricNodes", "save it with Mesh.SaveParametric = 0, or as 4.1");
    cursor.find_line();
    if (section == "$Nodes") {
      cursor.is_4() ? read_nodes_4(cursor, out) : read_nodes_2(cursor, out);
      sort_by_label(out.vertex_labels, [&](const auto& order) { reorder<3>(out.coordinates, order); });
    } else if (section == "$Elements") {
      cursor.is_4() ? read_elements_4(cursor, out) : read_elements_2(cursor, out);
      sort_by_label(out.tet_labels, [&](const auto& order) {
        reorder<4>(out.corners, order);
        reorder<1>(out.tet_offsets, order);
      });
    } else if (section == "$ElementData") {
      read_element_data(cursor, out);
    } else {
      skip_section(cursor, section);
    }
    cursor.expect_word("$End" + section.substr(1));
    cursor.find_line();
  }
  return make_tet_mesh(out, cursor, scale);
}

}  // namespace argil::mesh_files
