#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace argil {

/// Input that a user gave cannot be used. Ends the program with exit code 2 and this message.
/// The message reads "FILE: PLACE: PROBLEM; REMEDY": `place` is a line, JSON pointer, column or element
/// number (may be empty), `problem` names the value and the allowed range, `remedy` says what to do.
class InputError : public std::runtime_error {
 public:
  InputError(std::string_view file, std::string_view place, std::string_view problem,
             std::string_view remedy);
};

/// A file could not be read or written although its name and content were acceptable. Exit code 4.
class IoError : public std::runtime_error {
 public:
  IoError(std::string_view file, std::string_view problem);
};

}  // namespace argil
