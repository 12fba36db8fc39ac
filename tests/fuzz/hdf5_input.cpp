#include "hdf5_input.h"

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

namespace {

constexpr std::size_t kMaxRecords = 12;
constexpr std::size_t kMaxValues = 4096;  // that are written; arrays of more stay unwritten

/// Where a trace has something: datasets, then attributes after the object that has them.
struct Place {
  const char* object;
  const char* attribute;  // none: the object is a dataset
};
constexpr std::array<Place, 16> kPlaces = {{{"time", nullptr},
                                            {"position", nullptr},
                                            {"orientation", nullptr},
                                            {"mode", nullptr},
                                            {"haptic/time", nullptr},
                                            {"haptic/tool_position", nullptr},
                                            {"haptic/tool_orientation", nullptr},
                                            {"haptic/mode", nullptr},
                                            {"position", "units"},
                                            {"haptic/tool_position", "units"},
                                            {".", "device"},
                                            {".", "device_to_world_scale"},
                                            {".", "device_to_world_rotation_xyzw"},
                                            {".", "device_to_world_translation_m"},
                                            {"haptic", nullptr},
                                            {"other", nullptr}}};

class Bytes {
 public:
  explicit Bytes(std::string_view bytes) : m_bytes(bytes) {}
  bool is_at_end() const { return m_bytes.empty(); }
  std::size_t take() {
    if (is_at_end()) return 0;
    const auto byte = static_cast<std::uint8_t>(m_bytes.front());
    m_bytes.remove_prefix(1);
    return byte;
  }
  std::string_view take(std::size_t count) {
    const std::string_view taken = m_bytes.substr(0, count);
    m_bytes.remove_prefix(taken.size());
    return taken;
  }

 private:
  std::string_view m_bytes;
};

struct Record {
  Place place;
  std::size_t type = 0;
  std::size_t layout = 0;
  std::vector<hsize_t> lengths;
  std::string_view data;
};

Record take_record(Bytes& bytes) {
  Record record;
  record.place = kPlaces[bytes.take() % kPlaces.size()];
  record.type = bytes.take() % 8;
  record.layout = bytes.take() % 4;
  record.lengths.resize(bytes.take() % 4);
  for (hsize_t& length : record.lengths) {
    length = bytes.take();
    if (length >= 200) length = hsize_t{1} << (length - 200);
  }
  record.data = bytes.take(bytes.take());
  return record;
}

/// Type in the file. 0 and 1 are both doubles, of one byte of data each or of eight.
hid_t make_type(std::size_t number, std::size_t length) {
  const std::array<hid_t, 5> numbers = {H5T_IEEE_F64LE, H5T_IEEE_F64LE, H5T_IEEE_F32BE, H5T_STD_I64LE,
                                        H5T_STD_U8LE};
  if (number < numbers.size()) return H5Tcopy(numbers[number]);
  if (number == 7) return H5Tcreate(H5T_OPAQUE, 3);
  const hid_t text = H5Tcopy(H5T_C_S1);
  H5Tset_size(text, number == 5 ? std::max<std::size_t>(length, 1) : H5T_VARIABLE);
  return text;
}

/// `count` values for the memory types of write(): the data again and again.
std::vector<double> make_numbers(const Record& record, std::size_t count) {
  std::vector<double> values(count, 0.0);
  const std::size_t width = record.type == 1 ? 8 : 1;
  const std::size_t given = record.data.size() / width;
  for (std::size_t i = 0; i < count && given > 0; ++i) {
    const char* at = record.data.data() + (i % given) * width;
    if (width == 8)
      std::memcpy(&values[i], at, 8);
    else
      values[i] =
          0.0625 * static_cast<double>(static_cast<signed char>(*at)) + static_cast<double>(i / given);
  }
  return values;
}

/// Calls `write(memory type, buffer)` with values for `count` elements.
template <class Write>
void write_values(const Record& record, hid_t type, std::size_t count, Write write) {
  if (record.type < 5) {
    write(H5T_NATIVE_DOUBLE, static_cast<const void*>(make_numbers(record, count).data()));
  } else if (record.type == 6) {
    const std::string text(record.data);
    write(type, static_cast<const void*>(std::vector<const char*>(count, text.c_str()).data()));
  } else {
    std::string characters;
    while (characters.size() < count * H5Tget_size(type))
      characters += record.data.empty() ? std::string_view("x") : record.data;
    write(type, static_cast<const void*>(characters.data()));
  }
}

void write_dataset(hid_t file, const Record& record, hid_t type, hid_t space, std::size_t count) {
  const hid_t links = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(links, 1);
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  if (record.layout > 0 && !record.lengths.empty()) {
    std::vector<hsize_t> chunk = record.lengths;
    for (hsize_t& length : chunk) length = std::clamp<hsize_t>(length, 1, 16);
    H5Pset_chunk(creation, static_cast<int>(chunk.size()), chunk.data());
    if (record.layout == 2) H5Pset_deflate(creation, 1);
  }
  const hid_t made = H5Dcreate2(file, record.place.object, type, space, links, creation, H5P_DEFAULT);
  if (made >= 0 && count > 0)
    write_values(record, type, count, [&](hid_t memory, const void* values) {
      H5Dwrite(made, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    });
  if (made >= 0) H5Dclose(made);
  H5Pclose(creation);
  H5Pclose(links);
}

void write_attribute(hid_t file, const Record& record, hid_t type, hid_t space, std::size_t count) {
  const hid_t made = H5Acreate_by_name(file, record.place.object, record.place.attribute, type, space,
                                       H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  if (made < 0) return;
  if (count > 0)
    write_values(record, type, count,
                 [&](hid_t memory, const void* values) { H5Awrite(made, memory, values); });
  H5Aclose(made);
}

void write_record(hid_t file, const Record& record) {
  if (record.layout == 3 &&
      record.place.attribute == nullptr) {  // a name of something else, perhaps of itself
    const std::string target(record.data);
    if (record.type % 2 == 0)
      H5Lcreate_soft(target.c_str(), file, record.place.object, H5P_DEFAULT, H5P_DEFAULT);
    else
      H5Lcreate_hard(file, target.empty() ? "/" : target.c_str(), file, record.place.object, H5P_DEFAULT,
                     H5P_DEFAULT);
    return;
  }
  std::size_t count = 1;
  for (const hsize_t length : record.lengths) count = length > kMaxValues ? 0 : count * length;
  if (count > kMaxValues) count = 0;
  const hid_t type = make_type(record.type, record.data.size());
  const hid_t space = record.lengths.empty() ? H5Screate(record.layout == 1 ? H5S_NULL : H5S_SCALAR)
                                             : H5Screate_simple(static_cast<int>(record.lengths.size()),
                                                                record.lengths.data(), nullptr);
  if (record.place.attribute == nullptr)
    write_dataset(file, record, type, space, count);
  else if (count > 0)  // an attribute is stored whole
    write_attribute(file, record, type, space, count);
  if (space >= 0) H5Sclose(space);
  H5Tclose(type);
}

}  // namespace

void write_hdf5(std::string_view bytes, const std::string& name) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const hid_t file = H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  Bytes left(bytes);
  for (std::size_t i = 0; i < kMaxRecords && !left.is_at_end(); ++i) write_record(file, take_record(left));
  H5Fclose(file);
}
