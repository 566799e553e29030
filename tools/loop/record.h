// tools/loop/record.h - what one stage of a loop project was made from: round-NN/made/STAGE.json
// (docs/file-formats.md).
//
// A record is written before a stage begins (Status::begun) and once more when it is done: what has no record that says
// done is not done, whatever files lie there. Contents count, not times: files are named by path, relative to the
// project, and SHA-256.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace burin {

using FileHashes = std::map<std::string, std::string>;  ///< by path relative to the project; "" for a file that is gone
using OptionTexts = std::map<std::string, std::string>;  ///< "tolerance-mm" to "3"

struct MadeRecord {
  enum class Status {
    begun,        ///< and never ended: what lies there may be half of a result
    interrupted,  ///< ended early, by a signal or a time limit: a result, but not what was asked for
    done,
    accepted,  ///< interrupted, and taken as it is by --keep
    adopted    ///< made before there were records (or by hand); its inputs are those of the day when --keep was said
  };

  /// What differed later, and was told to be kept: these contents and options raise no question any more.
  struct Kept {
    OptionTexts options;
    FileHashes inputs, outputs;
  };

  std::string stage;                          ///< "design"
  Status status = Status::begun;              ///<
  std::string burin;                          ///< the version that made it
  OptionTexts options;                        ///< that were given
  FileHashes inputs, outputs;                 ///<
  Kept kept;                                  ///<
  std::vector<std::string> accepted_unknown;  ///< of a measured bench: parameters to go on with undetermined

  /// Whether its outputs count.
  bool holds() const { return status == Status::done || status == Status::accepted || status == Status::adopted; }
};

const char* in_words(MadeRecord::Status status);

/// Throws Error naming file and field; a file that is not there is no record.
std::optional<MadeRecord> read_record(const std::filesystem::path& file);
void write_record(const MadeRecord& record, const std::filesystem::path& file);

/// How a record names a file: relative to the project, also from outside it.
std::string path_in_project(const std::filesystem::path& project, const std::filesystem::path& file);

}  // namespace burin
