#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <exception>
#include <new>
#include <string_view>

#include "eval/cli/command.h"

namespace {

std::terminate_handler usual_end = nullptr;
std::atomic<bool> was_short{false};  // of memory, once

[[noreturn]] void note_and_throw() {
  was_short = true;
  throw std::bad_alloc();
}

/// If memory runs out in code that must not throw, nothing can be unwound: the destruction of a JSON value and the
/// message of a failing rollback take memory, and ODE cannot go on. The program then says so and ends as if it were
/// killed, which stores survive. Which exception it was is not always known here.
[[noreturn]] void end() {
  if (was_short) {
    constexpr std::string_view kWords = "moma: out of memory\n";
    (void)!write(STDERR_FILENO, kWords.data(), kWords.size());
    _exit(moma::cli::kBadInput);
  }
  usual_end();
  std::abort();
}

/// Runs before the constructors of all other objects of the program, which take memory too.
[[gnu::constructor(101)]] void set_ends() {
  std::set_new_handler(note_and_throw);
  usual_end = std::set_terminate(end);
}

}  // namespace

int main(int argc, char** argv) { return moma::cli::run_program(moma::cli::Arguments(argv, argv + argc)); }
