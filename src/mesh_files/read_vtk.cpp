// Legacy .vtk unstructured grid, ASCII and binary (big-endian), versions 1 to 5.1 ["VTK File Formats",
// kitware].
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "base/lower_case.h"
#include "mesh_files/number_type.h"
#include "mesh_files/vtk_grid.h"

namespace argil::mesh_files {
namespace {

constexpr std::array<std::pair<std::string_view, NumberType>, 13> kTypes = {{
    {"char", NumberType::int8},
    {"signed_char", NumberType::int8},
    {"unsigned_char", NumberType::uint8},
    {"short", NumberType::int16},
    {"unsigned_short", NumberType::uint16},
    {"int", NumberType::int32},
    {"vtkidtype", NumberType::int32},
    {"unsigned_int", NumberType::uint32},
    {"long", NumberType::int64},
    {"vtktypeint64", NumberType::int64},
    {"unsigned_long", NumberType::uint64},
    {"float", NumberType::float32},
    {"double", NumberType::float64},
}};

std::optional<NumberType> find_type(std::string_view word) {
  const std::string name = to_lower_case(word);
  const auto type =
      std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& known) { return known.first == name; });
  return type == kTypes.end() ? std::nullopt : std::optional(type->second);
}

class LegacyReader {
 public:
  explicit LegacyReader(const std::string& file) : m_cursor(file) {}
  const FileCursor& cursor() const { return m_cursor; }
  VtkGrid read();

 private:
  void read_header();
  void read_cells();
  void read_cell_types();
  bool read_attribute(const std::string& keyword);
  void read_scalars();
  void read_field();
  void skip_metadata();
  NumberType number_type();
  void skip_strings(std::int64_t count, bool are_lines);
  std::vector<double> bits(std::int64_t count, std::string_view what);
  void read_array(const std::string& name, const std::string& type, std::int64_t tuples,
                  std::int64_t components, std::string_view what, bool is_wanted);
  std::vector<double> numbers(std::int64_t tuples, std::int64_t components, NumberType type,
                              std::string_view what, bool is_wanted = true);
  bool is_kept(std::int64_t components) const { return m_data == Data::cell && components == 1; }

  FileCursor m_cursor;
  bool m_is_binary = false;
  bool m_is_5 = false;
  enum class Data { none, point, cell } m_data = Data::none;
  std::int64_t m_data_count = 0;
  VtkGrid m_grid;
};

void LegacyReader::read_header() {
  const auto line = m_cursor.find_line();
  constexpr std::string_view kMagic = "# vtk DataFile Version ";
  if (!line || !line->starts_with(kMagic))
    m_cursor.fail("does not begin with \"# vtk DataFile Version\"", "save it as legacy .vtk or as .vtu");
  m_is_5 = m_cursor.parse_number(line->substr(kMagic.size()), "the format version") >= 5.0;
  m_cursor.find_line();  // title
  const std::string encoding(m_cursor.word("ASCII or BINARY"));
  m_is_binary = encoding == "BINARY";
  if (!m_is_binary && encoding != "ASCII")
    m_cursor.fail("encoding \"" + encoding.substr(0, 40) + "\"", "it is ASCII or BINARY");
  if (m_is_binary) m_cursor.set_binary();
  m_cursor.expect_word("DATASET");
  const std::string kind(m_cursor.word("UNSTRUCTURED_GRID"));
  if (kind != "UNSTRUCTURED_GRID")
    m_cursor.fail("DATASET " + kind.substr(0, 40), "a body of tets is an UNSTRUCTURED_GRID");
}

NumberType LegacyReader::number_type() {
  const std::string_view word = m_cursor.word("a number type");
  if (const auto type = find_type(word)) return *type;
  m_cursor.fail("number type \"" + std::string(word.substr(0, 40)) + "\" is not known",
                "use int, float, double or vtktypeint64");
}

// Array of a known length; in the binary form it begins on a line of its own. Numbers that are not wanted may
// be anything.
std::vector<double> LegacyReader::numbers(std::int64_t tuples, std::int64_t components, NumberType type,
                                          std::string_view what, bool is_wanted) {
  m_cursor.require_room(tuples, static_cast<std::size_t>(std::max<std::int64_t>(components, 1)), what);
  const std::int64_t count = tuples * components;
  std::vector<double> values;
  if (!m_is_binary) {
    m_cursor.require_room(count, 1, what);
    for (std::int64_t i = 0; i < count; ++i) {
      const std::string_view word = m_cursor.word(what);
      if (is_wanted) values.push_back(m_cursor.parse_any_number(word, what));
    }
    return values;
  }
  m_cursor.find_line();
  const std::size_t size = size_of(type);
  m_cursor.require_room(count, size, what);
  const std::string_view bytes = m_cursor.take(static_cast<std::size_t>(count) * size, what);
  for (std::size_t at = 0; is_wanted && at < bytes.size(); at += size)
    values.push_back(load_number(bytes.data() + at, type, std::endian::big));
  return values;
}

// Strings: one a line, or each after its length, whose first two bits say in how many bytes it stands.
void LegacyReader::skip_strings(std::int64_t count, bool are_lines) {
  m_cursor.find_line();  // the rest of the array's head
  m_cursor.require_room(count, 1, "the number of strings");
  for (std::int64_t i = 0; i < count; ++i) {
    if (are_lines) {
      if (!m_cursor.find_line()) m_cursor.fail_truncated("a string");
      continue;
    }
    const auto first = m_cursor.binary<std::uint8_t>("a string's length");
    constexpr std::array<int, 4> kMore = {7, 3, 1, 0};
    std::uint64_t length = first & 0x3FU;
    for (int more = kMore[first >> 6U]; more > 0; --more)
      length = length << 8U | m_cursor.binary<std::uint8_t>("a string's length");
    m_cursor.take(length, "a string");
  }
}

// Numbers 0 and 1; in the binary form eight a byte, the first highest.
std::vector<double> LegacyReader::bits(std::int64_t count, std::string_view what) {
  if (!m_is_binary) return numbers(count, 1, NumberType::uint8, what);
  m_cursor.find_line();
  m_cursor.require_room(count / 8, 1, what);
  const std::string_view bytes = m_cursor.take(static_cast<std::size_t>((count + 7) / 8), what);
  std::vector<double> values;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
    values.push_back(static_cast<std::uint8_t>(bytes[i / 8]) >> (7 - i % 8) & 1);
  return values;
}

// The values after an array's head. Strings and variants (a type and a string, always one a line) are passed
// over.
void LegacyReader::read_array(const std::string& name, const std::string& type, std::int64_t tuples,
                              std::int64_t components, std::string_view what, bool is_wanted) {
  m_cursor.require_room(tuples / 8, static_cast<std::size_t>(std::max<std::int64_t>(components, 1)), what);
  const std::string kind = to_lower_case(type);
  std::vector<double> values;
  if (kind == "string" || kind == "utf8_string") return skip_strings(tuples * components, !m_is_binary);
  if (kind == "variant") return skip_strings(tuples * components, true);
  if (kind == "bit") {
    values = bits(tuples * components, what);
  } else if (const auto number = find_type(kind)) {
    values = numbers(tuples, components, *number, what, is_wanted);
  } else {
    m_cursor.fail("array \"" + name + "\" of type \"" + type.substr(0, 40) + "\"",
                  "use int, float, double or string");
  }
  if (is_wanted) m_grid.cell_arrays.push_back({name, std::move(values)});
}

void LegacyReader::read_cells() {
  const std::int64_t first = m_cursor.count("the number of cells", 1);
  const std::int64_t second = m_cursor.count("the length of the cell list", 1);
  if (m_is_5) {  // first = number of offsets, one more than cells
    m_cursor.expect_word("OFFSETS");
    const NumberType offset_type = number_type();
    m_grid.ends = numbers(first, 1, offset_type, "a cell offset");
    if (!m_grid.ends.empty()) m_grid.ends.erase(m_grid.ends.begin());
    m_cursor.expect_word("CONNECTIVITY");
    const NumberType point_type = number_type();
    m_grid.connectivity = numbers(second, 1, point_type, "a cell's point");
    return;
  }
  const std::vector<double> list = numbers(second, 1, NumberType::int32, "a cell's point");
  std::size_t at = 0;
  for (std::int64_t cell = 0; cell < first; ++cell) {
    const double size = at < list.size() ? list[at] : -1.0;
    if (!(size >= 0.0 && size <= static_cast<double>(list.size() - at - 1) && size == std::floor(size)))
      m_cursor.fail("CELLS: the list ends within cell " + std::to_string(cell),
                    "check the two counts after CELLS; write the file again");
    const std::size_t end = at + 1 + static_cast<std::size_t>(size);
    for (++at; at < end; ++at) m_grid.connectivity.push_back(list[at]);
    m_grid.ends.push_back(static_cast<double>(m_grid.connectivity.size()));
  }
}

void LegacyReader::read_cell_types() {
  const std::int64_t count = m_cursor.count("the number of cell types", 1);
  m_grid.types = numbers(count, 1, NumberType::int32, "a cell type");
}

// Percent signs in names stand for bytes: %20 is a blank.
std::string decode_name(std::string_view text) {
  const auto digit = [](char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
  };
  std::string name;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() && digit(text[i + 1]) >= 0 && digit(text[i + 2]) >= 0) {
      name += static_cast<char>(16 * digit(text[i + 1]) + digit(text[i + 2]));
      i += 2;
    } else {
      name += text[i];
    }
  }
  return name;
}

// SCALARS name type [components] / LOOKUP_TABLE name / values
void LegacyReader::read_scalars() {
  const auto line = m_cursor.find_line();
  // numbers() passes the line break itself; a file that ends here has none.
  const std::size_t end_of_line =
      m_cursor.offset() - (m_cursor.bytes().substr(0, m_cursor.offset()).ends_with('\n') ? 1 : 0);
  WordsOf words(line.value_or(""));
  const std::string name = decode_name(words.next());
  const std::string type_word(words.next());
  const std::string_view components_word = words.next();
  const std::int64_t components =
      components_word.empty() ? 1 : m_cursor.parse_integer(components_word, "the number of components");
  if (components < 1 || components > 4)
    m_cursor.fail("SCALARS of " + std::to_string(components) + " components", "scalars have 1 to 4");
  if (m_cursor.peek_word() == "LOOKUP_TABLE") {
    m_cursor.find_word();
    m_cursor.word("the name of a lookup table");
  } else {
    m_cursor.seek(end_of_line);
  }
  read_array(name, type_word, m_data_count, components, "a scalar", is_kept(components));
}

void LegacyReader::read_field() {
  m_cursor.word("a field's name");
  const std::int64_t num_arrays = m_cursor.count("the number of arrays", 1);
  for (std::int64_t a = 0; a < num_arrays; ++a) {
    while (m_cursor.peek_word() == "METADATA") {
      m_cursor.find_word();
      skip_metadata();
    }
    const std::string name = decode_name(m_cursor.word("an array's name"));
    const std::int64_t components = m_cursor.count("the number of components", 1);
    const std::int64_t count = m_cursor.count("the number of tuples", 1);
    const std::string type(m_cursor.word("the type of an array"));
    read_array(name, type, count, components, "an array's value", is_kept(components));
  }
}

// "METADATA", then lines up to an empty one.
void LegacyReader::skip_metadata() {
  m_cursor.find_line();
  for (auto line = m_cursor.find_line(); line && !line->empty();) line = m_cursor.find_line();
}

// One attribute of points or cells; false for a word that is none.
bool LegacyReader::read_attribute(const std::string& keyword) {
  if (keyword == "SCALARS") {
    read_scalars();
  } else if (keyword == "FIELD") {
    read_field();
  } else if (keyword == "VECTORS" || keyword == "NORMALS" || keyword == "TENSORS" || keyword == "TENSORS6") {
    m_cursor.word("a name");
    const NumberType type = number_type();
    const std::int64_t components = keyword == "TENSORS" ? 9 : keyword == "TENSORS6" ? 6 : 3;
    numbers(m_data_count, components, type, "a component", false);
  } else if (keyword == "TEXTURE_COORDINATES") {
    m_cursor.word("a name");
    const std::int64_t components = m_cursor.count("the number of components", 1);
    const NumberType type = number_type();
    numbers(m_data_count, components, type, "a texture coordinate", false);
  } else if (keyword == "GLOBAL_IDS" || keyword == "PEDIGREE_IDS") {
    const std::string name = decode_name(m_cursor.word("a name"));
    const std::string type(m_cursor.word("the type of an array"));
    read_array(name, type, m_data_count, 1, "a number", false);
  } else if (keyword == "COLOR_SCALARS") {
    m_cursor.word("a name");
    const std::int64_t components = m_cursor.count("the number of components", 1);
    numbers(m_data_count, components, NumberType::uint8, "a colour", false);
  } else if (keyword == "LOOKUP_TABLE") {
    m_cursor.word("a name");
    const std::int64_t count = m_cursor.count("the length of a lookup table", 1);
    numbers(count, 4, NumberType::uint8, "a colour", false);
  } else if (keyword == "METADATA") {
    skip_metadata();
  } else {
    return false;
  }
  return true;
}

VtkGrid LegacyReader::read() {
  read_header();
  while (const auto word = m_cursor.find_word()) {
    const std::string keyword(*word);
    if (keyword == "POINTS") {
      const std::int64_t count = m_cursor.count("the number of points", 3);
      const NumberType type = number_type();
      m_grid.points = numbers(count, 3, type, "a point coordinate");
    } else if (keyword == "CELLS") {
      read_cells();
    } else if (keyword == "CELL_TYPES") {
      read_cell_types();
    } else if (keyword == "POINT_DATA" || keyword == "CELL_DATA") {
      m_data = keyword == "POINT_DATA" ? Data::point : Data::cell;
      m_data_count = m_cursor.count("the number of values", 1);
    } else if (!read_attribute(keyword)) {
      m_cursor.fail("\"" + keyword.substr(0, 40) + "\" where a section such as CELLS was expected",
                    "check the counts of the section above");
    }
  }
  return std::move(m_grid);
}

}  // namespace

mesh::TetMesh read_vtk(const std::string& file, double scale) {
  LegacyReader reader(file);
  const VtkGrid grid = reader.read();
  return make_tet_mesh(grid, reader.cursor(), scale);
}

}  // namespace argil::mesh_files
