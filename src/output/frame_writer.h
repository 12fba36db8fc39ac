#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "hdf5/file.h"
#include "output/frame_precision.h"
#include "sim/record.h"

namespace argil::output {

/// Writes the frames of a run. An array that equals the last frame's is not stored again: both frames have
/// one dataset, under two names.
class FrameWriter {
 public:
  /// `frames`: the group, which has `num_frames` of them.
  FrameWriter(hdf5::Group frames, std::uint64_t num_frames, FramePrecision precision);
  /// `epoch`: of its cells, 0 for those of the start.
  void write(const sim::Frame& frame, int epoch);
  FramePrecision precision() const { return m_precision; }

 private:
  struct Last {
    std::string path;  // where it was stored first
    hdf5::Shape shape;
    std::vector<double> values;
  };
  /// Bits that are kept of the largest value; 0: all.
  struct Kept {
    int picture, single;
  };
  template <class Array>
  void put(const hdf5::Group& group, const char* name, const Array& array, const hdf5::Shape& shape,
           const Kept& kept, const hdf5::Label& label);

  hdf5::Group m_frames;
  std::uint64_t m_num_frames;
  FramePrecision m_precision;
  std::map<std::string, Last> m_last;  // as stored, by the name in the frame
};

/// Rounds to multiples of the power of two that leaves the largest value `bits` bits (single precision has
/// 24); zeros lose their sign. Where a value is not finite, or the largest is beyond 1e290 or below 1e-290,
/// nothing changes.
void round_to_bits(std::vector<double>& values, int bits);

}  // namespace argil::output
