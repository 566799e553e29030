// The burin program: subcommands over the libraries. How a command is made stands in tools/commands.h.
#include <malloc.h>

#include "tools/command_line.h"

int main(int argc, char** argv) {
#ifdef __GLIBC__
  // Grooves that cut each other are a hundred megabytes of pieces, made anew in each iteration. Memory that goes back
  // to the system in between comes back page by page and cleared, which is a tenth of such an iteration's time.
  mallopt(M_TRIM_THRESHOLD, 1 << 30);  // bytes
  mallopt(M_MMAP_MAX, 0);
#endif
  return burin::run_program({argv + 1, argv + argc});
}
