#include "run/export.h"

#include <cstdio>
#include <filesystem>

#include "base/error.h"
#include "output/html_page.h"
#include "output/vtu.h"
#include "run/files.h"
#include "run/run.h"

namespace argil::run {
namespace {

namespace fs = std::filesystem;

/// The page without data: share/argil/viewer.html beside the folder of this program.
std::string find_viewer() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path viewer = program.parent_path().parent_path() / "share/argil/viewer.html";
  if (!fs::exists(viewer, error))
    throw InputError(viewer.string(), "", "is not there: the viewer was not built",
                     "build it with node and npm (scripts/build_viewer), or look at the .xdmf with ParaView");
  return viewer.string();
}

void export_page(const ExportOptions& options) {
  require_other_file(options.html, options.result, "the result", "--html");
  const auto notes =
      output::write_html(options.result, options.html, {find_viewer(), options.megabytes, options.cage});
  std::printf("%s: %.1f MB\n", options.html.c_str(), static_cast<double>(fs::file_size(options.html)) / 1e6);
  for (const std::string& note : notes) std::printf("  %s\n", note.c_str());
}

void export_series(const ExportOptions& options) {
  const std::size_t count = output::write_vtu_series(options.result, options.vtu);
  std::printf("%s: %zu frames\n", options.vtu.c_str(), count);
}

}  // namespace

int export_result(const ExportOptions& options) {
  require_input_file(options.result);
  if (!options.html.empty()) export_page(options);
  if (!options.vtu.empty()) export_series(options);
  return ExitCode::kDone;
}

}  // namespace argil::run
