#include "base/status.h"

#include <sstream>

namespace argil {

std::string to_string(const Failure& failure) {
  std::ostringstream text;
  text.precision(9);
  text << "tick " << failure.tick << ", " << failure.stage << ": " << failure.quantity << " is "
       << failure.value << ", bound " << failure.bound;
  if (failure.element >= 0) text << ", element " << failure.element;
  return text.str();
}

}  // namespace argil
