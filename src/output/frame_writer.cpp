#include "output/frame_writer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "output/array_shape.h"
#include "output/schema.h"

namespace argil::output {

using hdf5::Group;
using hdf5::Shape;

namespace {

bool has_equal_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  });
}

}  // namespace

void round_to_bits(std::vector<double>& values, int bits) {
  constexpr double kLeast = 1e-290;  // below it the step would not be a normal number,
  constexpr double kMost = 1e290;    // above it a sum of steps might not be one
  double largest = 0.0;
  for (const double value : values) {
    if (!std::isfinite(value)) return;
    largest = std::max(largest, std::abs(value));
  }
  if (largest < kLeast || largest > kMost) return;
  int exponent = 0;
  std::frexp(largest, &exponent);  // largest < 2^exponent
  const double step = std::ldexp(1.0, exponent - bits);
  const double steps = std::ldexp(1.0, bits - exponent);
  for (double& value : values) value = std::nearbyint(value * steps) * step + 0.0;
}

FrameWriter::FrameWriter(Group frames, std::uint64_t num_frames, FramePrecision precision)
    : m_frames(std::move(frames)), m_num_frames(num_frames), m_precision(precision) {
  if (num_frames == 0) return;
  const Group last = m_frames.open_group(schema::name_number(num_frames - 1));
  for (const std::string& name : last.names()) {
    const hdf5::Dataset dataset = last.open_dataset(name);
    m_last.emplace(name, Last{dataset.path(), dataset.shape(), dataset.read<double>()});
  }
}

template <class Array>
void FrameWriter::put(const Group& group, const char* name, const Array& array, const Shape& shape,
                      const Kept& kept, const hdf5::Label& label) {
  std::vector<double> values(array.data(), array.data() + array.size());
  const int bits = m_precision == FramePrecision::picture  ? kept.picture
                   : m_precision == FramePrecision::single ? kept.single
                                                           : 0;
  if (bits > 0 && Group::is_compressed<double>(shape)) round_to_bits(values, bits);
  const auto last = m_last.find(name);
  if (last != m_last.end() && !values.empty() && last->second.shape == shape &&
      has_equal_bits(last->second.values, values))
    return group.link_dataset(name, last->second.path);
  group.write_array(name, values.data(), shape, true, label);
  m_last.insert_or_assign(name, Last{group.path() + "/" + name, shape, std::move(values)});
}

void FrameWriter::write(const sim::Frame& frame, int epoch) {
  Group group = m_frames.create_group(schema::name_number(m_num_frames));
  group.write_attribute("tick", frame.tick);
  group.write_attribute("time", frame.time);
  group.write_attribute("state_hash", frame.state_hash);
  if (epoch > 0) group.write_attribute(schema::kEpoch, std::int64_t{epoch});
  // In Mandel's notation the Euclidean norm of the six numbers is the tensor's Frobenius norm.
  const Field plastic_norm = frame.plastic_strain.colwise().norm();
  constexpr int kSingle = 24;
  constexpr Kept kCage{22, 0}, kSkin{16, kSingle}, kField{12, kSingle};  // README.md: what that comes to
  const auto put_field = [&](const char* name, const Field& field, const hdf5::Label& label) {
    put(group, name, field, field_shape(field), kField, label);
  };
  put(group, "position", frame.position, entity_shape(frame.position), kCage, schema::kPosition);
  put_field("saturation", frame.saturation, schema::kSaturation);
  put(group, "plastic_strain", frame.plastic_strain, entity_shape(frame.plastic_strain), kField,
      schema::kPlasticStrain);
  put_field("plastic_strain_norm", plastic_norm, schema::kPlasticNorm);
  put(group, "skin_position", frame.skin_position, entity_shape(frame.skin_position), kSkin,
      schema::kSkinPosition);
  put_field("skin_saturation", frame.skin_saturation, schema::kSkinSaturation);
  put_field("skin_influence", frame.skin_influence, schema::kSkinInfluence);
  ++m_num_frames;
}

}  // namespace argil::output
