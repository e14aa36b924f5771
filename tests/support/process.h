#pragma once

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/sanitized.h"

namespace moma::test {

struct ProcessResult {
  int code = -1;  ///< exit code; -1 where a signal ended it
  int signal = 0;
  std::string out;
  std::string err;
};

/// A program run without a shell, its output in files of `folder`, its input empty. Calls of moma, by env or not, are
/// copies of one that has loaded its libraries (ready.c).
class Process {
 public:
  Process(const std::vector<std::string>& arguments, const std::filesystem::path& folder)
      : out_(folder / ".stdout"), err_(folder / ".stderr") {
    pid_ = copy_of_ready(arguments, folder);
    if (pid_ > 0) return;
    std::vector<char*> argv;
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    pid_ = fork();
    if (pid_ < 0) throw std::runtime_error("fork failed");
    if (pid_ > 0) return;
    const int out = open(out_.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0644);
    const int err = open(err_.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0644);
    const int in = open("/dev/null", O_RDONLY);
    if (out < 0 || err < 0 || in < 0 || chdir(folder.c_str()) != 0) _exit(126);
    dup2(in, 0);
    dup2(out, 1);
    dup2(err, 2);
    execv(argv[0], argv.data());
    _exit(127);
  }

  ~Process() {
    if (pid_ > 0) {
      kill(SIGKILL);
      wait();
    }
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// Nothing where it has ended: kill() takes -1 for every process there is.
  void kill(int signal) const {
    if (pid_ > 0) ::kill(pid_, signal);
  }
  pid_t pid() const { return pid_; }

  bool running() {
    if (pid_ <= 0) return false;
    if (waitpid(pid_, &status_, WNOHANG) == pid_) pid_ = -1;
    return pid_ > 0;
  }

  ProcessResult wait() {
    if (pid_ > 0) {
      while (waitpid(pid_, &status_, 0) < 0 && errno == EINTR) continue;
      pid_ = -1;
    }
    ProcessResult result;
    result.code = WIFEXITED(status_) ? WEXITSTATUS(status_) : -1;
    result.signal = WIFSIGNALED(status_) ? WTERMSIG(status_) : 0;
    result.out = text(out_);
    result.err = text(err_);
    return result;
  }

 private:
  /// -1 where the call is of another program than moma. Sanitizers have to be the first library.
  static pid_t copy_of_ready(const std::vector<std::string>& arguments, const std::filesystem::path& folder) {
    static std::map<std::string, int> sockets;  // by what is preloaded
    const std::string moma = MOMA_BINARY_DIR "/moma", ready = MOMA_BINARY_DIR "/tests/ready.so",
                      preload = "LD_PRELOAD=";
    std::size_t first = arguments.front() == "/usr/bin/env" ? 1 : 0;
    std::string variables, preloaded = ready;
    int counts[2] = {0, 0};
    for (; first < arguments.size() && arguments[first].find('=') != std::string::npos; ++first, ++counts[1]) {
      variables += arguments[first] + '\0';
      if (arguments[first].starts_with(preload)) preloaded += ':' + arguments[first].substr(preload.size());
    }
    if (MOMA_SANITIZED || first >= arguments.size() || arguments[first] != moma) return -1;
    for (char** variable = environ; *variable != nullptr; ++variable, ++counts[1])
      variables += std::string(*variable) + '\0';
    counts[0] = static_cast<int>(arguments.size() - first);
    std::string message(reinterpret_cast<const char*>(counts), sizeof counts);
    message += folder.string() + '\0';
    for (; first < arguments.size(); ++first) message += arguments[first] + '\0';
    message += variables;

    int& to = sockets[preloaded];
    if (to == 0) {
      int ends[2];
      if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) throw std::runtime_error("no socket");
      if (fork() == 0) {
        const std::string here = std::to_string(dup(ends[1]));
        setenv("LD_PRELOAD", preloaded.c_str(), 1);
        setenv("MOMA_READY", here.c_str(), 1);
        execl(moma.c_str(), moma.c_str(), nullptr);
        _exit(127);
      }
      close(ends[1]);
      to = ends[0];
    }
    pid_t pid = -1;
    if (send(to, message.data(), message.size(), MSG_NOSIGNAL) < 0 || recv(to, &pid, sizeof pid, 0) != sizeof pid ||
        pid < 0)
      throw std::runtime_error("moma is not ready (" + ready + ")");
    return pid;
  }

  static std::string text(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  std::filesystem::path out_;
  std::filesystem::path err_;
  pid_t pid_ = -1;
  int status_ = 0;
};

}  // namespace moma::test
