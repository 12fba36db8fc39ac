#include "base/signal_stack.h"

namespace argil {

namespace {
constexpr std::size_t kSize = 1 << 16;  // [bytes]; a vendor's function may run on it
}

SignalStack::SignalStack() : m_memory(std::make_unique<char[]>(kSize)) {
  stack_t stack = {};
  stack.ss_sp = m_memory.get();
  stack.ss_size = kSize;
  sigaltstack(&stack, &m_before);
}

SignalStack::~SignalStack() {
  sigaltstack(&m_before, nullptr);
}

}  // namespace argil
