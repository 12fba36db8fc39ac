#pragma once

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <vector>

namespace argil::test {

/// Another program, whose standard output is read line by line. Its standard input closes, and it is waited
/// for, at the end.
class ChildProcess {
 public:
  /// Runs in `folder`, by default in this process's own.
  explicit ChildProcess(std::vector<std::string> command, const std::string& folder = ".") {
    int input[2], output[2];
    if (pipe(input) != 0 || pipe(output) != 0) ADD_FAILURE() << "no pipe";
    std::vector<char*> arguments;
    for (std::string& word : command) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    m_child = fork();
    if (m_child == 0) {
      dup2(input[0], STDIN_FILENO);
      dup2(output[1], STDOUT_FILENO);
      for (const int end : {input[0], input[1], output[0], output[1]}) close(end);
      if (chdir(folder.c_str()) == 0) execv(arguments[0], arguments.data());
      _exit(127);
    }
    close(input[0]);
    close(output[1]);
    m_input = input[1];
    m_output = output[0];
  }
  ~ChildProcess() { wait(); }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// The next line without its end; empty after the last, or when none comes for a minute.
  std::string read_line() {
    for (;;) {
      const std::size_t end = m_text.find('\n');
      if (end != std::string::npos) {
        const std::string line = m_text.substr(0, end);
        m_text.erase(0, end + 1);
        return line;
      }
      pollfd waited{m_output, POLLIN, 0};
      char piece[4096];
      const ssize_t size = ::poll(&waited, 1, 60000) > 0 ? read(m_output, piece, sizeof piece) : 0;
      if (size <= 0) return {};
      m_text.append(piece, static_cast<std::size_t>(size));
    }
  }
  pid_t id() const { return m_child; }
  /// Closes its input and waits; its status as waitpid gives it.
  int wait() {
    if (m_child <= 0) return m_status;
    close(m_input);
    waitpid(m_child, &m_status, 0);
    close(m_output);
    m_child = 0;
    return m_status;
  }

 private:
  pid_t m_child = 0;
  int m_status = 0;
  int m_input = -1;
  int m_output = -1;
  std::string m_text;
};

}  // namespace argil::test
