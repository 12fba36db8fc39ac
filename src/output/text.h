#pragma once

#include <functional>
#include <ostream>
#include <string>

namespace argil::output {

/// Text that may stand in XML, also between double quotes.
std::string escape_xml(const std::string& text);

/// Four significant digits, for a person.
std::string rounded(double value);

/// A quantity for a person: four significant digits and the prefix (n to G) that puts it between 1 and 1000,
/// as in "2.15 mN". `unit` stands without a prefix: "g", not "kg".
std::string with_prefix(double value, const std::string& unit);

/// Writes a whole file. Throws IoError with the system's reason.
void write_file(const std::string& file, const std::string& content);
/// The same, piece by piece: memory does not grow with the file.
void write_file(const std::string& file, const std::function<void(std::ostream&)>& write);

}  // namespace argil::output
