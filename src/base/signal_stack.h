#pragma once

#include <signal.h>  // NOLINT: stack_t is POSIX

#include <memory>

namespace argil {

/// As long as this object is there, signal handlers that ask for it (SA_ONSTACK) run on a stack of their own
/// in the thread that made it: also when the thread's own stack has overflowed. Destroyed by the same thread.
class SignalStack {
 public:
  SignalStack();
  ~SignalStack();
  SignalStack(const SignalStack&) = delete;
  SignalStack& operator=(const SignalStack&) = delete;

 private:
  std::unique_ptr<char[]> m_memory;
  stack_t m_before = {};
};

}  // namespace argil
