#pragma once

#include <string>

namespace argil::output {

/// Text that may stand in XML, also between double quotes.
std::string escape_xml(const std::string& text);

/// Writes a whole file. Throws IoError with the system's reason.
void write_file(const std::string& file, const std::string& content);

}  // namespace argil::output
