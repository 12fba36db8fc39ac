#include "run/interrupt.h"

#include <csignal>

namespace argil::run {
namespace {

volatile std::sig_atomic_t g_interrupted = 0;  // the signal; the one thing a signal handler may touch

void on_signal(int signal) {
  g_interrupted = signal;
}

void on_child(int) {}  // a signal that is ignored would not end a sleep

}  // namespace

void watch_signals() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  std::signal(SIGXFSZ, SIG_IGN);
}

bool is_interrupted() {
  return g_interrupted != 0;
}

SignalGuest::SignalGuest() : m_interrupt_before(), m_terminate_before(), m_size_before() {
  g_interrupted = 0;
  sigaction(SIGINT, nullptr, &m_interrupt_before);
  sigaction(SIGTERM, nullptr, &m_terminate_before);
  sigaction(SIGXFSZ, nullptr, &m_size_before);
}

SignalGuest::~SignalGuest() {
  sigaction(SIGINT, &m_interrupt_before, nullptr);
  sigaction(SIGTERM, &m_terminate_before, nullptr);
  sigaction(SIGXFSZ, &m_size_before, nullptr);
}

int SignalGuest::caught() const {
  return g_interrupted;
}

SignalPause::SignalPause() : m_before(), m_child_before() {
  sigset_t held;
  sigemptyset(&held);
  for (const int signal : {SIGINT, SIGTERM, SIGCHLD}) sigaddset(&held, signal);
  pthread_sigmask(SIG_BLOCK, &held, &m_before);
  struct sigaction action {};
  action.sa_handler = on_child;
  sigemptyset(&action.sa_mask);
  sigaction(SIGCHLD, &action, &m_child_before);
}

SignalPause::~SignalPause() {
  sigaction(SIGCHLD, &m_child_before, nullptr);
  pthread_sigmask(SIG_SETMASK, &m_before, nullptr);
}

void SignalPause::sleep() const {
  sigset_t open = m_before;
  for (const int signal : {SIGINT, SIGTERM, SIGCHLD}) sigdelset(&open, signal);
  sigsuspend(&open);
}

void SignalPause::end_in_child() const {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
  sigaction(SIGCHLD, &m_child_before, nullptr);
  sigprocmask(SIG_SETMASK, &m_before, nullptr);
}

}  // namespace argil::run
