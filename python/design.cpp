#include "design.h"

#include <atomic>
#include <exception>

namespace burin::python {

DesignResult watched_design(const DesignSpec& spec, const Board& board, const Bench& bench, DesignOptions options,
                            const std::function<bool(const DesignFrame&)>& on_frame,
                            const std::function<bool()>& interrupted) {
  std::atomic<bool> stopped = false;
  std::exception_ptr thrown;
  options.stop = [&] { return stopped || interrupted(); };
  options.watch = [&](const DesignFrame& frame) {
    if (stopped) return;
    try {
      if (!on_frame(frame)) stopped = true;
    } catch (...) {
      thrown = std::current_exception();
      stopped = true;
    }
  };
  DesignResult result = design(spec, board, bench, options, {});
  if (thrown) std::rethrow_exception(thrown);
  return result;
}

}  // namespace burin::python
