#include "json_mutation.h"

#include <array>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace {

using Json = nlohmann::json;

constexpr double kInfinity = std::numeric_limits<double>::max();
const std::array kNumbers = {Json(0),
                             Json(-0.0),
                             Json(1),
                             Json(-1),
                             Json(2),
                             Json(7),
                             Json(0.1),
                             Json(0.5),
                             Json(1e-3),
                             Json(1e-9),
                             Json(1e5),
                             Json(std::numeric_limits<double>::denorm_min()),
                             Json(1e-300),
                             Json(1e300),
                             Json(kInfinity),
                             Json(-kInfinity),
                             Json(std::int64_t{1} << 31),
                             Json((std::int64_t{1} << 53) + 1),
                             Json(std::numeric_limits<std::int64_t>::min()),
                             Json(std::numeric_limits<std::uint64_t>::max())};
const std::array kTexts = {Json(""),
                           Json("a"),
                           Json("/"),
                           Json("."),
                           Json("../a"),
                           Json("\xc3\xa9\\\"\n"),
                           Json(std::string(1, '\0')),
                           Json(std::string(300, 'x')),
                           Json("none"),
                           Json("auto")};
const std::array kOthers = {Json(nullptr),  Json(true),       Json(false), Json::array(),
                            Json::object(), Json::array({1}), Json("1"),   Json(1)};

struct Place {
  Json* value;
  const Json* schema;  ///< null: nothing is known of it
};

const Json* find(const Json* schema, const std::string& word) {
  if (schema == nullptr || !schema->is_object()) return nullptr;
  const auto found = schema->find(word);
  return found == schema->end() ? nullptr : &*found;
}

void list_places(Json& value, const Json* schema, std::vector<Place>& places) {
  places.push_back({&value, schema});
  if (value.is_object())
    for (auto& [key, member] : value.items())
      list_places(member, find(find(schema, "properties"), key), places);
  if (value.is_array())
    for (Json& element : value) list_places(element, find(schema, "items"), places);
}

class Change {
  template <typename List>
  const auto& choose(const List& list) {
    return list[m_random() % std::size(list)];
  }

 public:
  explicit Change(unsigned seed) : m_random(seed) {}

  void apply(Json& document, const Json& schema) {
    std::vector<Place> places;
    list_places(document, &schema, places);
    const auto [value, known] = choose(places);
    if (value->is_object() && m_random() % 4 != 0)
      change_keys(*value, find(known, "properties"));
    else if (value->is_array() && !value->empty() && m_random() % 2 == 0)
      change_length(*value);
    else
      *value = make_value(known, *value);
  }

 private:
  void change_keys(Json& object, const Json* known) {
    if (known == nullptr || known->empty() || m_random() % 4 == 0) {
      if (!object.empty())
        object.erase(std::next(object.begin(), static_cast<long>(m_random() % object.size())));
      return;
    }
    const auto key = std::next(known->begin(), static_cast<long>(m_random() % known->size()));
    object[key.key()] = make_value(&*key, nullptr);
  }

  void change_length(Json& list) {
    const std::size_t place = m_random() % list.size();
    if (m_random() % 2 == 0)
      list.erase(place);
    else
      list.push_back(Json(list[place]));
  }

  Json make_value(const Json* known, const Json& present) {
    if (m_random() % 16 == 0) return choose(kOthers);
    if (const Json* words = find(known, "enum"); words != nullptr && m_random() % 8 != 0)
      return choose(*words);
    const Json* named = find(known, "type");
    const std::string type =
        named != nullptr && named->is_string() ? named->get<std::string>() : present.type_name();
    if (type == "boolean") return m_random() % 2 == 0;
    if (type == "string") return choose(kTexts);
    if (type == "integer" || type == "number") return make_number(known);
    if (type == "object") return Json::object();
    if (type == "array") return make_list(known);
    return choose(kOthers);
  }

  Json make_number(const Json* known) {
    for (const char* bound : {"minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum"})
      if (const Json* value = find(known, bound); value != nullptr && m_random() % 4 == 0) return *value;
    return choose(kNumbers);
  }

  Json make_list(const Json* known) {
    const Json* least = find(known, "minItems");
    std::size_t length = least != nullptr ? least->get<std::size_t>() : 0;
    if (length == 0 || m_random() % 4 == 0) length = m_random() % 5;
    Json list = Json::array();
    while (list.size() < length) list.push_back(make_value(find(known, "items"), nullptr));
    return list;
  }

  std::minstd_rand m_random;
};

}  // namespace

std::optional<std::string> change_json(const std::string& text, const Json& schema, unsigned seed) {
  Json document = Json::parse(text, nullptr, false);
  if (document.is_discarded()) return std::nullopt;
  Change(seed).apply(document, schema);
  return document.dump(-1, ' ', false, Json::error_handler_t::replace);
}
