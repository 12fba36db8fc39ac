#pragma once

// Messages of the Haply Inverse Service's simulation channel: JSON text in, values out. The README names the
// fields and where they are documented.

#include <string>
#include <string_view>

#include "base/types.h"

namespace argil::device::internal {

/// What one message says of the first Inverse3, or of the one with the wanted id. Nothing is checked but the
/// form: numbers may be anything.
struct HaplyMessage {
  std::string problem;                  ///< why the message is none; empty: all is well
  std::string device_id;                ///< empty: no Inverse3 in it
  std::string kind;                     ///< "inverse3", "minverse", …; only the first message has it
  Vec3 position = Vec3::Zero();         ///< cursor [m]
  Quat orientation = Quat::Identity();  ///< of the grip; identity without one
  unsigned buttons = 0;                 ///< of the grip, bits a b c
};

/// Any bytes give a message; the words of `problem` name what is missing or wrong.
HaplyMessage read_haply_message(std::string_view text, std::string_view wanted_id);

/// The command that renders a force on a device, 17 digits. `force` [N], finite.
std::string print_haply_force(std::string_view device_id, const Vec3& force);

}  // namespace argil::device::internal
