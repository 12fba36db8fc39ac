#pragma once

#include <string>

namespace argil::scenario {

/// What a run with this resolved scenario left out or made simpler than it is ("simplified"), and where it
/// took the exact way instead ("in full"), for a person: a line each, its name in the first twelve columns.
/// `resolved` is what print_resolved or print_portable gave, perhaps by an older argil: what it does not say
/// is named as such. `is_session`: a device moved the tool, beside a physics that kept its own time. Throws
/// InputError with `file` when it is not JSON.
std::string describe_model(const std::string& resolved, const std::string& file, bool is_session = false);

}  // namespace argil::scenario
