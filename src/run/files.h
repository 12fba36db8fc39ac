#pragma once

#include <string>
#include <vector>

#include "scenario/scenario.h"

namespace argil::run {

/// Refuses a file that is to be read but is not there, or is a folder. Throws InputError. (What cannot be
/// read for any other reason is an IoError of its reader.)
void require_input_file(const std::string& file, const std::string& place = "");

/// Refuses an output that is the file `input`, which is called `what` in the message; links count as what
/// they lead to. Throws InputError.
void require_other_file(const std::string& output, const std::string& input, const std::string& what,
                        const std::string& option = "-o");

/// Refuses an output that is a file which the scenario's run reads. Throws InputError.
void require_no_input(const scenario::Scenario& s, const std::string& output,
                      const std::string& option = "-o");

/// The same of a patch, which must not be one of the patches that are read either. Empty: it is printed.
void check_patch_name(const scenario::Scenario& s, const std::vector<std::string>& patches,
                      const std::string& output);

/// SHA-256 of a file's bytes.
std::string hash_file(const std::string& file);

/// The XDMF that is written beside a result.
std::string name_xdmf(const std::string& result);

/// Refuses a result name under which, or under whose XDMF's, a file lies that the run reads, and a name that
/// ends in .xdmf itself. Links count as what they lead to. `option` gave the name. Throws InputError.
void check_result_name(const scenario::Scenario& s, const std::string& result,
                       const std::string& option = "-o");

/// The same for the cage of a surface; its name must end in .msh. Throws InputError.
void check_cage_name(const std::string& surface, const std::string& cage);

}  // namespace argil::run
