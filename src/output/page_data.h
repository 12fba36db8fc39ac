#pragma once

#include <string>
#include <vector>

#include "output/surface_frames.h"

namespace argil::output {

/// Where one array lies in the block of numbers of a page. Little-endian, aligned to 4 bytes.
struct PageSection {
  std::string name;
  std::string type;  ///< float32, uint32, uint16 or uint8
  std::size_t offset = 0;
  std::size_t length = 0;  ///< numbers, not bytes
};

/// The numbers of a page: arrays one after the other.
class PageBlock {
 public:
  void add(const std::string& name, const std::vector<float>& values) { append(name, "float32", values); }
  void add(const std::string& name, const std::vector<std::uint32_t>& v) { append(name, "uint32", v); }
  void add(const std::string& name, const std::vector<std::uint16_t>& v) { append(name, "uint16", v); }
  void add(const std::string& name, const std::vector<std::uint8_t>& values) {
    append(name, "uint8", values);
  }
  const std::vector<PageSection>& sections() const { return m_sections; }
  const std::string& bytes() const { return m_bytes; }

 private:
  template <class T>
  void append(const std::string& name, const char* type, const std::vector<T>& values);

  std::vector<PageSection> m_sections;
  std::string m_bytes;
};

/// A field that a page can colour the body by; on the page a byte a vertex and frame, 255 = `top`.
struct PageField {
  std::string name, title, unit, ramp;
  double top = 1.0;
};

/// The moving surface, rounded: positions to a grid of 65 535 steps over the longest side of all that is
/// shown.
struct PageSurface {
  std::vector<FrameInfo> frames;  ///< that are shown
  Vec3 low = Vec3::Zero();        ///< [m] corner of the grid
  Vec3 high = Vec3::Zero();       ///< [m]
  double step = 0.0;              ///< [m] of the grid
  std::vector<PageField> fields;
};

/// Bytes that one frame takes before compression.
std::size_t page_frame_bytes(const SurfaceFrames& surface);

/// At most `limit` (≥ 2) of the frames at equal distances, with the first, the last, and the one nearest to
/// `tick`.
std::vector<FrameInfo> choose_frames(const std::vector<FrameInfo>& all, std::size_t limit, Tick tick);

/// Adds triangles, the rest positions, and positions and fields of `frames` to the block, each frame but the
/// first as what changed since the one before, modulo the range of the numbers.
PageSurface add_surface(PageBlock& block, const SurfaceFrames& surface, const std::vector<FrameInfo>& frames);

/// Adds tool_vertices [m, in the tool's frame] and tool_triangles.
void add_tool(PageBlock& block, const mesh::TriangleMesh& tool);

/// Adds the force: force_time [s], force_low and force_high [N], force_mode. At most 4000 points, each the
/// range of as many ticks; returns how many ticks a point stands for. Where its error was estimated also
/// error_low and error_high [N], between which the force should be.
std::size_t add_force(PageBlock& block, const std::vector<sim::HapticRecord>& records);

/// Adds tool_path [m]: the hand's point at the same ticks and at the last one, x y z each.
void add_path(PageBlock& block, const std::vector<sim::HapticRecord>& records);

}  // namespace argil::output
