#include "output/page_data.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace argil::output {
namespace {

constexpr double kGridSteps = 65535.0;
constexpr std::size_t kForcePoints = 4000;

// Rounds to a whole number of [0, top].
template <class T>
T round_to(double value, double top) {
  return static_cast<T>(std::clamp(std::round(value), 0.0, top));
}

// Each row of `per_frame` numbers but the first becomes its difference to the row before.
template <class T>
void take_differences(std::vector<T>& values, std::size_t per_frame) {
  for (std::size_t i = values.size(); i-- > per_frame;)
    values[i] = static_cast<T>(values[i] - values[i - per_frame]);
}

std::vector<float> to_floats(const Eigen::Ref<const Points>& points) {
  std::vector<float> values(static_cast<std::size_t>(points.size()));
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    for (int k = 0; k < 3; ++k)
      values[static_cast<std::size_t>(3 * i + k)] = static_cast<float>(points(k, i));
  return values;
}

std::vector<std::uint32_t> to_indices(const Triangles& triangles) {
  return {triangles.data(), triangles.data() + triangles.size()};
}

struct Extent {
  Vec3 low, high;  // [m] of all frames and of the body at rest
  double plastic_strain = 0.0;
  double influence = 0.0;
};

Extent measure(const SurfaceFrames& surface, const std::vector<FrameInfo>& frames) {
  Extent extent;
  extent.low = surface.rest_position().rowwise().minCoeff();
  extent.high = surface.rest_position().rowwise().maxCoeff();
  for (const FrameInfo& info : frames) {
    const SurfaceFrames::Shot shot = surface.read(info);
    extent.low = extent.low.cwiseMin(shot.position.rowwise().minCoeff());
    extent.high = extent.high.cwiseMax(shot.position.rowwise().maxCoeff());
    extent.plastic_strain = std::max(extent.plastic_strain, shot.plastic_strain.maxCoeff());
    if (shot.influence.size() > 0) extent.influence = std::max(extent.influence, shot.influence.maxCoeff());
  }
  return extent;
}

void append_rounded(std::vector<std::uint16_t>& numbers, const Points& position, const PageSurface& page) {
  for (Eigen::Index i = 0; i < position.cols(); ++i)
    for (int k = 0; k < 3; ++k)
      numbers.push_back(round_to<std::uint16_t>((position(k, i) - page.low(k)) / page.step, kGridSteps));
}

const Field& find_field(const SurfaceFrames::Shot& shot, const std::string& name) {
  return name == "saturation" ? shot.saturation : name == "influence" ? shot.influence : shot.plastic_strain;
}

}  // namespace

template <class T>
void PageBlock::append(const std::string& name, const char* type, const std::vector<T>& values) {
  static_assert(std::endian::native == std::endian::little);
  constexpr std::size_t kAlignment = 4;
  m_sections.push_back({name, type, m_bytes.size(), values.size()});
  const std::size_t size = values.size() * sizeof(T);
  m_bytes.append(reinterpret_cast<const char*>(values.data()), size);
  m_bytes.append((kAlignment - size % kAlignment) % kAlignment, '\0');
}

std::size_t page_frame_bytes(const SurfaceFrames& surface) {
  constexpr std::size_t kMostFields = 3;
  return static_cast<std::size_t>(surface.num_vertices()) * (3 * sizeof(std::uint16_t) + kMostFields);
}

std::vector<FrameInfo> choose_frames(const std::vector<FrameInfo>& all, std::size_t limit, Tick tick) {
  if (all.size() <= limit) return all;
  const auto distance = [tick](const FrameInfo& frame) { return std::abs(frame.tick - tick); };
  const auto nearest = static_cast<std::size_t>(
      std::min_element(all.begin(), all.end(),
                       [&](const auto& a, const auto& b) { return distance(a) < distance(b); }) -
      all.begin());
  std::vector<FrameInfo> chosen;
  for (std::size_t i = 0; i < limit; ++i) chosen.push_back(all[i * (all.size() - 1) / (limit - 1)]);
  if (nearest > 0 && nearest + 1 < all.size() && limit > 2) {
    // The one of those between first and last that lies nearest makes room.
    const auto replaced =
        std::min_element(chosen.begin() + 1, chosen.end() - 1, [&](const auto& a, const auto& b) {
          return std::abs(a.tick - all[nearest].tick) < std::abs(b.tick - all[nearest].tick);
        });
    *replaced = all[nearest];
  }
  return chosen;
}

PageSurface add_surface(PageBlock& block, const SurfaceFrames& surface,
                        const std::vector<FrameInfo>& frames) {
  const Extent extent = measure(surface, frames);
  PageSurface page{frames, extent.low, extent.high, (extent.high - extent.low).maxCoeff() / kGridSteps, {}};
  page.fields.push_back({"saturation", "saturation S", "–", "wet", 1.0});
  if (extent.plastic_strain > 0.0)
    page.fields.push_back({"plastic_strain", "plastic strain ‖εₚ‖", "–", "strained", extent.plastic_strain});
  if (extent.influence > 0.0)
    page.fields.push_back({"influence", "region of influence", "–", "strained", 1.0});

  std::vector<std::uint16_t> position, rest;
  append_rounded(rest, surface.rest_position(), page);
  std::vector<std::vector<std::uint8_t>> fields(page.fields.size());
  for (const FrameInfo& info : frames) {
    const SurfaceFrames::Shot shot = surface.read(info);
    append_rounded(position, shot.position, page);
    for (std::size_t f = 0; f < fields.size(); ++f)
      for (const double value : find_field(shot, page.fields[f].name))
        fields[f].push_back(round_to<std::uint8_t>(value / page.fields[f].top * 255.0, 255.0));
  }
  const auto num_vertices = static_cast<std::size_t>(surface.num_vertices());
  take_differences(position, 3 * num_vertices);
  block.add("triangles", to_indices(surface.triangles()));
  block.add("rest", rest);
  block.add("position", position);
  for (std::size_t f = 0; f < fields.size(); ++f) {
    take_differences(fields[f], num_vertices);
    block.add(page.fields[f].name, fields[f]);
  }
  return page;
}

namespace {

std::size_t find_stride(const std::vector<sim::HapticRecord>& records) {
  return std::max<std::size_t>(1, (records.size() + kForcePoints - 1) / kForcePoints);
}

}  // namespace

void add_path(PageBlock& block, const std::vector<sim::HapticRecord>& records) {
  const std::size_t stride = find_stride(records);
  std::vector<float> path;
  const auto add = [&](const sim::HapticRecord& record) {
    for (int k = 0; k < 3; ++k) path.push_back(static_cast<float>(record.tool_position(k)));
  };
  for (std::size_t i = 0; i < records.size(); i += stride) add(records[i]);
  if (!records.empty() && (records.size() - 1) % stride != 0) add(records.back());
  block.add("tool_path", path);
}

std::size_t add_force(PageBlock& block, const std::vector<sim::HapticRecord>& records) {
  const std::size_t stride = find_stride(records);
  std::vector<float> time, low, high, error_low, error_high;
  std::vector<std::uint8_t> mode;
  bool is_estimated = false;
  for (std::size_t begin = 0; begin < records.size(); begin += stride) {
    double least = records[begin].force.stableNorm(), most = least;
    for (std::size_t i = begin; i < std::min(begin + stride, records.size()); ++i) {
      least = std::min(least, records[i].force.stableNorm());
      most = std::max(most, records[i].force.stableNorm());
    }
    double below = least, above = most;
    for (std::size_t i = begin; i < std::min(begin + stride, records.size()); ++i) {
      const double force = records[i].force.stableNorm();
      const sim::ForceErrorParts& parts = records[i].error;
      below = std::min(below, force - parts.most_above());
      above = std::max(above, force + parts.most_below());
      is_estimated = is_estimated || parts.total() > 0.0;
    }
    error_low.push_back(static_cast<float>(std::max(0.0, below)));
    error_high.push_back(static_cast<float>(above));
    time.push_back(static_cast<float>(records[begin].time));
    low.push_back(static_cast<float>(least));
    high.push_back(static_cast<float>(most));
    mode.push_back(static_cast<std::uint8_t>(records[begin].mode));
  }
  block.add("force_time", time);
  block.add("force_low", low);
  block.add("force_high", high);
  block.add("force_mode", mode);
  if (!is_estimated) return stride;
  block.add("error_low", error_low);
  block.add("error_high", error_high);
  return stride;
}

void add_tool(PageBlock& block, const mesh::TriangleMesh& tool) {
  block.add("tool_vertices", to_floats(tool.vertices));
  block.add("tool_triangles", to_indices(tool.triangles));
}

}  // namespace argil::output
