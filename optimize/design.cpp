#include "burin/optimize/design.h"

#include "burin/optimize/design/design_run.h"

namespace burin {

DesignResult design(const DesignSpec& spec, const Board& board, const Bench& bench, const DesignOptions& options,
                    const Progress& progress) {
  return DesignRun(spec, board, bench, options, progress).run();
}

}  // namespace burin
