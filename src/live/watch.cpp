#include "live/watch.h"

#include <array>

#include "hdf5/file.h"
#include "output/table.h"

namespace argil::live {
namespace {

using output::schema::Column;
using enum hdf5::Element;

constexpr std::array kTicks = {
    Column{"tick", int64, 1, {"1", "count of haptic periods since the start"}},
    Column{"time", real64, 1, {"s", "tick times haptic period"}},
    Column{"tool_position", real64, 3, {"m", "hand's point of the tool, world coordinates"}},
    Column{"force", real64, 3, {"N", "force on the hand before the output gate"}},
    Column{"device_force", real64, 3, {"N", "force as the device renders it"}},
    Column{"mode", uint8, 1, {"1", "what the tool does: 0 push, 1 pull, 2 wet, 3 dry"}},
};
constexpr std::array kFrameTicks = {
    Column{"tick", int64, 1, {"1", "haptic tick whose contacts the picture shows the effect of"}},
};
constexpr std::uint64_t kTickChunk = 256;
constexpr std::uint64_t kFrameChunk = 16;
constexpr hdf5::Label kTriangles{"1", "triangles of the drawn surface, outward"};
constexpr hdf5::Label kPosition{"m", "vertices of the drawn surface, a picture after the other"};
constexpr hdf5::Label kSaturation{"1", "water saturation, 0 to 1: at the skin's vertices, or of each tet"};

}  // namespace

struct Watch::Impl {
  hdf5::File file;
  output::Table ticks, frame_ticks;
  hdf5::Dataset position, saturation;
  bool has_skin = false;  // that is drawn; else the cage
};

Watch::Watch(const std::string& name, const sim::Simulation& simulation) {
  const sim::Body& body = simulation.body();
  const bool has_skin = body.skin.num_triangles() > 0;
  const Triangles& triangles = has_skin ? body.skin.triangles : body.topology.boundary;
  hdf5::File file = hdf5::File::create_shared(name);
  {
    hdf5::Group root = file.root();
    root.write_attribute("format", "argil-watch");
    root.write_array("triangles", triangles.data(), {static_cast<std::uint64_t>(triangles.cols()), 3}, false,
                     kTriangles);
    root.create_group("ticks");
    root.create_group("frames");
  }
  const auto points =
      static_cast<std::uint64_t>(has_skin ? body.skin.vertices.cols() : body.mesh.vertices.cols());
  const auto values = has_skin ? points : static_cast<std::uint64_t>(body.mesh.num_tets());
  const hdf5::Group frames = file.root().open_group("frames");
  output::Table ticks = output::Table::create(file.root().open_group("ticks"), kTicks, kTickChunk);
  output::Table frame_ticks = output::Table::create(frames, kFrameTicks, kFrameChunk);
  hdf5::Dataset position = frames.create_series("position", real64, {points, 3}, 1, kPosition);
  hdf5::Dataset saturation = frames.create_series("saturation", real64, {values}, 1, kSaturation);
  file.let_others_read();
  m_impl = std::make_unique<Impl>(Impl{std::move(file), std::move(ticks), std::move(frame_ticks),
                                       std::move(position), std::move(saturation), has_skin});
}

Watch::~Watch() = default;

void Watch::append(const HandTick& tick) {
  output::Table& table = m_impl->ticks;
  const sim::HapticRecord& record = tick.record;
  table.put(record.tick);
  table.put(record.time);
  table.put(record.tool_position.data(), 3);
  table.put(record.force.data(), 3);
  table.put(record.device_force.data(), 3);
  table.put(static_cast<std::uint8_t>(record.mode));
  if (table.end_row()) table.show();
}

void Watch::append(const sim::Frame& frame) {
  const bool has_skin = m_impl->has_skin;
  m_impl->ticks.show();  // first: those that led to the picture
  m_impl->position.append(has_skin ? frame.skin_position.data() : frame.position.data(), 1);
  m_impl->saturation.append(has_skin ? frame.skin_saturation.data() : frame.saturation.data(), 1);
  m_impl->position.flush();
  m_impl->saturation.flush();
  m_impl->frame_ticks.put(frame.tick);
  m_impl->frame_ticks.end_row();
  m_impl->frame_ticks.show();  // last: what it counts is there
}

}  // namespace argil::live
