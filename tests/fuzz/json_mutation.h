#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

/// The document with one place changed as no bytes at random would: a value of another size or type, a key
/// that `schema` (JSON Schema, or null) knows there and that is not given, one left out, an element twice.
/// Nothing where `text` is not JSON. The same `seed` makes the same change.
std::optional<std::string> change_json(const std::string& text, const nlohmann::json& schema, unsigned seed);
