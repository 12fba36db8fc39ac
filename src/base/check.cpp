#include "base/check.h"

#include <cstdio>
#include <cstdlib>

namespace argil::detail {

void assertion_failed(const char* expression, const char* file, int line, const std::string& values) {
  std::fprintf(stderr, "argil: internal error: %s:%d: %s is false;%s\n", file, line, expression,
               values.c_str());
  std::abort();
}

}  // namespace argil::detail
