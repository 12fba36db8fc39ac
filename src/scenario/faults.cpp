#include "scenario/faults.h"

#include <algorithm>
#include <map>
#include <string_view>

namespace argil::scenario {
namespace {

constexpr std::size_t kMostSaid = 50;

bool is_below(std::string_view pointer, std::string_view above) {
  return pointer.starts_with(above) && (pointer.size() == above.size() || pointer[above.size()] == '/');
}

/// Where a value begins and ends, counted in beginnings and ends.
struct Stretch {
  std::size_t begin = 0;
  std::size_t end = 0;
};

class Places {
 public:
  explicit Places(const Json& document) { count(document, ""); }
  /// What is not there comes at the end of the object that it is missed in, and what is
  /// of another file at last.
  std::size_t find(std::string pointer) const {
    if (pointer.empty()) return m_count;
    for (bool is_there = true;; is_there = false) {
      if (const auto found = m_places.find(pointer); found != m_places.end())
        return is_there ? found->second.begin : found->second.end;
      pointer.resize(pointer.rfind('/'));
    }
  }

 private:
  void count(const Json& value, const std::string& pointer) {
    const std::size_t begin = m_count++;
    if (value.is_object())
      for (const auto& [key, below] : value.items()) count(below, pointer + "/" + escape_key(key));
    if (value.is_array())
      for (std::size_t i = 0; i < value.size(); ++i) count(value[i], pointer + "/" + std::to_string(i));
    m_places[pointer] = {begin, m_count++};
  }
  std::map<std::string, Stretch> m_places;
  std::size_t m_count = 0;
};

}  // namespace

void Faults::add(const std::string& message) {
  if (const std::size_t end = message.find('\n'); end != std::string::npos) {  // gathered below
    add(message.substr(0, end));
    add(message.substr(end + 1));
    return;
  }
  const std::string begin = m_file + ": /";
  std::string pointer;
  if (message.starts_with(begin)) {
    const std::size_t first = begin.size() - 1;
    pointer = message.substr(first, message.find(": ", first) - first);
  }
  const bool is_known = std::any_of(m_list.begin(), m_list.end(), [&](const Fault& f) {
    return pointer.empty() ? f.message == message : f.pointer == pointer;
  });
  if (!is_known) m_list.push_back({pointer, message});
}

bool Faults::concerns(const std::string& pointer) const {
  return std::any_of(m_list.begin(), m_list.end(), [&](const Fault& fault) {
    return !fault.pointer.empty() && (is_below(fault.pointer, pointer) || is_below(pointer, fault.pointer));
  });
}

bool Faults::explains(const std::string& pointer) const {
  return std::any_of(m_list.begin(), m_list.end(),
                     [&](const Fault& f) { return !f.pointer.empty() && is_below(pointer, f.pointer); }) ||
         std::find(m_misspelt.begin(), m_misspelt.end(), pointer) != m_misspelt.end();
}

void Faults::throw_all(const Json& document) {
  if (m_list.empty()) return;
  const Places places(document);
  std::stable_sort(m_list.begin(), m_list.end(), [&](const Fault& a, const Fault& b) {
    return places.find(a.pointer) < places.find(b.pointer);
  });
  std::string text;
  for (std::size_t i = 0; i < std::min(m_list.size(), kMostSaid); ++i)
    text += (i > 0 ? "\n" : "") + m_list[i].message;
  if (m_list.size() > kMostSaid) text += "\n" + std::to_string(m_list.size() - kMostSaid) + " more";
  throw InputError("", "", text, "");
}

}  // namespace argil::scenario
