#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "scenario/json_document.h"

namespace argil::scenario {

/// What is wrong with an input, gathered so that one message names all of it, a line each.
class Faults {
 public:
  explicit Faults(std::string file) : m_file(std::move(file)) {}

  /// Runs `check` and keeps what it refuses; was there nothing?
  template <class Check>
  bool check(const Check& check) {
    try {
      check();
      return true;
    } catch (const InputError& error) {
      add(error.what());
      return false;
    }
  }
  /// "FILE: POINTER: …" as an InputError has it; a second fault of one pointer, and what was said before,
  /// is left out.
  void add(const std::string& message);
  /// The key is there under another name, which was refused: it is not missed, too.
  void add_misspelt(const std::string& pointer) { m_misspelt.push_back(pointer); }

  bool empty() const { return m_list.empty(); }
  /// Is there a fault of the key, of one above or of one below it?
  bool concerns(const std::string& pointer) const;
  /// Is the key missing because of a fault that is known: of one above, or of its spelling?
  bool explains(const std::string& pointer) const;
  /// Throws them as one InputError, if there are any, in the order of the document's keys.
  void throw_all(const Json& document = Json::object());

 private:
  struct Fault {
    std::string pointer;
    std::string message;
  };
  std::string m_file;
  std::vector<Fault> m_list;
  std::vector<std::string> m_misspelt;
};

}  // namespace argil::scenario
