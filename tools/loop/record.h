// tools/loop/record.h - inputs and outputs of one stage of a loop project: round-NN/made/STAGE.json
// (docs/file-formats.md).
//
// A record is written before a stage begins (Status::begun), and again at its end. Without a finished record, a stage
// is unfinished, in spite of any files. Records compare contents, not times: they hold paths relative to the project
// and SHA-256 hashes.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace burin {

using FileHashes = std::map<std::string, std::string>;   ///< by path relative to the project; "" for a missing file
using OptionTexts = std::map<std::string, std::string>;  ///< "tolerance-mm" to "3"

struct MadeRecord {
  enum class Status {
    begun,        ///< never ended: its files may be partial
    interrupted,  ///< ended early, by a signal or a time limit: a result, but not the requested one
    done,
    accepted,  ///< interrupted, then accepted with --keep
    adopted    ///< made before records existed (or by hand); its inputs are those at the time of --keep
  };

  /// Later differences that the user accepted with --keep. These contents and options raise no question.
  struct Kept {
    OptionTexts options;
    FileHashes inputs, outputs;
  };

  std::string stage;                          ///< "design"
  Status status = Status::begun;              ///<
  std::string burin;                          ///< the version that made it
  OptionTexts options;                        ///< as given
  FileHashes inputs, outputs;                 ///<
  Kept kept;                                  ///<
  std::vector<std::string> accepted_unknown;  ///< of a measured bench: undetermined parameters that the user accepts

  /// Returns true if its outputs count.
  bool holds() const { return status == Status::done || status == Status::accepted || status == Status::adopted; }
};

const char* in_words(MadeRecord::Status status);

/// Reads a record; a missing file gives nothing. Throws Error with file and field.
std::optional<MadeRecord> read_record(const std::filesystem::path& file);
void write_record(const MadeRecord& record, const std::filesystem::path& file);

/// Returns a file's name in a record: relative to the project, also for files outside of it.
std::string path_in_project(const std::filesystem::path& project, const std::filesystem::path& file);

}  // namespace burin
