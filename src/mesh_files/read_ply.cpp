// PLY, ASCII and binary of both byte orders: vertex x, y, z and the polygons of face [Turk 1994].
#include <array>
#include <cmath>
#include <utility>

#include "mesh_files/number_type.h"
#include "mesh_files/surface_file.h"

namespace argil::mesh_files {
namespace {

constexpr std::array<std::pair<std::string_view, NumberType>, 16> kTypes = {{
    {"char", NumberType::int8},
    {"int8", NumberType::int8},
    {"uchar", NumberType::uint8},
    {"uint8", NumberType::uint8},
    {"short", NumberType::int16},
    {"int16", NumberType::int16},
    {"ushort", NumberType::uint16},
    {"uint16", NumberType::uint16},
    {"int", NumberType::int32},
    {"int32", NumberType::int32},
    {"uint", NumberType::uint32},
    {"uint32", NumberType::uint32},
    {"float", NumberType::float32},
    {"float32", NumberType::float32},
    {"double", NumberType::float64},
    {"float64", NumberType::float64},
}};

struct Property {
  std::string name;
  NumberType type = NumberType::float32;
  bool is_list = false;
  NumberType length_type = NumberType::uint8;
};

struct Element {
  std::string name;
  std::int64_t count = 0;
  std::vector<Property> properties;
};

class PlyReader {
 public:
  explicit PlyReader(const std::string& file) : m_cursor(file) {}
  FileCursor& cursor() { return m_cursor; }
  SurfaceFile read();

 private:
  void read_header();
  void read_format(WordsOf& words);
  NumberType parse_type(std::string_view word) const;
  double value(NumberType type, std::string_view what);
  void skip(NumberType type, std::string_view what);
  std::int64_t whole(NumberType type, std::string_view what);
  void read_vertex(const Element& element, SurfaceFile& out);
  void read_other(const Element& element, SurfaceFile& out);

  FileCursor m_cursor;
  bool m_is_binary = false;
  std::endian m_order = std::endian::little;
  std::vector<Element> m_elements;
};

NumberType PlyReader::parse_type(std::string_view word) const {
  for (const auto& [name, type] : kTypes)
    if (name == word) return type;
  m_cursor.fail("property type \"" + std::string(word.substr(0, 40)) + "\" is not known",
                "use int, float or double");
}

void PlyReader::read_format(WordsOf& words) {
  const std::string_view format = words.next();
  m_is_binary = format != "ascii";
  m_order = format == "binary_big_endian" ? std::endian::big : std::endian::little;
  if (m_is_binary && format != "binary_big_endian" && format != "binary_little_endian")
    m_cursor.fail("format \"" + std::string(format.substr(0, 40)) + "\"",
                  "it is ascii, binary_little_endian or binary_big_endian");
}

void PlyReader::read_header() {
  if (m_cursor.find_line() != "ply") m_cursor.fail("does not begin with \"ply\"", "save it as PLY");
  bool has_format = false;
  while (true) {
    const auto line = m_cursor.find_line();
    if (!line) m_cursor.fail_truncated("end_header");
    WordsOf words(*line);
    const std::string_view keyword = words.next();
    if (keyword == "end_header") break;
    if (keyword == "format") {
      has_format = true;
      read_format(words);
    } else if (keyword == "element") {
      Element element;
      element.name = words.next();
      element.count = m_cursor.parse_integer(words.next(), "the number of elements");
      m_cursor.require_room(element.count, 1, "the number of elements");
      m_elements.push_back(std::move(element));
    } else if (keyword == "property") {
      if (m_elements.empty()) m_cursor.fail("a property before any element", "write the file again");
      Property property;
      std::string_view type = words.next();
      if (type == "list") {
        property.is_list = true;
        property.length_type = parse_type(words.next());
        type = words.next();
      }
      property.type = parse_type(type);
      property.name = words.next();
      m_elements.back().properties.push_back(std::move(property));
    } else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty()) {
      m_cursor.fail("\"" + std::string(keyword.substr(0, 40)) + "\" in the header", "write the file again");
    }
  }
  if (!has_format) m_cursor.fail("the header has no format", "write the file again");
  if (m_is_binary) m_cursor.set_binary();
}

double PlyReader::value(NumberType type, std::string_view what) {
  if (!m_is_binary) return m_cursor.any_number(what);
  return load_number(m_cursor.take(size_of(type), what).data(), type, m_order);
}

// What nothing uses may be anything.
void PlyReader::skip(NumberType type, std::string_view what) {
  m_is_binary ? m_cursor.take(size_of(type), what) : m_cursor.word(what);
}

std::int64_t PlyReader::whole(NumberType type, std::string_view what) {
  const double number = value(type, what);
  if (number != std::floor(number) || !(std::abs(number) <= 0x1p53))
    m_cursor.fail(std::string(what) + " is not a whole number", "write the file again");
  return static_cast<std::int64_t>(number);
}

void PlyReader::read_vertex(const Element& element, SurfaceFile& out) {
  std::array<double, 3> x{};
  for (const Property& property : element.properties) {
    const std::int64_t length = property.is_list ? whole(property.length_type, "a list's length") : 1;
    m_cursor.require_room(length, 1, "a list's length");
    const bool is_coordinate = property.name.size() == 1 && property.name >= "x" && property.name <= "z";
    for (std::int64_t i = 0; i < length; ++i) {
      if (is_coordinate) {
        x[static_cast<std::size_t>(property.name[0] - 'x')] = value(property.type, "a vertex coordinate");
      } else {
        skip(property.type, "a vertex property");
      }
    }
  }
  out.coordinates.insert(out.coordinates.end(), x.begin(), x.end());
  out.vertex_offsets.push_back(m_cursor.last_offset());
}

// A face, or an element that is not wanted.
void PlyReader::read_other(const Element& element, SurfaceFile& out) {
  std::vector<std::int64_t> polygon;
  std::size_t offset = m_cursor.offset();
  for (const Property& property : element.properties) {
    const bool is_polygon = element.name == "face" && property.is_list &&
                            (property.name == "vertex_indices" || property.name == "vertex_index");
    const std::int64_t length = property.is_list ? whole(property.length_type, "a list's length") : 1;
    offset = m_cursor.last_offset();
    m_cursor.require_room(length, 1, "a list's length");
    if (is_polygon && length < 3)
      m_cursor.fail("a face of " + std::to_string(length) + " vertices", "a face has at least 3; remove it");
    for (std::int64_t i = 0; i < length; ++i) {
      if (is_polygon) {
        polygon.push_back(whole(property.type, "a face's vertex number"));
      } else {
        skip(property.type, "a property");
      }
    }
  }
  add_fan(polygon, offset, out);
}

SurfaceFile PlyReader::read() {
  read_header();
  SurfaceFile out;
  bool has_coordinates = false;
  for (const Element& element : m_elements) {
    if (element.name == "tristrips") m_cursor.fail("element tristrips", "save the faces as polygons");
    // An element takes at least one byte, or one digit, per property.
    if (element.properties.empty()) continue;
    m_cursor.require_room(element.count, element.properties.size(),
                          "the number of " + element.name + " elements");
    if (element.name == "vertex") {
      int found = 0;
      for (const Property& p : element.properties)
        found += p.name == "x" || p.name == "y" || p.name == "z" ? 1 : 0;
      has_coordinates = found == 3;
    }
    for (std::int64_t i = 0; i < element.count; ++i)
      element.name == "vertex" ? read_vertex(element, out) : read_other(element, out);
  }
  if (!has_coordinates)
    m_cursor.fail("element vertex has not the properties x, y, z", "save the coordinates too");
  return out;
}

}  // namespace

mesh::TriangleMesh read_ply(const std::string& file, double scale) {
  PlyReader reader(file);
  const SurfaceFile surface = reader.read();
  return make_triangle_mesh(surface, reader.cursor(), scale);
}

}  // namespace argil::mesh_files
