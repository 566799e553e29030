// tools/new/ask.h - questions to a person at a terminal: one at a time, the usual answer in brackets, asked again with
// the reason where an answer cannot be used.
#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

namespace burin {

/// Where questions go and answers come from.
struct Conversation {
  std::istream& in;
  std::ostream& out;
};

/// Asks "question [usual]: " until `use` takes the answer: it throws Error for one that cannot be used, which is said.
/// An empty line answers `usual`. Throws Error where the answers end (Ctrl-D).
void ask(Conversation& talk, const std::string& question, const std::string& usual,
         const std::function<void(const std::string&)>& use);

/// One of several questions, after which `use` may be called again where a person goes back to it.
struct Question {
  std::string words;
  std::function<std::string()> usual;
  std::function<void(const std::string&)> use;
};

/// Asks them in their order; "back" returns to the one before.
void ask_all(Conversation& talk, const std::vector<Question>& questions);

}  // namespace burin
