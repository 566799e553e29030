// tools/steps.h - the commands that `burin loop` runs as its steps, as functions. Their command lines fill the same
// arguments.
//
// Each function does the whole work of its command, writes its files, reports diagnostics by tell(), and returns the
// result for print() (tools/output_mode.h). It throws Error if the work fails.
#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "burin/optimize/design_options.h"
#include "burin/simulate/simulated_camera.h"
#include "tools/facts.h"
#include "tools/report/carve_check_files.h"

namespace burin {

/// Arguments of `burin design`; an empty path or text is not given.
struct DesignArguments {
  std::filesystem::path spec, out, bench, board, from;
  std::vector<std::filesystem::path> carved;
  int scratches = 0;
  std::string start = "guided", exposure = "view", time, carve_time, machine;
  std::vector<std::string> free;  ///< "width", "depth", "alpha"
  DesignOptions design;
  bool live = false;
  double depth_um = 0;  ///< of the grooves; 0: the bench's
};

/// Arguments of `burin toolpath`.
struct ToolpathArguments {
  std::filesystem::path scratches, board, bench, out, sent, resume, heights, drawing;
  std::vector<std::filesystem::path> replay;
  std::string machine = "grbl", part, order;
  bool frame = false, mend = false, follow_bow = false;
  int decimals = 0, max_lines = -1;
  std::size_t at_line = 0;
};

/// Arguments of `burin check carve`.
struct CarveCheckArguments {
  std::filesystem::path what;  ///< scratches, or the folder of a round
  std::filesystem::path out;
  CarveCheckFiles files;
};

/// Arguments of `burin simulate`.
struct SimulateArguments {
  std::filesystem::path truth, out;
  SimulateOptions simulate;
  int samples = 0;  ///< 0: the truth's
};

/// Arguments of `burin capture`.
struct CaptureArguments {
  std::filesystem::path photos, board, bench, plan, out;
  std::string light, port;
  std::vector<double> stops;
  double f_number = 0;
  bool tether = false, once = false, new_lamp = false;
};

/// Arguments of `burin calibrate`.
struct CalibrateArguments {
  std::filesystem::path session, out, camera;
  std::string lens_model, response = "auto";
  std::vector<std::string> free;  ///< "lens", with `camera`
  bool holds_out = false;         ///< cross-validates by `hold_out`, which may be empty
  std::string hold_out;
};

/// Arguments of `burin refine`.
struct RefineArguments {
  std::filesystem::path session, bench, out;
  std::string crossings = "auto";
  std::vector<std::string> fix;  ///< "lamp"
  bool holds_out = false;        ///< cross-validates by `hold_out`, which may be empty
  std::string hold_out;
  std::optional<double> pixel_mm;
};

/// Arguments of `burin report`.
struct ReportArguments {
  std::filesystem::path folder, session, before, under, board;
};

/// Result of a design. `stopped_early`: a signal or --time ended it, and what it had is written.
struct DesignDone {
  Report report;
  bool stopped_early = false;
};

DesignDone run_design(const DesignArguments& arguments);
Report run_toolpath(const ToolpathArguments& arguments);
/// `command`: its options that a person gave stay as they are; others come from the project. Null: all are given.
Report run_carve_check(const CarveCheckArguments& arguments, const CLI::App* command = nullptr);
Report run_simulate(const SimulateArguments& arguments);
Report run_capture(const CaptureArguments& arguments);
Report run_calibrate(CalibrateArguments arguments);
Report run_refine(RefineArguments arguments);
Report run_report(const ReportArguments& arguments);

/// Adds a lamp's name and position to a report, as a line without its end.
void report_lamp(const Light& light, int digits, Facts lamp);

/// Add the options of `burin design`, `burin toolpath` and `burin capture` without those for files. `command` may be
/// another command that forwards them, such as `burin loop`.
void add_design_options(CLI::App& command, DesignArguments& arguments);
void add_toolpath_options(CLI::App& command, ToolpathArguments& arguments);
void add_capture_options(CLI::App& command, CaptureArguments& arguments);

}  // namespace burin
