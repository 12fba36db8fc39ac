// One reader of hostile input under libFuzzer: any bytes must give a value, an InputError or an IoError;
// memory errors, undefined behaviour, leaks, hangs, failed assertions and requests for too much memory end
// the run. ARGIL_FUZZ_READ names the reader, ARGIL_FUZZ_ENDINGS the file endings it goes by; the first byte
// of a surface or tet input chooses among them.

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "base/error.h"
#include "contact/queries.h"
#include "device/trace.h"
#include "mesh/readers.h"
#include "scenario/scenario.h"
#include "scenario/sweep_file.h"

namespace {

using namespace argil;

[[maybe_unused]] void read_tets(const std::string& file) {
  mesh::read_tet_mesh(file);
}
[[maybe_unused]] void read_surface(const std::string& file) {
  mesh::read_triangle_mesh(file);
}
[[maybe_unused]] void read_motion(const std::string& file) {
  device::read_trace(file, {});
}
[[maybe_unused]] void read_query_file(const std::string& file) {
  contact::read_queries(file);
}
[[maybe_unused]] void read_scenario(const std::string& file) {
  scenario::load_scenario(file, {});
}
[[maybe_unused]] void read_point_list(const std::string& file) {
  scenario::load_points(file);
}

/// Memory-backed file of this process.
std::string write_input(const std::string& ending, const std::uint8_t* data, std::size_t size) {
  const std::string name = "/dev/shm/argil_fuzz_" + std::to_string(getpid()) + ending;
  std::FILE* file = std::fopen(name.c_str(), "wb");
  if (file == nullptr || std::fwrite(data, 1, size, file) != size || std::fclose(file) != 0) std::abort();
  return name;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string kEndings[] = {ARGIL_FUZZ_ENDINGS};
  constexpr std::size_t kCount = sizeof kEndings / sizeof kEndings[0];
  std::size_t choice = 0;
  if (kCount > 1) {
    if (size == 0) return 0;
    choice = *data++ % kCount;
    --size;
  }
  const std::string name = write_input(kEndings[choice], data, size);
  try {
    ARGIL_FUZZ_READ(name);
  } catch (const InputError&) {
  } catch (const IoError&) {
  }
  std::remove(name.c_str());
  return 0;
}
