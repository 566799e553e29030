#include <filesystem>
#include <memory>

#include "burin/capture/folder_session.h"
#include "burin/render/error.h"
#include "tools/commands.h"
#include "tools/progress_bar.h"

namespace burin {

void add_capture_command(CLI::App& burin) {
  struct Options {
    std::filesystem::path photos, board, out;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = burin.add_subcommand("capture", "Turn a folder of photos into a session, and judge the photos");
  command
      ->add_option("PHOTOS_DIR", options->photos, "The folder of photos: JPEG, PNG, TIFF, EXR or camera raw, with EXIF")
      ->required();
  command->add_option("--board", options->board, "The board in the photos: board.json")->required();
  command->add_option("--out", options->out, "The folder for session.json")->required();
  command->footer(example("burin capture photos --board board.json --out session"));
  command->callback([options] {
    ProgressBar bar;
    const CaptureResult result = capture_folder(options->photos, options->board, options->out, bar.progress());
    bar.clear();
    int errors = 0;
    std::string first;
    for (const Finding& finding : result.findings) {
      if (finding.severity == Finding::Severity::error) {
        if (++errors == 1) first = sentence(finding);
        fmt::print(stderr, "error: {}\n", sentence(finding));
      } else {
        note(sentence(finding));
      }
    }
    if (result.written.empty())
      fail(options->photos.string(),
           fmt::format("{} error{} found, no session was written", errors, errors == 1 ? " was" : "s were"),
           "correct or remove the photos named above");
    fmt::print("Wrote {}: {} photos of {} view{}; next: burin calibrate {} --out {}\n", result.written.string(),
               result.session.photos.size(), result.views, result.views == 1 ? "" : "s",
               shell_word(result.written.string()), shell_word(options->out.string()));
  });
}

}  // namespace burin
