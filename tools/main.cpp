// The burin program: subcommands over the libraries. tools/commands.h describes the form of a command.
#include <unistd.h>

#include <exception>
#include <new>
#include <string_view>
#include <system_error>

#include "tools/command_line.h"

#ifdef __GLIBC__
namespace {

// Libraries of OpenImageIO start threads during loading, before main() could catch their exceptions.
[[noreturn]] void end_before_main() {
  std::string_view words = "burin: a library could not be loaded; this is a fault in Burin, please report it\n";
  try {
    if (const std::exception_ptr thrown = std::current_exception()) std::rethrow_exception(thrown);
  } catch (const std::system_error&) {
    words =
        "burin: threads: the system gives too few to begin with; raise the limit on processes and threads (ulimit -u), "
        "or end other programs\n";
  } catch (const std::bad_alloc&) {
    words = "burin: memory ran out before it began; close other programs, or lift a limit on memory (ulimit -v)\n";
  } catch (...) {
  }
  if (::write(STDERR_FILENO, words.data(), words.size()) < 0) ::_exit(1);
  ::_exit(1);
}

void catch_before_main(int, char**, char**) { std::set_terminate(end_before_main); }

// Runs before the initializers of all libraries.
__attribute__((section(".preinit_array"), used)) void (*const kCatchBeforeMain)(int, char**,
                                                                                char**) = catch_before_main;

}  // namespace
#endif

int main(int argc, char** argv) { return burin::run_program({argv + 1, argv + argc}); }
