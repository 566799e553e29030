// burin/scene/files/verdict_json.h - verdicts in bench.json. docs/file-formats.md. Include it in .cpp files only: it
// pulls in nlohmann-json.
#pragma once

#include "burin/base/files/json_file.h"
#include "burin/scene/verdict.h"

namespace burin {

/// Facts, plus two sentences for people: "reason" and "next_photo.words".
Json verdict_json(const Verdict& verdict);

/// Reads the facts of version 2 and ignores its sentences.
Verdict read_verdict(JsonObject json);

/// Reads version 1, which had "determined", "weakly" and a sentence. Cause::told keeps the sentence. The source of a
/// number is `measured`, except for given ones.
Verdict read_verdict_of_version_1(JsonObject json);

}  // namespace burin
