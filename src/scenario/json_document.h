#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace argil::scenario {

using Json = nlohmann::ordered_json;

/// Parses text strictly: no comments, no duplicate keys, at most 64 levels and 10 000 keys an object. Throws
/// InputError with line and column, or with the pointer of a key that stands twice.
Json parse_json(const std::string& text, const std::string& file);

/// Reads and parses a file of at most 64 MiB. Throws InputError or IoError.
Json read_json(const std::string& file);

/// A value as text, its end left out where it is long.
std::string shorten(const Json& json);

/// A key as it stands in a JSON pointer: ~ as ~0, / as ~1.
std::string escape_key(const std::string& key);

/// The entry of `keys` that is nearest to `key` by edit distance; empty when none is near.
std::string find_nearest(const std::string& key, const std::vector<std::string>& keys);

}  // namespace argil::scenario
