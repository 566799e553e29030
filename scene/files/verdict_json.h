// burin/scene/files/verdict_json.h - verdicts in bench.json. docs/file-formats.md. Include it in .cpp files only: it
// pulls in nlohmann-json.
#pragma once

#include "burin/base/files/json_file.h"
#include "burin/scene/verdict.h"

namespace burin {

/// Facts, and beside them "reason" and "next_photo.words": the sentences that people read.
Json verdict_json(const Verdict& verdict);

/// The facts of version 2; its sentences are passed over.
Verdict read_verdict(JsonObject json);

/// The same of version 1, which had "determined", "weakly" and a sentence: the sentence is kept as it is (Cause::told),
/// and what it does not say as a fact is taken for measured.
Verdict read_verdict_of_version_1(JsonObject json);

}  // namespace burin
