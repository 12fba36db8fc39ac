#pragma once

#include <string>

namespace argil::scenario {

/// What a run with this resolved scenario left out or made simpler than it is ("simplified"), and where it
/// took the exact way instead ("in full"), for a person: a line each, its name in the first twelve columns.
/// `resolved` is what print_resolved or print_portable gave, perhaps by an older argil: what it does not say
/// is named as such. Throws InputError with `file` when it is not JSON.
std::string describe_model(const std::string& resolved, const std::string& file);

}  // namespace argil::scenario
