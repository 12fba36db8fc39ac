#pragma once

#include <string>
#include <vector>

#include "scenario/scenario.h"

namespace argil::scenario {

// A patch is a JSON object that holds some keys of a scenario alone, to be merged into it (RFC 7396).

/// Settings as a patch.
std::string print_patch(const std::vector<Setting>& settings);
/// The same with settings of the user's over it; those that it has no place for are refused, with the file
/// that it is to become. Throws InputError.
std::string print_patch(const std::vector<Setting>& settings, const std::vector<Setting>& over,
                        const std::string& file);

/// Pointers of what two JSON texts do not have in common, the first `most` of them and a word for the rest.
std::string describe_differences(const std::string& a, const std::string& b, int most);

/// A text as JSON has it, so that a setting of it stays a text.
std::string quote(const std::string& text);

/// A patch as settings. Throws InputError for what is no object, and for null, which would take a key away.
std::vector<Setting> read_patch(const std::string& file);

}  // namespace argil::scenario
