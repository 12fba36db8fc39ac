#include "device/haply_message.h"

#include <nlohmann/json.hpp>

namespace argil::device::internal {
namespace {

using Json = nlohmann::json;

/// The member, or null when there is none or `object` is no object.
const Json& member(const Json& object, const char* name) {
  static const Json kNull;
  const auto found = object.is_object() ? object.find(name) : object.end();
  return found != object.end() ? *found : kNull;
}

/// Reads object[names[i]] into values[i]; false when one is no number.
template <std::size_t n>
bool read_numbers(const Json& object, const char* const (&names)[n], double* values) {
  for (std::size_t i = 0; i < n; ++i) {
    const Json& value = member(object, names[i]);
    if (!value.is_number()) return false;
    values[i] = value.get<double>();
  }
  return true;
}

const Json& find_device(const Json& list, std::string_view wanted_id) {
  static const Json kNull;
  if (!list.is_array()) return kNull;
  for (const Json& device : list) {
    const Json& id = member(device, "device_id");
    const std::string_view text = id.is_string() ? id.get_ref<const std::string&>() : std::string_view();
    if (!text.empty() && (wanted_id.empty() || text == wanted_id)) return device;
  }
  return kNull;
}

unsigned read_buttons(const Json& grip) {
  const Json& buttons = member(grip, "buttons");
  unsigned bits = member(grip, "button") == true ? 1U : 0U;  // a grip with a cable has one
  constexpr const char* kNames[] = {"a", "b", "c"};
  for (unsigned i = 0; i < 3; ++i)
    if (member(buttons, kNames[i]) == true) bits |= 1U << i;
  return bits;
}

/// Of the first grip, with or without a cable. False when there is one and its orientation is no quaternion.
bool read_grip(const Json& root, HaplyMessage& message) {
  for (const char* kind : {"wireless_verse_grip", "verse_grip"}) {
    const Json& grip = find_device(member(root, kind), "");
    if (grip.is_null()) continue;
    const Json& state = member(grip, "state");
    double q[4];
    if (!read_numbers(member(state, "orientation"), {"x", "y", "z", "w"}, q)) return false;
    message.orientation = Quat(q[3], q[0], q[1], q[2]);
    message.buttons = read_buttons(state);
    return true;
  }
  return true;
}

}  // namespace

HaplyMessage read_haply_message(std::string_view text, std::string_view wanted_id) {
  HaplyMessage message;
  const Json root = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!root.is_object()) {
    message.problem = "no JSON object";
    return message;
  }
  const Json& device = find_device(member(root, "inverse3"), wanted_id);
  if (device.is_null()) {
    message.problem = wanted_id.empty() ? "no Inverse3 is connected to the service"
                                        : "Inverse3 " + std::string(wanted_id) + " is not connected any more";
    return message;
  }
  message.device_id = member(device, "device_id").get<std::string>();
  const Json& kind = member(member(device, "config"), "type");
  if (kind.is_string()) message.kind = kind.get<std::string>();
  if (!read_numbers(member(member(device, "state"), "cursor_position"), {"x", "y", "z"},
                    message.position.data()))
    message.problem = "state.cursor_position has not three numbers";
  else if (!read_grip(root, message))
    message.problem = "state.orientation of the grip has not four numbers";
  return message;
}

std::string print_haply_force(std::string_view device_id, const Vec3& force) {
  const Json vector = {{"x", force.x()}, {"y", force.y()}, {"z", force.z()}};
  const Json command = {{"set_cursor_force", {{"vector", vector}}}};
  const Json device = {{"device_id", std::string(device_id)}, {"commands", command}};
  return Json{{"inverse3", Json::array({device})}}.dump();
}

}  // namespace argil::device::internal
