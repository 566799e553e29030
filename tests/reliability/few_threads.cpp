// A library to be preloaded (LD_PRELOAD): the system gives the process BURIN_MOST_THREADS threads beside its first one,
// and then no more, as under `ulimit -u` or in a container with few processes. That limit itself does not hold for
// root, and counts what else its user runs.
#include <dlfcn.h>
#include <pthread.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>

extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*run)(void*), void* with) {
  static std::atomic<int> made{0};
  const char* const most = std::getenv("BURIN_MOST_THREADS");
  if (most != nullptr && ++made > std::atoi(most)) return EAGAIN;
  static const auto real = reinterpret_cast<decltype(&pthread_create)>(dlsym(RTLD_NEXT, "pthread_create"));
  return real(thread, attributes, run, with);
}
