#include "output/pack.h"

#include <algorithm>
#include <cstdio>
#include <utility>
#include <vector>

#include "base/error.h"
#include "hdf5/file.h"
#include "output/schema.h"

namespace argil::output {

using hdf5::Dataset;
using hdf5::File;
using hdf5::Group;
using hdf5::Shape;

namespace {

constexpr std::uint64_t kMostRows = 16;                        // of a chunk; to read one inflates all
constexpr std::uint64_t kMostBytes = std::uint64_t{64} << 20;  // that are held at once

void copy_attributes(const Group& from, Group& to) {
  for (const std::string& name : from.attribute_names()) switch (from.attribute_element(name)) {
      case hdf5::Element::text:
        to.write_attribute(name, from.read_text(name));
        break;
      case hdf5::Element::real64:
        to.write_attribute(name, from.read_real(name));
        break;
      default:
        to.write_attribute(name, from.read_integer(name));
    }
}

/// One array of the frames, from a file to another.
class ArrayOfFrames {
 public:
  ArrayOfFrames(const Group& from, const Group& to, const Group& packed, std::string name)
      : m_from(from), m_to(to), m_packed(packed), m_name(std::move(name)) {}

  void copy(const std::vector<std::string>& frames) {
    std::pair<std::uint64_t, std::uint64_t> last;
    for (const std::string& frame : frames) {
      const Group group = m_from.open_group(frame);
      if (!group.has(m_name)) continue;
      const Dataset array = group.open_dataset(m_name);
      if (!m_rows.empty() && array.find_identity() == last) {
        m_rows.back().repeats.push_back(frame);
        continue;
      }
      last = array.find_identity();
      const Shape shape = array.shape();
      if (shape != m_shape) write_rows();
      m_shape = shape;
      m_rows.push_back({frame, {}});
    }
    write_rows();
  }

 private:
  struct Row {
    std::string frame;                 ///< the first that has it
    std::vector<std::string> repeats;  ///< those after it
  };

  /// Distinct arrays of one shape, frame after frame.
  void write_rows() {
    if (m_rows.size() > 1 && Group::is_compressed<double>(m_shape))
      pack_rows();
    else
      for (const Row& row : m_rows)
        m_to.open_group(row.frame).copy_from(m_from.open_group(row.frame), m_name);
    for (const Row& row : m_rows)
      for (const std::string& frame : row.repeats)
        m_to.open_group(frame).link_dataset(m_name, m_to.open_group(row.frame).path() + "/" + m_name);
    m_rows.clear();
  }

  void pack_rows() {
    const Dataset first = m_from.open_group(m_rows[0].frame).open_dataset(m_name);
    const std::string units = first.read_text("units");
    const std::string about = first.read_text("about");
    const hdf5::Label label{units.c_str(), about.c_str()};
    const std::uint64_t count = hdf5::compute_count(m_shape);
    const std::uint64_t most = std::clamp<std::uint64_t>(kMostBytes / (count * sizeof(double)), 1, kMostRows);
    Dataset packed = m_packed.create_packed(m_name + "." + m_rows[0].frame, m_shape, most, label);
    std::vector<double> block;
    for (std::size_t i = 0; i < m_rows.size(); ++i) {
      const std::vector<double> row = m_from.open_group(m_rows[i].frame).open_dataset(m_name).read<double>();
      block.insert(block.end(), row.begin(), row.end());
      if (block.size() < most * count && i + 1 < m_rows.size()) continue;
      packed.append(block.data(), block.size() / count);
      block.clear();
    }
    for (std::size_t i = 0; i < m_rows.size(); ++i)
      m_to.open_group(m_rows[i].frame).create_view(m_name, packed, i, label);
  }

  const Group& m_from;
  const Group& m_to;
  const Group& m_packed;
  std::string m_name;
  Shape m_shape;
  std::vector<Row> m_rows;
};

void pack_frames(const Group& from, const Group& to, const Group& packed) {
  const std::vector<std::string> frames = from.names();
  std::vector<std::string> names;
  for (const std::string& frame : frames) {
    const Group group = from.open_group(frame);
    Group made = to.create_group(frame);
    copy_attributes(group, made);
    for (const std::string& name : group.names())
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  for (const std::string& name : names) ArrayOfFrames(from, to, packed, name).copy(frames);
}

void write_packed(const std::string& result_file, const std::string& copy) {
  const File old_file = File::open_for_reading(result_file);
  File file = File::create(copy);
  {
    const Group from = old_file.root();
    Group to = file.root();
    copy_attributes(from, to);
    for (const std::string& name : from.names())
      if (name != "frames") to.copy_from(from, name);
    pack_frames(from.open_group("frames"), to.create_group("frames"), to.create_group(schema::kPacked));
  }
  file.sync();
  file.close();
}

}  // namespace

void pack(const std::string& result_file) {
  const std::string copy = result_file + ".packing";
  try {
    write_packed(result_file, copy);
  } catch (const IoError&) {
    std::remove((copy + ".part").c_str());
    std::remove(copy.c_str());
    throw;
  }
  if (std::rename(copy.c_str(), result_file.c_str()) != 0) {
    std::remove(copy.c_str());
    throw IoError(result_file, "cannot be replaced by its packed copy");
  }
}

void try_to_pack(const std::string& result_file) noexcept {
  try {
    pack(result_file);
  } catch (const std::exception&) {  // what the run was for is whole
  }
}

}  // namespace argil::output
