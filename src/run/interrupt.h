#pragma once

#include <csignal>
#include <stdexcept>
#include <string>

namespace argil::run {

/// From here on SIGINT and SIGTERM are noted and no longer end the program, and a file-size limit is an error
/// of the write, like a full disk.
void watch_signals();

/// One of them came since.
bool is_interrupted();

/// For a run within another program: forgets signals that came before. At its end signals do what they did at
/// its begin.
class SignalGuest {
 public:
  SignalGuest();
  ~SignalGuest();
  SignalGuest(const SignalGuest&) = delete;
  SignalGuest& operator=(const SignalGuest&) = delete;

  /// The signal that has come since; 0: none.
  int caught() const;

 private:
  struct sigaction m_interrupt_before, m_terminate_before, m_size_before;
};

/// Many runs were ended by a signal before they were over. Ends the program with exit code 130 and this
/// message.
class Interrupted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// While it lives, SIGINT and SIGTERM wait, and SIGCHLD is of interest: between a look at what there is to do
/// and sleep() none is lost.
class SignalPause {
 public:
  SignalPause();
  ~SignalPause();
  SignalPause(const SignalPause&) = delete;
  SignalPause& operator=(const SignalPause&) = delete;

  /// Until one of them comes, or came while it waited.
  void sleep() const;
  /// In a child that becomes another program: what they did before, as if there had been no pause. Allowed
  /// after a fork.
  void end_in_child() const;

 private:
  sigset_t m_before;
  struct sigaction m_child_before;
};

}  // namespace argil::run
