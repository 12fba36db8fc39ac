#include "output/html_page.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <string_view>

#include "base/error.h"
#include "base/read_file.h"
#include "output/page_data.h"
#include "output/text.h"

namespace argil::output {
namespace {

constexpr const char* kPlace = "<!-- argil:data -->";  // in the viewer's page

// ---- Text that a browser reads ----------------------------------------------------------------------------

// A JSON string that may stand inside a <script> element.
std::string quote(std::string_view text) {
  std::ostringstream out;
  out << '"';
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out << '\\' << c;
    else if (c == '<' || static_cast<unsigned char>(c) < 0x20)
      out << "\\u00"
          << "0123"[c >> 4] << "0123456789abcdef"[c & 15];
    else
      out << c;
  }
  out << '"';
  return out.str();
}

// Numbers, one after the other in brackets. JSON knows no NaN: null.
template <class Vector>
std::string list(const Vector& values) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(9);
  const char* gap = "[";
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    out << gap;
    if (std::isfinite(values(i)))
      out << values(i);
    else
      out << "null";
    gap = ",";
  }
  out << ']';
  return out.str();
}

std::string number(double value) {
  const std::string bracketed = list(Eigen::Matrix<double, 1, 1>(value));
  return bracketed.substr(1, bracketed.size() - 2);
}

template <class Items, class Write>
std::string join(const Items& items, Write write) {
  std::string text = "[";
  for (const auto& item : items) text += (text.size() > 1 ? ",\n" : "\n") + write(item);
  return text + "]";
}

std::string to_base64(const std::string& bytes) {
  constexpr const char* kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(4 * (bytes.size() / 3 + 1));
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t rest = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (k < rest ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= rest ? kLetters[bits >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

std::string deflate_bytes(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string packed(size, '\0');
  const int status = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                               reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), 9);
  if (status != Z_OK) throw std::bad_alloc();  // the only way in which zlib fails here
  packed.resize(size);
  return packed;
}

// ---- What is said about the result
// --------------------------------------------------------------------------

const sim::HapticRecord* find_peak(const std::vector<sim::HapticRecord>& records) {
  const auto peak = std::max_element(records.begin(), records.end(), [](const auto& a, const auto& b) {
    return a.force.stableNorm() < b.force.stableNorm();
  });
  return peak == records.end() ? nullptr : &*peak;
}

std::string describe_frame(const FrameInfo& frame, const std::vector<sim::HapticRecord>& records,
                           bool has_tool) {
  sim::HapticRecord record;  // at rest where nothing was recorded
  const auto next = std::lower_bound(records.begin(), records.end(), frame.tick,
                                     [](const auto& r, Tick tick) { return r.tick < tick; });
  if (!records.empty()) record = next == records.end() ? records.back() : *next;
  return "{\"time_s\":" + number(frame.time) +
         ",\"has_tool\":" + (has_tool && !records.empty() ? "true" : "false") +
         ",\"mode\":" + quote(to_string(record.mode)) + ",\"force_N\":" + list(record.force) +
         ",\"tool_position_m\":" + list(record.tool_position) +
         ",\"tool_orientation\":" + list(record.tool_orientation.coeffs()) + "}";
}

std::string describe_field(const PageField& field) {
  return "{\"name\":" + quote(field.name) + ",\"title\":" + quote(field.title) +
         ",\"unit\":" + quote(field.unit) + ",\"ramp\":" + quote(field.ramp) +
         ",\"top\":" + number(field.top) + "}";
}

std::string describe_section(const PageSection& section) {
  return "{\"name\":" + quote(section.name) + ",\"type\":" + quote(section.type) +
         ",\"offset\":" + std::to_string(section.offset) + ",\"length\":" + std::to_string(section.length) +
         "}";
}

std::string summarise(const ResultReader& reader, const SurfaceFrames& surface) {
  std::string outcome;
  switch (reader.outcome()) {
    case Outcome::done:
      outcome = "run done";
      break;
    case Outcome::interrupted:
      outcome = "run interrupted";
      break;
    case Outcome::running:
      outcome = "run not finished";
      break;
    case Outcome::failed:
      outcome = "run failed";
      if (const auto failure = reader.read_failure()) outcome += ": " + to_string(*failure);
      break;
  }
  return outcome + " · " + (surface.is_skin() ? "skin" : "cage") + " of " +
         std::to_string(surface.triangles().cols()) + " triangles";
}

std::vector<std::string> list_notes(const SurfaceFrames& surface, const PageSurface& page, std::size_t stride,
                                    const PageOptions& options) {
  std::vector<std::string> notes;
  std::ostringstream out;
  out.precision(3);
  const auto take = [&] {
    notes.push_back(out.str());
    out.str("");
  };
  const std::size_t all = surface.frames().size();
  out << (page.frames.size() < all ? "Decimated in time: shows " : all == 1 ? "Shows its " : "Shows all ");
  if (page.frames.size() < all) out << page.frames.size() << " of ";
  out << all << (all == 1 ? " frame" : " frames");
  if (page.frames.size() < all)
    out << ", so that they take at most " << options.frame_megabytes << " MB (--megabytes)";
  take();
  out << "Positions are rounded to " << page.step * 1e6 << " µm, fields to 1/255 of their scale";
  take();
  if (stride > 1) {
    out << "Each point of the force plot is the range of " << stride << " ticks";
    take();
  }
  if (surface.is_skin()) {
    out << "Saturation and plastic strain of a skin vertex are those of the tet around it";
    take();
  }
  return notes;
}

std::string describe(const ResultReader& reader, const SurfaceFrames& surface, const PageSurface& page,
                     const std::vector<sim::HapticRecord>& records, const std::vector<std::string>& notes,
                     const PageBlock& block, bool has_tool) {
  const sim::HapticRecord* peak = find_peak(records);
  const double last_time = records.empty() ? page.frames.back().time : records.back().time;
  const Vec3 touched = peak != nullptr ? peak->tool_position : Vec3(0.5 * (page.low + page.high));
  std::string text = "{\"file\":" + quote(std::filesystem::path(reader.file()).filename().string());
  text += ",\n\"summary\":" + quote(summarise(reader, surface));
  text += ",\n\"notes\":" + join(notes, quote);
  text += ",\n\"num_vertices\":" + std::to_string(surface.num_vertices());
  text += ",\n\"duration_s\":" + number(last_time);
  text += ",\n\"peak_force_N\":" + number(peak != nullptr ? peak->force.stableNorm() : 0.0);
  text += ",\n\"touched\":" + list(touched);
  text += ",\n\"grid\":{\"low\":" + list(page.low) + ",\"high\":" + list(page.high) +
          ",\"step\":" + number(page.step) + "}";
  text += ",\n\"fields\":" + join(page.fields, describe_field);
  text += ",\n\"frames\":" +
          join(page.frames, [&](const FrameInfo& frame) { return describe_frame(frame, records, has_tool); });
  return text + ",\n\"sections\":" + join(block.sections(), describe_section) + "}";
}

}  // namespace

std::vector<std::string> write_html(const std::string& result_file, const std::string& html_file,
                                    const PageOptions& options) {
  std::string page = read_file(options.viewer);
  const std::size_t place = page.find(kPlace);
  if (place == std::string::npos)
    throw InputError(options.viewer, "", std::string("has no ") + kPlace, "run scripts/build_viewer again");

  const ResultReader reader(result_file);
  const SurfaceFrames surface(reader, options.wants_cage);
  const std::vector<sim::HapticRecord> records = reader.read_haptic();
  const sim::HapticRecord* peak = find_peak(records);
  constexpr double kMegabyte = 1e6;
  const auto limit = static_cast<std::size_t>(
      std::max(2.0, options.frame_megabytes * kMegabyte / static_cast<double>(page_frame_bytes(surface))));

  PageBlock block;
  const mesh::TriangleMesh tool = reader.read_header().tool;
  add_tool(block, tool);
  const std::size_t stride = add_force(block, records);
  add_path(block, records);
  const PageSurface shown =
      add_surface(block, surface, choose_frames(surface.frames(), limit, peak != nullptr ? peak->tick : 0));
  const std::vector<std::string> notes = list_notes(surface, shown, stride, options);
  const std::string about = describe(reader, surface, shown, records, notes, block, tool.num_triangles() > 0);
  page.replace(place, std::strlen(kPlace),
               "<script type=\"application/json\" id=\"argil-about\">" + about +
                   "</script>\n<script type=\"text/plain\" id=\"argil-data\">" +
                   to_base64(deflate_bytes(block.bytes())) + "</script>");
  write_file(html_file, page);
  return notes;
}

}  // namespace argil::output
