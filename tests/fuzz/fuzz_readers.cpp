// A reader of hostile input under libFuzzer: any bytes must give a value, an InputError or an IoError; memory
// errors, undefined behaviour, leaks, hangs, failed assertions and requests for too much memory end the run.
// ARGIL_FUZZ_READER names the reader; where it reads several formats, the input's first byte chooses one.

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/read_file.h"
#include "contact/queries.h"
#include "device/haply_message.h"
#include "device/trace.h"
#include "hdf5_input.h"
#include "json_mutation.h"
#include "mesh_files/readers.h"
#include "scenario/scenario.h"
#include "scenario/study_file.h"
#include "scenario/sweep_file.h"
#include "scenario/tolerance_file.h"

namespace {

using namespace argil;

enum class Form { other, json, scenario };

struct Reader {
  std::vector<std::string> endings;  ///< of its files' names, by which it tells formats apart
  std::function<void(const std::string& file)> read;
  Form form = Form::other;
};

/// What is accepted is printed with all defaults, and that must be accepted again and print the same.
void read_scenario(const std::string& file) {
  const std::string resolved = print_resolved(scenario::load_scenario(file, {}));
  std::FILE* stream = std::fopen(file.c_str(), "wb");
  if (stream == nullptr || std::fputs(resolved.c_str(), stream) < 0 || std::fclose(stream) != 0) std::abort();
  if (print_resolved(scenario::load_scenario(file, {})) != resolved) std::abort();
}

/// A point that was read is written as a line that reads as the same point.
void read_points(const std::string& file) {
  for (const scenario::SweepPoint& point : scenario::load_points(file)) print_point(point);
}

/// A message that names a device leads to a command that is a message again, if not one with a state.
void read_haply(const std::string& file) {
  using namespace device::internal;
  const HaplyMessage message = read_haply_message(read_file(file), "");
  if (message.device_id.empty() != (message.problem.starts_with("no "))) std::abort();
  if (message.device_id.empty()) return;
  const HaplyMessage again =
      read_haply_message(print_haply_force(message.device_id, Vec3(1.0, -0.5, 0.0)), "");
  if (again.device_id != message.device_id || again.problem.empty()) std::abort();
}

/// As a scenario without keys reads it, and with all that keys of /trace can say.
void read_recording(const std::string& file) {
  device::TraceOptions options;
  options.time_unit = device::TimeUnit::ms;
  options.length_unit = device::LengthUnit::mm;
  options.angle_order = device::AngleOrder::XYZ;
  options.angle_unit = device::AngleUnit::deg;
  options.button_column = "button";
  options.button_mode = device::ButtonMode::pull;
  try {
    device::read_trace(file, options);
  } catch (const InputError&) {
  }
  try {
    device::TraceOptions named;
    named.columns = {"t", "x", "y", "-", "z"};
    device::read_trace(file, named);
  } catch (const InputError&) {
  }
  device::read_trace(file, {});
}

const std::map<std::string, Reader, std::less<>>& readers() {
  static const std::map<std::string, Reader, std::less<>> kReaders = {
      {"tets",
       {{".msh", ".mesh", ".node", ".vtk", ".vtu", ".veg"},
        [](const std::string& file) { mesh_files::read_tet_mesh(file); }}},
      {"surfaces",
       {{".obj", ".stl", ".ply", ".off"},
        [](const std::string& file) { mesh_files::read_triangle_mesh(file); }}},
      {"traces", {{".csv"}, read_recording}},
      {"hdf5", {{".h5"}, [](const std::string& file) { device::read_trace(file, {}); }}},
      {"messages", {{".json"}, read_haply, Form::json}},
      {"queries", {{".csv"}, [](const std::string& file) { contact::read_queries(file); }}},
      {"scenarios", {{".json"}, read_scenario, Form::scenario}},
      {"points", {{".jsonl"}, read_points}},
      {"sweeps", {{".json"}, [](const std::string& file) { scenario::load_sweep(file); }, Form::json}},
      {"studies",
       {{".chart", ".stability", ".tolerances"},
        [](const std::string& file) {
          if (file.ends_with("chart")) scenario::read_chart_study(file);
          if (file.ends_with("stability")) scenario::read_stability_study(file);
          if (file.ends_with("tolerances")) scenario::load_tolerances(file);
        },
        Form::json}},
  };
  return kReaders;
}

const Reader& chosen_reader() {
  const char* name = std::getenv("ARGIL_FUZZ_READER");
  const auto found = readers().find(name != nullptr ? name : "");
  if (found == readers().end()) {
    std::fputs("fuzz_readers: ARGIL_FUZZ_READER must name one of", stderr);
    for (const auto& [known, reader] : readers()) std::fprintf(stderr, " %s", known.c_str());
    std::fputs("\n", stderr);
    std::exit(2);
  }
  return found->second;
}

/// A file of this process in memory, by its name; kept open, because making one anew costs more than reading.
class MemoryFile {
 public:
  explicit MemoryFile(const std::string& ending)
      : m_name("/dev/shm/argil_fuzz_" + std::to_string(getpid()) + ending),
        m_descriptor(open(m_name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600)) {}
  ~MemoryFile() {
    close(m_descriptor);
    unlink(m_name.c_str());
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  const std::string& name() const { return m_name; }
  void put(std::string_view bytes) const {
    const bool ok = ftruncate(m_descriptor, 0) == 0 &&
                    pwrite(m_descriptor, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size());
    if (!ok) std::abort();
  }

 private:
  std::string m_name;
  int m_descriptor;
};

const MemoryFile& file_of(const std::string& ending) {
  static std::map<std::string, MemoryFile> files;
  return files.try_emplace(ending, ending).first->second;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Reader& reader = chosen_reader();
  std::string_view input(reinterpret_cast<const char*>(data), size);
  std::size_t choice = 0;
  if (reader.endings.size() > 1) {
    if (input.empty()) return 0;
    choice = static_cast<std::uint8_t>(input.front()) % reader.endings.size();
    input.remove_prefix(1);
  }
  const std::string& ending = reader.endings[choice];
  if (ending == ".node") {  // two files, divided by a byte that neither has
    const std::size_t end = std::min(input.find('\x1e'), input.size());
    file_of(".ele").put(input.substr(std::min(end + 1, input.size())));
    input = input.substr(0, end);
  }
  if (ending == ".h5")
    write_hdf5(input, file_of(ending).name());
  else
    file_of(ending).put(input);
  try {
    reader.read(file_of(ending).name());
  } catch (const InputError&) {
  } catch (const IoError&) {
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

/// Half of the changes of JSON are such as keep it JSON.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
  static const nlohmann::json kAnything;
  static const nlohmann::json scenario_schema = nlohmann::json::parse(scenario::print_schema());
  const Reader& reader = chosen_reader();
  const std::size_t begin = reader.endings.size() > 1 ? 1 : 0;  // after the byte that chooses the format
  if (reader.form != Form::other && seed % 2 == 0 && size > begin) {
    const std::string text(reinterpret_cast<const char*>(data) + begin, size - begin);
    const nlohmann::json& schema = reader.form == Form::scenario ? scenario_schema : kAnything;
    const auto changed = change_json(text, schema, seed / 2);
    if (changed && begin + changed->size() <= max_size) {
      std::copy(changed->begin(), changed->end(), data + begin);
      return begin + changed->size();
    }
  }
  return LLVMFuzzerMutate(data, size, max_size);
}
