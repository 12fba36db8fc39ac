#include "run/files.h"

#include <filesystem>

#include "base/error.h"
#include "base/hash.h"
#include "base/read_file.h"

namespace argil::run {
namespace {

bool has_ending(const std::string& file, const char* ending) {
  return std::filesystem::path(file).extension() == ending;
}

std::string name_with_ending(const std::string& file, const char* ending) {
  return std::filesystem::path(file).replace_extension(ending).filename().string();
}

}  // namespace

void require_input_file(const std::string& file, const std::string& place) {
  std::error_code error;
  if (!std::filesystem::exists(file, error))
    throw InputError(file, place, "does not exist", "check the path");
  if (std::filesystem::is_directory(file, error))
    throw InputError(file, place, "is a folder", "name a file in it");
  if (std::filesystem::is_character_file(file, error))  // may never end
    throw InputError(file, place, "is a device", "name a file");
}

void require_other_file(const std::string& output, const std::string& input, const std::string& what,
                        const std::string& option) {
  std::error_code missing;  // a file that is not there is no input
  if (std::filesystem::equivalent(output, input, missing))
    throw InputError(output, "", "is " + what + " and would be overwritten",
                     "give another name to " + option);
}

void require_no_input(const scenario::Scenario& s, const std::string& output, const std::string& option) {
  for (const scenario::InputFile& input : scenario::list_input_files(s))
    require_other_file(
        output, input.file,
        input.pointer.empty() ? "the scenario" : "a file that the run reads (" + input.pointer + ")", option);
}

void check_patch_name(const scenario::Scenario& s, const std::vector<std::string>& patches,
                      const std::string& output) {
  if (output.empty()) return;
  require_no_input(s, output);
  for (const std::string& patch : patches) require_other_file(output, patch, "the patch that is read");
}

std::string hash_file(const std::string& file) {
  return Sha256().add(read_file(file)).hex_digest();
}

std::string name_xdmf(const std::string& result) {
  return std::filesystem::path(result).replace_extension(".xdmf").string();
}

void check_result_name(const scenario::Scenario& s, const std::string& result, const std::string& option) {
  if (has_ending(result, ".xdmf"))
    throw InputError(result, "", "is the name of the XDMF that is written beside a result",
                     "give " + option + " a name such as " + name_with_ending(result, ".h5"));
  require_no_input(s, result, option);
  require_no_input(s, name_xdmf(result), option);
  for (const char* ending : {".csv", ".txt", ".json", ".npy", ".npz", ".vtu", ".pvd", ".vtk", ".html", ".msh",
                             ".obj", ".stl", ".ply"})
    if (has_ending(result, ending))
      throw InputError(result, "", std::string("ends in ") + ending + ", and a result is written as HDF5",
                       "give " + option + " a name such as " + name_with_ending(result, ".h5") +
                           "; argil export makes pages and VTK files of it");
}

void check_cage_name(const std::string& surface, const std::string& cage) {
  require_other_file(cage, surface, "the surface");
  if (!has_ending(cage, ".msh"))
    throw InputError(cage, "", "does not end in .msh, and a cage is written as Gmsh",
                     "give -o a name such as " + name_with_ending(cage, ".msh"));
}

}  // namespace argil::run
