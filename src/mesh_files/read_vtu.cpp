// VTK's XML unstructured grid, .vtu: numbers as text, base64 or raw bytes, plain or packed by zlib
// ["VTK XML Formats", docs.vtk.org].
#include <algorithm>
#include <map>
#include <optional>

#include "base/error.h"
#include "mesh_files/vtk_arrays.h"
#include "mesh_files/vtk_grid.h"

namespace argil::mesh_files {
namespace {

struct Tag {
  std::string name;  // with a leading / when it closes
  std::map<std::string, std::string> attributes;
  std::size_t begin = 0;
  std::size_t end = 0;  // after the >
  std::string attribute(const std::string& key, const std::string& otherwise = "") const {
    const auto at = attributes.find(key);
    return at == attributes.end() ? otherwise : at->second;
  }
};

std::string decode_entities(std::string_view text) {
  constexpr std::pair<std::string_view, char> kEntities[] = {
      {"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}};
  std::string decoded;
  while (!text.empty()) {
    const auto entity = std::find_if(std::begin(kEntities), std::end(kEntities), [&](const auto& candidate) {
      return text.starts_with(candidate.first);
    });
    const bool is_entity = entity != std::end(kEntities);
    decoded += is_entity ? entity->second : text.front();
    text.remove_prefix(is_entity ? entity->first.size() : 1);
  }
  return decoded;
}

// name="value" name='value' …
void read_attributes(std::string_view text, const FileCursor& cursor, Tag& tag) {
  while (!(text = trim(text)).empty() && text != "/") {
    const std::size_t equals = text.find('=');
    const std::string_view value = equals == std::string_view::npos ? "" : trim(text.substr(equals + 1));
    const bool is_quoted = !value.empty() && (value.front() == '"' || value.front() == '\'');
    const std::size_t close = is_quoted ? value.find(value.front(), 1) : std::string_view::npos;
    if (close == std::string_view::npos)
      cursor.fail_at(tag.begin, "<" + tag.name + "> has an attribute without a quoted value",
                     "write the file again");
    tag.attributes[std::string(trim(text.substr(0, equals)))] = decode_entities(value.substr(1, close - 1));
    text = value.substr(close + 1);
  }
}

// Next tag from `offset` on; comments, declarations and text are passed over. Nothing at the end.
std::optional<Tag> find_tag(const FileCursor& cursor, std::size_t offset) {
  const std::string_view bytes = cursor.bytes();
  while ((offset = bytes.find('<', offset)) != std::string_view::npos) {
    const std::string_view rest = bytes.substr(offset);
    const std::string_view closing = rest.starts_with("<!--") ? "-->" : rest.starts_with("<?") ? "?>" : ">";
    const std::size_t end = bytes.find(closing, offset);
    if (end == std::string_view::npos) cursor.fail_truncated(closing);
    if (rest.starts_with("<!") || rest.starts_with("<?")) {
      offset = end + closing.size();
      continue;
    }
    Tag tag;
    tag.begin = offset;
    tag.end = end + 1;
    const std::string_view inside = bytes.substr(offset + 1, end - offset - 1);
    const std::size_t name_end = std::min(inside.find_first_of(" \t\r\n/", 1), inside.size());
    tag.name = inside.substr(0, name_end);
    if (!tag.name.starts_with('/')) read_attributes(inside.substr(name_end), cursor, tag);
    return tag;
  }
  return std::nullopt;
}

struct DataArray {
  std::string section;  // Points, Cells, CellData, …
  std::string name;
  std::int64_t components = 1;
  Tag tag;
};

class VtuReader {
 public:
  explicit VtuReader(const std::string& file) : m_cursor(file) {}
  const FileCursor& cursor() const { return m_cursor; }
  VtkGrid read();

 private:
  void read_tags();
  void read_file_tag(const Tag& tag);
  void read_piece_tag(const Tag& tag);
  void read_appended_tag(const Tag& tag);
  std::int64_t whole(const Tag& tag, const std::string& key, const std::string& otherwise) const;
  std::size_t appended_end(std::size_t begin) const;
  std::vector<double> decode(const DataArray& array) const;
  std::vector<double> decode_named(const std::string& section, const std::string& name) const;
  void require_size(const DataArray& array, const std::vector<double>& values, std::int64_t count) const;

  FileCursor m_cursor;
  ArrayEncoding m_encoding;
  std::int64_t m_num_points = -1;
  std::int64_t m_num_cells = -1;
  std::vector<DataArray> m_arrays;
  std::optional<std::size_t> m_appended;  // first byte after the underscore
  bool m_appended_is_base64 = false;
};

std::int64_t VtuReader::whole(const Tag& tag, const std::string& key, const std::string& otherwise) const {
  const std::string text(trim(tag.attribute(key, otherwise)));
  if (text.empty() || text.find_first_not_of("0123456789") != std::string::npos || text.size() > 15)
    m_cursor.fail_at(tag.begin, "<" + tag.name + "> has " + key + "=\"" + text.substr(0, 40) + "\"",
                     "give a whole number");
  return std::stoll(text);
}

void VtuReader::read_file_tag(const Tag& tag) {
  if (tag.attribute("type") != "UnstructuredGrid")
    m_cursor.fail_at(tag.begin, "VTKFile of type \"" + tag.attribute("type") + "\"",
                     "a body of tets is an UnstructuredGrid");
  const std::string order = tag.attribute("byte_order", "LittleEndian");
  m_encoding.order = order == "BigEndian" ? std::endian::big : std::endian::little;
  const std::string header = tag.attribute("header_type", "UInt32");
  m_encoding.header = header == "UInt64" ? NumberType::uint64 : NumberType::uint32;
  const std::string compressor = tag.attribute("compressor");
  m_encoding.is_packed = compressor == "vtkZLibDataCompressor";
  if ((order != "BigEndian" && order != "LittleEndian") || (header != "UInt32" && header != "UInt64"))
    m_cursor.fail_at(tag.begin, "byte_order \"" + order + "\", header_type \"" + header + "\"",
                     "use LittleEndian or BigEndian, UInt32 or UInt64");
  if (!compressor.empty() && !m_encoding.is_packed)
    m_cursor.fail_at(tag.begin, "compressor " + compressor,
                     "save it with the compressor ZLib or None, or as legacy .vtk");
}

void VtuReader::read_piece_tag(const Tag& tag) {
  if (m_num_points >= 0) m_cursor.fail_at(tag.begin, "a second Piece", "save the body in one piece");
  m_num_points = whole(tag, "NumberOfPoints", "");
  m_num_cells = whole(tag, "NumberOfCells", "");
}

void VtuReader::read_appended_tag(const Tag& tag) {
  const std::string encoding = tag.attribute("encoding", "raw");
  if (encoding != "raw" && encoding != "base64")
    m_cursor.fail_at(tag.begin, "AppendedData with encoding \"" + encoding + "\"", "use raw or base64");
  m_appended_is_base64 = encoding == "base64";
  const std::size_t mark = m_cursor.bytes().find('_', tag.end);
  if (mark == std::string_view::npos) m_cursor.fail_truncated("the underscore before appended data");
  m_appended = mark + 1;
}

// Everything up to the appended data, which are not text.
void VtuReader::read_tags() {
  std::string section;
  std::size_t offset = 0;
  bool is_vtk = false;
  while (auto tag = find_tag(m_cursor, offset)) {
    offset = tag->end;
    if (tag->name == "VTKFile") {
      is_vtk = true;
      read_file_tag(*tag);
    } else if (!is_vtk) {
      break;
    } else if (tag->name == "Piece") {
      read_piece_tag(*tag);
    } else if (tag->name == "DataArray") {
      DataArray array{section, tag->attribute("Name"), whole(*tag, "NumberOfComponents", "1"), *tag};
      m_arrays.push_back(std::move(array));
    } else if (tag->name == "AppendedData") {
      read_appended_tag(*tag);
      break;
    } else if (tag->name == "Points" || tag->name == "Cells" || tag->name == "PointData" ||
               tag->name == "CellData" || tag->name == "FieldData") {
      section = tag->name;
    } else if (tag->name == "/VTKFile") {
      break;
    }
  }
  if (!is_vtk) m_cursor.fail_at(0, "does not begin with a VTKFile element", "save it as .vtu or legacy .vtk");
  if (m_num_cells < 0) m_cursor.fail_at(0, "has no Piece", "write the file again");
}

// Where the appended array that begins at `begin` must end: at the next one, or at the end of the file. No
// two share their bytes, so that a small file cannot ask for a large memory.
std::size_t VtuReader::appended_end(std::size_t begin) const {
  std::size_t end = m_cursor.bytes().size();
  int num_here = 0;
  for (const DataArray& array : m_arrays) {
    if (array.tag.attribute("format") != "appended") continue;
    const std::size_t other = *m_appended + static_cast<std::size_t>(whole(array.tag, "offset", ""));
    if (other > begin) end = std::min(end, other);
    if (other == begin && ++num_here > 1)
      m_cursor.fail_at(array.tag.begin, "array \"" + array.name + "\" has the offset of another",
                       "give each its own");
  }
  return end;
}

std::vector<double> VtuReader::decode(const DataArray& array) const {
  const auto fail = [&](const std::string& problem) {
    m_cursor.fail_at(array.tag.begin, "array \"" + array.name + "\": " + problem,
                     "the file is truncated or damaged; write it again");
  };
  const std::optional<NumberType> type = find_number_type(array.tag.attribute("type"));
  if (!type) fail("type \"" + array.tag.attribute("type") + "\" is not a number");
  const std::string format = array.tag.attribute("format", "ascii");
  const std::string_view bytes = m_cursor.bytes();
  const std::size_t text_end = std::min(bytes.find('<', array.tag.end), bytes.size());
  const std::string_view text = bytes.substr(array.tag.end, text_end - array.tag.end);
  if (format == "ascii") {
    std::vector<double> values;
    WordsOf words(text);
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
      const std::optional<double> value = find_number(word);
      if (!value) fail("\"" + std::string(word.substr(0, 40)) + "\" is not a number");
      values.push_back(*value);
    }
    return values;
  }
  std::string problem;
  std::vector<double> values;
  if (format == "binary") {
    values = decode_block(decode_base64(text), *type, m_encoding, problem);
  } else if (format == "appended" && m_appended) {
    const std::size_t begin = *m_appended + static_cast<std::size_t>(whole(array.tag, "offset", ""));
    if (begin >= bytes.size()) fail("its offset is behind the end of the file");
    const std::string_view rest = bytes.substr(begin, appended_end(begin) - begin);
    values = m_appended_is_base64 ? decode_block(decode_base64(rest), *type, m_encoding, problem)
                                  : decode_block(rest, *type, m_encoding, problem);
  } else {
    problem = format == "appended" ? "there is no AppendedData" : "format \"" + format + "\" is not known";
  }
  if (!problem.empty()) fail(problem);
  return values;
}

void VtuReader::require_size(const DataArray& array, const std::vector<double>& values,
                             std::int64_t count) const {
  if (static_cast<std::int64_t>(values.size()) != count)
    m_cursor.fail_at(array.tag.begin,
                     "array \"" + array.name + "\" has " + std::to_string(values.size()) + " numbers where " +
                         std::to_string(count) + " are announced",
                     "the file is truncated or damaged; write it again");
}

std::vector<double> VtuReader::decode_named(const std::string& section, const std::string& name) const {
  for (const DataArray& array : m_arrays) {
    if (array.section != section || (array.name != name && !name.empty())) continue;
    std::vector<double> values = decode(array);
    if (section == "Points") require_size(array, values, 3 * m_num_points);
    if (name == "offsets" || name == "types") require_size(array, values, m_num_cells);
    return values;
  }
  m_cursor.fail_at(0, "<" + section + "> has no array" + (name.empty() ? "" : " \"" + name + "\""),
                   "write the file again");
}

VtkGrid VtuReader::read() {
  read_tags();
  VtkGrid grid;
  grid.points = decode_named("Points", "");
  grid.connectivity = decode_named("Cells", "connectivity");
  grid.ends = decode_named("Cells", "offsets");
  grid.types = decode_named("Cells", "types");
  for (const DataArray& array : m_arrays) {
    const std::string type = array.tag.attribute("type");
    if (array.section != "CellData" || array.components != 1 || type == "String" || type == "Bit") continue;
    grid.cell_arrays.push_back({array.name, decode(array)});
    require_size(array, grid.cell_arrays.back().values, m_num_cells);
  }
  return grid;
}

}  // namespace

mesh::TetMesh read_vtu(const std::string& file, double scale) {
  VtuReader reader(file);
  const VtkGrid grid = reader.read();
  return make_tet_mesh(grid, reader.cursor(), scale);
}

}  // namespace argil::mesh_files
