// burin trace - follows a result back to its photos and pictures, by content.
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "tools/commands.h"
#include "tools/content_hash.h"
#include "tools/loop/record.h"
#include "tools/progress_bar.h"
#include "tools/project.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// A record and the place of its outputs: the original one, or a former/ folder.
struct KnownRecord {
  std::string name;  // "round-01/design"
  MadeRecord record;
  std::string former;  // folder relative to the project; empty: original place
};

struct Trace {
  Project project;
  std::vector<KnownRecord> records;
  ContentHashes hashes;
  std::set<std::string> told;  // path and hash
  std::set<const KnownRecord*> followed;
  std::set<std::string> changed;  // paths
  Report report;
};

void add_records(Trace& trace, const fs::path& folder, const std::string& prefix) {
  const auto add = [&](const fs::path& file, const std::string& former) {
    if (const std::optional<MadeRecord> record = read_record(file))
      trace.records.push_back({prefix + record->stage, *record, former});
  };
  if (fs::is_directory(folder / "made"))
    for (const auto& entry : fs::directory_iterator(folder / "made"))
      if (entry.path().extension() == ".json" && entry.path().filename().string().front() != '.') add(entry.path(), "");
  if (fs::is_directory(folder / "former"))
    for (const auto& entry : fs::directory_iterator(folder / "former"))
      add(entry.path() / "made.json", path_in_project(trace.project.folder, entry.path()));
}

// Returns the record of a file with these contents, preferably one in its original place. An edited result matches by
// the contents that --keep accepted.
const KnownRecord* maker_of(const Trace& trace, const std::string& name, const std::string& hash, bool any_name) {
  const KnownRecord* found = nullptr;
  for (const KnownRecord& known : trace.records) {
    const auto has = [&](const FileHashes& files) {
      if (const auto file = files.find(name); file != files.end() && file->second == hash) return true;
      if (!any_name) return false;
      for (const auto& [other, content] : files)
        if (content == hash) return true;
      return false;
    };
    if (!has(known.record.outputs) && !has(known.record.kept.outputs)) continue;
    if (!found || known.former.empty()) found = &known;
  }
  return found;
}

// State of an input file: "the same", "changed since", ...
std::string state_of_file(Trace& trace, const std::string& name, const std::string& hash, const KnownRecord* maker) {
  const std::string now = trace.hashes.of(trace.project.folder / name);
  if (now == hash) return hash.empty() ? "was not there" : "the same";
  // A repeated stage may have moved it.
  if (maker && !maker->former.empty()) {
    const fs::path round = fs::path(maker->former).parent_path().parent_path();
    const fs::path moved = fs::path(maker->former) / fs::path(name).lexically_relative(round);
    if (trace.hashes.of(trace.project.folder / moved) == hash) {
      trace.changed.insert(name);
      return fmt::format("changed since; as it was: {}", moved.string());
    }
  }
  trace.changed.insert(name);
  return now.empty() ? "GONE" : "CHANGED";
}

void follow(Trace& trace, const std::string& name, const std::string& hash, int depth) {
  Facts facts = trace.report.add("trace");
  facts.set("depth", depth);
  facts.set("file", name);
  facts.set("sha256", hash);
  const KnownRecord* maker = maker_of(trace, name, hash, depth == 0);
  const bool again = !trace.told.insert(name + " " + hash).second;
  std::string line = fmt::format("{:{}}{}  {}", "", 2 * depth, name, hash.substr(0, 12));
  if (depth > 0) {
    const std::string state = state_of_file(trace, name, hash, maker);
    facts.set("state", state);
    line += "  " + state;
  }
  if (again) {
    if (maker) facts.line("{}  (see above)\n", line);
    return;
  }
  if (!maker) {
    facts.line("{}\n", line);
    return;
  }
  const MadeRecord& record = maker->record;
  const auto made = record.outputs.find(name);
  const bool edited = made != record.outputs.end() && made->second != hash;
  line += fmt::format("  by {}{}, Burin {}{}", maker->name,
                      record.status == MadeRecord::Status::done ? "" : std::string(", ") + in_words(record.status),
                      record.burin, edited ? ", then changed by hand" : "");
  facts.set("stage", maker->name);
  facts.set("burin", record.burin);
  facts.set("edited", edited);
  if (!trace.followed.insert(maker).second) {
    facts.line("{}  (see above)\n", line);
    return;
  }
  for (const auto& [option, text] : record.options) line += fmt::format(", {} {}", option, text);
  facts.line("{}\n", line);
  for (const auto& [input, content] : record.inputs) follow(trace, input, content, depth + 1);
}

// Returns the nearest project with rounds above the file.
fs::path project_folder_of(const fs::path& file) {
  for (fs::path folder = fs::absolute(file).lexically_normal().parent_path();; folder = folder.parent_path()) {
    if (fs::exists(folder / "design.json") && Project{folder}.rounds() > 0) return folder;
    if (folder == folder.parent_path()) break;
  }
  fail(file.string(), "lies in no loop project", "name the one that made it: --project DIR");
}

Report run(const fs::path& file, const fs::path& project) {
  Trace trace;
  ProgressBar bar;
  bar.progress()("looking whether files are as they were", 0);
  trace.project.folder = project.empty() ? project_folder_of(file) : project;
  const std::string hash = trace.hashes.of(file);
  if (hash.empty()) fail(file.string(), "is no file", "name a file that burin loop made");
  add_records(trace, trace.project.folder, "");
  for (int round = 1; round <= trace.project.rounds(); ++round)
    add_records(trace, trace.project.round(round), trace.project.round(round).filename().string() + "/");
  const std::string name = path_in_project(trace.project.folder, file);
  if (!maker_of(trace, name, hash, true)) {
    for (const KnownRecord& known : trace.records)
      if (known.former.empty() && known.record.outputs.contains(name))
        fail(file.string(), "was changed since " + known.name + " made it", "its record is of other contents");
    fail(file.string(), "was made by no stage of " + trace.project.folder.string(),
         "name a result, such as a G-code, a report or a bench of one of its rounds");
  }
  follow(trace, name, hash, 0);
  bar.clear();
  trace.report.data["changed"] = trace.changed;
  if (!trace.changed.empty())
    trace.report.failure.emplace(ErrorCode::refused, file.string(),
                                 fmt::format("{} of the files that it rests on {} what {} when it was made",
                                             trace.changed.size(), trace.changed.size() == 1 ? "is not" : "are not",
                                             trace.changed.size() == 1 ? "it was" : "they were"),
                                 "they are marked above");
  else
    trace.report.line("It rests on {}, as they were when it was made.\n", counted(trace.told.size() - 1, "file"));
  return trace.report;
}

}  // namespace

void add_trace_command(CLI::App& burin) {
  struct Options {
    fs::path file, project;
  };
  auto o = std::make_shared<Options>();
  CLI::App* command =
      burin.add_subcommand("trace", "Trace a result to its input files, and check that they are unchanged");
  command
      ->add_option("FILE", o->file, "Trace this G-code, report, bench.json or table; copies are found by content hash")
      ->required();
  command->add_option("--project", o->project,
                      "Search this project for the file's origin [default: the file's own project]");
  command->footer(example("burin trace small-bench/round-01/board.gcode"));
  command->callback([o] { print(run(o->file, o->project)); });
}

}  // namespace burin
