#pragma once

// Checks for our own mistakes. A user's mistake is an InputError, a failed run is a StepStatus.

#include <sstream>
#include <string>

namespace argil::detail {

[[noreturn]] void assertion_failed(const char* expression, const char* file, int line,
                                   const std::string& values);

template <class... Values>
std::string print_values(const Values&... values) {
  std::ostringstream text;
  text.precision(17);
  ((text << ' ' << values), ...);
  return text.str();
}

}  // namespace argil::detail

/// Aborts with the expression and the given values when `condition` is not true. Armed in every build.
#define ARGIL_ASSERT(condition, ...)                                                 \
  do {                                                                               \
    if (!(condition)) [[unlikely]]                                                   \
      ::argil::detail::assertion_failed(#condition, __FILE__, __LINE__,              \
                                        ::argil::detail::print_values(__VA_ARGS__)); \
  } while (false)

/// The same for checks whose cost grows with the mesh; armed in debug builds only.
#ifdef NDEBUG
#define ARGIL_DCHECK(condition, ...) static_cast<void>(0)
#else
#define ARGIL_DCHECK(condition, ...) ARGIL_ASSERT(condition, __VA_ARGS__)
#endif
