#pragma once

// Recordings as texts, for the tests of their reader.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "base/error.h"
#include "device/trace.h"
#include "support/temp_folder.h"

namespace argil::device::test {

inline Trace read(const std::string& text, const TraceOptions& options = {}) {
  const argil::test::TempFolder folder;
  return read_trace(folder.write("trace.csv", text), options);
}

inline void expect_refused(const std::string& text, const std::string& place, const std::string& problem,
                           const TraceOptions& options = {}) {
  ARGIL_EXPECT_THROW_WITH(read(text, options), InputError, "trace.csv: " + place);
  ARGIL_EXPECT_THROW_WITH(read(text, options), InputError, problem);
}

inline bool has_note(const Trace& trace, const std::string& part) {
  return std::any_of(trace.notes.begin(), trace.notes.end(),
                     [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

}  // namespace argil::device::test
