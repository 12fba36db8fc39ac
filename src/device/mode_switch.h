#pragma once

#include "device/sample.h"

namespace argil::device {

/// Tool mode by buttons: pressing button 0 goes on to the next mode (push, pull, wet, dry, push, …), button 1
/// back to the one before. Holding a button does nothing more.
class ModeSwitch {
 public:
  explicit ModeSwitch(ToolMode mode) : m_mode(mode) {}
  /// `buttons`: bit i is set while button i is down. The mode from now on.
  ToolMode update(unsigned buttons) {
    const unsigned pressed = buttons & ~m_buttons;
    m_buttons = buttons;
    const int step = ((pressed & 1U) != 0 ? 1 : 0) - ((pressed & 2U) != 0 ? 1 : 0);
    m_mode = static_cast<ToolMode>((static_cast<int>(m_mode) + step + kNumToolModes) % kNumToolModes);
    return m_mode;
  }

 private:
  ToolMode m_mode;
  unsigned m_buttons = 0;
};

}  // namespace argil::device
