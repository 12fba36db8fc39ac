#include "base/error.h"

namespace argil {
namespace {

std::string join(std::string_view file, std::string_view place, std::string_view problem,
                 std::string_view remedy) {
  std::string text(file);
  if (!place.empty()) text.append(text.empty() ? "" : ": ").append(place);
  text.append(text.empty() ? "" : ": ").append(problem);
  if (!remedy.empty()) text.append("; ").append(remedy);
  return text;
}

}  // namespace

InputError::InputError(std::string_view file, std::string_view place, std::string_view problem,
                       std::string_view remedy)
    : std::runtime_error(join(file, place, problem, remedy)) {}

IoError::IoError(std::string_view file, std::string_view problem)
    : std::runtime_error(join(file, "", problem, "")) {}

}  // namespace argil
